//! Phase diagrams: outcomes over one parameter of a cell and its activity.
//!
//! A cell without a cue stays at rest where the primary branch has a stable shape. The exact folds and pitchforks of the branch bound
//! this region in each column; without axial symmetry the first pitchfork or fold of the bent states does. Elsewhere, and for every
//! cell with a cue, divisions are computed: such a cell may pass its stable shape on the way from the passive one.

use std::sync::atomic::{AtomicUsize, Ordering};

use serde::Serialize;

use super::memo::{Failure, Memo};
use super::scheduler::{self, SchedulerError, SchedulerOptions, Solved, Summary};
use super::solve::{resting, solve};
use furrow_cell::{Cell, Numerics, Parameter};
use furrow_mechanics::division::{Division, DivisionInput, Outcome};
use furrow_mechanics::equilibria::at_rest::{Edge, RestShapes};
use furrow_mechanics::equilibria::error::ShapeError;

/// A grid over one parameter of a cell and its activity.
///
/// # Examples
/// Outcomes for three sizes at the default activity: rest, unequal, equal.
///
/// ```
/// use furrow_lineage::batch::phase::PhaseOutcome::{Asymmetric, Failed, Symmetric};
/// use furrow_lineage::batch::{Memo, PhasePlane, Quantisation, SchedulerOptions};
/// use furrow_cell::{Cell, Numerics, Parameter};
/// let (cell, numerics) = (Cell::new(1.0), Numerics::default());
/// let across = vec![1.6, 2.0, 2.6];
/// let plane = PhasePlane { cell, numerics, parameter: Parameter::R0, across, up: vec![25.0], seed: 0 };
/// let diagram = plane.compute(&Memo::new(Quantisation::DEFAULT), &SchedulerOptions::default())?;
/// let found: Vec<_> = diagram.cells.iter().map(|cell| cell.outcome).collect();
/// assert_eq!(found, [Failed, Asymmetric, Symmetric]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct PhasePlane {
    /// The cell; the parameter across and ξ_s are replaced.
    pub cell: Cell,
    /// Discretisation.
    pub numerics: Numerics,
    /// The parameter across.
    pub parameter: Parameter,
    /// Its values.
    pub across: Vec<f64>,
    /// Values of ξ_s, 0 or above.
    pub up: Vec<f64>,
    /// Seed of the noise of every division.
    pub seed: u64,
}

/// The outcome of a cell at a point of the plane.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum PhaseOutcome {
    /// It divides into equal daughters.
    Symmetric,
    /// It divides into unequal daughters.
    Asymmetric,
    /// It stays at rest.
    Failed,
    /// Its division could not be computed.
    Undecided,
}

/// The evidence for an outcome.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Evidence {
    /// A stable shape exists, and no cue acts.
    Curves,
    /// A division was computed.
    Division,
}

/// One point of the plane.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct PhaseCell {
    /// Value of the parameter across.
    pub x: f64,
    /// Activity ξ_s.
    pub xi_s: f64,
    /// The outcome of the cell.
    pub outcome: PhaseOutcome,
    /// χ of its division.
    pub chi: Option<f64>,
    /// The evidence for the outcome.
    pub by: Evidence,
}

/// The exact edges at one value across.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Column {
    /// Value of the parameter across.
    pub x: f64,
    /// Intervals of ξ_s with a stable shape.
    pub at_rest: Vec<[f64; 2]>,
    /// Folds and pitchforks along the branch.
    pub edges: Vec<Edge>,
    /// The reason if the branch could not be followed; divisions are then computed for the whole column.
    #[serde(skip)]
    pub error: Option<ShapeError>,
}

/// A phase diagram.
#[derive(Clone, Debug, PartialEq)]
pub struct PhaseDiagram {
    /// Points, column by column, from the first ξ_s to the last in each.
    pub cells: Vec<PhaseCell>,
    /// Edges by column.
    pub columns: Vec<Column>,
    /// The reasons why divisions are undecided, and their number, if there are any.
    pub undecided: Option<(Failure, usize)>,
    /// The summary of the work for the divisions.
    pub summary: Summary,
}

/// Called with the number of finished columns and the number of all columns.
pub(crate) type ColumnsShown<'a> = &'a (dyn Fn(usize, usize) + Sync);

