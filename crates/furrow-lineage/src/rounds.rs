//! Rounds of division per founder.
//!
//! "Rounds" has more than one reading; all are given: fewest, mean and most divisions from the founder to a terminal
//! cell, and the number of generations, counted from the founder, that doubled fully.

use super::tree::Tree;
use furrow_mechanics::division::Outcome;
use serde::{Deserialize, Serialize};

/// Rounds of division from a founder to its terminal descendants.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Rounds {
    /// Fewest.
    pub min: u32,
    /// Mean over terminal cells.
    pub mean: f64,
    /// Most.
    pub max: u32,
    /// Generations, counted from the founder, in which every cell divided.
    pub full_doublings: u32,
    /// Terminal cells.
    pub terminal: u32,
    /// Generations, counted from the founder, in which every cell divided symmetrically.
    pub symmetric: u32,
}

/// A founder's row.
#[derive(Clone, Debug, PartialEq)]
pub struct FounderRounds {
    /// Index into the lineage's founders.
    pub founder: usize,
    /// Rounds; none if the founder was never born.
    pub rounds: Option<Rounds>,
}

#[derive(Clone, Default)]
struct Count {
    /// Cells, and dividing cells, per generation below the founder.
    cells: Vec<u64>,
    dividing: Vec<u64>,
    symmetric: Vec<u64>,
    /// Terminal cells per generation.
    terminal: Vec<u64>,
}

fn add(counts: &mut Vec<u64>, generation: usize) {
    counts.resize(counts.len().max(generation + 1), 0);
    counts[generation] += 1;
}

/// Rounds of every founder of the tree's lineage, in the file's order.
pub fn founder_rounds(tree: &Tree) -> Vec<FounderRounds> {
    let founders = tree.lineage.founders.len();
    let mut counts = vec![Count::default(); founders];
    // Each founder's mother founder and generation, to count a cell for all founders it descends from.
    let born = |k: usize| tree.founder_cell(k);
    let above: Vec<_> = (0..founders).map(|k| Some(tree.cell(tree.mother(born(k)?)?).founder)).collect();
    let birth: Vec<_> = (0..founders).map(|k| Some(tree.cell(born(k)?).generation)).collect();
    for node in tree.cells() {
        let cell = tree.cell(node);
        let divides = tree.daughters(node).is_some();
        let mut founder = Some(cell.founder);
        while let Some(k) = founder {
            if let Some(birth) = birth[k] {
                let generation = (cell.generation - birth) as usize;
                let count = &mut counts[k];
                add(&mut count.cells, generation);
                add(if divides { &mut count.dividing } else { &mut count.terminal }, generation);
                if divides && cell.fate.outcome() == Some(Outcome::Symmetric) {
                    add(&mut count.symmetric, generation);
                }
            }
            founder = above[k];
        }
    }
    let rounds = |count: &Count| {
        let full = |part: &[u64]| {
            count.cells.iter().enumerate().take_while(|(g, cells)| part.get(*g) == Some(cells)).count() as u32
        };
        let terminal: u64 = count.terminal.iter().sum();
        let weighted: u64 = count.terminal.iter().enumerate().map(|(g, n)| g as u64 * n).sum();
        Some(Rounds {
            min: count.terminal.iter().position(|&n| n > 0)? as u32,
            mean: weighted as f64 / terminal as f64,
            max: count.terminal.len() as u32 - 1,
            full_doublings: full(&count.dividing),
            terminal: terminal as u32,
            symmetric: full(&count.symmetric),
        })
    };
    counts.iter().enumerate().map(|(founder, count)| FounderRounds { founder, rounds: rounds(count) }).collect()
}
