//! Newton's method for a step or a stationary surface.

use furrow_bvp::Work;

use crate::linear::{Factored, Singular};
use crate::problem::{Problem, Residual, State};

/// Settings of Newton's method.
#[derive(Clone, Copy, Debug)]
pub struct Newton {
    /// Largest change of a coefficient of the surface, relative to R0, at which the iteration ends.
    pub tolerance: f64,
    /// The same relative to the first change. The difference of a shape from its extrapolation must be resolved even if it is small;
    /// otherwise small disturbances continue unchanged, as if by inertia.
    pub share: f64,
    /// Largest number of iterations.
    pub iterations: usize,
    /// Contraction factor above which the derivatives are recomputed.
    pub slow: f64,
}

/// Changes below this, relative to R0, are rounding errors.
const ROUNDING: f64 = 1e-10;

/// The reason why Newton's method failed.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum NewtonError {
    /// The linear equations are singular.
    #[error(transparent)]
    Singular(#[from] Singular),
    /// The iteration does not converge.
    #[error("Newton's method does not converge: a change of {change:.1e} R0 after {iterations} iterations")]
    NotConverged {
        /// The last change, relative to R0.
        change: f64,
        /// Number of iterations.
        iterations: usize,
    },
}

impl Problem {
    /// Adds a change of all unknowns; returns the largest change of a coefficient of the surface.
    pub fn change(&self, state: &mut State, by: &[f64], pressure: f64) -> f64 {
        let count = self.space.harmonics.len();
        let mut largest: f64 = 0.0;
        for spline in 0..self.space.splines() {
            for harmonic in 0..count {
                if let Some(k) = self.space.unknown(spline, 0, harmonic) {
                    state.surface[spline * count + harmonic] += by[k];
                    largest = largest.max(by[k].abs());
                }
                if let Some(k) = self.space.unknown(spline, 1, harmonic) {
                    state.flow[spline * count + harmonic] += by[k];
                }
            }
        }
        state.pressure += pressure;
        largest
    }

    /// Radius R0 of the sphere with the cell's volume.
    pub fn radius(&self) -> f64 {
        (self.constants.volume * 0.75 / std::f64::consts::PI).cbrt()
    }

    /// Removes the second-order change of the volume of the last step.
    fn keep_volume(&self, state: &mut State, factored: &Factored) {
        let excess = self.volume(&state.surface) - self.constants.volume;
        let mut change = vec![0.0; self.space.unknowns()];
        let border = factored.solve(&mut change, &[-excess]);
        self.change(state, &change, border[0]);
    }

    /// Solves for a state near the given one. `known` may contain the derivatives of a similar problem, and returns the last ones.
    ///
    /// # Errors
    /// [`NewtonError`]; the state is then the last iterate.
    pub fn solve(
        &self,
        newton: &Newton,
        state: &mut State,
        known: &mut Option<Factored>,
        work: &mut Work,
    ) -> Result<(), NewtonError> {
        let scale = self.radius();
        let mut before = f64::INFINITY;
        let mut change = f64::INFINITY;
        let mut tolerance = newton.tolerance;
        for iteration in 0..newton.iterations {
            let factored = match known {
                Some(factored) => factored,
                None => {
                    work.factorisations += 1;
                    known.insert(self.jacobian(state).factor()?)
                }
            };
            work.iterations += 1;
            let Residual { mut balances, volume } = self.residual(state);
            balances.iter_mut().for_each(|b| *b = -*b);
            let pressure = factored.solve(&mut balances, &[-volume])[0];
            change = self.change(state, &balances, pressure) / scale;
            if !(change.is_finite() && pressure.is_finite()) {
                return Err(NewtonError::NotConverged { change, iterations: iteration + 1 });
            }
            // Newton steps converge quadratically, steps with old derivatives linearly.
            let contraction = change / before;
            let left = if contraction < 1.0 { change * contraction / (1.0 - contraction) } else { change };
            if iteration == 0 {
                tolerance = newton.tolerance.min(newton.share * change).max(ROUNDING);
            }
            if change < tolerance || iteration > 0 && left < tolerance {
                self.keep_volume(state, factored);
                return Ok(());
            }
            if contraction > newton.slow {
                *known = None;
            }
            before = change;
        }
        Err(NewtonError::NotConverged { change, iterations: newton.iterations })
    }
}
