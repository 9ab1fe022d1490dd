//! Grows a custom lineage with two founders. One of them has a cue that only large cells of the first generations carry.
//!
//! `cargo run --release --example own_lineage`

use furrow::Cell;
use furrow::divide;
use furrow::founders_table;
use furrow::{EndRule, Grower, Lineage, Thresholds, TreeSettings};
use furrow::{Memo, Quantisation, SchedulerOptions};
use furrow::{founder_rows, newick};
use furrow_mechanics::critical::CriticalRadii;

const LINEAGE: &str = r#"Lineage(
    name: "two founders",
    cues: { "pulled": "tension:gradient,amplitude=0.3" },
    founders: [
        (name: "Z", cue: "pulled", inherit: false),
        (name: "X", mother: "Z", daughter: larger, cue_rules: [
            (cue: "pulled", to_generation: 1, above_r0: 2.5),
        ]),
        (name: "Y", mother: "Z", daughter: smaller),
    ],
)"#;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let lineage = Lineage::parse(LINEAGE, "two founders")?;
    let settings = TreeSettings { cell: Cell::new(4.0), ..TreeSettings::default() };
    let rule = Thresholds::new(CriticalRadii::new(&settings.numerics));
    let memo = Memo::new(Quantisation::DEFAULT);
    let (ends, options) = (EndRule::Thresholds(&rule), SchedulerOptions::default());
    let grower = Grower { lineage: &lineage, settings, ends, memo: &memo, options };
    let (tree, summary) = grower.grow(divide)?;
    print!("{}", founders_table(&tree, &founder_rows(&tree)));
    println!("{} divisions solved for {} cells", summary.solved, tree.len());
    println!("{} characters of Newick", newick(&tree).len());
    Ok(())
}
