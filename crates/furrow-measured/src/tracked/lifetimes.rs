//! Lifetimes of followed cells.

use std::collections::HashMap;

use furrow_input::InputError;

use super::{TimeUnit, TrackedLineage};
use crate::lifetimes::Lifetime;
use crate::names::Names;
use crate::volumes::{Skipped, note};

/// Lifetimes of the cells of one embryo.
#[derive(Clone, Debug, Default)]
pub struct TrackedLifetimes {
    /// Cells that were followed from birth to division.
    pub cells: Vec<Lifetime>,
    /// What could not be used of the embryo, and such cells with other names; the first of them.
    pub skipped: Vec<Skipped>,
    /// How much there is of it.
    pub skipped_count: u64,
}

impl TrackedLineage {
    /// The lifetimes of the cells that were followed from birth to division; those with other than these names are skipped.
    ///
    /// # Errors
    /// Times are in frames of unknown length.
    pub fn lifetimes(&self, names: &Names) -> Result<TrackedLifetimes, InputError> {
        let is_timed = self.time == TimeUnit::Minutes;
        let allowed = format!("given: the minutes from one frame to the next, since {} counts frames", self.name);
        InputError::require(is_timed, "--frame-minutes", "frame_minutes", "(not given)", allowed)?;
        let mut found =
            TrackedLifetimes { cells: Vec::new(), skipped: self.skipped.clone(), skipped_count: self.skipped_count };
        let used = self.used_lives();
        for (index, cell) in self.cells.iter().enumerate() {
            let (name, life) = (&cell.name, cell.lifetime());
            let Some(founder) = names.founder(name) else {
                if life.is_some() {
                    note(&mut found.skipped, &mut found.skipped_count, || cell.unused(names.unknown()));
                }
                continue;
            };
            let first = used.get(name.as_str()).copied().filter(|first| *first != index);
            if let Some(first) = first.map(|first| &self.cells[first]) {
                let why = format!("a second cell of this name; the first begins on line {}", first.place.1);
                note(&mut found.skipped, &mut found.skipped_count, || cell.unused(&why));
            } else if let Some(mean) = life {
                let (cell, founder, birth) = (name.clone(), founder.to_owned(), Some(cell.birth));
                found.cells.push(Lifetime { cell, founder, n: 1, mean, sd: None, birth });
            }
        }
        Ok(found)
    }

    /// Of the cells of each name the first that was followed from birth to division, or else the first.
    fn used_lives(&self) -> HashMap<&str, usize> {
        let mut used: HashMap<&str, usize> = HashMap::new();
        for (index, cell) in self.cells.iter().enumerate() {
            let known = used.entry(&cell.name).or_insert(index);
            if cell.lifetime().is_some() && self.cells[*known].lifetime().is_none() {
                *known = index;
            }
        }
        used
    }
}
