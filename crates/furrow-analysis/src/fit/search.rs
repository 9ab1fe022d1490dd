//! Particle swarms, which need no derivatives: counts are piecewise constant.
//!
//! # References
//! Zambrano-Bigiarini, Clerc & Rojas, "Standard Particle Swarm Optimisation 2011 at CEC-2013", IEEE CEC 2013.

use argmin::core::{CostFunction, Error, Executor};
use argmin::solver::brent::BrentOpt;
use argmin::solver::neldermead::NelderMead;
use argmin::solver::particleswarm::ParticleSwarm;
use furrow_lineage::batch::scheduler;
use furrow_lineage::{Lineage, TreeSettings};
use rand_xoshiro::Xoshiro256PlusPlus;
use rand_xoshiro::rand_core::SeedableRng;
use serde::Serialize;
use std::sync::atomic::AtomicBool;

/// The misfit to minimise over the unit cube; infinite where it is undefined.
type Misfit<'a> = &'a (dyn Fn(&[f64]) -> f64 + Sync);

/// Share of a range next to an end of it that counts as the end: a simplex only comes near it.
const AT_LIMIT: f64 = 0.005;
/// Valleys of a scan that are searched to the bottom, the accuracy there, and the most steps.
const VALLEYS: usize = 4;
const BOTTOM: f64 = 1e-6;
const STEPS: u64 = 60;

/// A box inside the unit cube, [lower, upper] by coordinate.
pub(crate) type Region = Vec<[f64; 2]>;

/// Size and seed of a search.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SearchBudget {
    /// Particles of the swarm.
    pub particles: usize,
    /// Moves of each.
    pub moves: u64,
    /// Seed of their positions and moves.
    pub seed: u64,
}

/// An end of the range in which a number is searched.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Limit {
    /// The lower end.
    Lower,
    /// The upper end.
    Upper,
}

impl Limit {
    /// That end of a range.
    pub fn of(self, [lower, upper]: [f64; 2]) -> f64 {
        if self == Limit::Lower { lower } else { upper }
    }

    /// The end at which a place of the unit interval lies, if it does: beyond it the fit may be better.
    pub(super) fn at(share: f64) -> Option<Limit> {
        match share {
            share if share <= AT_LIMIT => Some(Limit::Lower),
            share if share >= 1.0 - AT_LIMIT => Some(Limit::Upper),
            _ => None,
        }
    }
}

/// A number with its best value at an end of the range in which it was searched.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct NumberAtLimit {
    /// Its name.
    pub name: String,
    /// The best value.
    pub value: f64,
    /// The end.
    pub limit: Limit,
    /// Between which values was searched.
    pub searched: [f64; 2],
}

/// How far a search has come.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FitProgress {
    /// Candidates tried.
    pub done: usize,
    /// Most candidates that will be tried.
    pub of: usize,
    /// The least misfit so far, where there is one misfit.
    pub least: Option<f64>,
}

/// Called with the progress of a fit, from any thread.
pub(crate) type ShowProgress<'a> = &'a (dyn Fn(FitProgress) + Sync);

/// What all fits need: a lineage with the parameters of its divisions, and how they run.
#[derive(Clone, Copy)]
pub struct FitRun<'a> {
    /// The lineage.
    pub lineage: &'a Lineage,
    /// The parameters of its divisions.
    pub settings: &'a TreeSettings,
    /// Threads; 0 is one for each core.
    pub threads: usize,
    /// Stops the fit.
    pub cancel: &'a AtomicBool,
    /// Shows how far it is.
    pub progress: Option<ShowProgress<'a>>,
}

impl<'a> FitRun<'a> {
    /// A fit that shows no progress.
    pub fn new(lineage: &'a Lineage, settings: &'a TreeSettings, threads: usize, cancel: &'a AtomicBool) -> FitRun<'a> {
        FitRun { lineage, settings, threads, cancel, progress: None }
    }
}

impl SearchBudget {
    /// How often a swarm asks for the misfit: at its first positions and after each move.
    pub(super) fn evaluations(self) -> usize {
        self.particles * (self.moves as usize + 1)
    }
}

/// A misfit as the solver asks for it.
struct Problem<'a>(Misfit<'a>);

