//! Growth rates of small disturbances of a stationary surface, with every azimuthal number that the space holds.
//!
//! With J the derivatives of the balances and B what multiplies ∂_tX, disturbances e^{σt} satisfy J x + σ B x = 0. The rates
//! nearest to a shift s belong to the largest eigenvalues 1/(s − σ) of (J + s B)⁻¹ B.

use furrow_spectra::{Arnoldi, EigenError, Krylov, NoEigenvalues};

use crate::linear::Singular;
use crate::problem::{Motion, Problem, State};

/// A growth rate, in 1/τ.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rate {
    /// Real part: positive if the disturbance grows.
    pub re: f64,
    /// Imaginary part; pairs appear with both signs.
    pub im: f64,
}

/// Why growth rates were not found.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum RatesError {
    /// The shift is a growth rate.
    #[error(transparent)]
    Singular(#[from] Singular),
    /// The eigenvalues were not found.
    #[error(transparent)]
    Eigenvalues(#[from] EigenError),
    /// The small dense problem failed.
    #[error(transparent)]
    Dense(#[from] NoEigenvalues),
}

/// Where rates are sought, in 1/τ: somewhat above the fastest that cells at rest have.
const SHIFT: f64 = 6.0;

impl Problem {
    /// The `wanted` growth rates nearest to the shift, largest real part first; those of disturbances with azimuthal number
    /// `only` if the surface is axisymmetric and `only` is given.
    ///
    /// # Errors
    /// [`RatesError`].
    pub fn rates(&self, state: &State, wanted: usize, only: Option<usize>) -> Result<Vec<Rate>, RatesError> {
        let at = |rate: f64| {
            // At rest, ∂_tX = 0.
            let past = state.surface.iter().map(|x| -rate * x).collect();
            let mut problem = self.clone();
            problem.motion = Motion { rate, past };
            problem.noise.clear();
            problem.jacobian(state)
        };
        let (still, shifted) = (at(0.0), at(SHIFT));
        let size = still.size();
        let kept = self.kept(only);
        let keep = |x: &mut [f64]| x.iter_mut().zip(&kept).for_each(|(x, kept)| *x *= kept);
        let moving = shifted.clone();
        let factored = shifted.factor()?;
        let apply = |from: &[f64], to: &mut [f64]| -> Result<(), RatesError> {
            let mut from = from.to_vec();
            keep(&mut from);
            let (a, b) = (moving.apply(&from), still.apply(&from));
            to.iter_mut().zip(a.iter().zip(b)).for_each(|(to, (a, b))| *to = (a - b) / SHIFT);
            factored.solve(to, 0.0);
            keep(to);
            Ok(())
        };
        let arnoldi = Arnoldi { wanted, max_dimension: 80, tolerance: 1e-8 };
        let found = arnoldi.largest(&mut Krylov::default(), &vec![1.0; size], apply)?;
        let rate = |re: f64, im: f64| {
            let square = re * re + im * im;
            Rate { re: SHIFT - re / square, im: im / square }
        };
        let mut rates: Vec<Rate> = found.iter().map(|value| rate(value.re, value.im)).collect();
        rates.sort_by(|a, b| b.re.total_cmp(&a.re).then(b.im.total_cmp(&a.im)));
        Ok(rates)
    }

    /// 1 for the unknowns with azimuthal number `only`, 0 for others.
    fn kept(&self, only: Option<usize>) -> Vec<f64> {
        let space = &self.space;
        let mut kept = vec![1.0; space.unknowns()];
        for spline in 0..space.splines() {
            for (harmonic, of) in space.harmonics.iter().enumerate() {
                let unknowns = [0, 1].map(|field| space.unknown(spline, field, harmonic));
                if only.is_some_and(|m| m != of.azimuthal()) {
                    unknowns.into_iter().flatten().for_each(|k| kept[k] = 0.0);
                }
            }
        }
        kept
    }
}
