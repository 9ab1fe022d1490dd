//! Ranges of a lineage's counts over many trees: one for each set of constants, or one for each seed of the noise.

use super::constants::{Constant, Constants};
use furrow_lineage::batch::{Memo, Quantisation, SchedulerOptions, Summary, critical_radii, scheduler, solve};
use furrow_lineage::{
    EndRule, GrowError, Grower, Lineage, ObservedRounds, Rounds, Thresholds, Tree, TreeSettings, founder_rounds,
};
use ordered_float::OrderedFloat;
use serde::Serialize;
use std::sync::atomic::{AtomicBool, Ordering};

/// A reading of "rounds".
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Reading {
    /// Fewest rounds to a terminal cell.
    Min,
    /// Mean over terminal cells.
    Mean,
    /// Most rounds.
    Max,
}

impl Reading {
    /// All of them, with the names that users write.
    pub const NAMED: [(&str, Reading); 3] = [("min", Reading::Min), ("mean", Reading::Mean), ("max", Reading::Max)];

    /// The model's.
    pub fn of(self, rounds: &Rounds) -> f64 {
        match self {
            Reading::Min => f64::from(rounds.min),
            Reading::Mean => rounds.mean,
            Reading::Max => f64::from(rounds.max),
        }
    }

    /// The observed.
    pub fn observed(self, rounds: &ObservedRounds) -> Option<f64> {
        match self {
            Reading::Min => rounds.min.map(f64::from),
            Reading::Mean => rounds.mean,
            Reading::Max => rounds.max.map(f64::from),
        }
    }
}

/// Weighted quantiles of a number over trees.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Range {
    /// 5 % of the weight lies below.
    pub p5: f64,
    /// The median.
    pub p50: f64,
    /// 5 % of the weight lies above.
    pub p95: f64,
}

impl Range {
    /// Whether the two ranges have no number in common: a difference beyond the spread.
    pub fn is_apart_from(&self, other: &Range) -> bool {
        self.p95 < other.p5 || other.p95 < self.p5
    }

    /// Of numbers with their weights; `None` if there are no numbers. Where a share of the weight ends exactly between two numbers,
    /// the quantile is their mean.
    ///
    /// ```
    /// use furrow_analysis::ranges::Range;
    /// let median = |numbers: &[f64]| Some(Range::of(numbers.iter().map(|number| (*number, 1.0)).collect())?.p50);
    /// assert_eq!((median(&[4.0, 1.0]), median(&[4.0, 1.0, 2.0])), (Some(2.5), Some(2.0)));
    /// ```
    pub fn of(mut numbers: Vec<(f64, f64)>) -> Option<Range> {
        numbers.retain(|(_, weight)| *weight > 0.0);
        numbers.sort_by_cached_key(|item| OrderedFloat(item.0));
        let total: f64 = numbers.iter().map(|(_, weight)| weight).sum();
        let at = |share: f64| {
            let (mut below, end, rounding) = (0.0, share * total, 1e-12 * total);
            let found = numbers.iter().position(|(_, weight)| {
                below += weight;
                below >= end - rounding
            });
            let number = |k: usize| numbers.get(k).or(numbers.last()).map(|(number, _)| *number);
            let first = found.unwrap_or(numbers.len());
            let next = if below <= end + rounding { first + 1 } else { first };
            Some(0.5 * (number(first)? + number(next)?))
        };
        Some(Range { p5: at(0.05)?, p50: at(0.5)?, p95: at(0.95)? })
    }
}

/// A founder over many trees.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct FounderRange {
    /// Name.
    pub name: String,
    /// Rounds: fewest, mean, most, full and symmetric doublings, terminal cells; `None` if it is never born.
    pub rounds: Option<RoundsRange>,
    /// Size asymmetry χ of its division, where it divides.
    pub chi: Option<Range>,
    /// Its terminal cells; `None` if it is never born.
    pub cells: Option<Range>,
    /// Weight of the trees in which it divides.
    pub divides: f64,
    /// Weight of the trees with rounds within one of the observed rounds, by each reading of rounds.
    pub within_one_round: Option<WithinOne>,
    /// The constant on which its terminal cells depend most, by rank correlation; `None` over seeds.
    pub depends_on: Option<Dependence>,
}

/// Shares of weight for which a founder's rounds are within one of the observed; `None` where nothing was observed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct WithinOne {
    /// Fewest rounds.
    pub min: Option<f64>,
    /// Mean rounds.
    pub mean: Option<f64>,
    /// Most rounds.
    pub max: Option<f64>,
}