impl CostFunction for Problem<'_> {
    type Param = Vec<f64>;
    type Output = f64;

    fn cost(&self, place: &Vec<f64>) -> Result<f64, Error> {
        Ok((self.0)(place))
    }

    fn parallelize(&self) -> bool {
        true
    }
}

/// A misfit of one number.
struct Line<'a>(Misfit<'a>);

impl CostFunction for Line<'_> {
    type Param = f64;
    type Output = f64;

    fn cost(&self, place: &f64) -> Result<f64, Error> {
        Ok((self.0)(&[*place]))
    }
}

/// The best place that a swarm finds in a region, and its misfit; `None` if no misfit is finite. Evaluates particles in
/// parallel on the current pool; the result does not depend on the number of threads.
pub(crate) fn swarm(region: &Region, effort: SearchBudget, misfit: Misfit<'_>) -> Option<(Vec<f64>, f64)> {
    let bounds = (region.iter().map(|r| r[0]).collect::<Vec<_>>(), region.iter().map(|r| r[1]).collect());
    let solver =
        ParticleSwarm::new(bounds, effort.particles).with_rng_generator(Xoshiro256PlusPlus::seed_from_u64(effort.seed));
    let run = Executor::new(Problem(misfit), solver).configure(|state| state.max_iters(effort.moves)).run().ok()?;
    let best = run.state.best_individual?;
    best.cost.is_finite().then_some((best.position, best.cost))
}

/// The place of the least misfit over the unit interval, and the misfit: `count` places evenly spaced, and the bottoms of the deepest
/// valleys between them; `None` if no misfit is finite.
pub(crate) fn scan(count: usize, misfit: Misfit<'_>) -> Option<(Vec<f64>, f64)> {
    let last = count.max(2) - 1;
    let place = |k: usize| k as f64 / last as f64;
    let found = scheduler::in_parallel(last + 1, |k| misfit(&[place(k)]));
    // Of a level stretch the first place.
    let is_low = |k: &usize| {
        found[..*k].last().is_none_or(|f| found[*k] < *f) && found.get(k + 1).is_none_or(|f| found[*k] <= *f)
    };
    let mut low: Vec<usize> = (0..=last).filter(is_low).collect();
    low.sort_by(|a, b| found[*a].total_cmp(&found[*b]));
    let sides = |k: usize| [place(k.saturating_sub(1)), place((k + 1).min(last))];
    let bottoms = scheduler::in_parallel(low.len().min(VALLEYS), |k| bottom(sides(low[k]), misfit));
    let all = low.first().map(|k| (vec![place(*k)], found[*k])).into_iter().chain(bottoms.into_iter().flatten());
    all.filter(|(_, cost)| cost.is_finite()).min_by(|a, b| a.1.total_cmp(&b.1))
}

/// The bottom of a valley between two places of the unit interval (Brent's minimisation).
fn bottom([from, to]: [f64; 2], misfit: Misfit<'_>) -> Option<(Vec<f64>, f64)> {
    let solver = BrentOpt::new(from, to).set_tolerance(f64::EPSILON.sqrt(), BOTTOM);
    let run = Executor::new(Line(misfit), solver).configure(|state| state.max_iters(STEPS)).run().ok()?;
    Some((vec![run.state.best_param?], run.state.best_cost))
}

/// Goes downhill from a place of the unit interval with a known misfit to the next minimum; the first step is `edge` long.
pub(crate) fn valley((mut place, mut least): (Vec<f64>, f64), edge: f64, misfit: Misfit<'_>) -> (Vec<f64>, f64) {
    let mut ends = [-edge, edge].map(|step| (place[0] + step).clamp(0.0, 1.0));
    for (end, step) in [-edge, edge].into_iter().enumerate() {
        let mut step = step;
        loop {
            let next = misfit(&ends[end..=end]);
            if next >= least {
                break;
            }
            // The place before bounds the valley on the other side.
            ends[1 - end] = place[0];
            (place[0], least) = (ends[end], next);
            step *= 2.0;
            ends[end] = (place[0] + step).clamp(0.0, 1.0);
        }
    }
    bottom(ends, misfit).filter(|(_, found)| *found < least).unwrap_or((place, least))
}

