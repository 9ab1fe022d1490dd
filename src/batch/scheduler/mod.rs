//! Grows trees of divisions on all cores: whatever can be solved is solved, the longest expected work first.
//!
//! One coordinating thread, the caller's, owns the tree; a rayon pool of [`SchedulerOptions::threads`] workers solves.
//! A cell whose division is known costs a look-up and never sees the pool. A cell whose division is being solved, by
//! this tree, another tree or another process, waits as an entry in a list; no thread waits for it.

use std::{
    cmp::Ordering,
    collections::{BinaryHeap, HashMap, VecDeque, hash_map},
    panic::{AssertUnwindSafe, catch_unwind},
    sync::{
        atomic::{AtomicBool, Ordering as Memory},
        mpsc::{Receiver, RecvTimeoutError, Sender, channel},
    },
    time::{Duration, Instant},
};

use super::{
    key::Key,
    memo::{Failure, Memo, News, Notice, PrefixMap, Request, Ticket, Turn},
    store::{Claim, Store},
};
use crate::division::{Division, DivisionError, DivisionInput};

/// One cell to divide.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Job {
    /// The caller's name for the cell.
    pub cell: usize,
    /// Its division.
    pub input: DivisionInput,
}

/// How to run.
#[derive(Clone, Copy)]
pub struct SchedulerOptions<'a> {
    /// Divisions solved at once; 0 is one for each core.
    pub threads: usize,
    /// Set to true (by Ctrl-C, say) to stop: divisions being solved are finished and kept, no other is begun.
    pub interrupt: Option<&'a AtomicBool>,
    /// Told of every change in the number of divisions solved or running, and now and then of memo hits.
    pub progress: Option<&'a dyn Fn(Progress)>,
    /// Work expected of a cell and of what it holds up, in any unit; the largest is begun first. Affects the order of
    /// work and so its duration, never a result.
    pub expected_work: &'a dyn Fn(&DivisionInput) -> f64,
}

impl Default for SchedulerOptions<'_> {
    fn default() -> Self {
        SchedulerOptions { threads: 0, interrupt: None, progress: None, expected_work: &expected_work }
    }
}

impl std::fmt::Debug for SchedulerOptions<'_> {
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
    /// Divisions solved by this run.
    pub solved: usize,
    /// Divisions being solved now.
    pub running: usize,
    /// Divisions waiting for a worker.
    pub queued: usize,
    /// Cells whose division was already known, or solved for another cell.
    pub memo_hits: usize,
}

/// What a run did.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Summary {
    /// Cells whose division became known: `divisions_solved + memo_hits`.
    pub cells: usize,
    /// Divisions solved by this run.
    pub divisions_solved: usize,
    /// Cells that needed no solving of their own.
    pub memo_hits: usize,
    /// Distinct divisions of this run that came from the store.
    pub store_hits: usize,
    /// Damaged entries of the store, whose divisions were solved again if they were needed.
    pub corrupt: usize,
    /// Whether the run was stopped before its tree was complete.
    pub interrupted: bool,
    /// Largest relative shift of a cell's R0 by quantisation.
    pub max_r0_shift: f64,
    /// Estimated effect of that shift on χ: the steepest slope |Δχ/Δln R0| between neighbouring radii of this run (same
    /// parameters and cue, both divided) times the largest shift.
    pub chi_effect: f64,
    /// What the user should know, such as a store that could not be written.
    pub warnings: Vec<String>,
}

