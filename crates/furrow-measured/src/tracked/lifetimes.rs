//! Lifetimes of followed cells.

use std::collections::HashSet;

use furrow_input::InputError;

use super::{TimeUnit, TrackedLineage};
use crate::lifetimes::{Lifetime, Lifetimes};
use crate::names::Names;
use crate::volumes::note;

impl TrackedLineage {
    /// The lifetimes of the cells that were followed from birth to division; those with other than these names are skipped. Errors
    /// name the embryo's file `file`.
    ///
    /// # Errors
    /// Times are in frames of unknown length, or no cell was followed from birth to division.
    pub fn lifetimes(&self, file: &str, names: &Names) -> Result<Lifetimes, InputError> {
        if self.time == TimeUnit::Frames {
            let allowed = "given: the minutes from one frame to the next, since the file counts frames";
            return Err(InputError::not_allowed("--frame-minutes", "frame_minutes", "(not given)", allowed));
        }
        let mut found =
            Lifetimes { skipped: self.skipped.clone(), skipped_count: self.skipped_count, ..Lifetimes::default() };
        found.matched.extend(self.matched.clone());
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
        found.used = found.cells.len() as u64;
        found.names = names.clone();
        let first = found
            .skipped
            .first()
            .map_or(String::new(), |first| format!(" (the first of {} skipped: {first})", found.skipped_count));
        let why =
            format!("at least one cell with a known name that was followed from its birth to its division{first}");
        InputError::require(found.used > 0, file, "cells", self.cells.len(), why)?;
        Ok(found)
    }
}
