//! The coefficients of the equations at a place, and a cache of their values at the collocation points of a sweep.

use std::borrow::Cow;
use std::ops::Range;

use furrow_bvp::{CollocationPoint, CollocationPoints};

use super::equations::Constants;
use super::lanes::Arithmetic;
use furrow_cell::Number;
use furrow_cell::cue::Field;

/// The coefficients of the equations at one place of the contour: the constants of the material, modulated by the cue.
#[derive(Clone, Copy, Debug)]
pub struct LocalCoefficients<D> {
    /// Bending rigidity κ.
    pub kappa: D,
    /// ∂κ/∂u.
    pub kappa_u: D,
    /// η_b + η_s.
    pub eta_sum: D,
    /// η_b − η_s.
    pub eta_difference: D,
    /// Friction Γ.
    pub friction: D,
    /// Passive tension γ.
    pub tension: D,
    /// ∂γ/∂u.
    pub tension_u: D,
    /// Effective anisotropic activity X_s = gξ_s.
    pub xi_s: D,
    /// Effective isotropic activity X_b = gξ_b.
    pub xi_b: D,
    /// Source A f of the regulator.
    pub source: D,
    /// Spontaneous curvature C0, the same everywhere.
    pub spontaneous: D,
}

/// Number of coefficients.
pub(super) const COEFFICIENTS: usize = 11;

impl<D> From<[D; COEFFICIENTS]> for LocalCoefficients<D> {
    #[inline(always)]
    fn from(values: [D; COEFFICIENTS]) -> LocalCoefficients<D> {
        let [kappa, kappa_u, eta_sum, eta_difference, friction, tension, ..] = values;
        let [.., tension_u, xi_s, xi_b, source, spontaneous] = values;
        LocalCoefficients {
            kappa,
            kappa_u,
            eta_sum,
            eta_difference,
            friction,
            tension,
            tension_u,
            xi_s,
            xi_b,
            source,
            spontaneous,
        }
    }
}

impl<D> LocalCoefficients<D> {
    /// All coefficients, in the order of the fields.
    #[inline(always)]
    pub(super) fn into_array(self) -> [D; COEFFICIENTS] {
        let LocalCoefficients { kappa, kappa_u, eta_sum, eta_difference, friction, .. } = self;
        let LocalCoefficients { tension, tension_u, xi_s, xi_b, source, spontaneous, .. } = self;
        [kappa, kappa_u, eta_sum, eta_difference, friction, tension, tension_u, xi_s, xi_b, source, spontaneous]
    }

    /// The same with numbers of another kind.
    #[inline(always)]
    pub fn map<E>(self, number: impl Fn(D) -> E) -> LocalCoefficients<E> {
        self.into_array().map(number).into()
    }
}

impl<D: Arithmetic> LocalCoefficients<D> {
    /// C at the moment m, by M.3.
    #[inline(always)]
    pub fn mean(&self, m: D) -> D {
        m / self.kappa + self.spontaneous
    }
}

impl LocalCoefficients<f64> {
    /// ∂_sC where the shear is q and C is `mean`, on a contour of length `length`.
    pub fn mean_slope(&self, q: f64, mean: f64, length: f64) -> f64 {
        (q - (mean - self.spontaneous) * self.kappa_u / length) / self.kappa
    }

    /// Adds `factor` times other coefficients.
    pub fn add(&mut self, factor: f64, other: &LocalCoefficients<f64>) {
        let (own, other) = (self.into_array(), other.into_array());
        *self = std::array::from_fn(|k| own[k] + factor * other[k]).into();
    }
}

impl<D: Number> LocalCoefficients<D> {
    /// Adds the effect of one term of a cue, M.16, or of the regulator: `f` is A f and `f_u` is A ∂f/∂u at the place,
    /// `uniform` the coefficients without the cue. Fields enter the equations only here. Derivatives along the
    /// contour matter only for κ and γ.
    pub(super) fn modulate(&mut self, field: Field, uniform: &LocalCoefficients<D>, f: D, f_u: D) {
        let [eta_b, eta_s] = [1.0, -1.0].map(|sign| (uniform.eta_sum + uniform.eta_difference * sign) * 0.5);
        match field {
            Field::Kappa => {
                self.kappa += uniform.kappa * f;
                self.kappa_u += uniform.kappa * f_u;
            }
            Field::Activity => {
                self.xi_s += uniform.xi_s * f;
                self.xi_b += uniform.xi_b * f;
            }
            Field::XiS => self.xi_s += uniform.xi_s * f,
            Field::XiB => self.xi_b += uniform.xi_b * f,
            Field::EtaB => {
                self.eta_sum += eta_b * f;
                self.eta_difference += eta_b * f;
            }
            Field::EtaS => {
                self.eta_sum += eta_s * f;
                self.eta_difference -= eta_s * f;
            }
            Field::Viscosity => {
                self.eta_sum += uniform.eta_sum * f;
                self.eta_difference += uniform.eta_difference * f;
            }
            Field::Friction => self.friction += uniform.friction * f,
            Field::Tension => {
                self.tension += f;
                self.tension_u += f_u;
            }
        }
    }
}

