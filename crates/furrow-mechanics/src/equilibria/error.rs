//! Why a branch of stationary shapes, or a point of it, could not be computed.

use furrow_bvp::{ContinuationError, CurveError, NewtonError, SingularError};

use crate::law::{self, LawError};
use crate::polarity::{self, PolarityError};
use furrow_cell::{Cell, Parameter};
use furrow_input::rounded_number;
use std::borrow::Cow;

/// A kind of singular point.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum PointKind {
    /// The mirror symmetry breaks.
    Pitchfork,
    /// The branch turns in ξ_s.
    Fold,
}

impl std::fmt::Display for PointKind {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(if *self == PointKind::Pitchfork { "pitchfork" } else { "fold" })
    }
}

/// Which of the points is searched for: cells have folds that bound no stable shapes.
fn which(kind: PointKind) -> &'static str {
    if kind == PointKind::Fold { " that ends stable shapes" } else { "" }
}

/// The cell in an error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CellName {
    /// Radius R0.
    pub r0: f64,
    /// Confinement ε.
    pub epsilon: f64,
}

impl CellName {
    /// The name of a cell in messages.
    pub fn of(cell: &Cell) -> CellName {
        CellName { r0: cell.r0, epsilon: cell.epsilon }
    }

    /// Advice if a cell has no passive shape.
    pub(crate) fn advice(&self) -> &'static str {
        match self.r0 {
            0.01..1000.0 => "try a tension nearer to 0, an aspect nearer to 1, or more mesh intervals",
            _ => "passive shapes are found of cells of R0 from 0.01 to 1000",
        }
    }
}

/// A number in a message, with as many digits as distinguish shapes.
pub(super) fn digits(number: f64) -> String {
    rounded_number(number, 7)
}

/// Advice if a cell with its cue has no passive shape.
fn advice_on_cue(painted: bool) -> &'static str {
    if painted { "try a cue of smaller amplitude, or more mesh intervals" } else { "try more mesh intervals" }
}

impl std::fmt::Display for CellName {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "R0 = {}, epsilon = {}", digits(self.r0), digits(self.epsilon))
    }
}

/// Corrections of Newton's method below this stop decreasing by rounding, which grows with the mesh.
const ROUNDING: f64 = 1e-7;

/// On which mesh a branch may be followed that was lost.
fn better_mesh(source: &ContinuationError) -> &'static str {
    use furrow_bvp::{NewtonError, StepFailure};
    match source {
        ContinuationError::Start { source: NewtonError::Stalled { correction, .. }, .. }
        | ContinuationError::Lost { source: StepFailure::Newton(NewtonError::Stalled { correction, .. }), .. }
            if *correction < ROUNDING =>
        {
            "fewer"
        }
        _ => "more",
    }
}

/// The result of a search among shapes.
pub type Result<T, E = ShapeError> = std::result::Result<T, E>;