/// Ranges of [`Rounds`].
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct RoundsRange {
    /// Fewest.
    pub min: Range,
    /// Mean over terminal cells.
    pub mean: Range,
    /// Most.
    pub max: Range,
    /// Generations in which every cell divided.
    pub full_doublings: Range,
    /// Generations in which every cell divided symmetrically.
    pub symmetric: Range,
    /// Terminal cells.
    pub terminal: Range,
}

/// The dependence of a number on a constant.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Dependence {
    /// The constant.
    pub parameter: String,
    /// Spearman's rank correlation, from −1 to 1.
    pub rank_correlation: f64,
}

/// One of the trees, as far as ranges are taken of it.
pub(crate) struct TreeCounts {
    weight: f64,
    cells: usize,
    /// Rounds, χ and whether it divides, by founder.
    founders: Vec<(Option<Rounds>, Option<f64>, bool)>,
}

impl TreeCounts {
    pub(crate) fn of(tree: &Tree, weight: f64) -> TreeCounts {
        let founder = |(founder, rounds): (usize, Option<Rounds>)| {
            let cell = tree.founder_cell(founder);
            let divides = cell.is_some_and(|id| tree.daughters(id).is_some());
            (rounds, cell.and_then(|id| tree.cell(id).fate.chi()), divides)
        };
        let founders = founder_rounds(tree).into_iter().enumerate().map(founder).collect();
        TreeCounts { weight, cells: tree.len(), founders }
    }
}

/// A lineage over many trees.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct LineageRanges {
    /// Founders, in the lineage's order.
    pub founders: Vec<FounderRange>,
    /// Trees.
    pub members: usize,
    /// All cells.
    pub cells: Option<Range>,
    /// How much weight has founder's symmetric doublings of 0, 1, 2, …: by founder.
    pub symmetric_doublings: Vec<(String, Vec<f64>)>,
    /// Weight of the trees that agree with the paper's sentence on rounds, "to within a single round for the EMS and P lineages",
    /// read as most rounds, for EMS and P4; `None` if the lineage lacks either.
    pub paper_sentence: Option<f64>,
    /// Divisions solved.
    pub divisions_solved: usize,
    /// Divisions that were already known, or solved for another tree.
    pub memo_hits: usize,
}

/// Grows the lineage with every set of constants, in parallel over the sets; `cancel` ends it early. `grown` is called after each
/// tree, from any thread.
///
/// # Errors
/// [`GrowError`] of the first set that cannot be tree_counts.
pub fn ranges(
    lineage: &Lineage,
    settings: &TreeSettings,
    sets: &[Constants],
    threads: usize,
    cancel: &AtomicBool,
    grown: &(dyn Fn() + Sync),
) -> Result<LineageRanges, GrowError> {
    let read = |set: &Constants, tree: &Tree, work: &Summary| {
        grown();
        (TreeCounts::of(tree, set.weight), work.solved, work.memo_hits)
    };
    let trees = each_tree(lineage, settings, sets, threads, cancel, read)?;
    let (mut counts, mut divisions_solved, mut memo_hits) = (Vec::with_capacity(trees.len()), 0, 0);
    for (tree, solved, hits) in trees {
        counts.push(tree);
        divisions_solved += solved;
        memo_hits += hits;
    }
    Ok(LineageRanges { divisions_solved, memo_hits, ..summed_up(lineage, sets, &counts) })
}

/// Grows the lineage with every set of constants, in parallel over the sets, and reads each tree with `read`.
///
/// # Errors
/// As [`ranges`].
pub(crate) fn each_tree<T: Send>(
    lineage: &Lineage,
    settings: &TreeSettings,
    sets: &[Constants],
    threads: usize,
    cancel: &AtomicBool,
    read: impl Fn(&Constants, &Tree, &Summary) -> T + Sync,
) -> Result<Vec<T>, GrowError> {
    let grow = |set: &Constants| {
        if cancel.load(Ordering::Relaxed) {
            return Err(GrowError::Interrupted { solved: 0 });
        }
        let (lineage, settings) = set.applied(lineage, settings);
        let quantisation = Quantisation::with_relative_step(settings.r0_step).unwrap_or(Quantisation::DEFAULT);
        let rule = Thresholds::new(critical_radii(&settings.numerics, None));
        let memo = Memo::new(quantisation);
        let (tree, summary) = grow_alone(&lineage, settings, EndRule::Thresholds(&rule), &memo, cancel)?;
        Ok(read(set, &tree, &summary))
    };
    let pool = scheduler::pool(threads).map_err(GrowError::Workers)?;
    pool.install(|| scheduler::in_parallel(sets.len(), |k| grow(&sets[k]))).into_iter().collect()
}

