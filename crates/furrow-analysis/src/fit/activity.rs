//! The activity that each founder alone would need for its observed rounds.
//!
//! The paper leaves open what stops lineages that mechanics would divide further. If it were activity alone, a founder and
//! its descendants would share the ξ_s at which the model's rounds equal the observed ones. A founder keeps the size it has
//! with the run's constants, and all other cells keep their activity. All other parameters of a founder come from the
//! lineage file.

use super::error::{FitError, check_cancelled};
use super::search::{FitProgress, FitRun, Limit, NumberAtLimit};
use crate::ranges::{Reading, grow_alone};
use furrow_lineage::batch::{Memo, scheduler};
use furrow_lineage::{EndRule, GrowError, Rounds, Scope, Thresholds, founder_rounds};
use furrow_mechanics::critical::CriticalRadii;
use ordered_float::OrderedFloat;
use serde::Serialize;
use std::sync::atomic::{AtomicUsize, Ordering};

/// The activity that a founder would need.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FounderActivity {
    /// Name.
    pub name: String,
    /// Observed rounds, by the reading asked for.
    pub observed: f64,
    /// Its activity in the run: the lineage file's, or else the activity of all cells.
    pub run_xi_s: f64,
    /// Rounds in the run, as `furrow tree` counts them; `None` if it is never born.
    pub rounds: Option<f64>,
    /// The widest interval of ξ_s in which rounds are within half a round of the observed; `None` if no interval exists.
    pub xi_s: Option<[f64; 2]>,
    /// All such intervals.
    pub intervals: Vec<[f64; 2]>,
    /// The activity tried that comes nearest, and its rounds.
    pub nearest: Option<(f64, f64)>,
    /// Between which ξ_s was searched.
    pub searched: [f64; 2],
    /// Ends of the range asked for that `xi_s` reaches: beyond them rounds may be the observed ones as well.
    pub at_limit: Vec<Limit>,
}

/// Largest deviation at which rounds count as the observed ones.
pub(crate) const WITHIN: f64 = 0.5;
/// Rounds beyond the most observed after which growth stops, for extremes and for means. Fewest and most rounds are too
/// many then; cutting a few long branches changes a mean little.
const DEEPER: [u32; 2] = [2, 8];
/// Activities tried, evenly in their logarithm, beside the founder's own: rounds may fall with activity, so that all are tried.
const TRIED: usize = 20;
/// Halvings at each end of an interval, to half a percent. The nearer to an edge, the longer cells there wait at their threshold.
const HALVINGS: usize = 5;

/// Most trees grown for a founder, for the progress: at the activities tried and, as a rule, for two ends.
const MOST: usize = TRIED + 2 * HALVINGS;

/// One founder's rounds over its activity.
struct Search<'a> {
    run: &'a FitRun<'a>,
    memo: &'a Memo,
    reading: Reading,
    founder: usize,
    /// The critical radii that are stored.
    ends: Thresholds<'a>,
    /// Trees grown for all founders.
    trees: &'a AtomicUsize,
    /// Its rounds in the run.
    own: Option<f64>,
    /// Called with each tree that is grown.
    grown: &'a (dyn Fn() + Sync),
}

