//! Fits one set of constants to the embryo.
//!
//! Swarms minimise M + λT, misfit and deviation of the thresholds (see [`evaluated`]), at several λ; the Pareto front comes from
//! all evaluated sets.

pub mod evaluated;

pub use evaluated::{Evaluated, FounderFit, Parts, ThresholdFit};

use self::evaluated::by_misfit;
use super::error::{FitError, check_cancelled};
use super::search::{FitProgress, FitRun, Limit, NumberAtLimit, Region, SearchBudget, moved, swarm};
use super::targets::{Searched, Targets};
use furrow_cell::{Cell, Parameter};
use furrow_lineage::Lineage;
use furrow_lineage::batch::{Memo, scheduler};
use serde::Serialize;
use std::collections::BTreeMap;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

/// λ of the swarms, in misfit per unit of the thresholds' rms deviation. The first, which looks for the counts alone, has the
/// whole region; the others what lies between its best and the constants of the start.
const TRADES: [f64; 4] = [0.0, 1.0, 5.0, 25.0];
/// Share of the effort that each but the first is given.
const SHARE: u64 = 3;
/// Places on the straight line from the start to the best.
const STEPS: usize = 8;
/// Increase of the misfit that defines the sharpness of the best.
const WORSE: f64 = 0.05;
/// Smallest and largest move, in the unit cube.
const MOVES: [f64; 2] = [0.0025, 0.32];
/// Halvings of the last move.
const HALVINGS: usize = 4;
/// Generations beyond the observed and cells per observed cell after which growth stops: the misfit is large then.
const BEYOND: [u32; 2] = [5, 6];

/// Between which values of a constant the misfit is at most 0.05 above the best, the others as they are; of the activity
/// at the gain of the best.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Sharpness {
    /// The constant.
    pub parameter: Parameter,
    /// The lower end.
    pub from: f64,
    /// The upper end.
    pub to: f64,
    /// Whether an end is a limit of the search.
    pub reaches_limit: bool,
}

/// The result of a fit of constants.
#[derive(Clone, Debug, PartialEq)]
pub struct FittedConstants {
    /// The least misfit of the counts.
    pub best: Evaluated,
    /// The constants of the start.
    pub start: Evaluated,
    /// The Pareto front, from the least misfit to the best thresholds.
    pub front: Vec<Evaluated>,
    /// How sharp the best is.
    pub sharpness: Vec<Sharpness>,
    /// The least and the largest value of each constant among all sets with a misfit within 0.05 of the best. The activity is in
    /// units of the gain of the best.
    pub plateau: Vec<(Parameter, [f64; 2])>,
    /// Constants of the best that lie at an end of the range in which they were searched.
    pub at_limit: Vec<NumberAtLimit>,
    /// Sets of constants tried.
    pub tried: usize,
}

/// The objective of the fit, and all sets of constants evaluated so far.
struct Objective<'a> {
    run: FitRun<'a>,
    targets: &'a Targets,
    memo: &'a Memo,
    /// How often a set is asked for, and how often it will be at most.
    asked: AtomicUsize,
    of: usize,
    /// All evaluated places by their bits, so that their order does not depend on threads.
    seen: Mutex<BTreeMap<Vec<u64>, Option<Evaluated>>>,
}