/// Evenly spaced values, including both ends; only the first if `points` is 1.
pub fn spaced(from: f64, to: f64, points: usize) -> Vec<f64> {
    let last = (points.max(2) - 1) as f64;
    (0..points).map(|k| if k + 1 == points && k > 0 { to } else { from + (to - from) * k as f64 / last }).collect()
}

impl PhasePlane {
    fn cell_at(&self, x: f64) -> Cell {
        let mut cell = self.cell.clone();
        self.parameter.set(&mut cell, x);
        cell
    }

    /// The stable shapes of every column, on all cores.
    fn columns(&self, threads: usize, shown: ColumnsShown<'_>) -> Result<Vec<Column>, SchedulerError> {
        // The search extends slightly beyond the diagram so that its upper edge is included.
        let xi_max = 1.01 * self.up.iter().copied().fold(0.0, f64::max) + 0.1;
        let done = AtomicUsize::new(0);
        let column = |&x: &f64| {
            let found = resting(&self.cell_at(x), &self.numerics, xi_max);
            let error = found.as_ref().err().cloned();
            let RestShapes { intervals, edges } = found.unwrap_or_default();
            shown(done.fetch_add(1, Ordering::Relaxed) + 1, self.across.len());
            Column { x, at_rest: intervals, edges, error }
        };
        let pool = scheduler::pool(threads)?;
        Ok(pool.install(|| scheduler::in_parallel(self.across.len(), |k| column(&self.across[k]))))
    }

    /// Computes the diagram.
    ///
    /// # Errors
    /// [`SchedulerError`] if no workers can be started. A division that cannot be computed is counted in
    /// [`PhaseDiagram::undecided`], and [`Summary::interrupted`] is set if the run was stopped.
    pub fn compute(&self, memo: &Memo, options: &SchedulerOptions<'_>) -> Result<PhaseDiagram, SchedulerError> {
        self.compute_shown(memo, options, &|_, _| ())
    }

    /// The same, with a callback. Stationary shapes are computed before the divisions, column by column; `shown` gets the number of
    /// finished columns and the number of all columns.
    ///
    /// # Errors
    /// As [`compute`](PhasePlane::compute).
    pub fn compute_shown(
        &self,
        memo: &Memo,
        options: &SchedulerOptions<'_>,
        shown: ColumnsShown<'_>,
    ) -> Result<PhaseDiagram, SchedulerError> {
        let columns = self.columns(options.threads, shown)?;
        let points = || columns.iter().flat_map(|column| self.up.iter().map(move |xi_s| (column, *xi_s)));
        let rests = |column: &Column, xi_s: f64| {
            let stable = column.at_rest.iter().any(|[a, b]| (*a..=*b).contains(&xi_s));
            stable && !self.cell_at(column.x).has_cue()
        };
        let inputs = points().filter(|(column, xi_s)| !rests(column, *xi_s)).map(|(column, xi_s)| {
            let cell = Cell { xi_s, ..self.cell_at(column.x) };
            DivisionInput { cell, numerics: self.numerics, seed: self.seed }
        });
        let Solved { divisions, unsolved, summary } = scheduler::solve_all(inputs, memo, options, solve)?;
        let undecided = unsolved.first().map(|job| (job.failure.clone(), unsolved.len()));
        let mut divisions = divisions.into_iter();
        let cell = |(column, xi_s): (&Column, f64)| match rests(column, xi_s) {
            true => point(column.x, xi_s, Evidence::Curves, None),
            false => point(column.x, xi_s, Evidence::Division, divisions.next().flatten().as_ref()),
        };
        let cells = points().map(cell).collect();
        Ok(PhaseDiagram { cells, columns, undecided, summary })
    }
}

fn point(x: f64, xi_s: f64, by: Evidence, division: Option<&Division>) -> PhaseCell {
    let outcome = match (by, division.map(|d| d.outcome())) {
        (Evidence::Curves, _) | (_, Some(Outcome::Arrested)) => PhaseOutcome::Failed,
        (_, Some(Outcome::Symmetric)) => PhaseOutcome::Symmetric,
        (_, Some(Outcome::Asymmetric)) => PhaseOutcome::Asymmetric,
        (_, None) => PhaseOutcome::Undecided,
    };
    PhaseCell { x, xi_s, outcome, chi: division.and_then(|d| d.chi()), by }
}
