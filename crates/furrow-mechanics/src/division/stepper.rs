//! Implicit time stepping of the cortex: variable-step backward differentiation formulas on a moving mesh.
//!
//! One step solves the boundary-value problem with ∂_t x = α₀ (x − x_past), N.13: α₀ and x_past follow from
//! differentiating the polynomial through the new and the last k shapes at fixed u. The difference from the
//! extrapolated shape estimates the local error. Backward differentiation damps unresolved modes, including *growing*
//! ones; while the shape is nearly mirror-symmetric, its odd part is therefore controlled relative to its own size.
//!
//! # References
//! Hairer, Nørsett & Wanner, *Solving Ordinary Differential Equations I*, Springer 1993, ch. III.5 (variable steps).

use furrow_bvp::newton::NewtonScratch;
use furrow_bvp::{
    BoundaryValueProblem, Gauss, Newton, NewtonError, NewtonReport, Solution, System, Transfer, Work, mesh,
};

use super::halves::Halves;
use crate::cortex::equations::{COMPONENTS, Carried, LENGTH, PHI, R, REGULATED, Z};
use crate::cortex::resolution::{self, Places};
use crate::cortex::{Cortex, amount, symmetry};

/// Share of the mesh monitor (about the turning of the contour, in radians) in one interval at the default resolution
/// of 48.
const SHARE: f64 = 1.1;
/// Fraction of that share in a new mesh, so that the shape can sharpen before the mesh must move again.
const ROOM: f64 = 0.85;
/// Most intervals a mesh may grow to.
const MAX_INTERVALS: usize = 1024;

/// Newton's tolerance for a step, relative to 1 + |value|, at the preset's time tolerance; it is smaller for smaller
/// time tolerances, always a small fraction of the error allowed in time. Volumes are accurate to a tenth of it.
pub const SOLVED_TO: f64 = 1e-7;
/// The same as a part of the time tolerance.
const SOLVED_SHARE: f64 = 6.25e-3;
/// Steps of a large cell, or short steps, cannot be solved more accurately: velocities are differences of shapes over
/// the step.
const ROUNDING: f64 = 1e-8;

/// The iteration of a step. A factorisation costs as much as a dozen solves, so that slow chord steps are preferred to
/// a new one. While a neck closes, its forces are far larger than all others and grow at first during the iteration.
const NEWTON: Newton = Newton {
    tolerance: SOLVED_TO,
    max_factorisations: 6,
    max_iterations: 24,
    min_damping: 1e-3,
    leniency: 2.0,
    chord_contraction: 0.5,
};

/// Largest relative difference of the rate 1/Δt at which factors are reused.
const SAME_RATE: f64 = 0.25;

/// Weight, relative to R0, of an error of the regulator in units of its resting concentration.
const CARRIED: f64 = 0.05;

/// Highest order of the formulas.
pub(crate) const MAX_ORDER: usize = 4;

/// A shape at a time.
#[derive(Clone, Debug)]
pub struct HistoryPoint {
    /// Time, in τ.
    pub t: f64,
    /// The full state.
    pub y: Solution,
    /// Size of (r, z) by parity, for shapes that a step has led to.
    pub size: Option<ParityNorm>,
}

/// Weights of the values at `times` in the derivative at `times[0]` of the interpolating polynomial.
pub(crate) fn derivative_weights(times: &[f64], out: &mut [f64]) {
    let t0 = times[0];
    out[0] = times[1..].iter().map(|t| 1.0 / (t0 - t)).sum();
    for i in 1..times.len() {
        let mut weight = 1.0 / (times[i] - t0);
        for j in (1..times.len()).filter(|&j| j != i) {
            weight *= (t0 - times[j]) / (times[i] - times[j]);
        }
        out[i] = weight;
    }
}

/// Weights of the values at `times` in the polynomial through them, evaluated at t.
pub(crate) fn extrapolation_weights(times: &[f64], t: f64, out: &mut [f64]) {
    for i in 0..times.len() {
        out[i] = (0..times.len()).filter(|&j| j != i).map(|j| (t - times[j]) / (times[i] - times[j])).product();
    }
}

/// Sizes of displacements or shapes, split by parity under u → 1 − u; L² over u of (r, z).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ParityNorm {
    /// Mirror-symmetric part.
    pub even: f64,
    /// Antisymmetric part.
    pub odd: f64,
}

