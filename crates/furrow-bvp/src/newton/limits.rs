//! What ends a solve before it converges or fails by itself.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// A switch that ends solves from another thread or from a signal handler. Its clones share it.
///
/// # Examples
/// ```
/// use furrow_bvp::Interrupt;
/// let interrupt = Interrupt::default();
/// interrupt.clone().set();
/// assert!(interrupt.is_set());
/// ```
#[derive(Clone, Debug, Default)]
pub struct Interrupt(Arc<AtomicBool>);

impl Interrupt {
    /// Ends the solves that have it in their settings, before their next factorisation.
    pub fn set(&self) {
        self.0.store(true, Ordering::Relaxed);
    }

    /// Whether it was set.
    pub fn is_set(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}

impl From<Arc<AtomicBool>> for Interrupt {
    fn from(flag: Arc<AtomicBool>) -> Self {
        Interrupt(flag)
    }
}

impl PartialEq for Interrupt {
    /// Whether it is the same switch.
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }
}

/// Why a solve was ended from outside.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Stop {
    /// The budget of work is spent.
    #[error("the budget of work is spent")]
    Budget,
    /// The [`Interrupt`] was set.
    #[error("interrupted")]
    Interrupted,
}

/// The work that is left: factorised intervals, without end by default.
#[derive(Clone, Debug)]
pub(crate) struct WorkLimit {
    left: f64,
    interrupt: Interrupt,
}

impl Default for WorkLimit {
    fn default() -> Self {
        WorkLimit { left: f64::INFINITY, interrupt: Interrupt::default() }
    }
}

impl WorkLimit {
    /// The budget for the given number of factorisations on a mesh with the given number of intervals.
    pub fn new(budget: f64, intervals: usize, interrupt: &Interrupt) -> WorkLimit {
        WorkLimit { left: budget * intervals as f64, interrupt: interrupt.clone() }
    }

    /// Takes the work of one factorisation off. An error if nothing was left for it.
    pub fn spend(&mut self, intervals: usize) -> Result<(), Stop> {
        if self.interrupt.is_set() {
            return Err(Stop::Interrupted);
        }
        if self.left <= 0.0 {
            return Err(Stop::Budget);
        }
        self.left -= intervals as f64;
        Ok(())
    }
}
