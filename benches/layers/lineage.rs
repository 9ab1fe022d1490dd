//! The memo, the store, and the built-in tree.

use furrow_formats::{newick, tree_from_json, tree_to_json};
use std::sync::mpsc::channel;

use divan::counter::ItemsCount;
use divan::{Bencher, black_box};
use furrow_cell::Cell;
use furrow_lineage::batch::memo::Request;
use furrow_lineage::batch::{Key, Memo, Quantisation, SchedulerOptions, Store};
use furrow_lineage::{EndRule, Grower, Lineage, Tree, TreeSettings};
use furrow_mechanics::division::{Division, DivisionError, DivisionInput, Outcome, divide};

use crate::stand_in;

/// Look-ups of one sample.
const HITS: usize = 100_000;
/// Distinct divisions among them.
const DIVISIONS: usize = 1000;

fn input(number: usize) -> DivisionInput {
    let r0 = 1.0 + number as f64 / 256.0;
    DivisionInput::new(Cell::gao2026_thresholds(r0))
}

/// A division without solving.
fn free(input: &DivisionInput) -> Division {
    stand_in::division(input.cell.r0, Outcome::Symmetric, 0.0)
}

fn filled(memo: Memo) -> Memo {
    let (sender, _receiver) = channel();
    for number in 0..DIVISIONS {
        let input = memo.canonical(&input(number));
        if let Request::Leased(lease) = memo.request(Key::new(&input), &sender) {
            lease.solve(&input, |input| Ok(free(input)));
        }
    }
    memo
}

/// 100,000 hits: quantise, hash, look up.
#[divan::bench]
fn memo_hits(bencher: Bencher) {
    let memo = filled(Memo::new(Quantisation::DEFAULT));
    let inputs: Vec<DivisionInput> = (0..DIVISIONS).map(input).collect();
    let (sender, _receiver) = channel();
    bencher.counter(ItemsCount::new(HITS)).bench_local(|| {
        for input in inputs.iter().cycle().take(HITS) {
            let request = memo.request(Key::new(&memo.canonical(input)), &sender);
            assert!(matches!(request, Request::Known { .. }));
        }
    });
}

/// 1000 divisions read from a store: each a query, and its checksum verified.
#[divan::bench]
fn store_hits(bencher: Bencher) {
    let folder = tempfile::tempdir().unwrap();
    let memo = filled(Memo::new(Quantisation::DEFAULT).with_store(Store::open(folder.path()).unwrap()));
    let keys: Vec<_> = (0..DIVISIONS).map(|number| Key::new(&memo.canonical(&input(number)))).collect();
    let store = Store::open(folder.path()).unwrap();
    bencher.counter(ItemsCount::new(DIVISIONS)).bench_local(|| {
        for key in &keys {
            black_box(store.get(key)).unwrap();
        }
    });
}

/// Opening a store of 100,000 divisions and reading one of them.
#[divan::bench(sample_count = 10)]
fn store_open(bencher: Bencher) {
    let folder = tempfile::tempdir().unwrap();
    let store = Store::open(folder.path()).unwrap();
    for number in 0..HITS {
        store.commit(&Key::new(&input(number)), &input(number), &free(&input(number)));
    }
    bencher.bench_local(|| Store::open(folder.path()).unwrap().get(&Key::new(&input(7))).unwrap());
}

fn grow(
    lineage: &Lineage,
    memo: &Memo,
    threads: usize,
    solve: fn(&DivisionInput) -> Result<Division, DivisionError>,
) -> Tree {
    let settings = TreeSettings::default();
    let options = SchedulerOptions { threads, ..SchedulerOptions::default() };
    Grower { lineage, settings, ends: EndRule::Dynamics, memo, options }.grow(solve).unwrap().0
}

/// The built-in tree without a cache, all ends by dynamics.
#[divan::bench(args = [1, 2], sample_count = 3, sample_size = 1)]
fn tree_cold(bencher: Bencher, threads: usize) {
    let lineage = Lineage::c_elegans().unwrap();
    bencher.bench_local(|| grow(&lineage, &Memo::new(Quantisation::DEFAULT), threads, divide));
}

/// The same with all divisions in the store: opened, grown, written.
#[divan::bench]
fn tree_warm(bencher: Bencher) {
    let lineage = Lineage::c_elegans().unwrap();
    let folder = tempfile::tempdir().unwrap();
    let open = || Memo::new(Quantisation::DEFAULT).with_store(Store::open(folder.path()).unwrap());
    grow(&lineage, &open(), 0, divide);
    bencher.bench_local(|| {
        let tree = grow(&lineage, &open(), 1, |input| panic!("R0 = {} is in the store", input.cell.r0));
        (newick(&tree), tree_to_json(&tree).unwrap())
    });
}

/// 131,071 cells of a lineage of 16 generations, all from the memo.
#[divan::bench(sample_count = 5, sample_size = 1)]
fn tree_of_hits(bencher: Bencher) {
    let text = "Lineage(name: \"x\", limits: (max_depth: 16), founders: [(name: \"Q\")])";
    let lineage = Lineage::parse(text, "x.ron").unwrap();
    let memo = Memo::new(Quantisation::DEFAULT);
    let grown = grow(&lineage, &memo, 1, |input| Ok(free(input)));
    bencher.counter(ItemsCount::new(grown.len())).bench_local(|| {
        let tree = grow(&lineage, &memo, 1, |input| panic!("R0 = {} is in the memo", input.cell.r0));
        (newick(&tree), tree_from_json(&tree_to_json(&tree).unwrap()).unwrap())
    });
}