/// Why a run gave no complete tree.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SchedulerError {
    /// A division could not be computed. All others were, and are kept.
    #[error("cell {cell} (R0 = {r0}): {failure}")]
    Division {
        /// The caller's name for the cell; the one with the largest R0 if there are several.
        cell: usize,
        /// Its radius R0.
        r0: f64,
        /// What went wrong.
        failure: Failure,
        /// Cells without a result of their own, this one included; what would have followed from them is not counted.
        failed_cells: usize,
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

/// Expected work of a cell and the longest chain of divisions below it, in units of a symmetric division.
///
/// Large cells halve. Below the asymmetric window's upper edge a division costs two to three times as much and leaves a
/// daughter hardly smaller than its mother, so that the chains through the window are the longest: what leads there is
/// to be begun first. The radii are those of the preset `gao2026`; with other parameters the order of work may be less
/// good, and the results are the same.
pub fn expected_work(input: &DivisionInput) -> f64 {
    /// Below this a cell comes to rest undivided.
    const CRITICAL: f64 = 1.7;
    const WINDOW_EDGE: f64 = 2.25;
    /// Work of a division in the window.
    const SLOW: f64 = 2.5;
    /// Radius of half the volume, ½^{1/3}.
    const HALF: f64 = 0.793_700_525_984_099_7;
    /// Radius of the larger daughter at χ = 0.8, 0.9^{1/3}.
    const LARGER: f64 = 0.965_489_384_605_629_7;
    let mut work = 1.0;
    let mut r0 = input.r0;
    // Far more divisions than any chain has; infinite radii end too.
    for _ in 0..64 {
        if r0.is_nan() || r0 < CRITICAL {
            break;
        }
        let slow = r0 < WINDOW_EDGE;
        work += if slow { SLOW } else { 1.0 };
        r0 *= if slow { LARGER } else { HALF };
    }
    work
}

/// Grows the tree that starts with `roots`: solves every cell's division, each distinct one once, and lets `expand` say
/// which cells follow from it.
///
/// `solve` is called on the workers with R0 quantised; `expand` on the calling thread with the cell and its division,
/// whose daughters are scaled to the cell's own R0, so that volumes are kept exactly. The order in which cells are
/// expanded depends on timing; a tree is the same every time if what `expand` returns depends on its arguments alone.
///
/// An interrupted run returns what it did with [`Summary::interrupted`] set.
///
/// # Errors
/// [`SchedulerError::Division`] if a division failed, after all others are done. [`SchedulerError::Pool`] if no threads
/// can be started.
pub fn run<S, X>(
    roots: Vec<Job>,
    memo: &Memo,
    options: &SchedulerOptions<'_>,
    solve: S,
    mut expand: X,
) -> Result<Summary, SchedulerError>
where
    S: Fn(&DivisionInput) -> Result<Division, DivisionError> + Sync,
    X: FnMut(usize, &Division) -> Vec<Job>,
{
    let threads = match options.threads {
        0 => std::thread::available_parallelism().map_or(1, usize::from),
        threads => threads,
    };
    let (sender, notices) = channel();
    let mut run = Run::new(roots, memo, options, sender);
    // A tree that needs no solving needs no threads either.
    run.settle_known(&mut expand);
    if run.is_incomplete() {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .thread_name(|index| format!("division-{index}"))
            .build()
            .map_err(|error| SchedulerError::Pool { threads, reason: error.to_string() })?;
        pool.in_place_scope(|scope| {
            run.work(&notices, threads, &mut expand, |task: Task<'_>| {
                let solve = &solve;
                scope.spawn(move |_| task.solve(solve));
            });
        });
    }
    run.finish()
}

/// A division for a worker.
struct Task<'m> {
    input: DivisionInput,
    ticket: Ticket<'m>,
    /// Keeps other processes from solving the same.
    claim: Option<Claim>,
}

impl Task<'_> {
    fn solve(self, solve: &impl Fn(&DivisionInput) -> Result<Division, DivisionError>) {
        // A panic must not take the pool, and with it the process, down: it would lose what the others solve.
        match catch_unwind(AssertUnwindSafe(|| solve(&self.input))) {
            Ok(Ok(division)) => self.ticket.solved(division),
            Ok(Err(error)) => self.ticket.failed(Failure::Division(error)),
            Err(payload) => self.ticket.failed(Failure::Panicked(panic_text(payload.as_ref()))),
        }
        // Only now: whoever gets the claim next finds the division in the store.
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

/// A division in the queue, ordered by expected work, then by radius and age.
struct Queued<'m> {
    work: f64,
    age: usize,
    input: DivisionInput,
    ticket: Ticket<'m>,
    /// When another process was first found at it.
    busy_since: Option<Instant>,
}

