//! Growth rates of small perturbations of a stationary shape.
//!
//! Linearising the dynamics about a stationary state gives the pencil J x = σ M x (M.22), where M multiplies ∂_t(r, z).
//! It acts only through the normal velocity v_n = sinψ ∂_t r + cosψ ∂_t z, so that a perturbation is described by its
//! normal displacement w at the collocation points, which determines everything else instantly. One implicit step of
//! rate s maps w ↦ P_s w = s (sM − J)⁻¹ M w, with eigenvalues
//!
//! * \[N.12 shift\] μ = s/(s − σ), σ = s (1 − 1/μ),
//!
//! so that the rightmost σ belong to the extreme μ, which an Arnoldi iteration finds first. A shift s > 0 misses no
//! growing mode: σ > s has μ < 0, outside the disc |μ − ½| ≤ ½ that holds all decaying modes. The step is the implicit
//! time step of the division itself, with the same factors.
//!
//! Mirror-symmetric states are given on the half domain; even modes solve the half problem, odd modes the same intervals
//! with δr = δm = δT = 0 at u = ½ and no scalar unknowns.
//!
//! A regulator has its own rate of change. It enters as ∂_tφ − w j, where w is the tangential velocity of a place of
//! fixed u, so that a perturbation is described by its normal displacement and by δφ − j δw, which does not depend on
//! the labelling of places along the contour.
//!
//! # References
//! Saad, *Numerical Methods for Large Eigenvalue Problems*, SIAM 2011, ch. 6 and 8. Physics of the pencil: the paper's
//! criterion dis(t) = ‖r − r₀‖ + ‖z − z₀‖ decides the same by evolving a perturbation.

mod disturbances;
pub(crate) mod following;
mod shifts;
pub(crate) mod spectrum;

use furrow_bvp::{
    AntisymmetricEnd, BoundaryValueProblem, Direction, FactorisationError, Residual, Solution, SolutionOperator, System,
};
use furrow_cell::Cell;
use furrow_spectra::{Arnoldi, Krylov};

use crate::cortex::equations::{R, Z};
use crate::cortex::observables::{carried, positions};
use crate::cortex::problem::SHAPE_SCALARS;
use crate::cortex::symmetry::even;
use crate::cortex::{Cortex, Domain};
use disturbances::Disturbances;
pub use spectrum::{GrowthRate, Parity, Spectrum, StabilityError};
use spectrum::{Result, sort};
pub(crate) use {shifts::Shifts, spectrum::rightmost};

/// Steps of the power iteration for one mode: each reduces the mode closest to it to a third, and modes that decay at
/// the cell's own rate far more.
const DIRECTION_STEPS: usize = 12;

/// Workspace for growth rates; it allocates nothing large once it has handled the largest mesh.
///
/// # Examples
/// A small cell rests in a shape with an odd slowest mode, which decays:
///
/// ```
/// use furrow_cell::{Cell, Numerics};
/// use furrow_mechanics::equilibria::stationary::stationary;
/// use furrow_mechanics::stability::{Parity, Stability};
/// let shape = stationary(&Cell::new(1.6), &Numerics::default())?;
/// let spectrum = Stability::new(shape.solution.m).leading(&shape.cortex, &shape.solution)?;
/// assert!(spectrum.is_stable() && (spectrum.growth_rate() + 0.495859).abs() < 1e-5);
/// assert_eq!(spectrum.values[0].parity, Parity::Odd);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Stability {
    /// Settings.
    pub arnoldi: Arnoldi,
    system: System,
    antisymmetric: AntisymmetricEnd,
    right_hand_side: Residual,
    update: Direction,
    disturbances: Disturbances,
    operator: SolutionOperator,
    krylov: Krylov,
}

impl Stability {
    /// Workspace for solutions with m stages per interval.
    pub fn new(stages: usize) -> Stability {
        Stability {
            arnoldi: Arnoldi::default(),
            system: System::new(Cortex::dimensions_for(&Cell::new(1.0), 0), stages),
            antisymmetric: AntisymmetricEnd::default(),
            right_hand_side: Residual::default(),
            update: Direction::default(),
            disturbances: Disturbances::default(),
            operator: SolutionOperator::default(),
            krylov: Krylov::default(),
        }
    }

