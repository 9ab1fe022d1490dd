//! Lifetimes of followed cells.

use std::collections::HashSet;

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
        let mut seen = HashSet::new();
        for cell in &self.cells {
            let Some(mean) = cell.lifetime() else { continue };
            let (name, birth) = (cell.name.clone(), Some(cell.birth));
            let why = match names.founder(&name) {
                None => names.unknown(),
                Some(_) if !seen.insert(name.clone()) => "a second cell of this name",
                Some(founder) => {
                    let founder = founder.to_owned();
                    found.cells.push(Lifetime { cell: name, founder, n: 1, mean, sd: None, birth });
                    continue;
                }
            };
            note(&mut found.skipped, &mut found.skipped_count, || cell.unused(why));
        }
        Ok(found)
    }
}
