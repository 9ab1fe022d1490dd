//! Fits one set of constants to the embryo.
//!
//! The misfit of a set of constants follows from its tree:
//!
//! * \[F.3 misfit\] M = w_r ⟨|mean rounds − observed|⟩ + w_t ⟨|log₂(terminal cells/observed)|⟩ + w_χ ⟨|χ − measured|⟩ + (1 for each
//!   founder that should divide symmetrically and does not, for each pitchfork of another kind than the given one, and for each
//!   division that ends otherwise than given),
//!
//! averaged over the founders and divisions in the targets. Counts are piecewise constant and have no useful derivative.
//! The second objective is
//!
//! * \[F.4 thresholds\] T = rms of ξ_s*/published − 1, over the published pitchforks.
//!
//! Shapes depend on gain and activity only through gξ_s: the gain makes the mean logarithmic deviation of the thresholds
//! zero, and the activity follows. Swarms minimise M + λT at several λ; the Pareto front comes from all evaluated sets.

use super::error::{FitError, check_cancelled};
use super::search::{FitProgress, FitRun, Limit, NumberAtLimit, Region, SearchBudget, moved, swarm};
use super::targets::{MeasuredChi, Searched, Targets};
use crate::ranges::grow_alone;
use furrow_cell::{Cell, Parameter};
use furrow_lineage::batch::{Memo, scheduler};
use furrow_lineage::{
    EndRule, Founder, FounderRounds, Lineage, Rounds, Thresholds, Tree, TreeSettings, founder_rounds,
};
use furrow_mechanics::calibration::Threshold;
use furrow_mechanics::calibration::statements::GivenCriticality;
use furrow_mechanics::critical::CriticalRadii;
use furrow_mechanics::division::Outcome;
use furrow_mechanics::equilibria::{BranchOptions, Pitchfork, pitchfork};
use rayon::prelude::*;
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

/// A founder of a tree beside its observations.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FounderFit {
    /// Name.
    pub name: String,
    /// Rounds of the model; `None` if it is never born.
    pub rounds: Option<Rounds>,
    /// Observed mean rounds.
    pub observed_mean: Option<f64>,
    /// Observed terminal cells.
    pub observed_terminal: Option<u32>,
    /// χ of its division, where it divides.
    pub chi: Option<f64>,
    /// Whether it divides into equal daughters.
    pub symmetric: bool,
}

/// The parts of a misfit.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Parts {
    /// Mean of |mean rounds − observed|.
    pub rounds: f64,
    /// Mean of |log₂(terminal cells/observed)|.
    pub terminal: f64,
    /// Mean of |χ − measured|.
    pub chi: f64,
    /// Founders that should divide symmetrically and do not.
    pub not_symmetric: usize,
    /// Pitchforks with their asymmetric branch on the side opposite to the given one.
    pub reversed: usize,
    /// Divisions that end otherwise than given.
    pub contradicted: usize,
}

/// A threshold beside the published one.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ThresholdFit {
    /// Cell radius R0.
    pub r0: f64,
    /// Volume fraction ε.
    pub epsilon: f64,
    /// ξ_s* as published.
    pub xi_s: f64,
    /// ξ_s* of these constants.
    pub computed: f64,
}

/// A set of constants with the tree that it grows.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Evaluated {
    /// Constants searched for, and the gain.
    pub constants: Vec<(Parameter, f64)>,
    /// Misfit of the counts, M.
    pub misfit: f64,
    /// Its parts.
    pub parts: Parts,
    /// T: rms relative deviation of the thresholds; `None` if one was not found.
    pub thresholds_rms: Option<f64>,
    /// Thresholds; `None` if one was not found.
    pub thresholds: Vec<ThresholdFit>,
    /// Founders, in the lineage's order.
    pub founders: Vec<FounderFit>,
    /// The first cell with these constants.
    #[serde(skip)]
    pub cell: Cell,
}

impl Evaluated {
    fn rms(&self) -> f64 {
        self.thresholds_rms.unwrap_or(f64::INFINITY)
    }
}

