//! Solves divisions and the divisions that follow from them on all cores; those with the most expected work come first.
//!
//! The caller's thread coordinates the dependencies; a rayon pool of [`SchedulerOptions::threads`] workers solves the
//! divisions. A known division costs only a look-up on the coordinating thread. A division in progress, in this run or
//! another, is an entry in a list of waiting jobs; no thread blocks on it.

mod effect;
mod run;

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Mutex, PoisonError, atomic::AtomicBool, mpsc::channel};

use rayon::prelude::*;

use self::run::{Assignment, Run};
use super::memo::{Event, Failure, Memo, Solve};
use super::store::StoreWarning;
use furrow_input::rounded_number;
use furrow_mechanics::division::{Division, DivisionInput};

/// One division to solve.
#[derive(Clone, Debug, PartialEq)]
pub struct Job {
    /// The caller's number for it.
    pub id: usize,
    /// Its input.
    pub input: DivisionInput,
}

/// Work other than a division.
pub(crate) type Work<'s> = Box<dyn FnOnce() + Send + 's>;

/// The next step of a run.
// Few steps exist at a time, and boxing would require an allocation for each division.
#[allow(clippy::large_enum_variant)]
pub(crate) enum Step<'s, S = Job> {
    /// Solves a division.
    Solve(S),
    /// Does some work on a worker, then requests the jobs that follow from the job of that number.
    Prepare(usize, Work<'s>),
}

/// Options of a run.
#[derive(Clone, Copy)]
pub struct SchedulerOptions<'a> {
    /// Divisions solved at once; 0 is one for each core.
    pub threads: usize,
    /// Set to true (for example by Ctrl-C) to stop: divisions in progress are finished and kept, and no others are started.
    pub interrupt: Option<&'a AtomicBool>,
    /// Called at every change of the number of solved or running divisions, and occasionally at memo hits.
    pub progress: Option<&'a dyn Fn(Progress)>,
    /// Expected work of a division and of the divisions that wait for it, in any unit; the largest is started first. The default is
    /// the radius. It affects the order and thus the duration of the work, but not the results.
    pub expected_work: &'a dyn Fn(&DivisionInput) -> f64,
}

impl Default for SchedulerOptions<'_> {
    fn default() -> Self {
        SchedulerOptions { threads: 0, interrupt: None, progress: None, expected_work: &|input| input.cell.r0 }
    }
}

/// The progress of a run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Progress {
    /// Divisions solved by this run.
    pub solved: usize,
    /// Divisions being solved now.
    pub running: usize,
    /// Divisions waiting for a worker.
    pub queued: usize,
    /// Jobs for which the division was already known, or was solved for another job.
    pub memo_hits: usize,
}

/// Counts and warnings of a run.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Summary {
    /// Jobs done: `solved + memo_hits`.
    pub jobs: usize,
    /// Divisions solved by this run.
    pub solved: usize,
    /// Jobs for which the division was already known, or was solved for another job.
    pub memo_hits: usize,
    /// Distinct divisions of this run that came from the store.
    pub store_hits: usize,
    /// Damaged entries of the store that this run found and solved again.
    pub corrupt: usize,
    /// Whether the run was stopped before all jobs were done.
    pub interrupted: bool,
    /// Largest relative shift of a radius by rounding.
    pub max_size_shift: f64,
    /// Estimated effect of that shift on χ: the largest shift times the steepest slope of χ over ln R0 between neighbouring radii
    /// of this run with otherwise equal inputs.
    pub shift_effect: f64,
    /// Jobs with a [second neck](Division::second_neck) in their division.
    pub three_parts: usize,
    /// Warnings for the user, for example about a store that could not be written.
    pub warnings: Vec<StoreWarning>,
}

impl Summary {
    /// Adds the summary of a later run.
    pub fn add(&mut self, later: Summary) {
        self.jobs += later.jobs;
        self.solved += later.solved;
        self.memo_hits += later.memo_hits;
        self.store_hits += later.store_hits;
        self.corrupt += later.corrupt;
        self.interrupted |= later.interrupted;
        self.max_size_shift = self.max_size_shift.max(later.max_size_shift);
        self.shift_effect = self.shift_effect.max(later.shift_effect);
        self.three_parts += later.three_parts;
        self.warnings.extend(later.warnings);
    }