impl Search<'_> {
    /// Whether founder `k` is this one or descends from it.
    fn is_below(&self, k: usize) -> bool {
        k == self.founder || self.run.lineage.mother(k).is_some_and(|mother| self.is_below(mother))
    }

    /// Rounds at an activity; `None` if the founder is never born, or the tree could not be grown.
    fn rounds(&self, xi_s: f64) -> Result<Option<f64>, GrowError> {
        self.trees.fetch_add(1, Ordering::Relaxed);
        (self.grown)();
        let mut lineage = self.run.lineage.clone();
        for k in 0..lineage.founders.len() {
            if self.is_below(k) {
                lineage.founders[k].physics.xi_s = Some(xi_s);
            }
        }
        if let Some(most) = self.run.lineage.founders[self.founder].observed.and_then(|o| o.max) {
            let deeper = DEEPER[usize::from(self.reading == Reading::Mean)];
            let depth = self.run.lineage.generation(self.founder) + most + deeper;
            lineage.limits.max_depth = lineage.limits.max_depth.min(depth);
        }
        let (tree, _) = grow_alone(
            &lineage,
            self.run.settings.clone(),
            EndRule::Thresholds(&self.ends),
            self.memo,
            self.run.cancel,
        )?;
        Ok(founder_rounds(&tree)[self.founder].map(|rounds| self.reading.of(&rounds)))
    }

    fn run(&self, observed: f64, range: [f64; 2]) -> Result<FounderActivity, GrowError> {
        let meets = |rounds: Option<f64>| rounds.is_some_and(|r| (r - observed).abs() <= WITHIN);
        let xi_at = |k: usize| range[0] * (range[1] / range[0]).powf(k as f64 / (TRIED - 1) as f64);
        let founder = &self.run.lineage.founders[self.founder];
        let run_xi_s = founder.physics.xi_s.unwrap_or(self.run.settings.cell.xi_s);
        let own = Some(run_xi_s).filter(|xi_s| (range[0]..range[1]).contains(xi_s));
        let mut activities: Vec<f64> = (0..TRIED).map(xi_at).chain(own).collect();
        activities.sort_by_key(|xi_s| OrderedFloat(*xi_s));
        activities.dedup();
        let tried: Result<Vec<(f64, Option<f64>)>, GrowError> =
            activities.into_iter().map(|xi_s| Ok((xi_s, self.rounds(xi_s)?))).collect();
        let tried = tried?;
        // Where rounds begin and cease to be the observed ones, between neighbours.
        let edge = |inside: f64, outside: f64| -> Result<f64, GrowError> {
            let mut last = inside;
            self.bisect([inside, outside], |xi_s, rounds| {
                let met = meets(rounds);
                last = if met { xi_s } else { last };
                Some(met)
            })?;
            Ok(last)
        };
        // Rounds are steps: an interval may lie between two neighbours, one with too few rounds and one with too many.
        let mut points = tried.clone();
        for pair in tried.windows(2) {
            let [(below, few), (above, many)] = [pair[0], pair[1]];
            let [few, many] = [few, many].map(|r| r.unwrap_or(0.0) - observed);
            if few * many < 0.0 && few.abs() > WITHIN && many.abs() > WITHIN {
                self.bisect([below, above], |xi_s, rounds| {
                    points.push((xi_s, rounds));
                    let off = rounds.unwrap_or(0.0) - observed;
                    (off.abs() > WITHIN).then_some((off < 0.0) == (few < 0.0))
                })?;
            }
        }
        points.sort_by_cached_key(|item| OrderedFloat(item.0));
        let mut intervals: Vec<[f64; 2]> = Vec::new();
        let mut open: Option<f64> = None;
        for (k, &(xi_s, rounds)) in points.iter().enumerate() {
            match (meets(rounds), open) {
                (true, None) => open = Some(if k == 0 { xi_s } else { edge(xi_s, points[k - 1].0)? }),
                (false, Some(from)) => {
                    intervals.push([from, edge(points[k - 1].0, xi_s)?]);
                    open = None;
                }
                _ => {}
            }
        }
        intervals.extend(open.map(|from| [from, range[1]]));
        let width = |[from, to]: &[f64; 2]| to / from;
        let xi_s = intervals.iter().copied().max_by(|a, b| width(a).total_cmp(&width(b)));
        let reached = |[from, to]: [f64; 2]| {
            let ends = [(Limit::Lower, from <= range[0]), (Limit::Upper, to >= xi_at(TRIED - 1))];
            ends.into_iter().filter(|(_, reached)| *reached).map(|(limit, _)| limit).collect()
        };
        let nearest = points.iter().filter_map(|&(xi_s, rounds)| Some((xi_s, rounds?)));
        Ok(FounderActivity {
            name: founder.name.clone(),
            observed,
            run_xi_s,
            rounds: self.own,
            at_limit: xi_s.map_or(Vec::new(), reached),
            xi_s,
            intervals,
            nearest: nearest.min_by(|a, b| (a.1 - observed).abs().total_cmp(&(b.1 - observed).abs())),
            searched: range,
        })
    }

    /// Halves an interval of activities: `is_first` says whether the middle replaces the first end, or `None` to stop.
    fn bisect(
        &self,
        mut ends: [f64; 2],
        mut is_first: impl FnMut(f64, Option<f64>) -> Option<bool>,
    ) -> Result<(), GrowError> {
        for _ in 0..HALVINGS {
            let middle = (ends[0] * ends[1]).sqrt();
            match is_first(middle, self.rounds(middle)?) {
                Some(first) => ends[usize::from(!first)] = middle,
                None => break,
            }
        }
        Ok(())
    }
}

