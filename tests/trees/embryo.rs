//! The built-in lineage grown from mechanics.

use furrow_cell::Numerics;
use furrow_formats::founder_rows;
use furrow_formats::tree_to_json;
use furrow_lineage::batch::{Memo, Quantisation, SchedulerOptions, Summary};
use furrow_lineage::{EndRule, Grower, Lineage, TerminalReason, Thresholds, Tree, TreeSettings};
use furrow_mechanics::critical::CriticalRadii;
use furrow_mechanics::division::{Outcome, divide};
use furrow_report::TreeSummary;

fn grow(memo: &Memo, threads: usize, ends: EndRule<'_>) -> (Tree, Summary) {
    let lineage = Lineage::c_elegans().unwrap();
    let settings = TreeSettings { r0_step: memo.quantisation().relative_step(), ..TreeSettings::default() };
    let options = SchedulerOptions { threads, ..SchedulerOptions::default() };
    Grower { lineage: &lineage, settings, ends, memo, options }.grow(divide).unwrap()
}

fn by_boundary(memo: &Memo, threads: usize) -> Tree {
    let ends = Thresholds::new(CriticalRadii::new(&Numerics::default()));
    let tree = grow(memo, threads, EndRule::Thresholds(&ends)).0;
    assert!(ends.unknown().is_empty(), "{:?}", ends.unknown());
    tree
}

/// The paper's report on the lineage.
#[test]
fn the_embryo() {
    let memo = Memo::new(Quantisation::DEFAULT);
    let (tree, summary) = grow(&memo, 2, EndRule::Dynamics);
    assert!(!TreeSummary::of(&tree).limited(), "the tree must end by itself");
    let rows = founder_rows(&tree);
    let row = |name: &str| rows.iter().find(|row| row.name == name).unwrap();
    // AB: four symmetric rounds, then asymmetric ones.
    let ab = row("AB").rounds.unwrap();
    assert_eq!((ab.symmetric, ab.full_doublings), (4, 5));
    // The germline: shallow divisions, then steep ones, then no division.
    let chi = |name: &str| row(name).chi.unwrap();
    assert!((chi("P0") - 0.1848).abs() < 0.01, "{}", chi("P0"));
    assert!(chi("P1") < 0.2 && chi("P2") < 0.2 && chi("P3") > 0.5);
    assert_eq!(row("P4").outcome, Some(Outcome::Arrested));
    // Volumes are handed down to rounding.
    for node in tree.cells() {
        if let Some([a, p]) = tree.daughters(node) {
            let volume = tree.cell(node).volume_fraction;
            let sum = tree.cell(a).volume_fraction + tree.cell(p).volume_fraction;
            assert!((sum - volume).abs() <= f64::EPSILON * volume);
        }
    }

    // The boundary and the dynamics agree about every cell: the trees have the same cells.
    let ended = by_boundary(&memo, 1);
    assert_eq!(ended.len(), tree.len());
    for node in ended.cells() {
        let (short, long) = (ended.cell(node), tree.cell(node));
        assert_eq!((&short.name, short.r0, short.fate.outcome()), (&long.name, long.r0, long.fate.outcome()));
        match short.fate.terminal_reason() {
            None => assert_eq!(short.fate, long.fate),
            Some(reason) => {
                assert!(matches!(reason, TerminalReason::BelowPitchfork { .. }), "{}: {reason:?}", short.name);
                assert!(matches!(long.fate.terminal_reason(), Some(TerminalReason::AtRest { .. })), "{}", long.name);
            }
        }
    }
    println!("{} cells, {} divisions", tree.len(), summary.solved);
}

/// Regression: a critical radius refined on the way was reported by the cells judged after it alone, in an order that
/// depends on timing.
#[test]
fn the_same_file_at_any_thread_count_and_from_any_memo() {
    let one = tree_to_json(&by_boundary(&Memo::new(Quantisation::DEFAULT), 1)).unwrap();
    let memo = Memo::new(Quantisation::DEFAULT);
    for threads in [2, 8, 1] {
        assert_eq!(tree_to_json(&by_boundary(&memo, threads)).unwrap(), one, "{threads} threads");
    }
}
