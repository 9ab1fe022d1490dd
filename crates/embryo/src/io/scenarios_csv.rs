//! `scenarios.csv`: founders of several scenarios, one row for each scenario and founder.

use super::tree_json::founder_rows;
use crate::lineage::Tree;
use crate::study::scenarios::Scenario;
use crate::study::table::csv_of;

/// The columns, in their order. Counts are as in the founders' table; what is not known, of a founder that was not born or not
/// observed, is empty.
pub const COLUMNS: [&str; 17] = [
    "scenario",
    "lineage",
    "cue",
    "founder",
    "r0",
    "outcome",
    "chi",
    "min",
    "mean",
    "max",
    "full_doublings",
    "terminal",
    "observed_min",
    "observed_mean",
    "observed_max",
    "observed_full_doublings",
    "observed_terminal",
];

/// The table of scenarios and their trees. `cue` is the one that a founder carries, in full.
pub fn scenarios_csv(scenarios: &[Scenario], trees: &[Tree]) -> String {
    let mut rows = vec![COLUMNS.map(str::to_owned)];
    for (scenario, tree) in scenarios.iter().zip(trees) {
        for (founder, row) in founder_rows(tree).iter().enumerate() {
            let (rounds, observed) = (row.rounds, row.observed);
            let cue = tree.founder_cell(founder).map(|id| tree.cell(id).cue.to_string());
            rows.push([
                scenario.name.clone(),
                scenario.label.clone(),
                text(cue),
                row.name.clone(),
                text(row.r0),
                text(row.outcome.map(|outcome| outcome.name())),
                text(row.chi),
                text(rounds.map(|r| r.min)),
                text(rounds.map(|r| r.mean)),
                text(rounds.map(|r| r.max)),
                text(rounds.map(|r| r.full_doublings)),
                text(rounds.map(|r| r.terminal)),
                text(observed.and_then(|o| o.min)),
                text(observed.and_then(|o| o.mean)),
                text(observed.and_then(|o| o.max)),
                text(observed.and_then(|o| o.full_doublings)),
                text(observed.and_then(|o| o.terminal)),
            ]);
        }
    }
    csv_of(rows).unwrap_or_default()
}

type Column = (&'static str, fn(&Line<'_>) -> String);

/// The columns, in their order. Counts are as in the founders' table; an unknown value, as of a founder that was not born or not
/// observed, is empty. `cue` is the one that the founder carries, in full.
const COLUMNS: [Column; 17] = [
    ("scenario", |line| line.scenario.name.clone()),
    ("lineage", |line| line.scenario.label.clone()),
    ("cue", |line| text(line.cue)),
    ("founder", |line| line.row.name.clone()),
    ("r0", |line| text(line.row.r0)),
    ("outcome", |line| text(line.row.outcome.map(|outcome| outcome.name()))),
    ("chi", |line| text(line.row.chi)),
    ("min", |line| rounds(line, |r| r.min)),
    ("mean", |line| rounds(line, |r| r.mean)),
    ("max", |line| rounds(line, |r| r.max)),
    ("full_doublings", |line| rounds(line, |r| r.full_doublings)),
    ("terminal", |line| rounds(line, |r| r.terminal)),
    ("observed_min", |line| observed(line, |o| o.min)),
    ("observed_mean", |line| observed(line, |o| o.mean)),
    ("observed_max", |line| observed(line, |o| o.max)),
    ("observed_full_doublings", |line| observed(line, |o| o.full_doublings)),
    ("observed_terminal", |line| observed(line, |o| o.terminal)),
];

fn text(value: Option<impl ToString>) -> String {
    value.map_or(String::new(), |value| value.to_string())
}
