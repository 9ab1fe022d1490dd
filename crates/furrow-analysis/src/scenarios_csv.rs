//! `scenarios.csv`: founders of several scenarios, one row for each scenario and founder; `spread.csv`: their ranges over seeds.

use crate::ranges::{LineageRanges, Range};
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

/// The table of ranges over seeds of the noise: a row for each scenario, founder and quantity.
pub fn spread_csv(scenarios: &[Scenario], spread: &[LineageRanges]) -> String {
    let mut rows = Vec::new();
    for (Scenario { name, label, .. }, ranges) in scenarios.iter().zip(spread) {
        for founder in &ranges.founders {
            let rounds = founder.rounds.as_ref();
            let quantities: [(&str, Option<Range>); 7] = [
                ("chi", founder.chi),
                ("min", rounds.map(|r| r.min)),
                ("mean", rounds.map(|r| r.mean)),
                ("max", rounds.map(|r| r.max)),
                ("full_doublings", rounds.map(|r| r.full_doublings)),
                ("symmetric", rounds.map(|r| r.symmetric)),
                ("cells", founder.cells),
            ];
            for (quantity, range) in quantities {
                let Some(Range { p5, p50, p95 }) = range else { continue };
                let seeds = ranges.members;
                let cells = json!([name, label, founder.name, quantity, seeds, p5, p50, p95]);
                let cells = cells.as_array().cloned().unwrap_or_default();
                rows.push(Row { index: rows.len(), cells, why: None });
            }
        }
    }
    let columns = ["scenario", "lineage", "founder", "quantity", "seeds", "p5", "p50", "p95"];
    csv_text(&columns.map(str::to_owned), &rows)
}
