//! Growing trees: cells below the critical radius of their cue do not divide; other divisions are computed.

use super::scenarios::{Scenario, grow};
use furrow_cell::settings::Settings;
use furrow_cell::{Cell, Cue};
use furrow_lineage::batch::{Memo, Quantisation, SchedulerOptions, Summary};
use furrow_lineage::{EndRule, GrowError, Lineage, Scope, Thresholds, Tree, TreeSettings, expected_work};
use furrow_mechanics::division::{DivisionInput, divide};
use furrow_mechanics::equilibria::{CriticalRadii, ShapeError};
use std::sync::atomic::AtomicBool;

/// The parameters of a tree's divisions. The first cell has the radius that its lineage gives, if it gives one.
pub fn tree_settings(given: Settings, lineage: &Lineage, seed: u64, quantisation: Quantisation) -> TreeSettings {
    let r0 = lineage.given_r0(lineage.first()).unwrap_or(given.cell.r0);
    let (cell, numerics) = (Cell { r0, ..given.cell }, given.numerics);
    TreeSettings { cell, numerics, seed, r0_step: quantisation.relative_step() }
}

/// Lineages to be grown with the same parameters, as scenarios without names.
pub fn scenarios_of(lineages: Vec<Lineage>, given: &Settings, quantisation: Quantisation) -> Vec<Scenario> {
    let scenario = |lineage: Lineage| Scenario {
        name: String::new(),
        folder: String::new(),
        label: String::new(),
        cue: None,
        settings: tree_settings(given.clone(), &lineage, 0, quantisation),
        lineage,
    };
    lineages.into_iter().map(scenario).collect()
}

/// Trees that were grown in one run.
#[derive(Debug, Default)]
pub struct Grown {
    /// One for each scenario, in their order.
    pub trees: Vec<Tree>,
    /// Counts of what was solved.
    pub summary: Summary,
    /// Cues without a critical radius, and why none was found; the divisions of their cells decided instead.
    pub unknown: Vec<(Cue, ShapeError)>,
}

/// Grows all scenarios in one run, which shares what is solved and the workers.
///
/// With `dynamics` every cell's division is computed,
/// also below the critical radius of its cue. `cancel` ends searches for critical radii as well as divisions; it replaces the
/// flag of `options`.
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
    // Scenarios have the same numerics, and what all cells share is the same.
    let Some(Scenario { settings, .. }) = scenarios.first() else { return Ok(Grown::default()) };
    let radii = CriticalRadii::new(&settings.numerics).interrupted_by(cancel);
    let rule = Thresholds::new(radii).with_scope(Scope::FirstIfKnown);
    let plain = settings.cell.clone().with_cue(Cue::none());
    // The order of the work is no reason to search for a radius, which growth does when it comes to such cells.
    let order = |input: &DivisionInput| {
        rule.critical_radius(&plain).map_or(input.cell.r0, |critical| expected_work(critical)(input))
    };
    let mut options = SchedulerOptions { interrupt: Some(cancel), ..options };
    if !dynamics {
        options.expected_work = &order;
    }
    let ends = if dynamics { EndRule::Dynamics } else { EndRule::Thresholds(&rule) };
    let (trees, summary) = grow(scenarios, ends, memo, options, divide)?;
    Ok(Grown { trees, summary, unknown: rule.unknown() })
}