/// Grows one tree on the calling thread's behalf: studies of many trees grow them side by side.
pub(super) fn grow_alone(
    lineage: &Lineage,
    settings: TreeSettings,
    ends: EndRule<'_>,
    memo: &Memo,
    cancel: &AtomicBool,
) -> Result<(Tree, Summary), GrowError> {
    let options = SchedulerOptions { threads: 1, interrupt: Some(cancel), ..SchedulerOptions::default() };
    Grower { lineage, settings, ends, memo, options }.grow(solve)
}

/// The share of the weight of all trees for which a condition holds.
fn share(trees: &[TreeCounts], holds: impl Fn(&TreeCounts) -> bool) -> f64 {
    // A fold from 0: `sum` gives −0 for no numbers, which files would show.
    let total = trees.iter().fold(0.0, |weight, tree| weight + tree.weight);
    trees.iter().filter(|tree| holds(tree)).fold(0.0, |weight, tree| weight + tree.weight) / total
}

fn founder_range(lineage: &Lineage, sets: &[Constants], trees: &[TreeCounts], k: usize) -> FounderRange {
    let range = |of: &dyn Fn(&TreeCounts) -> Option<f64>| -> Option<Range> {
        Range::of(trees.iter().filter_map(|tree| Some((of(tree)?, tree.weight))).collect())
    };
    let rounds = |of: fn(&Rounds) -> f64| range(&|tree| tree.founders[k].0.as_ref().map(of));
    let all = || {
        Some(RoundsRange {
            min: rounds(|r| f64::from(r.min))?,
            mean: rounds(|r| r.mean)?,
            max: rounds(|r| f64::from(r.max))?,
            full_doublings: rounds(|r| f64::from(r.full_doublings))?,
            symmetric: rounds(|r| f64::from(r.symmetric))?,
            terminal: rounds(|r| f64::from(r.terminal))?,
        })
    };
    let terminal = |tree: &TreeCounts| tree.founders[k].0.map_or(0.0, |rounds| f64::from(rounds.terminal));
    let within_one_round = lineage.founders[k].observed.map(|observed| {
        let near = |reading: Reading| {
            let observed = reading.observed(&observed)?;
            Some(share(trees, |tree| tree.founders[k].0.is_some_and(|r| (reading.of(&r) - observed).abs() <= 1.0)))
        };
        WithinOne { min: near(Reading::Min), mean: near(Reading::Mean), max: near(Reading::Max) }
    });
    FounderRange {
        within_one_round,
        name: lineage.founders[k].name.clone(),
        rounds: all(),
        chi: range(&|tree| tree.founders[k].1),
        cells: rounds(|r| f64::from(r.terminal)),
        divides: share(trees, |tree| tree.founders[k].2),
        depends_on: strongest(sets, trees, &trees.iter().map(terminal).collect::<Vec<_>>()),
    }
}

/// The ranges over trees; `sets` are the constants of each, or empty. Without the work they took.
pub(crate) fn summed_up(lineage: &Lineage, sets: &[Constants], trees: &[TreeCounts]) -> LineageRanges {
    let total: f64 = trees.iter().map(|tree| tree.weight).sum();
    let founder = |k: usize| founder_range(lineage, sets, trees, k);
    let symmetric = |k: usize| {
        let mut shares: Vec<f64> = Vec::new();
        for tree in trees {
            let Some(rounds) = &tree.founders[k].0 else { continue };
            let doublings = rounds.symmetric as usize;
            shares.resize(shares.len().max(doublings + 1), 0.0);
            shares[doublings] += tree.weight / total;
        }
        (lineage.founders[k].name.clone(), shares)
    };
    let sentence = || {
        let of = |name: &str| {
            let k = lineage.founder_named(name)?;
            Some((k, lineage.founders[k].observed?.max?))
        };
        let both = [of("EMS")?, of("P4")?];
        let near = |tree: &TreeCounts, (k, most): (usize, u32)| {
            tree.founders[k].0.as_ref().is_some_and(|rounds| rounds.max.abs_diff(most) <= 1)
        };
        Some(share(trees, |tree| both.iter().all(|one| near(tree, *one))))
    };
    let count = lineage.founders.len();
    LineageRanges {
        paper_sentence: sentence(),
        founders: (0..count).map(founder).collect(),
        members: trees.len(),
        cells: Range::of(trees.iter().map(|tree| (tree.cells as f64, tree.weight)).collect()),
        symmetric_doublings: (0..count).map(symmetric).collect(),
        divisions_solved: 0,
        memo_hits: 0,
    }
}

