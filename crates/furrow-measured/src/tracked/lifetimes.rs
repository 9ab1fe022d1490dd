//! Lifetimes of followed cells.

use std::collections::HashSet;

use furrow_input::InputError;

use super::{TimeUnit, TrackedLineage};
use crate::lifetimes::{Lifetime, Lifetimes};
use crate::names::founder;
use crate::volumes::{Skipped, note};

impl TrackedLineage {
    /// The lifetimes of the cells whose birth and division were seen. Errors name the embryo's file `file`.
    ///
    /// # Errors
    /// Times are in frames of unknown length, or no cell was followed from birth to division.
    pub fn lifetimes(&self, file: &str) -> Result<Lifetimes, InputError> {
        if self.time == TimeUnit::Frames {
            let allowed = "given: the minutes from one frame to the next, since the file counts frames";
            return Err(InputError::not_allowed("--frame-minutes", "frame_minutes", "(not given)", allowed));
        }
        let whole = |index: usize| {
            let cell = &self.cells[index];
            let founder = founder(&cell.name)?.to_owned();
            let (name, birth) = (cell.name.clone(), Some(cell.birth));
            Some((Lifetime { cell: name, founder, n: 1, mean: cell.lifetime()?, sd: None, birth }, &cell.place))
        };
        let mut found =
            Lifetimes { skipped: self.skipped.clone(), skipped_count: self.skipped_count, ..Lifetimes::default() };
        let mut names = HashSet::new();
        for lifetime in (0..self.cells.len()).filter_map(whole) {
            if names.insert(lifetime.0.cell.clone()) {
                found.cells.push(lifetime.0);
                continue;
            }
            let ((file, line), why) = (lifetime.1.clone(), "a second cell of this name".to_owned());
            let value = lifetime.0.cell;
            note(&mut found.skipped, &mut found.skipped_count, || Skipped {
                file,
                line,
                column: "name".to_owned(),
                value,
                why,
            });
        }
        found.used = found.cells.len() as u64;
        let why = "at least one cell with a name of Sulston's that was followed from its birth to its division";
        InputError::require(found.used > 0, file, "cells", self.cells.len(), why)?;
        Ok(found)
    }
}
