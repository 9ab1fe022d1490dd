//! Trees that differ by the seed of their noise: divisions that the noise does not decide are computed once.

use std::collections::BTreeMap;
use std::sync::Mutex;

use furrow_cell::Cell;
use furrow_formats::tree_to_json;
use furrow_lineage::batch::{Memo, Quantisation, SchedulerOptions};
use furrow_lineage::{EndRule, Grower, Lineage, Tree, TreeSettings, grow_replicates};
use furrow_mechanics::division::{Division, DivisionError, DivisionInput, Outcome};

use crate::common::stand_in::{division, fake, grown};

/// As [`fake`], but above R0 = 4 χ is decided by the seed, and below the seed moves it by next to nothing.
fn chancy(input: &DivisionInput) -> Result<Division, DivisionError> {
    let (r0, seed) = (input.cell.r0, input.seed as f64);
    Ok(match r0 {
        r0 if r0 > 4.0 => division(r0, Outcome::Asymmetric, 0.3 + 0.05 * seed),
        r0 if (1.7..2.25).contains(&r0) => division(r0, Outcome::Asymmetric, -0.88 + 1e-5 * seed),
        _ => return fake(input),
    })
}

fn replicates(lineage: &Lineage, seeds: u64) -> (Vec<Tree>, BTreeMap<(u64, u64), usize>) {
    let (memo, options) = (Memo::new(Quantisation::DEFAULT), SchedulerOptions::default());
    let settings = |seed| TreeSettings { seed, cell: Cell::new(5.0), ..TreeSettings::default() };
    let grower = |seed| Grower { lineage, settings: settings(seed), ends: EndRule::Dynamics, memo: &memo, options };
    let growers: Vec<Grower<'_>> = (0..seeds).map(grower).collect();
    // How often each radius is solved with each seed.
    let solved = Mutex::new(BTreeMap::new());
    let solve = |input: &DivisionInput| {
        *solved.lock().unwrap().entry((input.cell.r0.to_bits(), input.seed)).or_default() += 1;
        chancy(input)
    };
    let (trees, _) = grow_replicates(&growers, 0, solve).unwrap();
    (trees, solved.into_inner().unwrap())
}

#[test]
fn only_divisions_that_the_noise_decides_are_computed_for_every_seed() {
    let lineage = Lineage::parse("(name: \"one\", founders: [(name: \"S\")])", "one.ron").unwrap();
    let (trees, solved) = replicates(&lineage, 6);
    let seeds_of = |r0: f64| solved.keys().filter(|(bits, _)| *bits == r0.to_bits()).count();
    assert_eq!(seeds_of(Quantisation::DEFAULT.apply(5.0)), 6);
    assert!(solved.values().all(|times| *times == 1));
    for (seed, tree) in trees.iter().enumerate() {
        let chi = tree.cell(tree.first()).fate.chi().unwrap();
        assert!((chi - (0.3 + 0.05 * seed as f64)).abs() < 1e-12, "{chi}");
    }
    // Below, no radius is solved with more than two seeds.
    let small = solved.keys().filter(|(bits, seed)| f64::from_bits(*bits) < 4.0 && *seed > 1);
    assert_eq!(small.count(), 0);
    assert!(solved.keys().any(|(bits, seed)| f64::from_bits(*bits) < 4.0 && *seed == 1));
}

#[test]
fn the_first_replicate_is_the_tree_of_its_seed_also_where_a_limit_cuts_it() {
    for limits in ["", ", limits: (max_cells: 7)", ", limits: (max_depth: 2)"] {
        let text = format!("(name: \"one\", founders: [(name: \"S\", r0: 5.0)]{limits})");
        let lineage = Lineage::parse(&text, "one.ron").unwrap();
        let (trees, _) = replicates(&lineage, 3);
        let alone = grown(&lineage, &|_| None, chancy);
        let cells = |tree: &Tree| -> Vec<String> { tree.cells().map(|id| format!("{:?}", tree.cell(id))).collect() };
        assert_eq!(cells(&trees[0]), cells(&alone), "{limits}");
        assert!(trees.iter().all(|tree| !tree_to_json(tree).unwrap().is_empty()));
        assert!(trees[2].len() >= 3);
    }
}