impl Objective<'_> {
    fn check_cancelled(&self) -> Result<(), FitError> {
        check_cancelled(self.run.cancel, self.evaluated().len(), SETS)
    }

    /// The set of constants at a place of the unit cube; `None` where no tree can be grown.
    fn at(&self, place: &[f64]) -> Option<Evaluated> {
        let key: Vec<u64> = place.iter().map(|x| x.to_bits()).collect();
        let asked = self.asked.fetch_add(1, Ordering::Relaxed) + 1;
        if let Some(known) = self.evaluated().get(&key) {
            return known.clone();
        }
        self.check_cancelled().ok()?;
        let found = self.evaluate(&self.targets.cell_at(&self.run.settings.cell, place));
        self.check_cancelled().ok()?;
        let mut seen = self.evaluated();
        seen.insert(key, found.clone());
        if let Some(progress) = self.run.progress {
            let least = seen.values().flatten().map(|e| e.misfit).fold(f64::INFINITY, f64::min);
            progress(FitProgress { done: asked.min(self.of), of: self.of, least: Some(least) });
        }
        found
    }

    fn evaluated(&self) -> std::sync::MutexGuard<'_, BTreeMap<Vec<u64>, Option<Evaluated>>> {
        // The map stays valid if a thread panics: entries are complete before they are inserted.
        self.seen.lock().unwrap_or_else(std::sync::PoisonError::into_inner)
    }

    /// M + λT at a place.
    fn traded(&self, place: &[f64], trade: f64) -> f64 {
        let Some(found) = self.at(place) else { return f64::INFINITY };
        match found.thresholds_rms {
            Some(rms) => found.misfit + trade * rms,
            None if trade == 0.0 || self.targets.thresholds.is_empty() => found.misfit,
            None => f64::INFINITY,
        }
    }

    /// An upper bound of the sets tried: by the swarms, on the line, and along each constant both ways, where few searches take all steps.
    fn most(&self, effort: SearchBudget) -> usize {
        let swarms: usize = (0..self.trades().len()).map(|trade| share_of(effort, trade).evaluations()).sum();
        let doublings = (MOVES[1] / MOVES[0]).log2() as usize + 1;
        swarms + STEPS + 2 * self.targets.unknowns.len() * (doublings + HALVINGS)
    }

    /// The constants with their best value at an end of the range searched.
    fn at_limit(&self, place: &[f64]) -> Vec<NumberAtLimit> {
        let cell = self.targets.cell_at(&self.run.settings.cell, place);
        let of = |(unknown, &share): (&Searched, &f64)| {
            let Searched { parameter, from, to } = *unknown;
            let (name, value) = (parameter.to_string(), parameter.get(&cell));
            Some(NumberAtLimit { name, value, limit: Limit::at(share)?, searched: [from, to] })
        };
        self.targets.unknowns.iter().zip(place).filter_map(of).collect()
    }

    fn trades(&self) -> &[f64] {
        if self.targets.thresholds.is_empty() { &TRADES[..1] } else { &TRADES }
    }

    /// How far the constant at `index` may move one way before the misfit is 0.05 worse than `best`: a place in the unit cube.
    fn reach(&self, place: &[f64], index: usize, way: f64, best: f64) -> f64 {
        let allowed =
            |share: f64| self.at(&moved(place, index, share)).is_some_and(|found| found.misfit <= best + WORSE);
        let (mut inside, mut step) = (place[index], MOVES[0]);
        let outside = loop {
            let next = (place[index] + way * step).clamp(0.0, 1.0);
            if !allowed(next) {
                break next;
            }
            inside = next;
            if next == 0.0 || next == 1.0 || step >= MOVES[1] {
                return inside;
            }
            step *= 2.0;
        };
        let mut ends = [inside, outside];
        for _ in 0..HALVINGS {
            let middle = 0.5 * (ends[0] + ends[1]);
            ends[usize::from(!allowed(middle))] = middle;
        }
        ends[0]
    }

    fn sharpness(&self, place: &[f64], best: &Evaluated) -> Vec<Sharpness> {
        let of = |index: usize| {
            let unknown = &self.targets.unknowns[index];
            let ends = [-1.0, 1.0].map(|way| self.reach(place, index, way, best.misfit));
            let value = |share: f64| {
                let cell = self.targets.cell_at(&self.run.settings.cell, &moved(place, index, share));
                at_gain_of(best, unknown.parameter, &cell)
            };
            let ([from, to], reaches_limit) = (ends.map(value), ends[0] <= 0.0 || ends[1] >= 1.0);
            Sharpness { parameter: unknown.parameter, from, to, reaches_limit }
        };
        scheduler::in_parallel(self.targets.unknowns.len(), of)
    }
}

/// The lineage with limits of growth that suffice to recognise bad constants.
fn bounded(lineage: &Lineage) -> Lineage {
    let mut out = lineage.clone();
    let observed = || lineage.founders.iter().filter_map(|founder| founder.observed);
    let (rounds, cells) = (observed().filter_map(|o| o.max).max(), observed().filter_map(|o| o.terminal).max());
    if let (Some(rounds), Some(cells)) = (rounds, cells) {
        out.limits.max_depth = out.limits.max_depth.min(rounds + BEYOND[0]);
        out.limits.max_cells = out.limits.max_cells.min((cells * BEYOND[1]) as usize);
    }
    out
}

/// Finds one set of constants for a lineage, starting from `settings`, in parallel over sets; the gain and the activity of
/// `settings` set the unit of the activity searched for.
///
/// # Errors
/// [`FitError`].
pub fn fit_constants(
    run: &FitRun<'_>,
    targets: &Targets,
    memo: &Memo,
    effort: SearchBudget,
) -> Result<FittedConstants, FitError> {
    let (lineage, settings) = (&bounded(run.lineage), run.settings);
    let (asked, seen) = (AtomicUsize::new(0), Mutex::default());
    let mut objective = Objective { run: FitRun { lineage, ..*run }, targets, memo, asked, of: 0, seen };
    objective.of = objective.most(effort);
    let objective = objective;
    scheduler::pool(run.threads)?.install(|| {
        let start = targets.place_of(&settings.cell);
        let first = objective.evaluate(&settings.cell);
        let mut best: Option<(Vec<f64>, f64)> = None;
        for (k, &trade) in objective.trades().iter().enumerate() {
            let all = || vec![[0.0, 1.0]; start.len()];
            let region = best.as_ref().map_or_else(all, |(place, _)| between(&start, place));
            let effort = share_of(effort, k);
            let found = swarm(&region, effort, &|place| objective.traded(place, trade));
            objective.check_cancelled()?;
            if k == 0 {
                best = found;
            }
        }
        let found = first.and_then(|first| complete(&objective, first, &start));
        objective.check_cancelled()?;
        let advice = "widen the limits, or start from other constants";
        found.ok_or_else(|| FitError::Nothing { tried: objective.evaluated().len(), what: SETS, advice })
    })
}