    /// The rightmost growth rates of the stationary state `y` of `cortex`, from two shifts. Half-domain states give even
    /// and odd modes. Continuation parameters are taken from `y`; `rate`, `past` and `noise` of `cortex` are ignored.
    ///
    /// # Errors
    /// A failed factorisation, or a rightmost growth rate that does not converge.
    pub fn leading(&mut self, cortex: &Cortex, y: &Solution) -> Result<Spectrum> {
        let (mut fixed, state) = freeze(cortex, y);
        let shifts = Shifts::of(&fixed, &state);
        shifts.leading(self.arnoldi, |shift, arnoldi| self.at_shift(&mut fixed, &state, shift, arnoldi))
    }

    /// The largest growth rate only, from one shift, and from further shifts if the shape has a narrow neck.
    ///
    /// # Errors
    /// As [`leading`](Self::leading).
    pub fn growth_rate(&mut self, cortex: &Cortex, y: &Solution) -> Result<f64> {
        self.rightmost(cortex, y).map(|rate| rate.re)
    }

    /// The rightmost growth rate only, as [`growth_rate`](Self::growth_rate).
    pub(crate) fn rightmost(&mut self, cortex: &Cortex, y: &Solution) -> Result<GrowthRate> {
        let (mut fixed, state) = freeze(cortex, y);
        let shifts = Shifts::of(&fixed, &state);
        shifts.rightmost(self.arnoldi, |shift, arnoldi| self.at_shift(&mut fixed, &state, shift, arnoldi))
    }

    /// The mode that grows at `growth` > 0, the rightmost rate of the stationary state `y`: the corresponding change of
    /// the whole state, of length 1 in the L² norm of (r, z) over u. Its sign is arbitrary.
    ///
    /// # Errors
    /// A factorisation fails.
    pub fn unstable_direction(&mut self, cortex: &Cortex, y: &Solution, growth: f64) -> Result<Direction> {
        let (mut fixed, state) = freeze(cortex, y);
        // A step at 1.5 times the mode's rate magnifies it threefold, and damps decaying modes.
        let shift = 1.5 * growth;
        let failed = StabilityError::at(shift);
        self.linearise(&mut fixed, &state, shift).map_err(&failed)?;
        self.right_hand_side = self.system.zero_residual();
        let mut mode: Vec<f64> = (0..self.disturbances.weights.len()).map(|k| 1.0 + k as f64).collect();
        let mut next = mode.clone();
        for _ in 0..DIRECTION_STEPS {
            self.disturbances.load(&mode, &mut self.right_hand_side);
            self.system.solve(&self.right_hand_side, &mut self.update)?;
            self.disturbances.read(&self.update, &mut next);
            self.disturbances.conserve(&mut next);
            let largest = next.iter().fold(0.0f64, |most, w| most.max(w.abs()));
            if !(largest.is_finite() && largest > 0.0) {
                return Err(StabilityError::Factorisation { shift, column: 0 });
            }
            mode.iter_mut().zip(&next).for_each(|(mode, next)| *mode = next / largest);
        }
        let mut out = self.update.clone();
        let weights = self.disturbances.weights.iter().step_by(self.disturbances.per_point);
        let size: f64 = (out.stages.chunks_exact(y.components).zip(weights))
            .map(|(s, weight)| weight * (s[R] * s[R] + s[Z] * s[Z]))
            .sum();
        let scale = 1.0 / size.sqrt();
        for values in [&mut out.nodes, &mut out.stages, &mut out.scalars] {
            values.iter_mut().for_each(|v| *v *= scale);
        }
        Ok(out)
    }