/// Why a stationary branch, or a point of it, could not be computed.
#[expect(missing_docs, reason = "the messages say what the fields are")]
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ShapeError {
    /// No passive shape to start from.
    #[error("no passive shape for {cell} ({source}); {}", cell.advice())]
    Passive { cell: CellName, source: NewtonError },
    /// The passive cell with its cue has no shape.
    #[error("no passive shape with the cue for {cell} ({source}); {}", advice_on_cue(*painted))]
    Cue { cell: CellName, source: NewtonError, painted: bool },
    /// The branch cannot be followed.
    #[error("{cell}: {source}; try {} mesh intervals", better_mesh(source))]
    Branch { cell: CellName, source: ContinuationError },
    /// A singular point on the way cannot be located.
    #[error("{cell}: the {kind} near xi_s = {} cannot be located: {source}", digits(*xi_s))]
    Point { cell: CellName, kind: PointKind, xi_s: f64, source: SingularError },
    /// The range contains no such point.
    #[error("{cell}: no {kind}{} for xi_s up to {}", which(*kind), digits(*xi_max))]
    NotFound { cell: CellName, kind: PointKind, xi_max: f64 },
    /// The branch of the passive shape has a fold but no pitchfork, and returns to a cell without activity.
    #[error("{cell}: no pitchfork: the branch of the passive shape turns back at the fold at xi_s = {}", digits(*xi_s))]
    TurnsBack { cell: CellName, xi_s: f64 },
    /// The cell's own law of active stress is refused, or cannot hold.
    #[error("{cell}: {source}")]
    Law { cell: CellName, source: LawError },
    /// The cell's cue, its law, or its shell, distinguishes the poles: its branch has folds but no pitchfork.
    #[error("{cell}: {cue} breaks the mirror symmetry, and with it the pitchfork; its shapes are bounded by a fold")]
    NoPitchfork { cell: CellName, cue: String },
    /// Neither end of a range has the point from which a curve could be followed.
    #[error("{source}; the curve begins at an end of the range, and {parameter} = {} has no such point or leads to none: try another range", digits(*to))]
    NoEnd { source: Box<ShapeError>, parameter: Parameter, to: f64 },
    /// A curve of singular points does not reach the requested value.
    #[error("the curve of {kind}s does not reach {parameter} = {}: {source}", digits(*value))]
    Curve { kind: PointKind, parameter: Parameter, value: f64, source: CurveError },
    /// A curve of singular points ends at shapes without activity.
    #[error("the curve of {kind}s does not reach {parameter} = {}: xi_s falls to 0 on the way", digits(*value))]
    Inactive { kind: PointKind, parameter: Parameter, value: f64 },
    /// Perturbations of this azimuthal number decay along the branch of the passive shape.
    #[error("{cell}: disturbances m = {m} do not grow on the branch of the passive shape up to xi_s = {xi_s:.4}")]
    NoGrowth { cell: CellName, m: usize, xi_s: f64 },
    /// A curve of thresholds of such perturbations does not reach the requested value.
    #[error(
        "the threshold of disturbances m = {m} is not found beyond {parameter} = {}, on the way to {}",
        digits(*reached),
        digits(*value)
    )]
    ThresholdLost { m: usize, parameter: Parameter, reached: f64, value: f64 },
    /// Cells below a critical radius divide, or do not come to rest.
    #[error("{cell}: the {kind} at R0 = {} bounds no division: smaller cells do not rest", digits(*r0))]
    NoBound { cell: CellName, kind: PointKind, r0: f64 },
    /// Cells above a critical radius rest as well: on a branch that this point does not end.
    #[error("{cell}: division begins above the {kind} at R0 = {}: cells of {above:.6} rest too", digits(*r0))]
    RestsAbove { cell: CellName, kind: PointKind, r0: f64, above: f64 },
    /// The position of a cue that follows PAR polarity could not be computed.
    #[error("{cell}: PAR polarity, which the cue follows: {source}")]
    Polarity { cell: CellName, source: PolarityError },
    /// The shell or the cue is not round.
    #[error(
        "{cell}: a flattened shell, or a cue at one side of the axis, has no shapes with axial symmetry; only single divisions, trees and states at rest are computed without it"
    )]
    NoAxis { cell: CellName },
    /// Without turnover, every amount of a regulator has its own shapes at rest.
    #[error(
        "{cell}: regulator.turnover = 0: shapes at rest need a turnover above 0, since without it every amount of the regulator has its own"
    )]
    NoTurnover { cell: CellName },
    /// A cue that follows PAR polarity differs for every cell.
    #[error(
        "{cell}: the cue follows PAR polarity and differs for every cell: its {kind}s have no curve; write it as the step or the band that furrow polarity prints"
    )]
    FollowsPar { cell: CellName, kind: PointKind },
    /// States that are bent to one side, without axial symmetry.
    #[error("{cell}: bent states: {reason}")]
    Bent { cell: CellName, reason: String },
    /// Not found within the budget.
    #[error("{cell}: not found in {steps} steps along branches and curves, the largest number tried")]
    OutOfBudget { cell: CellName, steps: usize },
    /// The search was interrupted.
    #[error("interrupted")]
    Interrupted,
}

/// The cell, with cues that follow PAR polarity at their resolved positions.
///
/// # Errors
/// [`ShapeError::Polarity`], [`ShapeError::NoTurnover`], [`ShapeError::NoAxis`] and [`ShapeError::Law`].
pub(crate) fn resolved(cell: &Cell) -> Result<Cow<'_, Cell>> {
    if cell.cue.regulator().is_some_and(|regulator| regulator.turnover == 0.0) {
        return Err(ShapeError::NoTurnover { cell: CellName::of(cell) });
    }
    if !cell.has_axis() {
        return Err(ShapeError::NoAxis { cell: CellName::of(cell) });
    }
    law::check(cell).map_err(|source| ShapeError::Law { cell: CellName::of(cell), source })?;
    polarity::resolved(cell).map_err(|source| ShapeError::Polarity { cell: CellName::of(cell), source })
}

/// Refuses a law of the cell's own, for computations with the paper's law alone.
///
/// # Errors
/// [`ShapeError::Law`].
pub(crate) fn with_paper_law(cell: &Cell) -> Result<()> {
    let Some(law) = &cell.law else { return Ok(()) };
    Err(ShapeError::Law { cell: CellName::of(cell), source: LawError::WithoutAxis { law: law.name().to_owned() } })
}
