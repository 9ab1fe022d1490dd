//! Settings of a continuation, and why one fails.

use crate::dense::PivotFailure;
use crate::dimensions::Dimensions;
use crate::invalid::{self, InvalidInput, short};
use crate::linear::FactorisationError;
use crate::metric::Metric;
use crate::newton::{BUDGET, Interrupt, Newton, NewtonError, Stop};
use crate::solution::Solution;

/// Settings of a continuation.
#[derive(Clone, Debug, PartialEq)]
pub struct ContinuationSettings {
    /// The corrector. Few factorisations: a step that needs more is too long.
    pub newton: Newton,
    /// First step, in arclength.
    pub first_step: f64,
    /// Smallest step before giving up.
    pub min_step: f64,
    /// Largest step.
    pub max_step: f64,
    /// Smallest cosine between the tangents of neighbouring points.
    pub min_cosine: f64,
    /// Move the mesh when the largest interval carries this many times its share of the monitor.
    pub remesh_above: f64,
    /// Number of points between checks of the mesh; 1 checks at every point.
    pub remesh_every: usize,
    /// Bound on the largest defect of every point, see [`mesh::defect`](crate::mesh::defect): the mesh is refined where it is exceeded, and coarsened
    /// where fewer intervals do. Newton's tolerance is tightened where this one asks for it. None leaves the number of
    /// intervals as it is.
    pub tolerance: Option<f64>,
    /// Most intervals of a refined mesh.
    pub max_intervals: usize,
    /// Most work of one step, in factorisations of a mesh of `max_intervals`.
    pub budget: f64,
    /// Ends a step from outside.
    pub interrupt: Interrupt,
}

impl Default for ContinuationSettings {
    fn default() -> Self {
        ContinuationSettings {
            newton: Newton { max_factorisations: 3, max_iterations: 8, min_damping: 0.2, ..Newton::default() },
            first_step: 0.05,
            min_step: 1e-8,
            max_step: 1.0,
            min_cosine: 0.9,
            remesh_above: 1.8,
            remesh_every: 1,
            tolerance: None,
            max_intervals: 2000,
            budget: BUDGET,
            interrupt: Interrupt::default(),
        }
    }
}

impl ContinuationSettings {
    /// Checks the settings.
    ///
    /// # Errors
    /// [`InvalidInput::Setting`].
    pub fn check(&self) -> Result<(), InvalidInput> {
        let ContinuationSettings { first_step, min_step, max_step, min_cosine, remesh_above, remesh_every, .. } = *self;
        self.newton.check()?;
        invalid::setting("the budget", self.budget, self.budget > 0.0, "a number above 0")?;
        invalid::positive("first_step", first_step)?;
        invalid::positive("min_step", min_step)?;
        invalid::setting("max_step", max_step, max_step > 0.0, "a number above 0")?;
        invalid::setting("min_cosine", min_cosine, (-1.0..1.0).contains(&min_cosine), "a number from −1, below 1")?;
        invalid::setting("remesh_above", remesh_above, remesh_above >= 1.0, "a number from 1")?;
        invalid::setting("remesh_every", remesh_every as f64, remesh_every > 0, "a whole number from 1")?;
        self.tolerance.map_or(Ok(()), |tolerance| invalid::positive("the tolerance", tolerance))
    }
}

/// Checks that a problem lacks one condition, for its last scalar unknown, and that guess and metric fit it.
pub(super) fn check_problem(dims: Dimensions, y: &Solution, metric: &Metric) -> Result<(), InvalidInput> {
    y.fits(dims)?;
    if dims.missing_conditions() != 1 {
        return Err(InvalidInput::NotSquare { missing: dims.missing_conditions(), allowed: "1" });
    }
    invalid::index("scalar unknown", 0, dims.scalars)?;
    metric.check(y)
}

/// Why a step along a branch failed.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum StepFailure {
    /// The corrector does not converge.
    #[error(transparent)]
    Newton(#[from] NewtonError),
    /// The tangents at both ends of the step are too far apart.
    #[error("the branch turns too sharply (cosine {cosine:.3})")]
    Turn {
        /// Cosine of the angle between the tangents.
        cosine: f64,
    },
    /// The point found is not on the branch the step set out from.
    #[error("the step leads to another branch")]
    OtherBranch,
    /// The solution found has degenerated, see [`BoundaryValueProblem::is_degenerate`](crate::BoundaryValueProblem::is_degenerate).
    #[error("solutions degenerate")]
    Degenerate,
    /// There is no tangent: the system bordered by the plane condition is singular.
    #[error("the Jacobian is singular (pivot {})", .0.column)]
    Singular(PivotFailure),
}

impl From<FactorisationError> for StepFailure {
    fn from(error: FactorisationError) -> Self {
        match error {
            FactorisationError::Invalid(input) => input.into(),
            FactorisationError::Pivot(failure) => StepFailure::Singular(failure),
        }
    }
}

impl From<InvalidInput> for StepFailure {
    fn from(input: InvalidInput) -> Self {
        NewtonError::Invalid(input).into()
    }
}

/// Why a continuation failed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ContinuationError {
    /// The problem, the point to start from, the metric or the settings are refused.
    #[error(transparent)]
    Invalid(#[from] InvalidInput),
    /// No first point.
    #[error("no first point at parameter {}: {source}", short(*parameter))]
    Start {
        /// Value of λ.
        parameter: f64,
        /// Error of the solver.
        source: NewtonError,
    },
    /// Solutions degenerate at the start or in the step after the last point, as a cycle that shrinks to an equilibrium.
    #[error("the solution degenerates at parameter {} after arclength {}: a cycle is an equilibrium there", short(*parameter), short(*arclength))]
    Degenerate {
        /// Value of λ at the last point.
        parameter: f64,
        /// Arclength of the last point.
        arclength: f64,
    },
    /// The corrector fails for the smallest step.
    #[error("the branch is lost at parameter {} after arclength {}: {source}", short(*parameter), short(*arclength))]
    Lost {
        /// Value of λ at the last point.
        parameter: f64,
        /// Arclength of the last point.
        arclength: f64,
        /// The last failure.
        source: StepFailure,
    },
    /// A step was ended from outside. The state is left at the last point.
    #[error("{reason} at parameter {} after arclength {}", short(*parameter), short(*arclength))]
    Stopped {
        /// Why.
        reason: Stop,
        /// Value of λ at the last point.
        parameter: f64,
        /// Arclength of the last point.
        arclength: f64,
    },
    /// The accuracy asked for would need more intervals than allowed, or narrower ones than numbers can tell apart.
    #[error(
        "the limit of {limit} intervals is reached at parameter {} with a defect of {defect:.3e}, \
         the tolerance is {tolerance:.3e}",
        short(*parameter)
    )]
    MeshLimit {
        /// Most intervals allowed.
        limit: usize,
        /// Value of λ at the point that is not accurate enough.
        parameter: f64,
        /// Its defect.
        defect: f64,
        /// What was asked for.
        tolerance: f64,
    },
}
