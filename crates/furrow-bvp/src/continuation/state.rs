//! The state of a continuation, and what its steps report.

use serde::{Deserialize, Serialize};

use crate::direction::Direction;
use crate::invalid::{self, InvalidInput};
use crate::newton::NewtonReport;
use crate::solution::Solution;

use super::predictor::History;

/// State of a run, sufficient to resume it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct State {
    /// The newest point.
    pub solution: Solution,
    /// Its unit tangent.
    pub tangent: Direction,
    /// Arclength from the first point.
    pub arclength: f64,
    /// The step to try next.
    pub step: f64,
    /// Points accepted, the first included.
    pub points: usize,
    /// Sign of dλ/ds as last confirmed with exact factors; 0 if not known.
    pub direction: f64,
    /// Sign of the determinant bordered by the tangent: the same all along a branch; 0 if not known.
    #[serde(default)]
    pub orientation: f64,
    /// The last points, for the predictor.
    pub history: History,
}

impl State {
    /// Checks that tangent and history belong to the solution, and that there is a step to go on with.
    ///
    /// # Errors
    /// [`InvalidInput`].
    pub fn check(&self) -> Result<(), InvalidInput> {
        self.solution.check()?;
        self.tangent.check(&self.solution)?;
        self.history.check(&self.solution)?;
        invalid::setting("the arclength", self.arclength, self.arclength.is_finite(), "a finite number")?;
        invalid::setting("the step", self.step, self.step > 0.0, "a number above 0")
    }

    /// Value of λ.
    pub fn parameter(&self) -> f64 {
        self.solution.scalars.last().copied().unwrap_or(f64::NAN)
    }

    /// dλ/ds.
    pub fn parameter_slope(&self) -> f64 {
        self.tangent.scalars.last().copied().unwrap_or(f64::NAN)
    }
}

/// The result of one accepted step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Advance {
    /// dλ/ds changed sign: a fold lies between the last two points.
    pub passed_fold: bool,
    /// Another branch crosses between the last two points, and this one goes straight on:
    /// [`locate::branch_point`](crate::locate::branch_point) finds where. A step past two of them shows neither.
    /// Where λ has an extremum there, as on the branch that bends at a pitchfork, `passed_fold` is true as well.
    pub passed_branch_point: bool,
    /// Work of the corrector.
    pub report: NewtonReport,
    /// Steps rejected before.
    pub rejected: usize,
    /// Largest defect of the point, where a [`tolerance`](crate::ContinuationSettings::tolerance) is set; see also
    /// [`Continuation::defect`](crate::Continuation::defect).
    pub defect: Option<f64>,
}

/// Why following a branch ended.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub enum Termination {
    /// λ left its range; the last point lies on the bound.
    ParameterBound(f64),
    /// The largest number of points is reached.
    PointLimit(usize),
    /// Solutions degenerate in the step after the last point, see
    /// [`BoundaryValueProblem::is_degenerate`](crate::BoundaryValueProblem::is_degenerate): a branch of cycles ends at a Hopf point.
    Degenerate,
    /// The visitor returned false.
    Stopped,
}
