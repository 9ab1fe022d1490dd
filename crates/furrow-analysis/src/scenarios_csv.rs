//! `scenarios.csv`: founders of several scenarios, one row for each scenario and founder; `spread.csv`: their ranges over seeds.

use crate::json::merged;
use crate::ranges::{LineageRanges, Range};
use crate::table::values_csv;
use furrow_formats::founder_rows;
use furrow_lineage::{Scenario, Tree};
use serde_json::json;

/// The columns. Counts are as in the founders' table; an unknown value, as of a founder that was not born or not observed, is
/// empty. `cue` is the one that the founder carries, in full.
const COLUMNS: &str = "scenario,lineage,cue,founder,r0,outcome,chi,min,mean,max,full_doublings,terminal,\
    observed_min,observed_mean,observed_max,observed_full_doublings,observed_terminal";

/// The table of scenarios and their trees.
pub fn scenarios_csv(scenarios: &[Scenario], trees: &[Tree]) -> String {
    let mut rows = Vec::new();
    for (Scenario { name, label, .. }, tree) in scenarios.iter().zip(trees) {
        for (founder, row) in founder_rows(tree).into_iter().enumerate() {
            let cue = tree.founder_cell(founder).map(|id| tree.cell(id).cue.to_string());
            let of_scenario = json!({ "scenario": name, "lineage": label, "founder": row.name, "cue": cue });
            let observed = row.observed.map(|observed| {
                json!({
                    "observed_min": observed.min,
                    "observed_mean": observed.mean,
                    "observed_max": observed.max,
                    "observed_full_doublings": observed.full_doublings,
                    "observed_terminal": observed.terminal,
                })
            });
            rows.push([json!(row.rounds), json!(observed), of_scenario].into_iter().fold(json!(row), merged));
        }
    }
    values_csv(COLUMNS, rows)
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
                rows.push(json!([name, label, founder.name, quantity, ranges.members, p5, p50, p95]));
            }
        }
    }
    values_csv("scenario,lineage,founder,quantity,seeds,p5,p50,p95", rows)
}