    fn at_shift(&mut self, cortex: &mut Cortex, y: &Solution, shift: f64, arnoldi: Arnoldi) -> Result<Spectrum> {
        let failed = StabilityError::at(shift);
        self.linearise(cortex, y, shift).map_err(&failed)?;
        let Stability { system, antisymmetric, disturbances, operator, krylov, .. } = self;
        disturbances.assemble(system, operator)?;
        let (mut out, mut scalars) = (Spectrum::default(), [0.0; SHAPE_SCALARS]);
        for &parity in parities(cortex.domain) {
            let end = end_of(parity, system, antisymmetric, y.components).map_err(&failed)?;
            let step = |from: &[f64], to: &mut [f64]| {
                operator.apply(system, end, from, to, &mut scalars)?;
                // Odd perturbations do not change the amount of a regulator.
                if parity != Parity::Odd {
                    disturbances.conserve(to);
                }
                Ok(())
            };
            out.values.extend(rightmost(&arnoldi, krylov, &disturbances.weights, step, (parity, shift))?);
        }
        sort(&mut out.values);
        Ok(out)
    }

    /// Factors of the system at rate `shift` with the state as its own past, and the responses to w.
    fn linearise(&mut self, cortex: &mut Cortex, y: &Solution, shift: f64) -> Result<(), FactorisationError> {
        cortex.rate = shift;
        positions(y, &mut cortex.past);
        let mut past = std::mem::take(&mut cortex.carried_past);
        carried(cortex, y, &mut past);
        cortex.carried_past = past;
        if self.system.dimensions() != cortex.dimensions() {
            self.system = System::new(cortex.dimensions(), y.m);
        }
        self.system.factorise(cortex, y, &[])?;
        self.disturbances.set(cortex, y, &self.system.gauss, shift);
        Ok(())
    }
}

/// Symmetries of the modes of a shape.
fn parities(domain: Domain) -> &'static [Parity] {
    match domain {
        Domain::Full => &[Parity::Mixed],
        Domain::Half => &[Parity::Even, Parity::Odd],
    }
}

/// The end of the problem for odd modes, from the factors of the problem for even modes; `None` for other modes.
fn end_of<'a>(
    parity: Parity,
    system: &System,
    end: &'a mut AntisymmetricEnd,
    components: usize,
) -> Result<Option<&'a AntisymmetricEnd>, FactorisationError> {
    if parity != Parity::Odd {
        return Ok(None);
    }
    system.eliminate_antisymmetric(even(components), end)?;
    Ok(Some(end))
}

/// The cell with its free parameters fixed at the values they have in `y`.
pub(crate) fn freeze(cortex: &Cortex, y: &Solution) -> (Cortex, Solution) {
    let mut fixed = Cortex::new(&cortex.cell, cortex.domain, &cortex.free);
    fixed.prepare(&y.scalars);
    let fixed = Cortex::new(&fixed.cell, fixed.domain, &[]);
    let mut state = y.clone();
    state.scalars.truncate(SHAPE_SCALARS);
    (fixed, state)
}

#[cfg(test)]
mod tests {
    use nalgebra::DMatrix;

    use super::*;
    use crate::cortex::amount::{self, AmountOf};
    use crate::cortex::symmetry::unfold;
    use crate::equilibria::{StationaryShape, stationary};
    use furrow_bvp::{Newton, newton::NewtonScratch};
    use furrow_cell::{Cell, Numerics, Parameter};

    /// The mirror-symmetric state of a cell at ξ_s.
    fn symmetric(r0: f64, epsilon: f64, xi_s: f64, numerics: &Numerics) -> (Cortex, Solution) {
        let below = Cell { epsilon, xi_s: xi_s.min(26.5), ..Cell::gao2026_thresholds(r0) };
        let StationaryShape { mut cortex, solution: mut y, .. } = stationary(&below, numerics).unwrap();
        // A step along the branch would pass these activities and the fold above them.
        for xi_s in [27.0, 27.02].into_iter().filter(|close| *close <= xi_s) {
            cortex.set(Parameter::XiS, xi_s);
            let (mut system, mut scratch) = (System::new(cortex.dimensions(), y.m), NewtonScratch::default());
            Newton::default().solve(&mut system, &mut scratch, &mut cortex, &mut y, &[], false).unwrap();
        }
        (cortex, y)
    }

