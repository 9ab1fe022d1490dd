//! Trees of cells with a law of active stress as text.

use crate::common::stand_in::grow;
use furrow_cell::{Cell, Law};
use furrow_formats::{newick, tree_from_json, tree_to_json};
use furrow_lineage::{Lineage, Place, TreeSettings};
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

/// A regulator that the law reads is a substance of every cell: `--cue` gives it to all, and its source to the cells with a cue.
#[test]
fn every_cell_has_the_regulator_that_the_law_reads() {
    let text = "Law(name: \"x\", stress_uu: \"xi_s*C*(1 + phi)\", stress_phiphi: \"xi_s*C*(1 + phi)\")";
    let cell = Cell::new(3.0).with_law(Law::parse(text, "x.ron").unwrap());
    let regulator = |source: &str| format!("regulator:{source},turnover=10,diffusion=1,activity=0");
    let carried = |lineage: &Lineage, source: &str| {
        let lineage = lineage.carrying(&regulator(source), &cell).unwrap();
        let cues = |founder: usize| lineage.cue_at(Place { founder, round: 1, generation: 9, r0: 1.0, apart: 0 });
        (0..lineage.founders.len()).map(|founder| cues(founder).to_string()).collect::<Vec<_>>()
    };
    let rules = "(name: \"C\", mother: \"A\", daughter: larger, cue_rules: [(cue: \"none\")]),
        (name: \"D\", mother: \"A\", daughter: smaller, cue: \"none\")";
    let text = format!(
        "Lineage(name: \"x\", cues: {{\"polar\": \"kappa:u0=0.4,omega=0.1,amplitude=0.2\"}}, founders: [(name: \"Q\", r0: 5.0, cue: \"polar\", inherit: false), \
         (name: \"A\", mother: \"Q\", daughter: larger), (name: \"B\", mother: \"Q\", daughter: smaller, cue: \"polar\"), {rules}])"
    );
    let lineages = [Lineage::c_elegans().unwrap(), Lineage::parse(&text, "x.ron").unwrap()];
    let step = "step,u0=0.4,omega=0.1,amplitude=0.2";
    for lineage in &lineages {
        // Without a source, or with one that both poles see alike, all cells are alike.
        for source in ["none", "band,u0=0.5,omega=0.1,amplitude=1"] {
            assert!(carried(lineage, source).iter().all(|cue| *cue == regulator(source)), "{source}");
        }
        let cues = carried(lineage, step);
        assert!(cues.iter().all(|cue| [regulator(step), regulator("none")].contains(cue)), "{cues:?}");
        assert!(cues.contains(&regulator(step)) && cues.contains(&regulator("none")), "{cues:?}");
    }
    // A law that reads no regulator leaves other cells without a cue.
    let plain = lineages[0].carrying(&regulator("none"), &Cell::new(3.0)).unwrap();
    assert!(plain.is_without_cues());
}