/// Parity norms of (r, z) combinations at the stages of a mirror-symmetric mesh; `value(i)` gives (r, z) at stage i.
pub(crate) fn parity_norm(gauss: &Gauss, mesh: &[f64], value: impl Fn(usize) -> [f64; 2]) -> ParityNorm {
    let last = (mesh.len() - 1) * gauss.m - 1;
    // Each is needed for its own stage and for the mirrored one.
    let values: Vec<[f64; 2]> = (0..=last).map(value).collect();
    let (mut even, mut odd) = (0.0, 0.0);
    for (k, interval) in mesh.windows(2).enumerate() {
        for (j, b) in gauss.b.iter().enumerate() {
            let i = k * gauss.m + j;
            let weight = (interval[1] - interval[0]) * b * 0.25;
            let ([r, z], [rm, zm]) = (values[i], values[last - i]);
            even += weight * ((r + rm) * (r + rm) + (z - zm) * (z - zm));
            odd += weight * ((r - rm) * (r - rm) + (z + zm) * (z + zm));
        }
    }
    ParityNorm { even: even.sqrt(), odd: odd.sqrt() }
}

/// [`parity_norm`] of a change of shape. `change` returns any two components of the change at the stage that begins at
/// i; the change of a regulator, relative to its resting concentration, is multiplied by `scale`.
pub(crate) fn change_norm(
    gauss: &Gauss,
    y: &Solution,
    scale: f64,
    change: impl Fn(usize, [usize; 2]) -> [f64; 2],
) -> ParityNorm {
    if y.components < REGULATED {
        return parity_norm(gauss, &y.mesh, |i| change(i * COMPONENTS, [R, Z]));
    }
    let norm = parity_norm(gauss, &y.mesh, |i| change(i * REGULATED, [R, Z]));
    let carried = parity_norm(gauss, &y.mesh, |i| [scale * change(i * REGULATED, [PHI; 2])[0], 0.0]);
    ParityNorm { even: norm.even.hypot(carried.even), odd: norm.odd.hypot(carried.odd) }
}

/// The result of one attempted step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Attempt {
    /// Estimated local error.
    pub error: ParityNorm,
    /// Odd part of the new shape.
    pub odd_size: f64,
}

/// Time stepper of one cell. `history[0]` is the newest accepted shape.
pub struct Stepper {
    /// The problem, with the rate and past of the step last attempted.
    pub cortex: Cortex,
    /// Linear algebra.
    pub system: System,
    /// Accepted shapes, newest first, all on the same mesh.
    pub history: Vec<HistoryPoint>,
    /// Whether steps start from the polynomial through the last shapes instead of the last shape.
    pub extrapolates: bool,
    /// Work of all attempts; steps are counted by the caller.
    pub work: Work,
    /// Size of the antisymmetric part of a shape, relative to R0, below which the step from there may be solved on
    /// [halves](Self::halve).
    pub nearly_symmetric: f64,
    /// Weights of the shapes, newest first, in the rate of change of the newest, for the formula last attempted.
    pub weights: Vec<f64>,
    spare: Vec<HistoryPoint>,
    trial: HistoryPoint,
    scratch: NewtonScratch,
    newton: Newton,
    weight: Vec<f64>,
    places: Places,
    grid: Vec<f64>,
    /// Whether the current factors belong to half contours, and their rate.
    factored: Option<(bool, f64)>,
    share: f64,
    /// Number of times that the intervals are halved in meshes from the next [`adapt`](Self::adapt) on.
    pub(super) halvings: u32,
    halves: Option<Halves>,
}

impl Stepper {
    /// Starts from a shape at t = 0. `resolution` is the nominal number of intervals; the mesh follows the shape and
    /// uses fewer while it is smooth, more where it is sharp.
    pub fn new(cortex: Cortex, stages: usize, resolution: usize, start: Solution) -> Stepper {
        let system = System::new(cortex.dimensions(), stages);
        Stepper {
            cortex,
            system,
            trial: HistoryPoint { t: 0.0, y: start.clone(), size: None },
            history: vec![HistoryPoint { t: 0.0, y: start, size: None }],
            extrapolates: true,
            work: Work::default(),
            nearly_symmetric: 0.0,
            weights: Vec::new(),
            spare: Vec::new(),
            scratch: NewtonScratch::default(),
            newton: NEWTON,
            weight: Vec::new(),
            places: Places::default(),
            grid: Vec::new(),
            factored: None,
            share: SHARE * 48.0 / resolution as f64,
            halvings: 0,
            halves: None,
        }
    }