    /// Arnoldi compared with every finite eigenvalue of the pencil itself, assembled densely by differences of the
    /// residual.
    #[test]
    fn agrees_with_the_dense_pencil() {
        let numerics = Numerics { stages: 3, intervals: 12, ..Numerics::default() };
        let (mut cortex, y) = symmetric(2.0, 0.87, 24.0, &numerics);
        let mut system = System::new(cortex.dimensions(), 3);
        let size = y.nodes.len() + y.stages.len() + y.scalars.len();
        let mut derivative = |cortex: &mut Cortex| {
            let mut column = |k: usize, step: f64, cortex: &mut Cortex| {
                let mut moved = y.clone();
                let mut values = moved.nodes.iter_mut().chain(&mut moved.stages).chain(&mut moved.scalars);
                *values.nth(k).unwrap() += step;
                system.evaluate(cortex, &moved, &[], false).unwrap();
                let r = &system.residual;
                [&r.stages, &r.nodes, &r.left, &r.right, &r.border].into_iter().flatten().copied().collect::<Vec<_>>()
            };
            let mut out = DMatrix::<f64>::zeros(size, size);
            for k in 0..size {
                // Fourth-order differences.
                let h = 2e-3;
                let at = [-2.0, -1.0, 1.0, 2.0].map(|x| column(k, x * h, cortex));
                for i in 0..size {
                    out[(i, k)] = (at[0][i] - 8.0 * at[1][i] + 8.0 * at[2][i] - at[3][i]) / (12.0 * h);
                }
            }
            out
        };
        let jacobian = derivative(&mut cortex);
        cortex.rate = 1.0;
        positions(&y, &mut cortex.past);
        let mass = derivative(&mut cortex) - &jacobian;
        cortex.rate = 0.0;
        // J x = −σ M x: the eigenvalues of J⁻¹M are −1/σ, and 0 for constraints without a rate.
        let inverse_rates = jacobian.lu().solve(&mass).unwrap().complex_eigenvalues();
        let finite = inverse_rates.iter().filter(|theta| theta.re.hypot(theta.im) > 1e-3).map(|theta| -theta.inv());
        let mut expected: Vec<f64> = finite.map(|x| x.re).collect();
        expected.sort_by(|a, b| b.total_cmp(a));
        assert!(expected.len() > 3, "{expected:?}");
        let spectrum = Stability::new(3).leading(&cortex, &y).unwrap();
        let even = spectrum.values.iter().filter(|v| v.parity == Parity::Even);
        for (v, e) in even.zip(&expected).take(3) {
            assert!((v.re - e).abs() < 1e-5 * (1.0 + e.abs()), "{v:?} {expected:?}");
        }
    }

    /// R0 = 2.00, ε = 0.87: the odd mode starts to grow at the pitchfork, the even one at the fold.
    #[test]
    fn modes_cross_zero_at_the_bifurcations() {
        let targets = [22.046_88, 22.056_88, 22.066_88, 27.0, 27.02];
        let states = targets.map(|xi_s| symmetric(2.0, 0.87, xi_s, &Numerics::default()));
        let spectra = states.map(|(cortex, y)| Stability::new(4).leading(&cortex, &y).unwrap());
        let rate = |k: usize, parity| spectra[k].rightmost(Some(parity)).unwrap().re;
        assert!(rate(0, Parity::Odd) < -1e-3 && rate(2, Parity::Odd) > 1e-3);
        assert!(rate(1, Parity::Odd).abs() < 3e-6, "{}", rate(1, Parity::Odd));
        assert!(spectra[0].is_stable() && !spectra[2].is_stable());
        // σ of the even mode vanishes like a square root: σ² is linear in ξ_s.
        let [a, b] = [3, 4].map(|k| rate(k, Parity::Even).powi(2));
        let fold = targets[4] + b * (targets[4] - targets[3]) / (a - b);
        assert!((fold - 27.029_71).abs() < 1e-4, "{fold}");
    }