/// The candidates' name in errors.
const SETS: &str = "sets of constants";

/// The effort that the swarm of a trade is given.
fn share_of(effort: SearchBudget, trade: usize) -> SearchBudget {
    let moves = if trade == 0 { effort.moves } else { (effort.moves / SHARE).max(1) };
    SearchBudget { moves, seed: effort.seed.wrapping_add(trade as u64), ..effort }
}

/// The least of all, how sharp it is, and the front.
fn complete(objective: &Objective<'_>, start: Evaluated, from: &[f64]) -> Option<FittedConstants> {
    let (place, _) = least(objective)?;
    let line = |step: usize| {
        let share = step as f64 / STEPS as f64;
        from.iter().zip(&place).map(|(a, b)| (a + share * (b - a)).clamp(0.0, 1.0)).collect::<Vec<_>>()
    };
    scheduler::in_parallel(STEPS - 1, |k| objective.at(&line(k + 1)));
    // The search along each constant may find a better one, and is then repeated from there.
    let mut found = least(objective)?;
    let mut sharpness = objective.sharpness(&found.0, &found.1);
    for _ in 0..2 {
        let better = least(objective)?;
        if better.1.misfit >= found.1.misfit {
            break;
        }
        found = better;
        sharpness = objective.sharpness(&found.0, &found.1);
    }
    let (place, best) = least(objective)?;
    let at_limit = objective.at_limit(&place);
    let seen = objective.evaluated();
    let near = || seen.values().flatten().filter(|e| e.misfit <= best.misfit + WORSE);
    let range = |unknown: &Searched| {
        let fold = near()
            .map(|e| at_gain_of(&best, unknown.parameter, &e.cell))
            .fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], v| [a.min(v), b.max(v)]);
        (unknown.parameter, fold)
    };
    let plateau = objective.targets.unknowns.iter().map(range).collect();
    let front = front(seen.values().flatten().chain([&start]));
    Some(FittedConstants { best, front, sharpness, plateau, at_limit, tried: seen.len() + 1, start })
}

/// A constant of a cell; its activity at the gain of the best, since shapes depend on the product alone.
fn at_gain_of(best: &Evaluated, parameter: Parameter, cell: &Cell) -> f64 {
    match parameter {
        Parameter::XiS => cell.xi_s * cell.material.gain / best.cell.material.gain,
        _ => parameter.get(cell),
    }
}

/// The place of the least misfit so far; of equal ones that with the better thresholds.
fn least(objective: &Objective<'_>) -> Option<(Vec<f64>, Evaluated)> {
    let seen = objective.evaluated();
    let all = seen.iter().filter_map(|(key, found)| Some((key, found.as_ref()?)));
    let (key, found) = all.min_by(|a, b| by_misfit(a.1, b.1))?;
    Some((key.iter().map(|bits| f64::from_bits(*bits)).collect(), found.clone()))
}

/// The box between two places, a little widened, inside the unit cube.
fn between(a: &[f64], b: &[f64]) -> Region {
    let side = |(a, b): (&f64, &f64)| {
        let margin = 0.02 + 0.1 * (a - b).abs();
        let [low, high] = [a.min(*b) - margin, a.max(*b) + margin].map(|x| x.clamp(0.0, 1.0));
        if high > low { [low, high] } else { [(low - margin).max(0.0), (high + margin).min(1.0)] }
    };
    a.iter().zip(b).map(side).collect()
}

/// The Pareto front of misfit and thresholds, by rising misfit.
fn front<'a>(all: impl Iterator<Item = &'a Evaluated>) -> Vec<Evaluated> {
    let mut sets: Vec<&Evaluated> = all.filter(|e| e.thresholds_rms.is_some()).collect();
    sets.sort_by(|a, b| by_misfit(a, b));
    let mut out: Vec<Evaluated> = Vec::new();
    for set in sets {
        if out.last().is_none_or(|last| set.rms() < last.rms()) {
            out.push(set.clone());
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use furrow_lineage::TreeSettings;
    use furrow_lineage::batch::Quantisation;

    #[test]
    fn a_constant_at_the_edge_of_its_range_is_named() {
        let (lineage, targets) = (&Lineage::c_elegans().unwrap(), &Targets::embryo().unwrap());
        let (settings, memo, cancel) = (TreeSettings::default(), &Memo::new(Quantisation::DEFAULT), false.into());
        let run = FitRun::new(lineage, &settings, 1, &cancel);
        let objective = Objective { run, targets, memo, asked: AtomicUsize::new(0), of: 0, seen: Mutex::default() };
        let mut place = vec![0.5; targets.unknowns.len()];
        assert_eq!(objective.at_limit(&place), []);
        place[0] = 1.0;
        let Searched { parameter, from, to } = targets.unknowns[0];
        let (name, searched, limit) = (parameter.to_string(), [from, to], Limit::Upper);
        let found = objective.at_limit(&place);
        assert!((found[0].value / to - 1.0).abs() < 1e-12, "{found:?}");
        assert_eq!(found, [NumberAtLimit { name, value: found[0].value, limit, searched }]);
    }
}