/// Coefficients at places along the contour, without the contribution of a regulator.
///
/// Each profile of the cue costs an exponential. Profiles change with the mesh, with numbers of the cue, and, if a
/// width is given in L_h, with the length of the contour; the coefficients change with every other parameter too.
#[derive(Clone, Debug, Default)]
pub(super) struct CoefficientCache {
    /// Whether profiles depend on the length of the contour.
    by_length: bool,
    x: Vec<f64>,
    length: f64,
    /// The cue's [`profiles`](Constants::profiles) at every place.
    profiles: Vec<[f64; 2]>,
    /// Empty if they must be recomputed.
    local: Vec<LocalCoefficients<f64>>,
}

impl CoefficientCache {
    /// An empty cache for other places.
    pub fn for_others(&self) -> CoefficientCache {
        CoefficientCache { by_length: self.by_length, ..CoefficientCache::default() }
    }

    /// Discards everything except the profiles; `by_length` says whether a width of the cue is given in L_h.
    pub fn refresh(&mut self, by_length: bool) {
        self.by_length = by_length;
        self.local.clear();
    }

    /// Whether it holds all values at these places.
    pub fn holds(&self, x: &[f64], length: f64) -> bool {
        self.known(0, x, length).is_some()
    }

    /// Computes the missing values at these places, on a contour of length `length`.
    pub fn prepare(&mut self, constants: &Constants<f64>, x: &[f64], length: f64) {
        let CoefficientCache { by_length, x: known, length: of_length, profiles, local } = self;
        if known != x || *by_length && *of_length != length {
            *of_length = length;
            x.clone_into(known);
            local.clear();
            profiles.clear();
            profiles.extend(x.iter().flat_map(|&x| constants.profiles(x, length)));
        }
        if local.is_empty() && !x.is_empty() {
            let of_points = profiles.chunks_exact(profiles.len() / x.len());
            local.extend(of_points.map(|profiles| constants.painted(profiles.iter().copied())));
        }
    }

    /// The range of these places in the cache, if it holds their coefficients.
    fn known(&self, first: usize, x: &[f64], length: f64) -> Option<Range<usize>> {
        let range = first..first + x.len();
        let same = self.x.get(range.clone())? == x && (!self.by_length || self.length == length);
        (same && range.end <= self.local.len()).then_some(range)
    }

    /// Coefficients and profiles at collocation points. Coefficients are empty if they are uniform; profiles are empty
    /// if they are not in the cache.
    pub fn at_points(
        &self,
        constants: &Constants<f64>,
        points: CollocationPoints<'_>,
        length: f64,
    ) -> (Cow<'_, [LocalCoefficients<f64>]>, &[[f64; 2]]) {
        if !constants.vary() {
            return (Cow::Borrowed(&[]), &[]);
        }
        let Some(range) = self.known(points.first, points.x, length) else {
            return (points.x.iter().map(|&x| constants.at(x, length)).collect(), &[]);
        };
        let each = self.profiles.len() / self.x.len().max(1);
        (Cow::Borrowed(&self.local[range.clone()]), &self.profiles[range.start * each..range.end * each])
    }

    /// Coefficients at one collocation point.
    pub fn at(&self, constants: &Constants<f64>, point: CollocationPoint, length: f64) -> LocalCoefficients<f64> {
        let known = self.known(point.index, &[point.x], length);
        known.map_or_else(|| constants.at(point.x, length), |range| self.local[range.start])
    }
}

#[cfg(test)]
mod tests {
    use furrow_bvp::BoundaryValueProblem;
    use furrow_cell::cue::{Quantity, RegulatorQuantity};
    use furrow_cell::{Cell, Parameter};

    use super::*;
    use crate::cortex::equations::REGULATED;
    use crate::cortex::{Cortex, Domain};

    /// Right-hand sides at places of a contour of length `length`.
    fn values(cortex: &Cortex, x: &[f64], length: f64) -> Vec<f64> {
        let y = vec![0.7; x.len() * REGULATED];
        let (mut f, mut g) = (vec![0.0; y.len()], vec![0.0; x.len()]);
        cortex.rhs_many(CollocationPoints { first: 0, x, y: &y }, &[length, 1.0], &mut f, &mut g);
        f
    }

    #[test]
    fn cached_coefficients_equal_recomputed_ones() {
        let cue = "kappa:u0=0.4,omega=0.6Lh,amplitude=0.1+regulator:step,u0=0.25,omega=0.1,amplitude=1,turnover=10,diffusion=1,xi_s=0.5";
        let mut cortex = Cortex::new(&Cell::new(2.0).with_cue(cue.parse().unwrap()), Domain::Full, &[]);
        let amplitude = Parameter::Cue { term: 0, quantity: Quantity::Amplitude };
        let source = Parameter::Regulator(RegulatorQuantity::Source(Quantity::U0));
        let mut before = Vec::new();
        for (parameter, value, length, from) in [
            (Parameter::XiS, 25.0, 7.0, 0.1),
            (Parameter::XiS, 20.0, 7.0, 0.1),
            (amplitude, 0.2, 7.0, 0.1),
            (source, 0.3, 7.0, 0.1),
            (Parameter::XiS, 20.0, 8.0, 0.1),
            (Parameter::XiS, 20.0, 8.0, 0.2),
        ] {
            cortex.set(parameter, value);
            let x = [from, from + 0.3, from + 0.35];
            cortex.prepare_points(&x, &[length, 1.0]);
            let kept = values(&cortex, &x, length);
            assert_eq!(kept, values(&Cortex::new(&cortex.cell, Domain::Full, &[]), &x, length), "{parameter}");
            assert_ne!(kept, before, "{parameter}");
            before = kept;
        }
    }
}
