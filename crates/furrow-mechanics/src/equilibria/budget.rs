//! How much work a search among shapes may take, and whether it is still wanted.

use std::cell::Cell;
use std::sync::atomic::{AtomicBool, Ordering};

use super::error::{CellName, ShapeError};

/// The work that is left to a search, which is over when none is, or when it is interrupted.
///
/// Work is counted in steps tried along branches and curves, never in time: a search ends at the same point on every machine,
/// and what follows from it is the same.
#[derive(Debug)]
pub struct StepBudget<'a> {
    most: usize,
    spent: Cell<usize>,
    interrupt: Option<&'a AtomicBool>,
}

impl<'a> StepBudget<'a> {
    /// At most so many steps, until the flag is set.
    pub fn new(most: usize, interrupt: Option<&'a AtomicBool>) -> StepBudget<'a> {
        StepBudget { most, spent: Cell::new(0), interrupt }
    }

    /// As many as it takes.
    pub fn unlimited() -> StepBudget<'a> {
        StepBudget::new(usize::MAX, None)
    }

    /// Steps tried so far.
    pub fn spent(&self) -> usize {
        self.spent.get()
    }

    /// Counts steps tried, and says whether more may follow.
    pub(crate) fn spend(&self, steps: usize) -> bool {
        self.spent.set(self.spent.get().saturating_add(steps));
        self.spent.get() <= self.most && !self.is_interrupted()
    }

    fn is_interrupted(&self) -> bool {
        self.interrupt.is_some_and(|flag| flag.load(Ordering::Relaxed))
    }

    /// Goes on only with a search that may.
    ///
    /// # Errors
    /// [`ShapeError::Interrupted`], [`ShapeError::OutOfBudget`].
    pub(crate) fn check(&self, cell: &furrow_cell::Cell) -> Result<(), ShapeError> {
        if self.is_interrupted() {
            return Err(ShapeError::Interrupted);
        }
        match self.spent.get() > self.most {
            true => Err(ShapeError::OutOfBudget { cell: CellName::of(cell), steps: self.most }),
            false => Ok(()),
        }
    }
}