    /// From now on solves steps on half of the contour whenever the shape of this mirror-symmetric cell is [nearly
    /// symmetric](Self::nearly_symmetric).
    pub fn halve(&mut self) {
        self.halves = Some(Halves::new(&self.cortex, &self.history[0].y));
    }

    /// Sets the accuracy of the steps' equations for a time tolerance.
    pub fn solve_for(&mut self, time_tolerance: f64) {
        self.newton.tolerance = (SOLVED_SHARE * time_tolerance).clamp(ROUNDING, SOLVED_TO);
    }

    /// Solves steps more accurately, on a finer mesh: for small perturbations of a stationary shape.
    pub(crate) fn exacting(&mut self) {
        self.newton.tolerance *= 0.3;
        self.share *= 0.7;
    }

    /// Adds the work of a Newton iteration.
    pub fn count(&mut self, report: NewtonReport) {
        self.work.iterations += report.iterations;
        self.work.factorisations += report.factorisations;
    }

    /// Discards all shapes except the newest: the next step is of first order.
    pub(crate) fn restart(&mut self) {
        self.spare.extend(self.history.drain(1..));
        self.factored = None;
    }

    /// Attempts a step of size dt with order at most `order`; [`accept`](Self::accept) accepts it.
    pub fn attempt(&mut self, dt: f64, order: usize) -> Result<Attempt, NewtonError> {
        let order = order.min(self.history.len()).min(MAX_ORDER);
        let known = if self.extrapolates { (order + 1).min(self.history.len()) } else { 1 };
        let times = self.times(dt);
        let mut predict = [0.0; MAX_ORDER + 2];
        extrapolation_weights(&times[1..=known], times[0], &mut predict);
        extrapolate(&self.history[..known], &predict[..known], &mut self.trial.y);
        self.attempt_from_trial(dt, order, &predict[..known])
    }

    /// Lengthens the step of first order that was just solved to dt, from its change in proportion. On an error the solved step
    /// stays.
    pub(crate) fn lengthen(&mut self, dt: f64) -> Result<Attempt, NewtonError> {
        let solved = self.trial.clone();
        let longer = dt / (solved.t - self.history[0].t);
        self.trial.y.combine(longer, std::iter::once((&self.history[0].y, 1.0 - longer)));
        let attempt = self.attempt_from_trial(dt, 1, &[1.0]);
        if attempt.is_err() {
            self.trial = solved;
        }
        attempt
    }

    /// The time after a step of size dt, and before it the times of the last shapes.
    fn times(&self, dt: f64) -> [f64; MAX_ORDER + 2] {
        let mut times = [0.0; MAX_ORDER + 2];
        times[0] = self.history[0].t + dt;
        for (time, level) in times[1..].iter_mut().zip(&self.history) {
            *time = level.t;
        }
        times
    }

    /// Solves a step from the trial shape. `predict` are the weights of the last shapes in the one that the error is measured from.
    fn attempt_from_trial(&mut self, dt: f64, order: usize, predict: &[f64]) -> Result<Attempt, NewtonError> {
        let times = self.times(dt);
        let t = times[0];
        let mut alpha = [0.0; MAX_ORDER + 2];
        derivative_weights(&times[..=order], &mut alpha);
        self.state(&alpha[..=order]);
        self.trial.t = t;
        self.solve_trial()?;
        let share = dt / (t - times[predict.len()]);
        let gauss = &self.system.gauss;
        let new = &self.trial.y.stages;
        let r0 = self.cortex.cell.r0;
        let error = change_norm(gauss, &self.trial.y, CARRIED * r0, |i, [a, b]| {
            let mut change = [new[i + a], new[i + b]];
            for (level, weight) in self.history.iter().zip(predict) {
                change[0] -= weight * level.y.stages[i + a];
                change[1] -= weight * level.y.stages[i + b];
            }
            [change[0] * share, change[1] * share]
        });
        let n = self.trial.y.components;
        let size = parity_norm(gauss, &self.trial.y.mesh, |i| [new[i * n + R], new[i * n + Z]]);
        self.trial.size = Some(size);
        Ok(Attempt { error, odd_size: size.odd })
    }

