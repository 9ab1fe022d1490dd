//! Test functions of singular points: scalars that vanish there.

use crate::dimensions::Dimensions;
use crate::direction::Direction;
use crate::invalid::InvalidInput;
use crate::linear::{FactorisationError, System};
use crate::solution::Solution;

/// Why a singular point was not found.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SingularError {
    /// The problem, the point, the metric or the kind of singularity are refused.
    #[error(transparent)]
    Invalid(#[from] InvalidInput),
    /// A pivot vanished where the extended system should be regular.
    #[error(
        "the extended system is singular after {iterations} iterations: two singularities coincide, or none is near"
    )]
    Singular {
        /// Iterations done.
        iterations: usize,
    },
    /// The iteration does not converge.
    #[error("no convergence to the singular point in {iterations} iterations (last correction {correction:.3e})")]
    Stalled {
        /// Iterations done.
        iterations: usize,
        /// Last correction.
        correction: f64,
    },
    /// The iteration converges, but to another singular point than the one looked for.
    #[error("the iteration leads to another one, {distance:.1e} times the distance of the points around it away")]
    Elsewhere {
        /// How far outside the bracket, in its lengths.
        distance: f64,
    },
}

impl From<FactorisationError> for SingularError {
    fn from(error: FactorisationError) -> Self {
        match error {
            FactorisationError::Invalid(input) => SingularError::Invalid(input),
            FactorisationError::Pivot(_) => SingularError::Singular { iterations: 0 },
        }
    }
}

/// A scalar g(x) that vanishes at a kind of singular point.
pub trait Singularity<P> {
    /// Checks that problems of these sizes can have such points.
    ///
    /// # Errors
    /// [`InvalidInput`].
    fn check(&self, _problem: &P, _dims: Dimensions) -> Result<(), InvalidInput> {
        Ok(())
    }

    /// g at the point where `system` was factorised; `w` is the null direction of F with all but the first free parameter
    /// fixed, normalised by the first linear condition of `system`.
    ///
    /// # Errors
    /// If g cannot be computed for a vanishing pivot.
    fn evaluate(&mut self, system: &mut System, problem: &P, w: &Direction) -> Result<f64, FactorisationError>;

    /// Sign that changes at the singularity and nowhere else, for the value of g just computed.
    fn sign(&self, g: f64) -> f64 {
        g.signum()
    }

    /// Derivative of g along `d`, after [`evaluate`](Self::evaluate) at the same place.
    ///
    /// # Errors
    /// If the system has no factors or other sizes.
    fn derivative(
        &mut self,
        system: &mut System,
        problem: &mut P,
        y: &Solution,
        w: &Direction,
        d: &Direction,
    ) -> Result<f64, InvalidInput>;
}
