//! Turning points of a parameter along a branch.

use crate::dimensions::Dimensions;
use crate::direction::{Direction, Residual};
use crate::invalid::{self, InvalidInput};
use crate::linear::{FactorisationError, System};
use crate::problem::Directional;
use crate::problem::derivatives::second_residual;
use crate::solution::Solution;

use super::singularity::Singularity;

/// A turning point of scalar unknown `parameter`: g = its component in w.
///
/// [`MinimallyAugmented`](crate::MinimallyAugmented) has an example.
#[derive(Clone, Debug)]
pub struct Fold {
    /// Index of the parameter among the scalar unknowns.
    pub parameter: usize,
    residual: Residual,
    change: Direction,
}

impl Fold {
    /// For a parameter given by its index, which must be one of the problem's: see [`Singularity::check`].
    pub fn new(parameter: usize) -> Fold {
        Fold { parameter, residual: Residual::default(), change: Direction::default() }
    }
}

impl<P: Directional> Singularity<P> for Fold {
    fn check(&self, _: &P, dims: Dimensions) -> Result<(), InvalidInput> {
        invalid::index("scalar unknown", self.parameter, dims.scalars)
    }

    fn evaluate(&mut self, _: &mut System, _: &P, w: &Direction) -> Result<f64, FactorisationError> {
        Ok(w.scalars.get(self.parameter).copied().unwrap_or(f64::NAN))
    }

    /// J w = 0 along x + d: J w′ = −D²F\[d, w\].
    fn derivative(
        &mut self,
        system: &mut System,
        problem: &mut P,
        y: &Solution,
        w: &Direction,
        d: &Direction,
    ) -> Result<f64, InvalidInput> {
        let conditions = system.dimensions().linear_conditions();
        second_residual(&system.gauss, problem, y, [d, w], conditions, &mut self.residual);
        system.solve(&self.residual, &mut self.change)?;
        Ok(self.change.scalars.get(self.parameter).copied().unwrap_or(f64::NAN))
    }
}
