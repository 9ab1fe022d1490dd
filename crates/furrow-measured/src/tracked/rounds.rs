//! Rounds of division in a followed embryo.

use std::collections::HashMap;

use super::{TrackedCell, TrackedLineage};

/// Divisions from a cell to its last descendants that were followed.
#[derive(Clone, Debug, PartialEq)]
pub struct TrackedRounds {
    /// The cell.
    pub cell: String,
    /// Its last descendants: the cells that were not seen to divide.
    pub terminal: u32,
    /// Fewest divisions to one of them.
    pub min: u32,
    /// Their mean.
    pub mean: f64,
    /// Most.
    pub max: u32,
}

impl TrackedLineage {
    /// Rounds of each of these cells that was followed. Of several cells of one name it is the one born first.
    pub fn rounds(&self, names: &[&str]) -> Vec<TrackedRounds> {
        let mut first = HashMap::new();
        for (index, cell) in self.cells.iter().enumerate() {
            first.entry(cell.name.as_str()).or_insert(index);
        }
        let below = self.below();
        let of = |name: &&str| {
            let Below { terminal, sum, min, max } = below[*first.get(name)?];
            let mean = sum as f64 / f64::from(terminal);
            Some(TrackedRounds { cell: (*name).to_owned(), terminal, min, mean, max })
        };
        names.iter().filter_map(of).collect()
    }

    /// Cells that were not seen to divide, with a name of Sulston's.
    pub fn terminal(&self) -> u32 {
        let is_last = |cell: &&TrackedCell| cell.daughters.is_empty() && crate::names::is_cell(&cell.name);
        self.cells.iter().filter(is_last).count() as u32
    }

    /// Divisions below every cell; daughters come after their mothers.
    fn below(&self) -> Vec<Below> {
        let mut below = vec![Below { terminal: 1, sum: 0, min: 0, max: 0 }; self.cells.len()];
        for (index, cell) in self.cells.iter().enumerate().rev() {
            let daughters = cell.daughters.iter().map(|daughter| below[*daughter]);
            let add = |a: Below, b: Below| Below {
                terminal: a.terminal + b.terminal,
                sum: a.sum + b.sum,
                min: a.min.min(b.min),
                max: a.max.max(b.max),
            };
            let Some(both) = daughters.reduce(add) else { continue };
            let sum = both.sum + u64::from(both.terminal);
            below[index] = Below { terminal: both.terminal, sum, min: both.min + 1, max: both.max + 1 };
        }
        below
    }
}

/// Divisions from a cell to its last descendants: how many these are, and the sum, the least and the largest number.
#[derive(Clone, Copy)]
struct Below {
    terminal: u32,
    sum: u64,
    min: u32,
    max: u32,
}
