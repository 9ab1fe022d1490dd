//! Solves what is asked for, and what follows from it, on all cores: the most expected work first.
//!
//! One coordinating thread, the caller's, knows what follows from what; a rayon pool of [`SchedulerOptions::threads`]
//! workers solves. A task whose record is known costs a look-up and never sees the pool. A task that is being solved, by
//! this run, another run or another process, waits as an entry in a list; no thread waits for it.

mod effect;
mod queue;
mod run;

use std::sync::{atomic::AtomicBool, mpsc::channel};

use self::run::Run;
use super::{
    memo::{Failure, Memo},
    store::StoreWarning,
    task::Task,
};

/// One task to solve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Job<T> {
    /// The caller's number for it.
    pub id: usize,
    /// The task.
    pub task: T,
}

/// How to run.
pub struct SchedulerOptions<'a, T> {
    /// Tasks solved at once; 0 is one for each core.
    pub threads: usize,
    /// Set to true (by Ctrl-C, say) to stop: tasks being solved are finished and kept, no other is begun.
    pub interrupt: Option<&'a AtomicBool>,
    /// Told of every change in the number of tasks solved or running, and now and then of memo hits.
    pub progress: Option<&'a dyn Fn(Progress)>,
    /// Work expected of a task and of what it holds up, in any unit; the most is begun first. By default it is the size.
    /// Affects the order of work and so its duration, never a result.
    pub expected_work: &'a dyn Fn(&T) -> f64,
}

impl<T: Task> Default for SchedulerOptions<'_, T> {
    fn default() -> Self {
        SchedulerOptions { threads: 0, interrupt: None, progress: None, expected_work: &T::size }
    }
}

impl<T> Clone for SchedulerOptions<'_, T> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<T> Copy for SchedulerOptions<'_, T> {}

impl<T> std::fmt::Debug for SchedulerOptions<'_, T> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("SchedulerOptions")
            .field("threads", &self.threads)
            .field("interrupt", &self.interrupt)
            .finish_non_exhaustive()
    }
}

/// Where a run stands.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Progress {
    /// Tasks solved by this run.
    pub solved: usize,
    /// Tasks being solved now.
    pub running: usize,
    /// Tasks waiting for a worker.
    pub queued: usize,
    /// Jobs whose record was already known, or solved for another job.
    pub memo_hits: usize,
}

/// What a run did.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Summary {
    /// Jobs whose record became known: `solved + memo_hits`.
    pub jobs: usize,
    /// Tasks solved by this run.
    pub solved: usize,
    /// Jobs that needed no solving of their own.
    pub memo_hits: usize,
    /// Distinct records of this run that came from the store.
    pub store_hits: usize,
    /// Damaged entries of the store, whose tasks were solved again if they were needed.
    pub corrupt: usize,
    /// Whether the run was stopped before all was done.
    pub interrupted: bool,
    /// Largest relative shift of a size by rounding.
    pub max_size_shift: f64,
    /// Estimated effect of that shift on the records' response: its steepest slope over the logarithm of the size,
    /// between neighbouring sizes of this run whose tasks are otherwise the same, times the largest shift.
    pub shift_effect: f64,
    /// What the user should know, such as a store that could not be written.
    pub warnings: Vec<StoreWarning>,
}

/// A job without a record.
#[derive(Clone, Debug, PartialEq)]
pub struct Unsolved<E> {
    /// The caller's number for it.
    pub id: usize,
    /// Its size, not rounded.
    pub size: f64,
    /// What went wrong.
    pub failure: Failure<E>,
}

fn unsolved_text<E: std::fmt::Display>(jobs: &[Unsolved<E>]) -> String {
    match jobs {
        [] => "no task is unsolved".to_owned(),
        [Unsolved { id, size, failure }] => format!("task {id} (size {size}): {failure}"),
        [Unsolved { id, size, failure }, others @ ..] => {
            format!("task {id} (size {size}): {failure} ({} further tasks failed)", others.len())
        }
    }
}

/// Why a run is not complete.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SchedulerError<E: std::fmt::Display> {
    /// Tasks could not be solved. All others were, and are kept.
    #[error("{}", unsolved_text(.jobs))]
    Unsolved {
        /// The jobs without a record, the largest first; what would have followed from them is not counted. One or more.
        jobs: Vec<Unsolved<E>>,
        /// What the run did.
        summary: Box<Summary>,
    },
    /// The workers could not be started.
    #[error("cannot start {threads} worker threads: {reason}")]
    Pool {
        /// Threads asked for.
        threads: usize,
        /// What the system said.
        reason: String,
    },
}

/// Whether there are no threads to be had: the calling thread is the only worker then, and gets the same.
const THREADLESS: bool = cfg!(target_family = "wasm");

/// Solves `jobs` and all that follows from them: each distinct task once. `expand` says which jobs follow from one.
///
/// `solve` is called on the workers with tasks whose sizes are rounded; `expand` on the calling thread with the job's
/// number and its record, scaled to the job's own size. The order in which jobs are expanded depends on timing; the
/// whole is the same every time if what `expand` returns depends on its arguments alone.
///
/// An interrupted run returns what it did with [`Summary::interrupted`] set.
///
/// # Errors
/// [`SchedulerError::Unsolved`] if a task failed, after all others are done. [`SchedulerError::Pool`] if no threads can be
/// started.
pub fn run<T, S, X>(
    jobs: Vec<Job<T>>,
    memo: &Memo<T>,
    options: &SchedulerOptions<'_, T>,
    solve: S,
    mut expand: X,
) -> Result<Summary, SchedulerError<T::Error>>
where
    T: Task,
    S: Fn(&T) -> Result<T::Record, T::Error> + Sync,
    X: FnMut(usize, &T::Record) -> Vec<Job<T>>,
{
    let threads = workers(options.threads);
    let (sender, notices) = channel();
    let mut run = Run::new(jobs, memo, options, sender);
    // Where nothing needs solving no threads are needed either.
    run.settle_known(&mut expand);
    if run.is_incomplete() && THREADLESS {
        run.work(&notices, 1, &mut expand, |assignment| assignment.solve(&solve));
    } else if run.is_incomplete() {
        pool(threads)?.in_place_scope(|scope| {
            run.work(&notices, threads, &mut expand, |assignment| {
                let solve = &solve;
                scope.spawn(move |_| assignment.solve(solve));
            });
        });
    }
    run.finish()
}

/// How many workers a number of threads asks for: 0 is one for each core.
pub fn workers(threads: usize) -> usize {
    match threads {
        0 => std::thread::available_parallelism().map_or(1, usize::from),
        threads => threads,
    }
}

/// The workers of a run.
pub(crate) fn pool<E: std::fmt::Display>(threads: usize) -> Result<rayon::ThreadPool, SchedulerError<E>> {
    let threads = workers(threads);
    rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .thread_name(|index| format!("solver-{index}"))
        .build()
        .map_err(|error| SchedulerError::Pool { threads, reason: error.to_string() })
}

#[cfg(test)]
mod tests;
