//! Growth rates, and their computation from one implicit step.

use furrow_bvp::{FactorisationError, InvalidInput};
use furrow_spectra::{Arnoldi, Krylov, NoEigenvalues, RitzValue};

use super::shifts::REACH;

/// Symmetry of a mode under reflection at the equator.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Parity {
    /// r even, z odd: the mode keeps the mirror symmetry.
    Even,
    /// r odd, z even: the mode breaks it.
    Odd,
    /// The state is given on the full domain; the symmetry of the mode is not known.
    Mixed,
}

/// One growth rate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GrowthRate {
    /// Re σ, in 1/τ; positive grows.
    pub re: f64,
    /// Im σ, in 1/τ.
    pub im: f64,
    /// Symmetry of the mode.
    pub parity: Parity,
    /// Estimated error of σ, from the residual of its Ritz pair.
    pub error: f64,
}

/// The rightmost growth rates of a stationary state.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Spectrum {
    /// Sorted by falling real part; complex pairs appear with both signs.
    pub values: Vec<GrowthRate>,
}

impl Spectrum {
    /// Rightmost growth rate of all, or of one parity.
    pub fn rightmost(&self, parity: Option<Parity>) -> Option<&GrowthRate> {
        self.values.iter().find(|v| parity.is_none_or(|p| v.parity == p))
    }

    /// Largest real part.
    pub fn growth_rate(&self) -> f64 {
        self.values.first().map_or(f64::NAN, |v| v.re)
    }

    /// Adds the rates from another shift that this spectrum does not hold yet; rates found from both agree.
    pub(super) fn add(&mut self, other: Spectrum, shift: f64) {
        for value in other.values {
            let slack = 1e-5 * (value.re.abs() + shift) + 10.0 * value.error;
            let near = |v: &GrowthRate| (v.re - value.re).hypot(v.im - value.im) <= slack + 10.0 * v.error;
            if !self.values.iter().any(|v| v.parity == value.parity && near(v)) {
                self.values.push(value);
            }
        }
        sort(&mut self.values);
    }

    /// Whether every perturbation decays.
    pub fn is_stable(&self) -> bool {
        self.growth_rate() < 0.0
    }
}

/// Why no spectrum could be computed.
#[expect(missing_docs, reason = "the messages say what the fields are")]
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum StabilityError {
    /// The shifted system could not be factorised.
    #[error("the system shifted by {shift:.3e} is singular or not finite (pivot {column})")]
    Factorisation { shift: f64, column: usize },
    /// The state has other sizes than the system.
    #[error(transparent)]
    Invalid(#[from] InvalidInput),
    /// The eigenvalues of the projected matrix could not be computed.
    #[error(transparent)]
    Projected(#[from] NoEigenvalues),
    /// Disturbances around the axis have equations for the paper's law alone.
    #[error(
        "disturbances without axial symmetry have equations for the paper's law alone; leave out the cell's own law"
    )]
    OwnLaw,
    /// The rightmost growth rate did not converge.
    #[error("the rightmost growth rate {value:.4e} is still uncertain by {error:.1e} after {dimension} Arnoldi steps")]
    NotConverged { value: f64, error: f64, dimension: usize },
}

pub(crate) type Result<T, E = StabilityError> = std::result::Result<T, E>;

impl StabilityError {
    /// The failure of a factorisation at a shift.
    pub(crate) fn at(shift: f64) -> impl Fn(FactorisationError) -> StabilityError {
        move |error| match error {
            FactorisationError::Pivot(failure) => StabilityError::Factorisation { shift, column: failure.column },
            FactorisationError::Invalid(input) => StabilityError::Invalid(input),
        }
    }
}

/// The rightmost growth rates of one parity within reach of the shift: `step` is w ↦ P_s w, in the inner
/// product of `weights`.
pub(crate) fn rightmost(
    arnoldi: &Arnoldi,
    krylov: &mut Krylov,
    weights: &[f64],
    step: impl FnMut(&[f64], &mut [f64]) -> Result<()>,
    (parity, shift): (Parity, f64),
) -> Result<Vec<GrowthRate>> {
    let limit = arnoldi.max_dimension.min(weights.len() - 1);
    let tolerance = arnoldi.tolerance;
    let result = krylov.run(weights, limit, step, |values, dimension| {
        if out_of_reach(values) {
            return Some(Ok(Vec::new()));
        }
        let mut rates = growth_rates(values, shift, parity);
        rates.truncate(arnoldi.wanted.max(1));
        let allowed = |r: &GrowthRate| tolerance * (r.re.hypot(r.im) + shift);
        match rates.iter().find(|r| r.error > allowed(r)) {
            None if !rates.is_empty() => Some(Ok(rates)),
            Some(r) if dimension == limit && rates[0].error > allowed(&rates[0]) => {
                Some(Err(StabilityError::NotConverged { value: r.re, error: r.error, dimension }))
            }
            // Later values are returned with their current errors.
            _ if dimension == limit => Some(Ok(rates)),
            _ => None,
        }
    });
    result?.unwrap_or_else(|| Ok(Vec::new()))
}

/// Whether all modes are out of reach of the shift: the largest Ritz value is too small even with ten times its
/// residual. Larger spaces would show no more.
fn out_of_reach(values: &[RitzValue]) -> bool {
    let modulus = |mu: &RitzValue| mu.re.hypot(mu.im);
    let largest = values.iter().max_by(|a, b| modulus(a).total_cmp(&modulus(b)));
    largest.is_some_and(|mu| (modulus(mu) + 10.0 * mu.residual) * REACH < 1.0)
}

/// N.12 for the Ritz values within reach of the shift, sorted by falling real part.
fn growth_rates(values: &[RitzValue], shift: f64, parity: Parity) -> Vec<GrowthRate> {
    // σ = s (1 − 1/μ), 1/μ = conj(μ)/|μ|².
    let rate = |mu: &RitzValue| {
        let size = mu.re.hypot(mu.im);
        let square = size * size;
        let (im, error) = (shift * mu.im / square, shift / square * mu.residual);
        (size * REACH >= 1.0).then(|| GrowthRate { re: shift * (1.0 - mu.re / square), im, parity, error })
    };
    let mut out: Vec<GrowthRate> = values.iter().filter_map(rate).collect();
    sort(&mut out);
    out
}

pub(crate) fn sort(values: &mut [GrowthRate]) {
    values.sort_by(|a, b| b.re.total_cmp(&a.re).then(b.im.total_cmp(&a.im)));
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Modes that all decay too fast for the shift end the iteration at its first check, not in the largest allowed
    /// space.
    #[test]
    fn modes_out_of_reach_are_given_up_early() {
        let rates_at = |slowest: f64| {
            let mut applied = 0;
            let step = |from: &[f64], to: &mut [f64]| {
                applied += 1;
                let mode = |k: usize| 1.0 / (1.0 + slowest * 3f64.powi(k as i32));
                to.iter_mut().zip(from).enumerate().for_each(|(k, (to, from))| *to = mode(k) * from);
                Ok(())
            };
            let (arnoldi, mut krylov) = (Arnoldi { wanted: 1, ..Arnoldi::default() }, Krylov::default());
            let found = rightmost(&arnoldi, &mut krylov, &[1.0; 60], step, (Parity::Mixed, 1.0)).unwrap();
            (found, applied)
        };
        let (found, applied) = rates_at(80.0);
        assert!(found.is_empty() && applied <= 14, "{found:?} {applied}");
        // A mode barely within reach is found.
        let (found, _) = rates_at(45.0);
        assert!((found[0].re + 45.0).abs() < 1e-6, "{found:?}");
    }
}
