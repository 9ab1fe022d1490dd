//! Growth rates of non-axisymmetric perturbations w cos mφ of an axisymmetric shape.
//!
//! The pencil and the computation of its rightmost eigenvalues are the same as in [`stability`](crate::stability): a
//! perturbation is described by its normal displacement w, which determines all other quantities instantly, and one
//! implicit step w ↦ P_s w has the eigenvalues s/(s − σ). For m = 0 the rates agree with
//! [`Stability`](crate::stability::Stability), from different equations.
//!
//! | module | role |
//! |---|---|
//! | [`base`] | the shape at one place |
//! | [`equations`] | the linearised balance of forces |
//! | [`problem`] | the boundary-value problem |
//! | [`mode`] | the displacements of a mode |
//!
//! [`equilibria`](crate::equilibria) follows the growth rates along branches and over parameters; this module does not
//! use it.

pub mod base;
pub mod equations;
pub mod mode;
pub mod problem;

use furrow_bvp::{Direction, Residual, Solution, System};
use furrow_spectra::{Arnoldi, Krylov};

use crate::cortex::amount::AmountOf;
use crate::cortex::symmetry::unfold;
use crate::cortex::{Cortex, Domain};
use crate::stability::spectrum::{Result, rightmost, sort};
use crate::stability::{Parity, Shifts, Spectrum, StabilityError, freeze};
use equations::{REGULATOR, W};
use mode::Mode;
use problem::Disturbance;

/// Distance of the shift from the growth rate in [`Azimuthal::mode`], relative to the rate and the cell's own rate.
const MODE_DISTANCE: f64 = 1e-2;
/// Most steps of the inverse iteration for a mode, and the change of the mode at which it ends.
const MODE_STEPS: usize = 60;
const MODE_SETTLED: f64 = 1e-12;

/// Perturbations of one azimuthal number about one shape.
///
/// # Examples
/// A small cell rests in a shape that is stable to axisymmetric perturbations, but furrows from one side:
///
/// ```
/// use furrow_cell::{Cell, Numerics};
/// use furrow_mechanics::azimuthal::Azimuthal;
/// use furrow_mechanics::equilibria::stationary;
/// let shape = stationary(&Cell::new(1.6), &Numerics::default())?;
/// let mut rates = Vec::new();
/// for m in 0..4 {
///     rates.push(Azimuthal::new(&shape.cortex, &shape.solution, m).leading()?.growth_rate());
/// }
/// assert!(rates[0] < 0.0 && rates[1] > 5.0 && rates[2] < 0.0 && rates[3] < 0.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Azimuthal {
    /// Settings.
    pub arnoldi: Arnoldi,
    /// The azimuthal number.
    pub m: usize,
    /// Whether the cell has a law of its own, which these equations lack.
    own_law: bool,
    problem: Disturbance,
    system: System,
    shifts: Shifts,
    /// Change of the amount of a conserved regulator; 0 for perturbations that vary with φ.
    amount: AmountOf,
    /// The shape on the whole contour.
    shape: Solution,
    /// A zero perturbation on the mesh of the shape.
    zero: Solution,
    /// A solution before its refinement.
    found: Solution,
    right_hand_side: Residual,
    update: Direction,
    /// h s times the response of every component to w and to the change of a regulator, at every collocation point.
    response: Vec<[f64; 2]>,
    /// Quadrature weights of ∫ w² du, followed by the weights of ∫ (R0 φ)² du for a regulator.
    weights: Vec<f64>,
    krylov: Krylov,
}

impl Azimuthal {
    /// Perturbations of the stationary state `y` of `cortex`; a half contour is unfolded. Continuation parameters are
    /// taken from `y`.
    pub fn new(cortex: &Cortex, y: &Solution, m: usize) -> Azimuthal {
        let (mut fixed, mut state) = freeze(cortex, y);
        let shifts = Shifts::of(&fixed, &state);
        if fixed.domain == Domain::Half {
            (fixed, state) = (Cortex::new(&fixed.cell, Domain::Full, &[]), unfold(&state));
        }
        Azimuthal::about(&fixed, &state, shifts, m)
    }

    /// Perturbations of the moving shape `y` on the whole contour, with its motion in `cortex`, frozen at this instant:
    /// their rates describe the initial growth of a perturbation.
    pub fn frozen(cortex: &Cortex, y: &Solution, m: usize) -> Azimuthal {
        Azimuthal::about(cortex, y, Shifts::of(cortex, y), m)
    }

