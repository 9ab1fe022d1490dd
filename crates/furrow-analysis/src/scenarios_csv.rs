//! `scenarios.csv`: founders of several scenarios, one row for each scenario and founder.

use furrow_cell::Cue;
use furrow_formats::{FounderRow, founder_rows};
use furrow_lineage::{ObservedRounds, Rounds, Scenario, Tree};

use crate::table::csv_of;

/// A founder of a scenario.
struct Line<'a> {
    scenario: &'a Scenario,
    row: &'a FounderRow,
    /// The cue of its cell, if it was born.
    cue: Option<&'a Cue>,
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

fn rounds<T: ToString>(line: &Line<'_>, of: fn(Rounds) -> T) -> String {
    text(line.row.rounds.map(of))
}

fn observed<T: ToString>(line: &Line<'_>, of: fn(ObservedRounds) -> Option<T>) -> String {
    text(line.row.observed.and_then(of))
}

/// The table of scenarios and their trees.
pub fn scenarios_csv(scenarios: &[Scenario], trees: &[Tree]) -> String {
    let mut records = vec![COLUMNS.map(|(name, _)| name.to_owned())];
    for (scenario, tree) in scenarios.iter().zip(trees) {
        for (founder, row) in founder_rows(tree).iter().enumerate() {
            let cue = tree.founder_cell(founder).map(|id| &tree.cell(id).cue);
            records.push(COLUMNS.map(|(_, of)| of(&Line { scenario, row, cue })));
        }
    }
    csv_of(records).unwrap_or_default()
}