impl Ord for Queued<'_> {
    fn cmp(&self, other: &Self) -> Ordering {
        self.work
            .total_cmp(&other.work)
            .then_with(|| self.input.r0.total_cmp(&other.input.r0))
            .then_with(|| other.age.cmp(&self.age))
    }
}

impl PartialOrd for Queued<'_> {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Queued<'_> {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Queued<'_> {}

type KeyMap<V> = HashMap<Key, V, PrefixMap>;

/// The cells that wait for one key.
#[derive(Default)]
struct Awaited {
    /// Whether one of this run's workers is at it.
    running: bool,
    cells: Vec<Waiting>,
}

#[derive(Clone, Copy)]
struct Waiting {
    cell: usize,
    /// The cell's input before quantisation.
    input: DivisionInput,
}

/// One division as a point of χ over R0, for the effect of quantisation.
#[derive(Clone, Copy)]
struct Sample {
    /// Key of the same input without its R0.
    family: Key,
    r0: f64,
    chi: f64,
}

struct Run<'a, 'm> {
    memo: &'m Memo,
    options: &'a SchedulerOptions<'a>,
    sender: Sender<Notice>,
    /// Cells not looked up yet.
    arrived: VecDeque<Job>,
    /// Divisions that wait for a worker.
    ready: BinaryHeap<Queued<'m>>,
    /// Divisions that another process is at; looked at again after the next pause.
    busy: Vec<Queued<'m>>,
    waiting: KeyMap<Awaited>,
    /// Failures of this run: a second cell with the same division is not tried again.
    failed: KeyMap<Failure>,
    samples: KeyMap<Sample>,
    running: usize,
    queued_ever: usize,
    worst: Option<(DivisionInput, usize, Failure)>,
    failed_cells: usize,
    summary: Summary,
}

impl<'a, 'm> Run<'a, 'm> {
    fn new(roots: Vec<Job>, memo: &'m Memo, options: &'a SchedulerOptions<'a>, sender: Sender<Notice>) -> Self {
        Run {
            memo,
            options,
            sender,
            arrived: roots.into(),
            ready: BinaryHeap::new(),
            busy: Vec::new(),
            waiting: KeyMap::default(),
            failed: KeyMap::default(),
            samples: KeyMap::default(),
            running: 0,
            queued_ever: 0,
            worst: None,
            failed_cells: 0,
            summary: Summary::default(),
        }
    }

    fn interrupted(&self) -> bool {
        self.options.interrupt.is_some_and(|flag| flag.load(Memory::Relaxed))
    }

    /// Whether cells are left that no worker of this run is at.
    fn is_incomplete(&self) -> bool {
        !self.arrived.is_empty() || self.waiting.values().any(|awaited| !awaited.running)
    }

