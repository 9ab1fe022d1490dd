//! Rounds of division per founder.
//!
//! "Rounds" has several definitions, and all are computed: the fewest, mean and most divisions from the founder to a
//! terminal cell, and the number of generations, counted from the founder, in which every cell divided.

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

/// Generations of the cells that descend from a founder, counted from the first cell.
#[derive(Clone, Copy)]
struct Count {
    /// Terminal cells, and the sum, the least and the largest of their generations.
    terminal: u64,
    sum: u64,
    least: u32,
    most: u32,
    /// The least generation of a cell that does not divide symmetrically.
    not_symmetric: u32,
}

impl Count {
    const NONE: Count = Count { terminal: 0, sum: 0, least: u32::MAX, most: 0, not_symmetric: u32::MAX };

    fn and(self, other: Count) -> Count {
        Count {
            terminal: self.terminal + other.terminal,
            sum: self.sum + other.sum,
            least: self.least.min(other.least),
            most: self.most.max(other.most),
            not_symmetric: self.not_symmetric.min(other.not_symmetric),
        }
    }

    /// Converted to rounds from a founder of the given generation; `None` if there are no cells, for example because the founder does
    /// not exist in the tree.
    fn rounds(self, birth: u32) -> Option<Rounds> {
        let Count { terminal, sum, least, most, not_symmetric } = self;
        (terminal > 0).then(|| Rounds {
            min: least - birth,
            mean: (sum - u64::from(birth) * terminal) as f64 / terminal as f64,
            max: most - birth,
            // The first generation with a terminal cell is the first in which not every cell divides.
            full_doublings: least - birth,
            terminal: terminal as u32,
            symmetric: not_symmetric - birth,
        })
    }
}

/// Rounds of every founder of the tree's lineage, in the file's order; `None` if the founder does not exist in the tree. The work is
/// proportional to the size of the tree, even for deeply nested founders.
pub fn founder_rounds(tree: &Tree) -> Vec<Option<Rounds>> {
    let founders = tree.lineage.founders.len();
    let mut counts = vec![Count::NONE; founders];
    for node in tree.cells() {
        let (cell, divides) = (tree.cell(node), tree.daughters(node).is_some());
        let (generation, count) = (cell.generation, &mut counts[cell.founder]);
        if !divides {
            let one = Count { terminal: 1, sum: generation.into(), least: generation, most: generation, ..Count::NONE };
            *count = count.and(one);
        }
        if !divides || cell.fate.outcome() != Some(Outcome::Symmetric) {
            count.not_symmetric = count.not_symmetric.min(generation);
        }
    }
    // Each founder's descendants also descend from the founder above it, so the last-born founders are added first.
    let birth = |k: usize| Some(tree.cell(tree.founder_cell(k)?).generation);
    let above = |k: usize| Some(tree.cell(tree.mother(tree.founder_cell(k)?)?).founder);
    let mut born: Vec<usize> = (0..founders).filter(|k| birth(*k).is_some()).collect();
    born.sort_by_cached_key(|k| std::cmp::Reverse(birth(*k)));
    for k in born {
        if let Some(mother) = above(k) {
            counts[mother] = counts[mother].and(counts[k]);
        }
    }
    (0..founders).map(|founder| counts[founder].rounds(birth(founder)?)).collect()
}