    fn about(cortex: &Cortex, y: &Solution, shifts: Shifts, m: usize) -> Azimuthal {
        let gauss = y.gauss();
        let problem = Disturbance::new(cortex, &gauss, y, m);
        let n = problem.components();
        let system = System::new(furrow_bvp::BoundaryValueProblem::dimensions(&problem), y.m);
        let widths = y.mesh.windows(2).map(|pair| pair[1] - pair[0]);
        let mut weights: Vec<f64> = widths.flat_map(|h| gauss.b.iter().map(move |b| h * b)).collect();
        if cortex.is_regulated() {
            let scale = cortex.cell.r0 * cortex.cell.r0;
            weights.extend_from_within(..);
            let points = weights.len() / 2;
            weights[points..].iter_mut().for_each(|weight| *weight *= scale);
        }
        let zero = y.resampled(n, &[0.0; 2], |_, _| {});
        Azimuthal {
            arnoldi: Arnoldi::default(),
            m,
            own_law: cortex.cell.law.is_some(),
            problem,
            system,
            shifts,
            amount: if m == 0 { AmountOf::disturbances(cortex, y, &gauss) } else { AmountOf::default() },
            shape: y.clone(),
            found: zero.clone(),
            zero,
            right_hand_side: Residual::default(),
            update: Direction::default(),
            response: Vec::new(),
            weights,
            krylov: Krylov::default(),
        }
    }

    /// Refuses a cell with a law of active stress of its own.
    fn check(&self) -> Result<()> {
        if self.own_law { Err(StabilityError::OwnLaw) } else { Ok(()) }
    }

    /// The rightmost growth rates, from two shifts.
    ///
    /// # Errors
    /// A failed factorisation, or a rightmost growth rate that does not converge.
    pub fn leading(&mut self) -> Result<Spectrum> {
        self.check()?;
        let (shifts, arnoldi) = (self.shifts, self.arnoldi);
        shifts.leading(arnoldi, |shift, arnoldi| self.at_shift(shift, arnoldi))
    }

    /// The largest growth rate only.
    ///
    /// # Errors
    /// As [`leading`](Self::leading).
    pub fn growth_rate(&mut self) -> Result<f64> {
        self.check()?;
        let (shifts, arnoldi) = (self.shifts, self.arnoldi);
        shifts.growth_rate(arnoldi, |shift, arnoldi| self.at_shift(shift, arnoldi))
    }

    /// The mode of a growth rate from [`leading`](Self::leading), scaled to a largest |w| of 1. A complex pair is
    /// returned at one of its phases.
    ///
    /// # Errors
    /// A factorisation fails.
    pub fn mode(&mut self, rate: f64) -> Result<Mode> {
        self.check()?;
        // Close enough to the rate that the step magnifies this mode most, and far enough that rounding does not
        // dominate.
        let shift = rate + MODE_DISTANCE * (rate.abs() + self.shifts.scale());
        self.factorise(shift)?;
        let points = self.points();
        let mut mode: Vec<f64> = (0..self.weights.len()).map(|k| 1.0 + k as f64).collect();
        let (mut next, mut rate) = (mode.clone(), rate);
        for _ in 0..MODE_STEPS {
            self.apply(points, &mode, &mut next)?;
            // The step magnifies the mode by μ = s/(s − σ).
            let largest = largest(&next);
            let weighed = |other: &[f64]| -> f64 {
                self.weights.iter().zip(&mode).zip(other).map(|((weight, a), b)| weight * a * b).sum()
            };
            let inverse = weighed(&mode) / weighed(&next);
            if !(inverse.is_finite() && largest != 0.0) {
                return Err(StabilityError::Factorisation { shift, column: 0 });
            }
            rate = shift * (1.0 - inverse);
            let mut change = 0.0f64;
            for (mode, next) in mode.iter_mut().zip(&next) {
                change = change.max((*mode - next / largest).abs());
                *mode = next / largest;
            }
            if change < MODE_SETTLED {
                break;
            }
        }
        let Direction { nodes, stages, scalars } = &self.update;
        let largest = largest(&next[..points]);
        let scaled = |values: &[f64]| values.iter().map(|v| v / largest).collect();
        let disturbance =
            Solution { nodes: scaled(nodes), stages: scaled(stages), scalars: scaled(scalars), ..self.zero.clone() };
        Ok(Mode { m: self.m, rate, disturbance, shape: self.shape.clone() })
    }

    fn at_shift(&mut self, shift: f64, arnoldi: Arnoldi) -> Result<Spectrum> {
        self.factorise(shift)?;
        let (mut krylov, weights) = (std::mem::take(&mut self.krylov), std::mem::take(&mut self.weights));
        let points = self.points();
        let step = |from: &[f64], to: &mut [f64]| self.apply(points, from, to);
        let found = rightmost(&arnoldi, &mut krylov, &weights, step, (Parity::Mixed, shift));
        (self.krylov, self.weights) = (krylov, weights);
        let mut out = Spectrum { values: found? };
        sort(&mut out.values);
        Ok(out)
    }

    fn points(&self) -> usize {
        self.zero.intervals() * self.zero.m
    }

