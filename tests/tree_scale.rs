//! A tree of more than 100,000 cells, all from the memo: grown, written, read back. The only test of its program, since it measures
//! the memory of the process.

mod common;

use furrow_formats::{tree_from_json, tree_to_json};
use std::time::Instant;

use common::stand_in::division;
use furrow_formats::{newick, write_atomically};
use furrow_lineage::batch::{Memo, Quantisation, SchedulerOptions};
use furrow_lineage::{EndRule, Grower, Lineage, TreeSettings};
use furrow_mechanics::division::{DivisionInput, Outcome};

/// Generations below the first cell.
const DEPTH: u32 = 16;
/// 2¹⁷ − 1.
const CELLS: usize = 131_071;
/// Resident memory allowed, in MB.
const MOST_MEMORY: u64 = 500;

/// Largest resident memory of this process so far, in MB; `None` if the system does not report it.
fn peak_memory() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|line| line.starts_with("VmHWM:"))?;
    Some(line.split_whitespace().nth(1)?.parse::<u64>().ok()? / 1024)
}

#[test]
fn hundred_thousand_cells_from_the_memo() {
    let text = format!("Lineage(name: \"x\", limits: (max_depth: {DEPTH}), founders: [(name: \"Q\")])");
    let lineage = Lineage::parse(&text, "x.ron").unwrap();
    let memo = Memo::new(Quantisation::DEFAULT);
    let settings = TreeSettings::default();
    let options = SchedulerOptions { threads: 2, ..SchedulerOptions::default() };
    let grower = Grower { lineage: &lineage, settings, ends: EndRule::Dynamics, memo: &memo, options };
    // Unequal to the last: g + 1 sizes in generation g.
    let unequal = |input: &DivisionInput| Ok(division(input.cell.r0, Outcome::Asymmetric, 0.2));
    let (first, solved) = grower.grow(unequal).unwrap();
    assert!((100..1000).contains(&solved.solved), "{}", solved.solved);

    let folder = tempfile::tempdir().unwrap();
    let (json_file, newick_file) = (folder.path().join("tree.json"), folder.path().join("tree.nwk"));
    let start = Instant::now();
    let (tree, summary) = grower.grow(|input| panic!("R0 = {} is in the memo", input.cell.r0)).unwrap();
    let grown = start.elapsed();
    write_atomically(&newick_file, newick(&tree).as_bytes()).unwrap();
    write_atomically(&json_file, tree_to_json(&tree).unwrap().as_bytes()).unwrap();
    let written = start.elapsed();
    let text = std::fs::read_to_string(&json_file).unwrap();
    let back = tree_from_json(&text).unwrap();
    let read = start.elapsed();
    let memory = peak_memory();
    println!(
        "{} cells, {} memo hits: grown {:.2} s, written {:.2} s, read back {:.2} s, together {:.2} s; {} MB of JSON, at most {} MB resident",
        tree.len(),
        summary.memo_hits,
        grown.as_secs_f64(),
        (written - grown).as_secs_f64(),
        (read - written).as_secs_f64(),
        read.as_secs_f64(),
        text.len() / 1_000_000,
        memory.map_or("?".to_owned(), |m| m.to_string()),
    );

    assert_eq!(tree.len(), CELLS);
    assert_eq!(summary.solved, 0);
    assert!(summary.memo_hits >= CELLS / 2);
    assert_eq!(tree_to_json(&back).unwrap(), text);
    assert_eq!(tree_to_json(&first).unwrap(), text);
    let names = std::fs::read_to_string(&newick_file).unwrap();
    assert_eq!((names.matches('Q').count(), names.matches(',').count()), (CELLS, (CELLS - 1) / 2));
    if let Some(memory) = memory {
        assert!(memory < MOST_MEMORY, "{memory} MB");
    }
}
