//! The memo, the store, and the built-in tree.

use std::sync::{Arc, mpsc::channel};

use divan::counter::ItemsCount;
use divan::{Bencher, black_box};
use furrow::batch::memo::Request;
use furrow::batch::{Key, Memo, Quantisation, SchedulerOptions, SolverVersion, Store};
use furrow::cell::Cell;
use furrow::division::{Division, DivisionError, DivisionInput, Outcome, divide};
use furrow::io::newick;
use furrow::lineage::{Grower, Lineage, Tree, TreeSettings};

/// Look-ups of one sample.
const HITS: usize = 100_000;
/// Distinct divisions they go round.
const DIVISIONS: usize = 1000;

fn input(number: usize) -> DivisionInput {
    let r0 = 1.0 + number as f64 / 256.0;
    DivisionInput::new(Cell::new(r0))
}

/// A division that cost nothing.
fn free(input: &DivisionInput) -> Division {
    Division {
        outcome: Outcome::Symmetric,
        chi: Some(0.0),
        chi_signed: Some(0.0),
        u_furrow: Some(0.5),
        t_end: 1.0,
        daughters: Some([input.cell.r0 * 0.5f64.cbrt(); 2]),
        growth_rate: None,
        slow_growth_rate: None,
        volume_drift: 0.0,
        work: bvp::Work::default(),
    }
}

fn filled(memo: Memo<DivisionInput>) -> Memo<DivisionInput> {
    let (sender, _receiver) = channel();
    for number in 0..DIVISIONS {
        let input = memo.canonical(&input(number));
        if let Request::Yours(ticket) = memo.request(memo.key(&input), &sender) {
            ticket.solved(free(&input));
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
            let request = memo.request(memo.key(&memo.canonical(input)), &sender);
            assert!(matches!(request, Request::Known(_)));
        }
    });
}

/// 100,000 hits in the store's table, keys at hand.
#[divan::bench]
fn store_hits(bencher: Bencher) {
    let folder = tempfile::tempdir().unwrap();
    let solver = SolverVersion::current();
    let memo = filled(Memo::new(Quantisation::DEFAULT).with_store(Store::open(folder.path(), solver).unwrap()));
    let keys: Vec<_> = (0..DIVISIONS).map(|number| memo.key(&memo.canonical(&input(number)))).collect();
    let store: Store<Division> = Store::open(folder.path(), solver).unwrap();
    bencher.counter(ItemsCount::new(HITS)).bench_local(|| {
        for key in keys.iter().cycle().take(HITS) {
            black_box(store.get(key)).unwrap();
        }
    });
}

/// Opening a store of 100,000 divisions: every entry read and its checksum verified.
#[divan::bench(sample_count = 10, sample_size = 1)]
fn store_open(bencher: Bencher) {
    let folder = tempfile::tempdir().unwrap();
    let solver = SolverVersion::current();
    let store = Store::open(folder.path(), solver).unwrap();
    for number in 0..HITS {
        let key = Key::new(&input(number), solver);
        store.commit(&key, &Arc::new(free(&input(number))));
    }
    bencher.counter(ItemsCount::new(HITS)).bench_local(|| {
        assert_eq!(Store::<Division>::open(folder.path(), solver).unwrap().len(), HITS);
    });
}

fn grow(
    lineage: &Lineage,
    memo: &Memo<DivisionInput>,
    threads: usize,
    solve: fn(&DivisionInput) -> Result<Division, DivisionError>,
) -> Tree {
    let settings = TreeSettings::default();
    let options = SchedulerOptions { threads, ..SchedulerOptions::default() };
    Grower { lineage, settings, ends: &|_| None, memo, options }.grow(solve).unwrap().0
}

/// The built-in tree from nothing; every cell's end is left to the dynamics.
#[divan::bench(args = [1, 2], sample_count = 3, sample_size = 1)]
fn tree_cold(bencher: Bencher, threads: usize) {
    let lineage = Lineage::c_elegans().unwrap();
    bencher.bench_local(|| grow(&lineage, &Memo::new(Quantisation::DEFAULT), threads, divide));
}

/// The same with all its divisions in the store: opened, grown, written as text.
#[divan::bench]
fn tree_warm(bencher: Bencher) {
    let lineage = Lineage::c_elegans().unwrap();
    let folder = tempfile::tempdir().unwrap();
    let open =
        || Memo::new(Quantisation::DEFAULT).with_store(Store::open(folder.path(), SolverVersion::current()).unwrap());
    grow(&lineage, &open(), 0, divide);
    bencher.bench_local(|| {
        let tree = grow(&lineage, &open(), 1, |input| panic!("R0 = {} is in the store", input.cell.r0));
        (newick(&tree), tree.to_json().unwrap())
    });
}

/// 131,071 cells of a lineage cut at 16 generations, all of them hits.
#[divan::bench(sample_count = 5, sample_size = 1)]
fn tree_of_hits(bencher: Bencher) {
    let text = "Lineage(name: \"x\", limits: (max_depth: 16), founders: [(name: \"Q\")])";
    let lineage = Lineage::parse(text, "x.ron").unwrap();
    let memo = Memo::new(Quantisation::DEFAULT);
    let grown = grow(&lineage, &memo, 1, |input| Ok(free(input)));
    bencher.counter(ItemsCount::new(grown.len())).bench_local(|| {
        let tree = grow(&lineage, &memo, 1, |input| panic!("R0 = {} is in the memo", input.cell.r0));
        (newick(&tree), Tree::from_json(&tree.to_json().unwrap()).unwrap())
    });
}
