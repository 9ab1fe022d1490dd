//! The largest growth rate at every point of a branch, each computed from the previous one.
//!
//! For s → 0 the implicit step P_s of N.12, divided by s, becomes w ↦ K w = (−J)⁻¹ M w with the eigenvalues κ = −1/σ.
//! An Arnoldi iteration finds modes near zero first, but fast-growing modes last. The number of growing modes is known:
//! it changes only at folds and pitchforks, which the branch locates, and after each of them the spectrum is
//! recomputed. The iteration ends when it has found this number of growing modes. If it finds another number, for
//! example where a pair of complex rates begins to grow, the spectrum is recomputed too.

use furrow_bvp::Solution;
use furrow_cell::Parameter;
use furrow_spectra::{Krylov, RitzValue};
use ordered_float::OrderedFloat;

use super::shifts::{REACH, shift_scale};
use super::spectrum::Result;
use super::{GrowthRate, Parity, Stability, end_of, parities};
use crate::cortex::Cortex;
use crate::cortex::problem::SHAPE_SCALARS;

/// Largest Krylov dimension before the spectrum is recomputed.
const MOST_DIMENSIONS: usize = 24;

/// Number of Ritz vectors from which the next point starts.
const KEPT: usize = 3;

/// Growth rates along one branch.
#[derive(Clone, Debug)]
pub(crate) struct FollowedRates {
    /// The cell at the last point.
    cortex: Cortex,
    /// The parameters with values at each point.
    free: Vec<Parameter>,
    stability: Stability,
    /// Number of folds and pitchforks before the point at which modes were counted, and the numbers of growing modes:
    /// even ones (all, on a full contour), and odd ones.
    counted: Option<(usize, [usize; 2])>,
    krylov: [Krylov; 2],
}

impl FollowedRates {
    /// For shapes of a cell with free parameters, with m stages per interval.
    pub(crate) fn new(cortex: &Cortex, stages: usize) -> FollowedRates {
        FollowedRates {
            cortex: Cortex::new(&cortex.cell, cortex.domain, &[]),
            free: cortex.free.clone(),
            stability: Stability::new(stages),
            counted: None,
            krylov: Default::default(),
        }
    }

    /// The cell at the last point.
    pub(crate) fn cortex(&self) -> &Cortex {
        &self.cortex
    }

    /// The rightmost growth rate at the next point of a branch, after `passed` folds and pitchforks; `None` if it cannot
    /// be computed.
    pub(crate) fn leading(&mut self, y: &Solution, passed: usize) -> Option<Leading> {
        let mut y = y.clone();
        for (parameter, value) in self.free.iter().zip(y.scalars.drain(SHAPE_SCALARS..)) {
            parameter.set(&mut self.cortex.cell, value);
        }
        self.cortex.refresh();
        let growing = self.counted.filter(|(then, _)| *then == passed).map(|(_, growing)| growing);
        growing.and_then(|growing| self.near_zero(&y, growing)).or_else(|| self.anew(&y, passed))
    }

    /// From the whole spectrum; counts the growing modes.
    fn anew(&mut self, y: &Solution, passed: usize) -> Option<Leading> {
        self.counted = None;
        if self.cortex.is_regulated() {
            // Fast modes of a regulator may grow at complex rates.
            return self.stability.rightmost(&self.cortex, y).ok().map(|rate| Leading::of(&rate));
        }
        let spectrum = self.stability.leading(&self.cortex, y).ok()?;
        let growing =
            |odd: bool| spectrum.values.iter().filter(|v| v.re > 0.0 && odd == (v.parity == Parity::Odd)).count();
        let growing = [growing(false), growing(true)];
        // If all requested modes grow, there may be more.
        self.counted = growing.iter().all(|&count| count < self.stability.arnoldi.wanted).then_some((passed, growing));
        spectrum.values.first().map(Leading::of)
    }

    /// From the modes nearest to zero, if the same number of modes grow as before.
    fn near_zero(&mut self, y: &Solution, growing: [usize; 2]) -> Option<Leading> {
        let FollowedRates { cortex, stability, krylov, .. } = self;
        let Stability { arnoldi, system, antisymmetric, disturbances, operator, .. } = stability;
        system.factorise(cortex, y, &[]).ok()?;
        let scale = shift_scale(cortex);
        disturbances.set(cortex, y, &system.gauss, 1.0);
        disturbances.assemble(system, operator).ok()?;
        let mut largest = Leading { rate: f64::NEG_INFINITY, frequency: 0.0 };
        let mut scalars = [0.0; SHAPE_SCALARS];
        for (krylov, (&parity, growing)) in krylov.iter_mut().zip(parities(cortex.domain).iter().zip(growing)) {
            let end = end_of(parity, system, antisymmetric, y.components).ok()?;
            let step = |from: &[f64], to: &mut [f64]| -> Result<()> {
                Ok(operator.apply(system, end, from, to, &mut scalars)?)
            };
            let tolerance = arnoldi.tolerance;
            let found = krylov.run(&disturbances.weights, MOST_DIMENSIONS, step, |values, _| {
                let modes = Modes::of(values, scale, tolerance);
                modes.are_all(growing).then(|| (modes.values[0].leading(), modes.nearest()))
            });
            let (leading, nearest) = found.ok()??;
            krylov.start_near(&nearest);
            if leading.rate > largest.rate {
                largest = leading;
            }
        }
        Some(largest)
    }
}