    /// A step conserves the amount of a regulator without turnover for every perturbation: flow dilutes as much as it
    /// concentrates.
    #[test]
    fn a_step_keeps_the_amount_of_a_conserved_regulator() {
        for strength in ["activity=0.3", "kappa=-0.2,friction=0.4"] {
            let (cortex, y) = conserved(strength);
            let mut stability = Stability::new(y.m);
            let (mut fixed, state) = freeze(&cortex, &y);
            let amount = AmountOf::disturbances(&fixed, &state, &y.gauss());
            stability.linearise(&mut fixed, &state, 3.0).unwrap();
            stability.system.factor_blocks(&[]).unwrap();
            stability.right_hand_side = stability.system.zero_residual();
            let before: Vec<f64> = (0..stability.disturbances.weights.len()).map(|k| (k as f64).sin()).collect();
            let mut after = before.clone();
            stability.disturbances.load(&before, &mut stability.right_hand_side);
            stability.system.solve(&stability.right_hand_side, &mut stability.update).unwrap();
            stability.disturbances.read(&stability.update, &mut after);
            let [before, after] = [before, after].map(|of| amount.excess(of.as_chunks::<2>().0.iter().copied()));
            assert!(before.abs() > 1e-3 && (after / before - 1.0).abs() < 1e-5, "{strength}: {before} {after}");
        }
    }

    /// Rates from the half contour, from the whole contour and from the azimuthal equations for m = 0 agree, and none
    /// of them is 0.
    #[test]
    fn modes_of_a_conserved_regulator_keep_its_amount() {
        let (cortex, y) = conserved("activity=0.3");
        let half = Stability::new(y.m).leading(&cortex, &y).unwrap();
        let (whole, unfolded) = (Cortex::new(&cortex.cell, Domain::Full, &[]), unfold(&y));
        let full = Stability::new(y.m).leading(&whole, &unfolded).unwrap();
        let azimuthal = crate::azimuthal::Azimuthal::new(&cortex, &y, 0).leading().unwrap();
        for ((h, f), a) in half.values.iter().zip(&full.values).zip(&azimuthal.values).take(2) {
            assert!(h.re < -1e-2, "{h:?}");
            assert!((h.re - f.re).abs() < 1e-6 && (h.re - a.re).abs() < 1e-6, "{h:?} {f:?} {a:?}");
        }
    }

    /// A cell at rest without turnover of its regulator, computed from a shape with turnover.
    fn conserved(couplings: &str) -> (Cortex, Solution) {
        let cell = |turnover: f64| {
            let cue = format!("regulator:none,turnover={turnover},diffusion=1,{couplings}");
            Cell { xi_s: 15.0, ..Cell::new(1.8) }.with_cue(cue.parse().unwrap())
        };
        let StationaryShape { mut solution, .. } = stationary(&cell(10.0), &Numerics::default()).unwrap();
        let mut cortex = Cortex::new(&cell(0.0), Domain::Half, &[]);
        let wanted = amount::of(&solution);
        amount::solve_at_rest(&Newton::default(), &mut cortex, &mut solution, wanted).unwrap();
        assert!((amount::of(&solution) / wanted - 1.0).abs() < 1e-11 && !cortex.amount_is_given);
        (cortex, solution)
    }

    /// The two parities of the half domain are the modes of the full domain.
    #[test]
    fn half_and_full_domain_agree() {
        let mut stability = Stability::new(4);
        for (r0, epsilon, xi) in [(2.0, 0.87, 25.0), (1.0, 0.6, 10.0), (5.0, 0.87, 8.0), (2.22, 0.64, 0.0)] {
            let (cortex, y) = symmetric(r0, epsilon, xi, &Numerics::default());
            let half = stability.leading(&cortex, &y).unwrap();
            let whole = Cortex::new(&cortex.cell, Domain::Full, &[]);
            let unfolded = unfold(&y);
            let full = stability.leading(&whole, &unfolded).unwrap();
            for (h, f) in half.values.iter().zip(&full.values).take(3) {
                assert!((h.re - f.re).abs() < 1e-6 * (1.0 + h.re.abs()), "{h:?} {f:?}");
            }
            let fast = stability.growth_rate(&cortex, &y).unwrap();
            assert!((fast - half.growth_rate()).abs() < 1e-8 * (1.0 + fast.abs()));
        }
    }
}
