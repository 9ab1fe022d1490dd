//! What waits for a worker, and what a worker is given.

use std::{
    cmp::Ordering,
    panic::{AssertUnwindSafe, catch_unwind},
    time::{Duration, Instant},
};

use crate::batch::{
    memo::{Failure, Ticket, Turn},
    store::Claim,
    task::Task,
};

/// A task in the queue, ordered by expected work, then by size and age.
pub struct Queued<'m, T: Task> {
    /// Expected work; what has most of it is begun first.
    pub work: f64,
    /// Number in the order of arrival.
    pub age: usize,
    /// The task, its size rounded.
    pub task: T,
    /// The duty to solve it.
    pub ticket: Ticket<'m, T>,
    /// When another process was first found at it.
    pub busy_since: Option<Instant>,
}

/// What became of a queued task whose turn it was.
pub enum Next<'m, T: Task> {
    /// A worker is to solve it.
    Assigned(Assignment<'m, T>),
    /// Another process is at it.
    Busy(Queued<'m, T>),
    /// Another process has solved it; a notice says so.
    Stored,
}

impl<'m, T: Task> Queued<'m, T> {
    /// Asks for the task as far as other processes are concerned; one that has been at it for longer than `patience` is
    /// no longer waited for.
    pub fn claim(self, patience: Duration) -> Next<'m, T> {
        let Queued { work, age, task, ticket, busy_since } = self;
        let insist = busy_since.is_some_and(|since| since.elapsed() > patience);
        match ticket.claim(insist) {
            Turn::Solve(ticket, claim) => Next::Assigned(Assignment { task, ticket, claim }),
            Turn::Stored => Next::Stored,
            Turn::Busy(ticket) => {
                let busy_since = busy_since.or_else(|| Some(Instant::now()));
                Next::Busy(Queued { work, age, task, ticket, busy_since })
            }
        }
    }
}

impl<T: Task> Ord for Queued<'_, T> {
    fn cmp(&self, other: &Self) -> Ordering {
        self.work
            .total_cmp(&other.work)
            .then_with(|| self.task.size().total_cmp(&other.task.size()))
            .then_with(|| other.age.cmp(&self.age))
    }
}

impl<T: Task> PartialOrd for Queued<'_, T> {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl<T: Task> PartialEq for Queued<'_, T> {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl<T: Task> Eq for Queued<'_, T> {}

/// A task for a worker.
pub struct Assignment<'m, T: Task> {
    /// The task, its size rounded.
    pub task: T,
    /// The duty to solve it.
    pub ticket: Ticket<'m, T>,
    /// Keeps other processes from solving the same.
    claim: Option<Claim>,
}

impl<T: Task> Assignment<'_, T> {
    /// Solves it and hands in what comes of it.
    pub fn solve(self, solve: &impl Fn(&T) -> Result<T::Record, T::Error>) {
        // A panic must not take the pool, and with it the process, down: it would lose what the others solve.
        match catch_unwind(AssertUnwindSafe(|| solve(&self.task))) {
            Ok(Ok(record)) => self.ticket.solved(record),
            Ok(Err(error)) => self.ticket.failed(Failure::Unsolved(error)),
            Err(payload) => self.ticket.failed(Failure::Panicked(panic_text(payload.as_ref()))),
        }
        // Only now: whoever gets the claim next finds the record in the store.
        drop(self.claim);
    }
}

fn panic_text(payload: &(dyn std::any::Any + Send)) -> String {
    payload
        .downcast_ref::<&str>()
        .map(|text| (*text).to_owned())
        .or_else(|| payload.downcast_ref::<String>().cloned())
        .unwrap_or_else(|| "no message".to_owned())
}
