//! What the branches of a tree are as long as.

use crate::lineage::{CellId, Tree};

/// What the branch that leads to a cell is as long as.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum BranchLengths {
    /// The time in τ from the cell's birth to its pinch-off, or to its rest; none where no division was computed. A cell just
    /// above the threshold of division takes thousands of τ: drawn to scale, all else is a point.
    #[default]
    Time,
    /// One, and 0 for the first cell: the distance of a cell from it is its generation. Every branch has a length then, as some
    /// programs demand.
    Generation,
    /// No lengths at all.
    None,
}

impl BranchLengths {
    /// The length of a cell's branch.
    pub fn of(self, tree: &Tree, cell: CellId) -> Option<f64> {
        match self {
            BranchLengths::Time => tree.cell(cell).fate.t_end(),
            BranchLengths::Generation => Some(if cell == tree.first() { 0.0 } else { 1.0 }),
            BranchLengths::None => None,
        }
    }
}