/// The activities that all founders with observed rounds would need.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FittedActivities {
    /// The compared quantities.
    pub rounds: Reading,
    /// Each founder's.
    pub founders: Vec<FounderActivity>,
    /// The activities at a limit of the search.
    pub at_limit: Vec<NumberAtLimit>,
    /// Trees grown.
    pub trees: usize,
}

/// The activity that every founder with observed rounds would need, searched between two activities; in parallel over founders.
///
/// # Errors
/// [`FitError`].
pub fn activities(
    run: &FitRun<'_>,
    memo: &Memo,
    reading: Reading,
    range: [f64; 2],
) -> Result<FittedActivities, FitError> {
    let FitRun { lineage, settings, threads, cancel, progress } = *run;
    let observed = |founder: usize| lineage.founders[founder].observed.and_then(|o| reading.observed(&o));
    let sought: Vec<(usize, f64)> = (0..lineage.founders.len()).filter_map(|k| Some((k, observed(k)?))).collect();
    // At every activity there is another critical radius, and a search for one takes longer than a tree of divisions.
    let ends = || Thresholds::new(CriticalRadii::new(&settings.numerics)).with_scope(Scope::Known);
    // Trees grown, and trees that count as done: all of a founder's once its search has ended.
    let (trees, done, of) = (&AtomicUsize::new(0), AtomicUsize::new(0), MOST * sought.len());
    let advance = |more: usize| {
        if more == 0 {
            return;
        }
        let done = done.fetch_add(more, Ordering::Relaxed) + more;
        if let Some(show) = progress {
            show(FitProgress { done, of, least: None });
        }
    };
    let one = |&(founder, observed): &(usize, f64), own: &[Option<Rounds>]| -> Result<FounderActivity, GrowError> {
        let own = own[founder].map(|rounds| reading.of(&rounds));
        let mine = AtomicUsize::new(0);
        let grown = || {
            if mine.fetch_add(1, Ordering::Relaxed) < MOST {
                advance(1);
            }
        };
        let search = Search { run, memo, reading, founder, ends: ends(), trees, own, grown: &grown };
        let found = search.run(observed, range);
        advance(MOST.saturating_sub(mine.load(Ordering::Relaxed)));
        found
    };
    let found: Result<Vec<FounderActivity>, GrowError> = scheduler::pool(threads)?.install(|| {
        // The tree of the run, with every founder's own parameters and without the limits of the search.
        trees.fetch_add(1, Ordering::Relaxed);
        let (tree, _) = grow_alone(lineage, settings.clone(), EndRule::Thresholds(&ends()), memo, cancel)?;
        let own = founder_rounds(&tree);
        scheduler::in_parallel(sought.len(), |k| one(&sought[k], &own)).into_iter().collect()
    });
    let trees = trees.load(Ordering::Relaxed);
    check_cancelled(cancel, trees, "trees")?;
    let founders = found?;
    Ok(FittedActivities { rounds: reading, at_limit: founders.iter().flat_map(at_limit).collect(), founders, trees })
}

/// The ends of the widest interval that are limits of the search.
fn at_limit(founder: &FounderActivity) -> impl Iterator<Item = NumberAtLimit> {
    founder.at_limit.iter().filter_map(|&limit| {
        let (name, searched) = (format!("xi_s of {}", founder.name), founder.searched);
        Some(NumberAtLimit { name, value: limit.of(founder.xi_s?), limit, searched })
    })
}