    /// Until nothing is left: looks up, starts tasks with `spawn`, and takes in what comes back.
    fn work<X>(&mut self, notices: &Receiver<Notice>, threads: usize, expand: &mut X, mut spawn: impl FnMut(Task<'m>))
    where
        X: FnMut(usize, &Division) -> Vec<Job>,
    {
        /// How late an interrupt may be noticed.
        const TICK: Duration = Duration::from_millis(20);
        /// How often another process is asked whether it is done.
        const BUSY_TICK: Duration = Duration::from_millis(5);
        loop {
            self.settle_known(expand);
            if self.interrupted() {
                self.summary.interrupted |= self.is_incomplete();
                self.arrived.clear();
                // The dropped tickets let other trees on the same memo take these divisions over.
                self.ready.clear();
                self.busy.clear();
                self.waiting.retain(|_, awaited| awaited.running);
            }
            while self.running < threads
                && let Some(queued) = self.ready.pop()
            {
                if let Some(task) = self.claim(queued) {
                    self.running += 1;
                    self.waiting.entry(task.ticket.key()).or_default().running = true;
                    self.report();
                    spawn(task);
                }
            }
            if self.waiting.is_empty() {
                return;
            }
            let tick = if self.busy.is_empty() { TICK } else { BUSY_TICK };
            self.ready.extend(self.busy.drain(..));
            match notices.recv_timeout(tick) {
                Ok(notice) => self.take_in(notice, expand),
                Err(RecvTimeoutError::Timeout) => {}
                // Cannot be, as `self` holds a sender.
                Err(RecvTimeoutError::Disconnected) => return,
            }
            while let Ok(notice) = notices.try_recv() {
                self.take_in(notice, expand);
            }
        }
    }

    /// Makes a queued division a task, unless another process has solved it or is at it.
    fn claim(&mut self, queued: Queued<'m>) -> Option<Task<'m>> {
        let Queued { work, age, input, ticket, busy_since } = queued;
        let patience = self.memo.store().map_or(Duration::ZERO, Store::patience);
        let insist = busy_since.is_some_and(|since| since.elapsed() > patience);
        match ticket.claim(insist) {
            Turn::Solve(ticket, claim) => Some(Task { input, ticket, claim }),
            Turn::Stored => None,
            Turn::Busy(ticket) => {
                let busy_since = busy_since.or_else(|| Some(Instant::now()));
                self.busy.push(Queued { work, age, input, ticket, busy_since });
                None
            }
        }
    }

    /// Looks up every cell that has arrived, and those that follow from the ones known, until all that is left waits.
    fn settle_known<X>(&mut self, expand: &mut X)
    where
        X: FnMut(usize, &Division) -> Vec<Job>,
    {
        while !self.interrupted()
            && let Some(Job { cell, input }) = self.arrived.pop_front()
        {
            let canonical = self.memo.canonical(&input);
            if input.r0 > 0.0 {
                self.summary.max_r0_shift = self.summary.max_r0_shift.max((canonical.r0 / input.r0 - 1.0).abs());
            }
            let key = self.memo.key(&canonical);
            let waiting = Waiting { cell, input };
            if let Some(failure) = self.failed.get(&key) {
                let failure = failure.clone();
                self.fail(waiting, &failure);
                continue;
            }
            if let Some(awaited) = self.waiting.get_mut(&key) {
                awaited.cells.push(waiting);
                continue;
            }
            match self.memo.request(key, &self.sender) {
                Request::Known(division) => {
                    self.summary.memo_hits += 1;
                    self.deliver(key, waiting, &canonical, &division, expand);
                }
                Request::Stored(division) => {
                    self.summary.memo_hits += 1;
                    self.summary.store_hits += 1;
                    self.deliver(key, waiting, &canonical, &division, expand);
                }
                Request::Pending => {
                    self.waiting.entry(key).or_default().cells.push(waiting);
                }
                Request::Yours(ticket) => {
                    self.waiting.entry(key).or_default().cells.push(waiting);
                    self.queued_ever += 1;
                    let work = (self.options.expected_work)(&canonical);
                    let age = self.queued_ever;
                    self.ready.push(Queued { work, age, input: canonical, ticket, busy_since: None });
                }
            }
        }
    }

    fn take_in<X>(&mut self, notice: Notice, expand: &mut X)
    where
        X: FnMut(usize, &Division) -> Vec<Job>,
    {
        let Notice { key, news } = notice;
        // Nothing waits if an interrupt has let go of it.
        let Some(Awaited { running, cells }) = self.waiting.remove(&key) else { return };
        if running {
            self.running -= 1;
        }
        match news {
            News::Solved(division) => {
                self.summary.divisions_solved += usize::from(running);
                self.summary.memo_hits += cells.len() - usize::from(running);
                self.deliver_all(key, cells, &division, expand);
            }
            News::Stored(division) => {
                self.summary.store_hits += 1;
                self.summary.memo_hits += cells.len();
                self.deliver_all(key, cells, &division, expand);
            }
            News::Failed(failure) => {
                for &waiting in &cells {
                    self.fail(waiting, &failure);
                }
                self.failed.insert(key, failure);
            }
            News::Abandoned => {
                self.arrived.extend(cells.into_iter().map(|Waiting { cell, input }| Job { cell, input }));
            }
        }
        self.report();
    }

    fn deliver_all<X>(&mut self, key: Key, cells: Vec<Waiting>, division: &Division, expand: &mut X)
    where
        X: FnMut(usize, &Division) -> Vec<Job>,
    {
        for waiting in cells {
            let canonical = self.memo.canonical(&waiting.input);
            self.deliver(key, waiting, &canonical, division, expand);
        }
    }

    fn deliver<X>(&mut self, key: Key, waiting: Waiting, canonical: &DivisionInput, division: &Division, expand: &mut X)
    where
        X: FnMut(usize, &Division) -> Vec<Job>,
    {
        self.summary.cells += 1;
        if let Some(chi) = division.chi
            && let hash_map::Entry::Vacant(vacant) = self.samples.entry(key)
        {
            let family = self.memo.key(&DivisionInput { r0: 0.0, ..*canonical });
            vacant.insert(Sample { family, r0: canonical.r0, chi });
        }
        let scale = waiting.input.r0 / canonical.r0;
        let children = if scale == 1.0 {
            expand(waiting.cell, division)
        } else {
            let daughters = division.daughters.map(|radii| radii.map(|r0| r0 * scale));
            expand(waiting.cell, &Division { daughters, ..division.clone() })
        };
        self.arrived.extend(children);
        if self.summary.cells.is_multiple_of(1024) {
            self.report();
        }
    }

    fn fail(&mut self, Waiting { cell, input }: Waiting, failure: &Failure) {
        self.failed_cells += 1;
        // Which of several is named must not depend on which came first.
        let worse = self.worst.as_ref().is_none_or(|(worst, worst_cell, _)| {
            worst.r0.total_cmp(&input.r0).then_with(|| cell.cmp(worst_cell)) == Ordering::Less
        });
        if worse {
            self.worst = Some((input, cell, failure.clone()));
        }
    }

    fn report(&self) {
        if let Some(progress) = self.options.progress {
            progress(Progress {
                solved: self.summary.divisions_solved,
                running: self.running,
                queued: self.ready.len(),
                memo_hits: self.summary.memo_hits,
            });
        }
    }

    fn finish(mut self) -> Result<Summary, SchedulerError> {
        self.summary.interrupted |= self.is_incomplete();
        self.report();
        if let Some(store) = self.memo.store() {
            self.summary.corrupt = store.damaged();
            self.summary.warnings = store.take_warnings();
        }
        if let Some((input, cell, failure)) = self.worst {
            return Err(SchedulerError::Division { cell, r0: input.r0, failure, failed_cells: self.failed_cells });
        }
        self.summary.chi_effect = steepest_slope(self.samples.into_values().collect()) * self.summary.max_r0_shift;
        Ok(self.summary)
    }
}

/// Largest |Δχ/Δln R0| between neighbouring radii of one family; 0 if there are none.
fn steepest_slope(mut samples: Vec<Sample>) -> f64 {
    samples.sort_by(|a, b| a.family.cmp(&b.family).then_with(|| a.r0.total_cmp(&b.r0)));
    samples
        .windows(2)
        .filter(|pair| pair[0].family == pair[1].family && pair[0].r0 < pair[1].r0)
        .map(|pair| ((pair[1].chi - pair[0].chi) / (pair[1].r0 / pair[0].r0).ln()).abs())
        .fold(0.0, f64::max)
}

#[cfg(test)]
mod tests;