    /// Warnings of the run and of its divisions.
    pub fn described(&self) -> impl Iterator<Item = String> {
        let count = match self.three_parts {
            1 => "1 division has".to_owned(),
            count => format!("{count} divisions have"),
        };
        let three_parts = (self.three_parts > 0).then(|| {
            format!(
                "{count} a second neck that is nearly closed when the first one closes: the cell falls into three parts, and χ and the \
                 daughters are those of the first neck (divide shows both)"
            )
        });
        self.warnings.iter().map(StoreWarning::to_string).chain(three_parts)
    }
}

/// A job without a division.
#[derive(Clone, Debug, PartialEq)]
pub struct Unsolved {
    /// The caller's number for it.
    pub id: usize,
    /// Its radius, not rounded.
    pub r0: f64,
    /// The reason.
    pub failure: Failure,
}

fn unsolved_text(jobs: &[Unsolved]) -> String {
    let [Unsolved { id, r0, failure }, others @ ..] = jobs else { return String::new() };
    let further = |n: usize| if n > 0 { format!(" ({n} further divisions failed)") } else { String::new() };
    format!("division {id} (R0 = {}): {failure}{}", rounded_number(*r0, 7), further(others.len()))
}

/// The result of a run.
pub type Result<T, E = SchedulerError> = std::result::Result<T, E>;

/// The reason why a run is incomplete.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SchedulerError {
    /// Some divisions could not be solved. All others were solved and are stored.
    #[error("{}", unsolved_text(.jobs))]
    Unsolved {
        /// The jobs without a division (at least one), the largest first; jobs that would have followed from them are not counted.
        jobs: Vec<Unsolved>,
        /// The summary of the run.
        summary: Box<Summary>,
    },
    /// The workers could not be started.
    #[error("cannot start {threads} worker threads: {reason}")]
    Pool {
        /// The requested number of threads.
        threads: usize,
        /// The system's error message.
        reason: String,
    },
}

/// Solves `jobs` and all jobs that follow from them, each distinct division once. `expand` returns the jobs that follow from one.
///
/// `solve` is called on the workers with rounded radii; `expand` is called on the calling thread with the job's
/// number and its division, scaled to the job's own radius. The order in which jobs are expanded depends on timing; the
/// result does not, provided that `expand` depends only on its arguments.
///
/// An interrupted run returns its summary so far, with [`Summary::interrupted`] set.
///
/// # Errors
/// [`SchedulerError::Unsolved`] if a division failed, after all others are done. [`SchedulerError::Pool`] if no threads
/// can be started.
pub fn run(
    jobs: Vec<Job>,
    memo: &Memo,
    options: &SchedulerOptions<'_>,
    solve: impl Solve,
    mut expand: impl FnMut(usize, &Division) -> Vec<Job>,
) -> Result<Summary> {
    let steps = |jobs: Vec<Job>| jobs.into_iter().map(Step::Solve).collect();
    let mut expand =
        |id: usize, division: Option<&Division>| division.map_or(vec![], |division| steps(expand(id, division)));
    run_steps(steps(jobs), memo, options, solve, &mut expand)
}

/// As [`run`], but some jobs require preparation on a worker: after a [`Step::Prepare`], `expand` is called without a
/// division.
///
/// # Errors
/// As [`run`].
pub(crate) fn run_steps<'s>(
    steps: Vec<Step<'s>>,
    memo: &Memo,
    options: &SchedulerOptions<'_>,
    solve: impl Solve,
    expand: &mut dyn FnMut(usize, Option<&Division>) -> Vec<Step<'s>>,
) -> Result<Summary> {
    let (sender, events) = channel();
    let mut run = Run::new(steps, memo, options, sender.clone(), expand);
    let perform = |task: Step<'_, Assignment<'_>>| match task {
        Step::Solve(assignment) => assignment.lease.solve(&assignment.input, &solve),
        Step::Prepare(id, work) => {
            // A panic must not block the run. If the preparation failed, the division is computed.
            let _ = catch_unwind(AssertUnwindSafe(work));
            let _ = sender.send(Event::Prepared(id));
        }
    };
    // Threads are needed only if a division must be solved.
    run.settle_known();
    // A caller that is itself a worker, as in studies of many trees, must not wait for a separate pool: while waiting it would start
    // another tree, and so on until its stack overflows. The page has no threads.
    let alone = cfg!(target_family = "wasm") || options.threads == 1 && rayon::current_thread_index().is_some();
    if run.is_incomplete() && alone {
        run.work(&events, 1, perform);
    } else if run.is_incomplete() {
        let threads = workers(options.threads);
        pool(threads)?.in_place_scope(|scope| {
            let perform = &perform;
            run.work(&events, threads, |task| scope.spawn(move |_| perform(task)));
        });
    }
    run.finish()
}