    fn factorise(&mut self, shift: f64) -> Result<()> {
        let failed = StabilityError::at(shift);
        self.problem.rate = shift;
        self.system.factorise(&mut self.problem, &self.zero, &[]).map_err(failed)?;
        self.right_hand_side = self.system.zero_residual();
        let per_interval = self.zero.m * self.problem.components();
        let widths = self.zero.mesh.windows(2).flat_map(|pair| std::iter::repeat_n(pair[1] - pair[0], per_interval));
        self.response.clear();
        let motions = self.problem.by_motion.iter();
        self.response.extend(motions.zip(widths).map(|(by, h)| by.map(|by| h * shift * by)));
        Ok(())
    }

    /// Near the poles terms in 1/r² nearly cancel, above all for m = 1, and elimination loses digits. Iterative
    /// refinement: the remaining residual is solved for once more.
    fn refine(&mut self) -> Result<()> {
        let Azimuthal { problem, system, right_hand_side, update, found, .. } = self;
        std::mem::swap(&mut found.nodes, &mut update.nodes);
        std::mem::swap(&mut found.stages, &mut update.stages);
        std::mem::swap(&mut found.scalars, &mut update.scalars);
        // The problem is linear: its residual there is J times the update.
        system.evaluate(problem, found, &[], false)?;
        let rows = system.residual.stages.iter_mut().zip(&right_hand_side.stages);
        rows.for_each(|(left, right)| *left += right);
        system.solve_own(update)?;
        for (a, b) in [
            (&mut update.nodes, &found.nodes),
            (&mut update.stages, &found.stages),
            (&mut update.scalars, &found.scalars),
        ] {
            a.iter_mut().zip(b).for_each(|(a, b)| *a += b);
        }
        Ok(())
    }

    /// w ↦ P_s w.
    fn apply(&mut self, points: usize, from: &[f64], to: &mut [f64]) -> Result<()> {
        let n = self.problem.components();
        let (displaced, changed) = from.split_at(points);
        let rows = self.right_hand_side.stages.chunks_exact_mut(n).zip(self.response.chunks_exact(n));
        for (i, (row, response)) in rows.enumerate() {
            let changed = changed.get(i).copied().unwrap_or(0.0);
            for (row, by) in row.iter_mut().zip(response) {
                *row = displaced[i] * by[0] + changed * by[1];
            }
        }
        self.system.solve(&self.right_hand_side, &mut self.update)?;
        self.refine()?;
        let (displaced, changed) = to.split_at_mut(points);
        for (i, x) in self.update.stages.chunks_exact(n).enumerate() {
            displaced[i] = x[W];
            if let Some(changed) = changed.get_mut(i) {
                *changed = x[REGULATOR];
            }
        }
        let excess = self.amount.excess(displaced.iter().zip(&*changed).map(|(w, phi)| [*w, *phi]));
        changed.iter_mut().for_each(|phi| *phi -= excess);
        Ok(())
    }
}

/// The value with the largest modulus.
fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0f64, |most, value| if value.abs() > most.abs() { *value } else { most })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cortex::equations::{LENGTH, M, PHI, R};
    use crate::equilibria::stationary;
    use furrow_cell::{Cell, Numerics};

    /// Without turnover, flow dilutes a regulator as much as it concentrates it, whatever the perturbation: the amount
    /// is constant.
    #[test]
    fn a_step_changes_the_amount_of_a_regulator_by_its_turnover_alone() {
        let turnover = 2.0;
        let cue = format!("regulator:none,turnover={turnover},diffusion=1,activity=0.3");
        let cell = Cell { xi_s: 12.0, ..Cell::new(1.8) }.with_cue(cue.parse().unwrap());
        let shape = stationary(&cell, &Numerics::default()).unwrap();
        let (cortex, y) = (Cortex::new(&cell, Domain::Full, &[]), unfold(&shape.solution));
        let mut disturbances = Azimuthal::new(&cortex, &y, 0);
        let shift = 3.0;
        disturbances.factorise(shift).unwrap();
        let points = disturbances.points();
        let before: Vec<f64> = (0..2 * points).map(|k| (0.1 * k as f64).sin()).collect();
        let mut after = before.clone();
        disturbances.apply(points, &before, &mut after).unwrap();
        let length = y.scalars[LENGTH];
        // ∫ of δφ + c C w over the surface, and of δφ + φ C w, on which turnover acts.
        let totals = |of: &[f64]| {
            (0..points).fold([0.0; 2], |[amount, excess], k| {
                let (state, u) = (y.stage(k / y.m, k % y.m), y.stage_x(&disturbances.system.gauss, k / y.m, k % y.m));
                let mean = cortex.constants().of_state(u, state, length).mean(state[M]);
                let area = disturbances.weights[k] * state[R];
                let by = |c: f64| area * (of[points + k] + c * mean * of[k]);
                [amount + by(1.0 + state[PHI]), excess + by(state[PHI])]
            })
        };
        let ([before, _], [after, excess]) = (totals(&before), totals(&after));
        let lost = shift * (before - after) / (turnover * excess);
        assert!(before.abs() > 1e-3 && (lost - 1.0).abs() < 1e-5, "{before} {after} {excess}");
    }
}
