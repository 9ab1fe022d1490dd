//! `scenarios.csv`: founders of several scenarios, one row for each scenario and founder.

use crate::table::{Row, csv_text};
use furrow_formats::founder_rows;
use furrow_lineage::{Scenario, Tree};
use serde_json::json;

/// The columns. Counts are as in the founders' table; an unknown value, as of a founder that was not born or not observed, is
/// empty. `cue` is the one that the founder carries, in full.
const COLUMNS: &str = "scenario,lineage,cue,founder,r0,outcome,chi,min,mean,max,full_doublings,terminal,\
    observed_min,observed_mean,observed_max,observed_full_doublings,observed_terminal";

/// Where a founder's row has those from `founder` on.
const FIELDS: [&str; 14] = [
    "/name",
    "/r0",
    "/outcome",
    "/chi",
    "/rounds/min",
    "/rounds/mean",
    "/rounds/max",
    "/rounds/full_doublings",
    "/rounds/terminal",
    "/observed/min",
    "/observed/mean",
    "/observed/max",
    "/observed/full_doublings",
    "/observed/terminal",
];

/// The table of scenarios and their trees.
pub fn scenarios_csv(scenarios: &[Scenario], trees: &[Tree]) -> String {
    let mut rows = Vec::new();
    for (Scenario { name, label, .. }, tree) in scenarios.iter().zip(trees) {
        for (founder, row) in founder_rows(tree).iter().enumerate() {
            let cue = tree.founder_cell(founder).map(|id| tree.cell(id).cue.to_string());
            let row = json!(row);
            let fields = FIELDS.iter().map(|field| row.pointer(field).cloned().unwrap_or_default());
            let cells = [json!(name), json!(label), json!(cue)].into_iter().chain(fields).collect();
            rows.push(Row { index: rows.len(), cells, why: None });
        }
    }
    csv_text(&COLUMNS.split(',').map(str::to_owned).collect::<Vec<_>>(), &rows)
}