/// Independent divisions.
#[derive(Clone, Debug, PartialEq)]
pub struct Solved {
    /// One result per input; `None` if it failed or the run was interrupted.
    pub divisions: Vec<Option<Division>>,
    /// Unsolved divisions, by the index of their input.
    pub unsolved: Vec<Unsolved>,
    /// The summary of the run.
    pub summary: Summary,
}

/// Solves each of `inputs`, as [`run`] does.
///
/// # Errors
/// [`SchedulerError::Pool`] if no threads can be started.
pub fn solve_all(
    inputs: impl IntoIterator<Item = DivisionInput>,
    memo: &Memo,
    options: &SchedulerOptions<'_>,
    solve: impl Solve,
) -> Result<Solved> {
    let jobs: Vec<Job> = inputs.into_iter().enumerate().map(|(id, input)| Job { id, input }).collect();
    let mut divisions = vec![None; jobs.len()];
    let run = run(jobs, memo, options, solve, |id, division| {
        divisions[id] = Some(division.clone());
        vec![]
    });
    let (summary, unsolved) = parts(run)?;
    Ok(Solved { divisions, unsolved, summary })
}

/// The summary of a run, and the jobs that it could not solve.
pub(crate) fn parts(run: Result<Summary>) -> Result<(Summary, Vec<Unsolved>)> {
    match run {
        Ok(summary) => Ok((summary, vec![])),
        Err(SchedulerError::Unsolved { jobs, summary }) => Ok((*summary, jobs)),
        Err(error) => Err(error),
    }
}

/// The number of workers for a requested number of threads; 0 is one per core.
pub fn workers(threads: usize) -> usize {
    if threads > 0 { threads } else { std::thread::available_parallelism().map_or(1, usize::from) }
}

/// Limits the threads for curves, spectra and other work outside a pool of workers, for the rest of the process. It has no effect
/// once such work has started.
pub fn bound_threads(threads: usize) {
    // Only a second call fails.
    let _ = rayon::ThreadPoolBuilder::new().num_threads(threads).build_global();
}

/// The workers of a run.
///
/// # Errors
/// [`SchedulerError::Pool`] if the threads cannot be started.
pub fn pool(threads: usize) -> Result<rayon::ThreadPool> {
    let threads = workers(threads);
    rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .thread_name(|index| format!("solver-{index}"))
        .build()
        .map_err(|error| SchedulerError::Pool { threads, reason: error.to_string() })
}

/// Calls `of` with each number below `count` on the workers of the current pool and returns the results in order. Each call
/// should take a millisecond or more. All callers share one compiled loop, which keeps the program small.
pub fn in_parallel<U: Send>(count: usize, of: impl Fn(usize) -> U + Sync) -> Vec<U> {
    let results: Vec<Mutex<Option<U>>> = (0..count).map(|_| Mutex::new(None)).collect();
    for_each_number(count, &|k| {
        let result = of(k);
        *results[k].lock().unwrap_or_else(PoisonError::into_inner) = Some(result);
    });
    let result = |cell: Mutex<Option<U>>| cell.into_inner().unwrap_or_else(PoisonError::into_inner);
    results.into_iter().filter_map(result).collect()
}

fn for_each_number(count: usize, work: &(dyn Fn(usize) + Sync)) {
    (0..count).into_par_iter().with_max_len(1).for_each(work);
}

#[cfg(test)]
mod tests;
