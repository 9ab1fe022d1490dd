//! Rounds of division in a followed embryo.

use std::collections::HashMap;

use serde::Serialize;

use super::{TrackedCell, TrackedLineage};
use crate::names::Names;
use crate::volumes::{Skipped, note};

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

/// A founder without rounds.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Absent {
    /// The founder.
    pub founder: String,
    /// Why its rounds are not known.
    pub why: String,
}

impl TrackedLineage {
    /// Rounds of these founders, and the reason for each founder without rounds. A founder that divided before the recording began has
    /// its daughters' rounds and one more. Of several cells of one name the first is used.
    pub fn rounds(&self, founders: &[&str], names: &Names) -> (Vec<TrackedRounds>, Vec<Absent>) {
        let known = self.counts_by_name(names);
        let (mut found, mut absent) = (Vec::new(), Vec::new());
        for founder in founders {
            let cell = (*founder).to_owned();
            if let Some(DivisionCounts { terminal, sum, min, max }) = known.get(*founder).copied() {
                let mean = sum as f64 / f64::from(terminal);
                found.push(TrackedRounds { cell, terminal, min, mean, max });
                continue;
            }
            let mut daughters: Vec<&String> =
                known.keys().filter(|name| names.birth(name).is_some_and(|(mother, ..)| mother == *founder)).collect();
            daughters.sort();
            let why = match daughters.first() {
                Some(only) => format!("it was not followed, and of its daughters only {only}"),
                None => "neither it nor its daughters were followed".to_owned(),
            };
            absent.push(Absent { founder: cell, why });
        }
        (found, absent)
    }

    /// Divisions below the cells of each name. A mother that was not followed is added if both daughters are known.
    fn counts_by_name(&self, names: &Names) -> HashMap<String, DivisionCounts> {
        let below = self.division_counts();
        let mut known = HashMap::new();
        for (cell, below) in self.cells.iter().zip(below) {
            known.entry(cell.name.clone()).or_insert(below);
        }
        let mut waiting: Vec<String> =
            self.cells.iter().filter(|cell| cell.mother.is_none()).map(|cell| cell.name.clone()).collect();
        while let Some(cell) = waiting.pop() {
            let Some((mother, sister, _)) = names.birth(&cell) else { continue };
            if let (None, Some(a), Some(b)) = (known.get(mother), known.get(&cell), known.get(&sister)) {
                let both = a.merged(*b).of_mother();
                known.insert(mother.to_owned(), both);
                waiting.push(mother.to_owned());
            }
        }
        known
    }

    /// Cells that were not seen to divide, with a name.
    pub fn terminal(&self, names: &Names) -> u32 {
        let is_last = |cell: &&TrackedCell| cell.daughters.is_empty() && names.is_cell(&cell.name);
        self.cells.iter().filter(is_last).count() as u32
    }

    /// What could not be used, the cells without a name, and the cells with a name that another one has: the first of them, and how many
    /// there are.
    pub fn skipped_with_names(&self, names: &Names) -> (Vec<Skipped>, u64) {
        let (mut skipped, mut count) = (self.skipped.clone(), self.skipped_count);
        let mut first: HashMap<&str, &TrackedCell> = HashMap::new();
        for cell in &self.cells {
            if !names.is_cell(&cell.name) {
                note(&mut skipped, &mut count, || cell.unused(names.unknown()));
            } else if let Some(first) = first.get(cell.name.as_str()) {
                let why = format!("a second cell of this name; the first begins on line {}", first.place.1);
                note(&mut skipped, &mut count, || cell.unused(&why));
            } else {
                first.insert(&cell.name, cell);
            }
        }
        (skipped, count)
    }

    /// Divisions below every cell; daughters come after their mothers.
    fn division_counts(&self) -> Vec<DivisionCounts> {
        let mut below = vec![DivisionCounts { terminal: 1, sum: 0, min: 0, max: 0 }; self.cells.len()];
        for (index, cell) in self.cells.iter().enumerate().rev() {
            let daughters = cell.daughters.iter().map(|daughter| below[*daughter]);
            let Some(both) = daughters.reduce(DivisionCounts::merged) else { continue };
            below[index] = both.of_mother();
        }
        below
    }
}

/// Divisions from a cell to its last descendants: how many these are, and the sum, the least and the largest number.
#[derive(Clone, Copy)]
struct DivisionCounts {
    terminal: u32,
    sum: u64,
    min: u32,
    max: u32,
}

impl DivisionCounts {
    /// The counts of two sisters together, from each of them.
    fn merged(self, other: DivisionCounts) -> DivisionCounts {
        DivisionCounts {
            terminal: self.terminal + other.terminal,
            sum: self.sum + other.sum,
            min: self.min.min(other.min),
            max: self.max.max(other.max),
        }
    }

    /// The counts from their mother.
    fn of_mother(self) -> DivisionCounts {
        let DivisionCounts { terminal, sum, min, max } = self;
        DivisionCounts { terminal, sum: sum + u64::from(terminal), min: min + 1, max: max + 1 }
    }
}
