//! Growth rates of small disturbances of a stationary surface, for all azimuthal modes of the function space.
//!
//! With J the derivatives of the balances and B the coefficient matrix of ∂_tX, disturbances e^{σt} satisfy J x + σ B x = 0. The
//! rates nearest to a shift s correspond to the largest eigenvalues 1/(s − σ) of (J + s B)⁻¹ B.

use furrow_spectra::{Arnoldi, EigenError, Krylov, NoEigenvalues};

use crate::linear::Singular;
use crate::problem::{Motion, Problem, State};
use crate::space::Harmonic;

/// A growth rate, in 1/τ.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rate {
    /// Real part: positive if the disturbance grows.
    pub re: f64,
    /// Imaginary part; complex pairs appear with both signs.
    pub im: f64,
}

/// The reason why growth rates were not found.
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

/// Disturbances among which growth rates are sought.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Among {
    /// All disturbances in the function space.
    All,
    /// Disturbances of one azimuthal mode number m, for an axisymmetric surface.
    Azimuthal(usize),
    /// Disturbances that preserve the mirror symmetry u → 1 − u of a surface.
    Even,
    /// Disturbances that break it.
    Odd,
}

/// The shift, in 1/τ at viscosity 1, slightly above the largest growth rates of stationary cells.
const SHIFT: f64 = 6.0;

impl Problem {
    /// The `wanted` growth rates nearest to the shift, largest real part first.
    ///
    /// # Errors
    /// [`RatesError`].
    pub fn rates(&self, state: &State, wanted: usize, among: Among) -> Result<Vec<Rate>, RatesError> {
        let at = |rate: f64| {
            // At rest, ∂_tX = 0.
            let past = state.surface.iter().map(|x| -rate * x).collect();
            let mut problem = self.clone();
            problem.motion = Motion { rate, past };
            problem.noise.clear();
            problem.drag = 0.0;
            problem.jacobian(state)
        };
        let shift = SHIFT / self.viscosity();
        let (still, shifted) = (at(0.0), at(shift));
        let size = still.size();
        let keep = self.projection(among);
        let moving = shifted.clone();
        let factored = shifted.factor()?;
        let apply = |from: &[f64], to: &mut [f64]| -> Result<(), RatesError> {
            let mut from = from.to_vec();
            keep(&mut from);
            let (a, b) = (moving.apply(&from), still.apply(&from));
            to.iter_mut().zip(a.iter().zip(b)).for_each(|(to, (a, b))| *to = (a - b) / shift);
            factored.solve(to, &[0.0]);
            keep(to);
            Ok(())
        };
        let arnoldi = Arnoldi { wanted, max_dimension: 80, tolerance: 1e-8 };
        let found = arnoldi.largest(&mut Krylov::default(), &vec![1.0; size], apply)?;
        let rate = |re: f64, im: f64| {
            let square = re * re + im * im;
            Rate { re: shift - re / square, im: im / square }
        };
        let mut rates: Vec<Rate> = found.iter().map(|value| rate(value.re, value.im)).collect();
        rates.sort_by(|a, b| b.re.total_cmp(&a.re).then(b.im.total_cmp(&a.im)));
        Ok(rates)
    }

    /// The projection onto the requested disturbances.
    pub(crate) fn projection(&self, among: Among) -> impl Fn(&mut [f64]) + use<> {
        let parts = self.partners(among);
        move |x: &mut [f64]| {
            let from = x.to_vec();
            for (x, (k, share, partner)) in x.iter_mut().zip(&parts) {
                *x = share * *x + partner * from[*k];
            }
        }
    }

    /// For each unknown its mirror partner, and the factors of both.
    fn partners(&self, among: Among) -> Vec<(usize, f64, f64)> {
        let space = &self.space;
        let last = space.splines() - 1;
        let mut parts: Vec<(usize, f64, f64)> = (0..space.unknowns()).map(|k| (k, 1.0, 0.0)).collect();
        for (spline, field) in (0..=last).flat_map(|spline| [(spline, 0), (spline, 1)]) {
            for (harmonic, of) in space.harmonics.iter().enumerate() {
                let Some(k) = space.unknown(spline, field, harmonic) else { continue };
                let mirrored = space.unknown(last - spline, field, harmonic).unwrap_or(k);
                // The mirror image reverses z.
                let sign = if matches!(of, Harmonic::Along(_)) { -0.5 } else { 0.5 };
                parts[k] = match among {
                    Among::All => (k, 1.0, 0.0),
                    Among::Azimuthal(m) => (k, if m == of.azimuthal() { 1.0 } else { 0.0 }, 0.0),
                    Among::Even => (mirrored, 0.5, sign),
                    Among::Odd => (mirrored, 0.5, -sign),
                };
            }
        }
        parts
    }
}