/// The constant that correlates most with the given numbers, one a set, by the weights of the trees; `None` if all numbers are equal.
fn strongest(sets: &[Constants], trees: &[TreeCounts], numbers: &[f64]) -> Option<Dependence> {
    let weights: Vec<f64> = trees.iter().map(|tree| tree.weight).collect();
    let ranked = |values: &[f64]| {
        let varies = values.windows(2).any(|pair| pair[0] != pair[1]);
        varies.then(|| ranks(values, &weights))
    };
    let of_numbers = ranked(numbers)?;
    let by = |(k, constant): (usize, &Constant)| -> Option<Dependence> {
        let values: Vec<f64> = sets.iter().map(|set| set.values[k].value).collect();
        let rank_correlation = weighted_correlation(&ranked(&values)?, &of_numbers, &weights)?;
        Some(Dependence { parameter: constant.name(), rank_correlation })
    };
    let all = sets.first()?.values.iter().enumerate().filter_map(by);
    all.max_by(|a, b| a.rank_correlation.abs().total_cmp(&b.rank_correlation.abs()))
}

/// The ranks of values with weights: the weight of all smaller ones and half of the weight of equal ones.
fn ranks(values: &[f64], weights: &[f64]) -> Vec<f64> {
    let share = |x: f64, y: f64| if y < x { 1.0 } else { 0.5 * f64::from(u8::from(y == x)) };
    let rank = |x: &f64| values.iter().zip(weights).map(|(y, weight)| weight * share(*x, *y)).sum();
    values.iter().map(rank).collect()
}

/// Pearson's correlation; `None` where one of the two does not vary.
pub(crate) fn correlation(a: &[f64], b: &[f64]) -> Option<f64> {
    weighted_correlation(a, b, &vec![1.0; a.len()])
}

/// The same of pairs with weights.
fn weighted_correlation(a: &[f64], b: &[f64], weights: &[f64]) -> Option<f64> {
    let total: f64 = weights.iter().sum();
    let mean = |values: &[f64]| values.iter().zip(weights).map(|(x, w)| w * x).sum::<f64>() / total;
    let (ma, mb) = (mean(a), mean(b));
    let sum = |of: &dyn Fn(f64, f64) -> f64| {
        a.iter().zip(b).zip(weights).map(|((x, y), w)| w * of(x - ma, y - mb)).sum::<f64>()
    };
    let (ab, aa, bb) = (sum(&|x, y| x * y), sum(&|x, _| x * x), sum(&|_, y| y * y));
    (aa > 0.0 && bb > 0.0).then(|| ab / (aa * bb).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_follow_the_weights() {
        let range = Range::of((1..=100).map(|k| (f64::from(k), 1.0)).collect()).unwrap();
        assert_eq!(range, Range { p5: 5.5, p50: 50.5, p95: 95.5 });
        let range = Range::of(vec![(1.0, 0.01), (2.0, 0.98), (3.0, 0.01)]).unwrap();
        assert_eq!(range, Range { p5: 2.0, p50: 2.0, p95: 2.0 });
        assert_eq!(Range::of(vec![]), None);
    }

    #[test]
    fn ranks_of_equal_numbers_are_shared() {
        assert_eq!(ranks(&[3.0, 1.0, 3.0, 2.0], &[1.0; 4]), [3.0, 0.5, 3.0, 1.5]);
        assert_eq!(ranks(&[3.0, 1.0, 2.0], &[0.5, 2.0, 1.0]), [3.25, 1.0, 2.5]);
        let rising: Vec<f64> = (0..9).map(|k| f64::from(k).exp()).collect();
        let straight: Vec<f64> = (0..9).map(f64::from).collect();
        let [a, b] = [&rising, &straight].map(|values| ranks(values, &[1.0; 9]));
        assert!((correlation(&a, &b).unwrap() - 1.0).abs() < 1e-12);
        assert_eq!(correlation(&[1.0, 1.0], &[1.0, 2.0]), None);
        // A set counts as often as its weight says, and not at all with the weight 0.
        let (a, b) = ([1.0, 2.0, 3.0, 0.0], [1.0, 3.0, 2.0, 9.0]);
        let twice = correlation(&[1.0, 2.0, 3.0, 3.0], &[1.0, 3.0, 2.0, 2.0]).unwrap();
        let found = weighted_correlation(&a, &b, &[0.5, 0.5, 1.0, 0.0]).unwrap();
        assert!((found - twice).abs() < 1e-12, "{found} {twice}");
    }
}