/// A local minimum near a place, for smooth misfits (Nelder & Mead's simplex with edges `edge`).
pub fn descend(place: &[f64], edge: f64, steps: u64, misfit: Misfit<'_>) -> Option<(Vec<f64>, f64)> {
    let corner = |k: usize| {
        let mut corner = place.to_vec();
        corner[k] += if corner[k] + edge > 1.0 { -edge } else { edge };
        corner
    };
    let simplex: Vec<Vec<f64>> = std::iter::once(place.to_vec()).chain((0..place.len()).map(corner)).collect();
    let solver = NelderMead::new(simplex).with_sd_tolerance(1e-9).ok()?;
    let run = Executor::new(Problem(misfit), solver).configure(|state| state.max_iters(steps)).run().ok()?;
    let cost = run.state.best_cost;
    Some((run.state.best_param?, cost)).filter(|(_, cost)| cost.is_finite())
}

/// A place with one of its coordinates at another value.
pub(super) fn moved(place: &[f64], index: usize, value: f64) -> Vec<f64> {
    let mut out = place.to_vec();
    out[index] = value;
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A valley of steps with its bottom at (0.3, 0.7).
    fn steps(place: &[f64]) -> f64 {
        let away = (place[0] - 0.3).hypot(2.0 * (place[1] - 0.7));
        (away * 50.0).round() / 50.0
    }

    #[test]
    fn a_swarm_finds_the_bottom_of_steps_at_any_number_of_threads() {
        let effort = SearchBudget { particles: 16, moves: 30, seed: 5 };
        let found = [1, 3].map(|threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| swarm(&vec![[0.0, 1.0]; 2], effort, &steps).unwrap())
        });
        assert_eq!(found[0], found[1]);
        assert!(found[0].1 <= 0.04, "{found:?}");
        // A function that is nowhere finite has no minimum.
        assert_eq!(swarm(&vec![[0.0, 1.0]; 2], effort, &|_| f64::INFINITY), None);
    }

    /// The narrow valley is the deeper one. A function that decreases over the whole range has its minimum at the end.
    #[test]
    fn a_scan_finds_the_deepest_valley() {
        let valleys = |place: &[f64]| (place[0] - 0.3).abs().min(5.0 * (place[0] - 0.81).abs() - 0.1);
        let (place, least) = scan(40, &valleys).unwrap();
        assert!((place[0] - 0.81).abs() < 1e-6 && (least + 0.1).abs() < 1e-5, "{place:?} {least}");
        assert_eq!(scan(12, &|place| -place[0]), Some((vec![1.0], -1.0)));
        assert_eq!(scan(12, &|_| f64::INFINITY), None);
    }

    /// From either side, and at an end of the interval.
    #[test]
    fn a_valley_is_left_at_its_bottom() {
        let bowl = |place: &[f64]| (place[0] - 0.31).powi(2);
        for start in [0.02, 0.3, 0.9] {
            let (place, _) = valley((vec![start], bowl(&[start])), 0.01, &bowl);
            assert!((place[0] - 0.31).abs() < 1e-5, "{place:?}");
        }
        assert_eq!(valley((vec![0.97], -0.97), 0.01, &|place| -place[0]), (vec![1.0], -1.0));
    }

    #[test]
    fn a_descent_ends_at_the_bottom() {
        let bowl = |place: &[f64]| (place[0] - 0.31).powi(2) + 3.0 * (place[1] - 0.72).powi(2);
        let (place, _) = descend(&[0.4, 0.6], 0.05, 200, &bowl).unwrap();
        assert!((place[0] - 0.31).abs() < 1e-3 && (place[1] - 0.72).abs() < 1e-3, "{place:?}");
    }

    #[test]
    fn ends_of_a_range_differ_from_its_inside() {
        let at = [0.0, 0.004, 0.006, 0.5, 0.994, 0.996, 1.0].map(Limit::at);
        let (lower, upper) = (Some(Limit::Lower), Some(Limit::Upper));
        assert_eq!(at, [lower, lower, None, None, None, upper, upper]);
        assert_eq!(Limit::Upper.of([2.0, 3.0]), 3.0);
    }
}