    /// States the step with these weights of the shapes, newest first, in the rate of change: sets its rate and its
    /// past.
    fn state(&mut self, weights: &[f64]) {
        self.weights.clear();
        self.weights.extend_from_slice(weights);
        let n = self.history[0].y.components;
        let points = self.history[0].y.stages.len() / n;
        self.cortex.past.clear();
        self.cortex.past.extend((0..points).map(|i| {
            let mut past = [0.0; 2];
            for (level, weight) in self.history.iter().zip(&weights[1..]) {
                let s = &level.y.stages[i * n..(i + 1) * n];
                past[0] -= weight * s[R];
                past[1] -= weight * s[Z];
            }
            [past[0] / weights[0], past[1] / weights[0]]
        }));
        self.cortex.carried_past.clear();
        if let Some(regulator) = self.cortex.cell.cue.regulator() {
            let past = |i: usize| {
                let mut past = [0.0; 3];
                for (level, weight) in self.history.iter().zip(&weights[1..]) {
                    let state = &level.y.stages[i * n..(i + 1) * n];
                    let parts = Carried::of(state, level.y.scalars[LENGTH], regulator.diluted).parts();
                    past.iter_mut().zip(parts).for_each(|(past, part)| *past -= weight / weights[0] * part);
                }
                Carried::from(past)
            };
            let past: Vec<Carried> = (0..points).map(past).collect();
            self.cortex.carried_past.extend(past);
        }
        self.cortex.rate = weights[0];
    }

    /// Solves the stated step from the trial shape and into it, on half contours if allowed, with the current factors
    /// if they belong to such a step at nearly the same rate.
    fn solve_trial(&mut self) -> Result<(), NewtonError> {
        let (newest, rate) = (&self.history[0], self.cortex.rate);
        let halved = self.halves.is_some()
            && newest.size.is_some_and(|size| size.odd < self.nearly_symmetric * self.cortex.cell.r0)
            && symmetry::is_mirrored(&newest.y.mesh);
        let near = |(of_halves, other): (bool, f64)| of_halves == halved && (rate / other - 1.0).abs() < SAME_RATE;
        let reuse = self.factored.is_some_and(near);
        let Stepper { newton, system, scratch, cortex, trial, halves, .. } = self;
        let solved = match halves {
            Some(halves) if halved => halves.solve(newton, cortex, &mut trial.y, reuse),
            _ => newton.solve(system, scratch, cortex, &mut trial.y, &[], reuse),
        };
        match solved {
            Ok(report) => {
                if report.factorisations > 0 {
                    self.factored = Some((halved, rate));
                }
                self.count(report);
            }
            Err(_) => {
                self.factored = None;
                self.work.iterations += self.newton.max_factorisations;
                // The next attempt is on the whole contour.
                self.history[0].size = None;
            }
        }
        solved.map(drop)
    }

    /// Makes the attempted step the newest level.
    pub fn accept(&mut self) {
        let oldest = self.history.len() > MAX_ORDER;
        let level = self.spare.pop().or_else(|| if oldest { self.history.pop() } else { None });
        let level = level.unwrap_or_else(|| self.trial.clone());
        self.history.insert(0, std::mem::replace(&mut self.trial, level));
        while self.history.len() > MAX_ORDER + 1 {
            self.spare.extend(self.history.pop());
        }
    }

    /// L² speed of the shape at fixed u over the last step, relative to R0; infinite before two shapes are known.
    pub fn speed(&self) -> f64 {
        let [new, old, ..] = &self.history[..] else { return f64::INFINITY };
        self.rate_of_change(|i, k| (new.y.stages[i + k] - old.y.stages[i + k]) / (new.t - old.t))
    }

    /// Estimated distance of the shape from rest, in L² and relative to R0. For a mode with rate σ, real or complex,
    /// that approaches or leaves rest, the speed is σ times the distance, and the acceleration σ times the speed.
    /// `None` before three shapes are known.
    pub(crate) fn distance_to_rest(&self) -> Option<f64> {
        let [new, old, older, ..] = &self.history[..] else { return None };
        let velocity = |a: &HistoryPoint, b: &HistoryPoint, i: usize| (a.y.stages[i] - b.y.stages[i]) / (a.t - b.t);
        let between = 0.5 * (new.t - older.t);
        let acceleration =
            self.rate_of_change(|i, k| (velocity(new, old, i + k) - velocity(old, older, i + k)) / between);
        Some(self.speed().powi(2) / acceleration)
    }