fn by_misfit(a: &Evaluated, b: &Evaluated) -> std::cmp::Ordering {
    a.misfit.total_cmp(&b.misfit).then(a.rms().total_cmp(&b.rms()))
}

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

    fn evaluate(&self, cell: &Cell) -> Option<Evaluated> {
        let settings = TreeSettings { cell: cell.clone(), ..self.run.settings.clone() };
        let ends = Thresholds::new(CriticalRadii::new(&settings.numerics));
        let (tree, _) =
            grow_alone(self.run.lineage, settings, EndRule::Thresholds(&ends), self.memo, self.run.cancel).ok()?;
        let founders = self.founders(&tree);
        let (cell, thresholds, reversed) = self.thresholds(cell);
        let contradicted =
            self.targets.contradicted(&cell, self.run.settings.numerics, self.memo, self.run.cancel).ok()?;
        let parts = Parts { reversed, contradicted, ..self.parts(&founders) };
        let weights = self.targets.weights;
        let misfit = weights.rounds * parts.rounds
            + weights.terminal * parts.terminal
            + weights.chi * parts.chi
            + (parts.not_symmetric + parts.reversed + parts.contradicted) as f64;
        let thresholds_rms = (!thresholds.is_empty()).then(|| {
            let sum: f64 = thresholds.iter().map(|t| (t.computed / t.xi_s - 1.0).powi(2)).sum();
            (sum / thresholds.len() as f64).sqrt()
        });
        let searched = self.targets.unknowns.iter().map(|u| u.parameter);
        let constants = searched.chain([Parameter::Gain]).map(|p| (p, p.get(&cell))).collect();
        Some(Evaluated { constants, misfit, parts, thresholds_rms, thresholds, founders, cell })
    }

    fn founders(&self, tree: &Tree) -> Vec<FounderFit> {
        let row = |FounderRounds { founder, rounds }: FounderRounds| {
            let Founder { name, observed, .. } = &self.run.lineage.founders[founder];
            let fate = tree.founder_cell(founder).map(|id| &tree.cell(id).fate);
            FounderFit {
                name: name.clone(),
                rounds,
                observed_mean: observed.and_then(|o| o.mean),
                observed_terminal: observed.and_then(|o| o.terminal),
                chi: fate.and_then(|fate| fate.chi()),
                symmetric: fate.is_some_and(|fate| fate.outcome() == Some(Outcome::Symmetric)),
            }
        };
        founder_rounds(tree).into_iter().map(row).collect()
    }

    fn parts(&self, founders: &[FounderFit]) -> Parts {
        let named = |name: &String| founders.iter().find(|founder| founder.name == *name);
        // The sum of no numbers is −0 in floating point.
        let mean = |numbers: Vec<f64>| (0.0 + numbers.iter().sum::<f64>()) / numbers.len().max(1) as f64;
        let counted = || self.targets.founders.iter().filter_map(named);
        // A founder that is never born has no rounds and no cell.
        let rounds = |f: &FounderFit| (f.rounds.map_or(0.0, |r| r.mean) - f.observed_mean.unwrap_or(0.0)).abs();
        let terminal = |f: &FounderFit| {
            let observed = f64::from(f.observed_terminal.unwrap_or(1));
            (f.rounds.map_or(0.5, |r| f64::from(r.terminal)) / observed).log2().abs()
        };
        let chi = |measured: &MeasuredChi| {
            // A cell that does not divide, or equally, is off by all of it.
            (named(&measured.cell).and_then(|f| f.chi).unwrap_or(0.0) - measured.mean).abs()
        };
        Parts {
            rounds: mean(counted().map(rounds).collect()),
            terminal: mean(counted().map(terminal).collect()),
            chi: mean(self.targets.chi.iter().map(chi).collect()),
            reversed: 0,
            contradicted: 0,
            not_symmetric: self.targets.symmetric.iter().filter_map(named).filter(|f| !f.symmetric).count(),
        }
    }

    /// The published thresholds with these constants, and the cell with the gain that suits them best; no thresholds if one is not
    /// found. The last is the number of pitchforks of another kind than the given one; it does not depend on the gain.
    fn thresholds(&self, cell: &Cell) -> (Cell, Vec<ThresholdFit>, usize) {
        let Targets { thresholds: given, criticalities, .. } = self.targets;
        let threshold = |given: &Threshold| {
            pitchfork::first(&given.cell(cell), &self.run.settings.numerics, &BranchOptions::default())
        };
        let found: Vec<Pitchfork> = match given.iter().map(threshold).collect() {
            Ok(found) if !given.is_empty() => found,
            _ => return (cell.clone(), vec![], criticalities.len()),
        };
        let is_reversed = |kind: &&GivenCriticality| {
            let mut of_cell = given.iter().zip(&found).filter(|(t, _)| [t.r0, t.epsilon] == [kind.r0, kind.epsilon]);
            of_cell.any(|(_, found)| found.criticality() != kind.kind)
        };
        let reversed = criticalities.iter().filter(is_reversed).count();
        let computed: Vec<f64> = found.iter().map(|found| found.point.xi_s).collect();
        let logs: f64 = computed.iter().zip(given).map(|(found, given)| (found / given.xi_s).ln()).sum();
        let factor = (logs / computed.len() as f64).exp();
        let mut cell = cell.clone();
        cell.material.gain *= factor;
        cell.xi_s /= factor;
        let fit = |(found, &Threshold { r0, epsilon, xi_s, .. }): (f64, &Threshold)| ThresholdFit {
            r0,
            epsilon,
            xi_s,
            computed: found / factor,
        };
        (cell, computed.into_iter().zip(given).map(fit).collect(), reversed)
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
        let of = |(index, unknown): (usize, &Searched)| {
            let ends = [-1.0, 1.0].map(|way| self.reach(place, index, way, best.misfit));
            let value = |share: f64| {
                let cell = self.targets.cell_at(&self.run.settings.cell, &moved(place, index, share));
                at_gain_of(best, unknown.parameter, &cell)
            };
            let ([from, to], reaches_limit) = (ends.map(value), ends[0] <= 0.0 || ends[1] >= 1.0);
            Sharpness { parameter: unknown.parameter, from, to, reaches_limit }
        };
        self.targets.unknowns.par_iter().enumerate().map(of).collect()
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
    (1..STEPS).into_par_iter().for_each(|step| {
        objective.at(&line(step));
    });
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
