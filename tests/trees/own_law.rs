//! Trees of cells with a law of active stress as text.

use crate::common::stand_in::grow;
use furrow_cell::{Cell, Law};
use furrow_formats::{newick, tree_from_json, tree_to_json};
use furrow_lineage::{Lineage, TreeSettings};
use furrow_mechanics::division::divide;

/// Divisions of the germline's first cells, with the cue and without, and of cells that rest.
#[test]
fn the_papers_law_as_text_grows_the_tree_of_the_built_in_one() {
    let mut lineage = Lineage::c_elegans().unwrap();
    lineage.limits.max_depth = 4;
    lineage.forget_first_radius();
    let law = Law::parse(include_str!("../../examples/laws/paper.ron"), "paper.ron").unwrap();
    let cells = [Cell::new(3.0), Cell::new(3.0).with_law(law)];
    let [built_in, own] = cells.map(|cell| {
        let settings = TreeSettings { cell, ..TreeSettings::default() };
        grow(&lineage, &settings, 1, &|_| None, divide).0
    });
    assert_eq!(own.len(), built_in.len());
    assert!(own.len() > 10, "{}", own.len());
    for (a, b) in own.cells().zip(built_in.cells()) {
        let (a, b) = (own.cell(a), built_in.cell(b));
        assert_eq!((&a.name, a.fate.outcome()), (&b.name, b.fate.outcome()));
        assert!((a.r0 - b.r0).abs() < 1e-8, "{}: {} {}", a.name, a.r0, b.r0);
    }
    assert_eq!(newick(&own).matches(',').count(), newick(&built_in).matches(',').count());
    // The file has the law.
    let again = tree_from_json(&tree_to_json(&own).unwrap()).unwrap();
    assert_eq!(again.settings.cell.law, own.settings.cell.law);
}