    /// L² norm over u, relative to R0, of a change; `change` returns its component k at the stage that begins at i.
    fn rate_of_change(&self, change: impl Fn(usize, usize) -> f64) -> f64 {
        let (newest, r0) = (&self.history[0].y, self.cortex.cell.r0);
        let norm = change_norm(&self.system.gauss, newest, r0, |i, at| at.map(|k| change(i, k)));
        norm.even.hypot(norm.odd) / r0
    }

    /// Even number of intervals that keeps the share of each in the monitor below `room` of its limit.
    fn wanted_intervals(&self, mesh: &[f64], room: f64) -> usize {
        let total: f64 = mesh.windows(2).zip(&self.weight).map(|(x, w)| (x[1] - x[0]) * w).sum();
        let share = self.share * 0.5f64.powi(self.halvings as i32);
        let wanted = (total / (room * share)).ceil() as usize;
        (2 * wanted.div_ceil(2)).clamp(8, MAX_INTERVALS)
    }

    /// Moves the mesh if the monitor is out of balance by more than `tolerance` or the number of intervals no longer
    /// fits the shape; all earlier shapes follow by their own collocation polynomials. `symmetric` keeps the mesh
    /// mirror-symmetric.
    pub(crate) fn adapt(&mut self, symmetric: bool, tolerance: f64) {
        let y = &self.history[0].y;
        resolution::monitor(&self.cortex, y, symmetric, &mut self.places, &mut self.weight);
        let (now, wanted) = (y.intervals(), self.wanted_intervals(&y.mesh, 1.0));
        if mesh::imbalance(&y.mesh, &self.weight) < tolerance && wanted <= now && 3 * wanted >= 2 * now {
            return;
        }
        // The monitor is known only at the old points, so a sharp neck takes a second iteration on the new ones.
        let mut source = self.spare.pop().unwrap_or_else(|| self.history[0].clone());
        source.y.clone_from(&self.history[0].y);
        for _ in 0..3 {
            let wanted = self.wanted_intervals(&source.y.mesh, ROOM);
            mesh::equidistribute(&source.y.mesh, &self.weight, wanted, &mut self.grid);
            if symmetric {
                let n = self.grid.len() - 1;
                for i in 0..=n / 2 {
                    let half = 0.5 * (self.grid[i] + 1.0 - self.grid[n - i]);
                    self.grid[i] = half;
                    self.grid[n - i] = 1.0 - half;
                }
            }
            self.history[0].y.transfer_into(&self.system.gauss, &self.grid, &mut source.y);
            resolution::monitor(&self.cortex, &source.y, symmetric, &mut self.places, &mut self.weight);
            if mesh::imbalance(&self.grid, &self.weight) < 1.2 {
                break;
            }
        }
        self.spare.push(source);
        let transfer = Transfer::new(&self.system.gauss, &self.history[0].y.mesh, &self.grid);
        for level in &mut self.history {
            transfer.apply(&level.y, &mut self.trial.y);
            if self.cortex.cell.cue.regulator().is_some_and(|regulator| regulator.diluted) {
                amount::keep(&self.system.gauss, &level.y, &mut self.trial.y);
            }
            std::mem::swap(&mut level.y, &mut self.trial.y);
        }
        self.work.remeshings += 1;
        self.factored = None;
    }
}

/// Σ w_j y_j over the history into `out`, taking mesh and shape from the first.
fn extrapolate(history: &[HistoryPoint], weights: &[f64], out: &mut Solution) {
    out.clone_from(&history[0].y);
    out.combine(weights[0], history.iter().map(|level| &level.y).zip(weights.iter().copied()).skip(1));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weights_are_exact_for_polynomials() {
        let times = [1.7, 1.2, 1.1, 0.4];
        let (mut d, mut e) = ([0.0; 4], [0.0; 4]);
        derivative_weights(&times, &mut d);
        extrapolation_weights(&times, 2.5, &mut e);
        for degree in 0..4 {
            let value = |t: f64| t.powi(degree);
            let slope: f64 = times.iter().zip(d).map(|(t, w)| w * value(*t)).sum();
            let exact = if degree == 0 { 0.0 } else { degree as f64 * 1.7f64.powi(degree - 1) };
            assert!((slope - exact).abs() < 1e-12);
            let ahead: f64 = times.iter().zip(e).map(|(t, w)| w * value(*t)).sum();
            assert!((ahead - value(2.5)).abs() < 1e-11);
        }
    }
}