/// The rightmost growth rate of a shape.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Leading {
    /// Re σ, in 1/τ.
    pub rate: f64,
    /// |Im σ|, in 1/τ.
    pub frequency: f64,
}

impl Leading {
    /// The leading rate of a spectrum.
    pub(crate) fn of(rate: &GrowthRate) -> Leading {
        Leading { rate: rate.re, frequency: rate.im.abs() }
    }
}

/// The growth rate of a Ritz value.
#[derive(Clone, Copy, Debug)]
struct Mode {
    /// Re σ.
    rate: f64,
    /// |σ|.
    size: f64,
    /// Whether σ is accurate.
    settled: bool,
    /// Its index among the Ritz values.
    place: usize,
}

impl Mode {
    /// The mode as the rightmost one of a shape.
    fn leading(&self) -> Leading {
        let Mode { rate, size, .. } = *self;
        Leading { rate, frequency: (size * size - rate * rate).max(0.0).sqrt() }
    }
}

/// The modes of Ritz values, the rightmost first.
struct Modes {
    values: Vec<Mode>,
}

impl Modes {
    /// The modes that are accurate, or slow enough that they must be.
    fn of(ritz: &[RitzValue], scale: f64, tolerance: f64) -> Modes {
        let mode = |(place, value): (usize, &RitzValue)| {
            let square = value.re * value.re + value.im * value.im;
            let size = 1.0 / square.sqrt();
            let settled = value.residual / square <= tolerance * (size + scale);
            (settled || size <= REACH * scale).then(|| Mode { rate: -value.re / square, size, settled, place })
        };
        let mut values: Vec<Mode> = ritz.iter().enumerate().filter_map(mode).collect();
        values.sort_by_cached_key(|item| OrderedFloat(-item.rate));
        Modes { values }
    }

    /// Whether `growing` modes grow, and the rightmost mode is accurate.
    fn are_all(&self, growing: usize) -> bool {
        let grow = self.values.iter().filter(|mode| mode.rate > 0.0).count();
        grow == growing && self.values.first().is_some_and(|mode| mode.settled)
    }

    /// The indices of the modes from which the iteration at the next point starts: the rightmost, then the slowest.
    fn nearest(&self) -> Vec<usize> {
        let mut others = self.values[1..].to_vec();
        others.sort_by_cached_key(|item| OrderedFloat(item.size));
        self.values[..1].iter().chain(&others).take(KEPT).map(|mode| mode.place).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::equilibria::{BranchOptions, primary};
    use furrow_cell::{Cell, Numerics};

    /// Along branches, across a pitchfork and a fold that the caller does not report, and with a cue on the whole
    /// contour.
    #[test]
    fn agrees_with_the_spectrum_at_every_point() {
        let cued = |r0, cue: &str| Cell::new(r0).with_cue(cue.parse().unwrap());
        let cells = [(Cell::new(2.0), 60), (cued(2.2, "tension:gradient,amplitude=0.1"), 40)];
        for (cell, points) in cells {
            let settings = BranchOptions::default().settings;
            let mut branch = primary::start(&cell, &Numerics::default(), &settings).unwrap();
            let stages = branch.state.solution.m;
            let (mut rates, mut alone) = (FollowedRates::new(&branch.problem, stages), Stability::new(stages));
            let (mut followed, mut least, mut most) = (0, f64::INFINITY, f64::NEG_INFINITY);
            let ended = branch.follow([0.0, 40.0], points, |branch, _| {
                let rate = rates.leading(&branch.state.solution, 0).unwrap().rate;
                let expected = alone.growth_rate(&branch.problem, &branch.state.solution).unwrap();
                let xi_s = branch.state.parameter();
                assert!((rate - expected).abs() < 1e-7 * (1.0 + expected.abs()), "{xi_s}: {rate} {expected}");
                followed += usize::from(rates.counted.is_some());
                (least, most) = (least.min(rate), most.max(rate));
                true
            });
            ended.unwrap();
            assert!(followed > 10 && least < -0.5 && most > 0.1, "{followed} {least} {most}");
        }
    }
}
