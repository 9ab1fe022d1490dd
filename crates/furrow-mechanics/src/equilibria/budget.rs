//! The budget of a search among shapes, and its interruption.

use std::cell::Cell;
use std::sync::atomic::{AtomicBool, Ordering};

use super::error::{CellName, ShapeError};

/// The budget of a search, which ends when the budget is spent or when it is interrupted.
///
/// Work is counted in attempted steps along branches and curves, never in time: a search ends at the same point on
/// every machine, with the same consequences.
#[derive(Debug)]
pub struct StepBudget<'a> {
    most: usize,
    spent: Cell<usize>,
    interrupt: Option<&'a AtomicBool>,
}

impl<'a> StepBudget<'a> {
    /// At most the given number of steps, until the flag is set.
    pub fn new(most: usize, interrupt: Option<&'a AtomicBool>) -> StepBudget<'a> {
        StepBudget { most, spent: Cell::new(0), interrupt }
    }

    /// Without a limit.
    pub fn unlimited() -> StepBudget<'a> {
        StepBudget::new(usize::MAX, None)
    }

    /// The flag that ends the search.
    pub fn interrupt(&self) -> Option<&'a AtomicBool> {
        self.interrupt
    }

    /// Steps tried so far.
    pub fn spent(&self) -> usize {
        self.spent.get()
    }

    /// Counts attempted steps, and returns whether more may follow.
    pub(crate) fn spend(&self, steps: usize) -> bool {
        self.spent.set(self.spent.get().saturating_add(steps));
        self.spent.get() <= self.most && !self.is_interrupted()
    }

    fn is_interrupted(&self) -> bool {
        self.interrupt.is_some_and(|flag| flag.load(Ordering::Relaxed))
    }

    /// Checks that the search may continue.
    ///
    /// # Errors
    /// [`ShapeError::Interrupted`], [`ShapeError::OutOfBudget`].
    pub fn check(&self, cell: &furrow_cell::Cell) -> Result<(), ShapeError> {
        if self.is_interrupted() {
            return Err(ShapeError::Interrupted);
        }
        match self.spent.get() > self.most {
            true => Err(ShapeError::OutOfBudget { cell: CellName::of(cell), steps: self.most }),
            false => Ok(()),
        }
    }
}
