//! `scenarios.csv`: founders of several scenarios, one row for each scenario and founder; `spread.csv`: their ranges over seeds.

use crate::ranges::{LineageRanges, Range};
use crate::table::cells_csv;
use furrow_formats::founder_rows;
use furrow_lineage::{Scenario, Tree};
use serde_json::{Value, json};

/// The columns. Counts are as in the founders' table; an unknown value, as of a founder that was not born or not observed, is
/// empty. `cue` is the one that the founder carries, in full.
const COLUMNS: &str = "scenario,lineage,cue,founder,r0,outcome,chi,min,mean,max,full_doublings,terminal,\
    observed_min,observed_mean,observed_max,observed_full_doublings,observed_terminal";

/// The table of scenarios and their trees.
pub fn scenarios_csv(scenarios: &[Scenario], trees: &[Tree]) -> String {
    let mut rows: Vec<Vec<Value>> = Vec::new();
    for (Scenario { name, label, .. }, tree) in scenarios.iter().zip(trees) {
        for (founder, row) in founder_rows(tree).iter().enumerate() {
            let cue = tree.founder_cell(founder).map(|id| tree.cell(id).cue.to_string());
            let (rounds, observed) = (row.rounds, row.observed.unwrap_or_default());
            rows.push(vec![
                json!(name),
                json!(label),
                json!(cue),
                json!(row.name),
                json!(row.r0),
                json!(row.outcome),
                json!(row.chi),
                json!(rounds.map(|r| r.min)),
                json!(rounds.map(|r| r.mean)),
                json!(rounds.map(|r| r.max)),
                json!(rounds.map(|r| r.full_doublings)),
                json!(rounds.map(|r| r.terminal)),
                json!(observed.min),
                json!(observed.mean),
                json!(observed.max),
                json!(observed.full_doublings),
                json!(observed.terminal),
            ]);
        }
    }
    cells_csv(COLUMNS.split(','), rows)
}

/// The table of ranges over seeds of the noise: a row for each scenario, founder and quantity.
pub fn spread_csv(scenarios: &[Scenario], spread: &[LineageRanges]) -> String {
    let mut rows: Vec<[Value; 8]> = Vec::new();
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
                let [name, label, founder] = [name, label, &founder.name].map(|text| json!(text));
                let [seeds, quantity] = [json!(ranges.members), json!(quantity)];
                rows.push([name, label, founder, quantity, seeds, json!(p5), json!(p50), json!(p95)]);
            }
        }
    }
    let columns = ["scenario", "lineage", "founder", "quantity", "seeds", "p5", "p50", "p95"];
    cells_csv(columns.into_iter(), rows)
}
