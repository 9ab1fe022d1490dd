//! Growing trees: cells below the critical radius of their cue do not divide; other divisions are computed.

use super::ranges::{LineageRanges, TreeCounts, summed_up};
use super::scenarios::{Scenario, growers};
use furrow_cell::settings::Settings;
use furrow_cell::{Cell, Cue};
use furrow_lineage::batch::{Memo, Quantisation, SchedulerOptions, Summary, critical_radii, solve};
use furrow_lineage::{
    EndRule, GrowError, Lineage, Scope, Thresholds, Tree, TreeSettings, expected_work, grow_replicates, grow_together,
};
use furrow_mechanics::division::DivisionInput;
use furrow_mechanics::equilibria::ShapeError;
use std::sync::atomic::AtomicBool;

/// The parameters of a tree's divisions. The first cell has the radius that its lineage gives, if it gives one.
pub fn tree_settings(given: Settings, lineage: &Lineage, seed: u64, quantisation: Quantisation) -> TreeSettings {
    let r0 = lineage.given_r0(lineage.first()).unwrap_or(given.cell.r0);
    let (cell, numerics) = (Cell { r0, ..given.cell }, given.numerics);
    TreeSettings { cell, numerics, seed, r0_step: quantisation.relative_step() }
}

/// A lineage as a scenario without a name.
pub fn scenario_of(lineage: Lineage, settings: TreeSettings) -> Scenario {
    let [name, folder, label] = Default::default();
    Scenario { name, folder, label, cue: None, lineage, settings }
}

/// Lineages to be grown with the same parameters, as scenarios without names.
pub fn scenarios_of(lineages: Vec<Lineage>, given: &Settings, quantisation: Quantisation) -> Vec<Scenario> {
    let settings: Vec<_> =
        lineages.iter().map(|lineage| tree_settings(given.clone(), lineage, 0, quantisation)).collect();
    lineages.into_iter().zip(settings).map(|(lineage, settings)| scenario_of(lineage, settings)).collect()
}

/// Trees that were grown in one run.
#[derive(Debug, Default)]
pub struct Grown {
    /// One for each scenario, in their order.
    pub trees: Vec<Tree>,
    /// Counts of what was solved.
    pub summary: Summary,
    /// Cues without a known critical radius, and the reason. The divisions of their cells decided instead.
    pub unknown: Vec<(Cue, ShapeError)>,
}

/// Grows all scenarios in one run. They share solved divisions and the workers.
///
/// With `dynamics` every cell's division is computed, also below the critical radius of its cue. `cancel` ends searches for critical
/// radii as well as divisions; it replaces the flag of `options`.
///
/// # Errors
/// As [`Grower::grow`](furrow_lineage::Grower::grow).
pub fn grown(
    scenarios: &[Scenario],
    dynamics: bool,
    memo: &Memo,
    options: SchedulerOptions<'_>,
    cancel: &AtomicBool,
) -> Result<Grown, GrowError> {
    growing(scenarios, dynamics, memo, options, cancel, |ends, options| {
        let (trees, summary) = grow_together(&growers(scenarios, ends, memo, options), solve)?;
        Ok(Grown { trees, summary, unknown: vec![] })
    })
}

/// Replicates that are grown at once: with all the others in the same queue, and all in memory.
const AT_ONCE: u32 = 32;

/// Grows every scenario with `count` seeds, its own and those that follow, as [`grow_replicates`] does: the trees of the first
/// seed, and for each scenario the ranges over all seeds.
///
/// # Errors
/// As [`grown`].
pub fn grown_replicates(
    scenarios: &[Scenario],
    count: u32,
    dynamics: bool,
    memo: &Memo,
    options: SchedulerOptions<'_>,
    cancel: &AtomicBool,
) -> Result<(Grown, Vec<LineageRanges>), GrowError> {
    let mut counts: Vec<Vec<TreeCounts>> = scenarios.iter().map(|_| Vec::new()).collect();
    let grown = growing(scenarios, dynamics, memo, options, cancel, |ends, options| {
        let mut grown = Grown::default();
        for from in (0..count).step_by(AT_ONCE as usize) {
            let replicate = |k: u32, scenario: &Scenario| {
                let seed = scenario.settings.seed.wrapping_add(u64::from(k));
                Scenario { settings: TreeSettings { seed, ..scenario.settings.clone() }, ..scenario.clone() }
            };
            let seeds = from..(from + AT_ONCE).min(count);
            let all: Vec<Scenario> =
                seeds.flat_map(|k| scenarios.iter().map(move |scenario| replicate(k, scenario))).collect();
            let first_seed = scenarios.first().map_or(0, |scenario| scenario.settings.seed);
            let (trees, summary) = grow_replicates(&growers(&all, ends, memo, options), first_seed, solve)?;
            for (k, tree) in trees.iter().enumerate() {
                counts[k % scenarios.len()].push(TreeCounts::of(tree, 1.0));
            }
            grown.summary.add(summary);
            if from == 0 {
                grown.trees = trees.into_iter().take(scenarios.len()).collect();
            }
        }
        Ok(grown)
    })?;
    let Summary { solved: divisions_solved, memo_hits, .. } = grown.summary;
    let ranges = |(scenario, counts): (&Scenario, &Vec<TreeCounts>)| LineageRanges {
        divisions_solved,
        memo_hits,
        ..summed_up(&scenario.lineage, &[], counts)
    };
    let ranges = scenarios.iter().zip(&counts).map(ranges).collect();
    Ok((grown, ranges))
}

/// Runs `grow` with what ends branches and with the order of the work.
fn growing(
    scenarios: &[Scenario],
    dynamics: bool,
    memo: &Memo,
    options: SchedulerOptions<'_>,
    cancel: &AtomicBool,
    grow: impl FnOnce(EndRule<'_>, SchedulerOptions<'_>) -> Result<Grown, GrowError>,
) -> Result<Grown, GrowError> {
    // Scenarios have the same numerics, and what all cells share is the same.
    let Some(Scenario { settings, .. }) = scenarios.first() else { return Ok(Grown::default()) };
    let radii = critical_radii(&settings.numerics, memo.store()).interrupted_by(cancel);
    let rule = Thresholds::new(radii).with_scope(Scope::FirstIfKnown);
    let plain = settings.cell.clone().with_cue(Cue::none());
    // Ordering the work is no reason to search for a radius; growth searches for it when it reaches such cells.
    let order = |input: &DivisionInput| {
        rule.critical_radius(&plain).map_or(input.cell.r0, |critical| expected_work(critical)(input))
    };
    let mut options = SchedulerOptions { interrupt: Some(cancel), ..options };
    if !dynamics {
        options.expected_work = &order;
    }
    let ends = if dynamics { EndRule::Dynamics } else { EndRule::Thresholds(&rule) };
    let grown = grow(ends, options)?;
    Ok(Grown { unknown: rule.unknown(), ..grown })
}
