//! One run: what has arrived, what waits, what is being solved, and what came of it.

use std::{
    collections::{BinaryHeap, VecDeque},
    sync::{
        atomic::Ordering as Memory,
        mpsc::{Receiver, RecvTimeoutError, Sender},
    },
    time::Duration,
};

use super::{
    Job, Progress, SchedulerError, SchedulerOptions, Summary, Unsolved,
    effect::Responses,
    queue::{Assignment, Next, Queued},
};
use crate::batch::{
    key::{Key, KeyMap},
    memo::{Failure, Memo, News, Notice, Request},
    store::Store,
    task::{Record, Task},
};

/// How late an interrupt may be noticed.
const TICK: Duration = Duration::from_millis(20);
/// How often another process is asked whether it is done.
const BUSY_TICK: Duration = Duration::from_millis(5);

/// The jobs that wait for one key.
struct Awaited<T> {
    /// Whether one of this run's workers is at it.
    running: bool,
    /// With their tasks before rounding.
    jobs: Vec<Job<T>>,
}

impl<T> Default for Awaited<T> {
    fn default() -> Self {
        Awaited { running: false, jobs: Vec::new() }
    }
}

pub struct Run<'a, 'm, T: Task> {
    memo: &'m Memo<T>,
    options: &'a SchedulerOptions<'a, T>,
    sender: Sender<Notice<T>>,
    /// Jobs not looked up yet.
    arrived: VecDeque<Job<T>>,
    /// Tasks that wait for a worker.
    ready: BinaryHeap<Queued<'m, T>>,
    /// Tasks that another process is at; looked at again after the next pause.
    busy: Vec<Queued<'m, T>>,
    waiting: KeyMap<Awaited<T>>,
    /// Failures of this run: a second job with the same task is not tried again.
    failed: KeyMap<Failure<T::Error>>,
    responses: Responses,
    running: usize,
    queued_ever: usize,
    unsolved: Vec<Unsolved<T::Error>>,
    summary: Summary,
}

impl<'a, 'm, T: Task> Run<'a, 'm, T> {
    pub fn new(
        jobs: Vec<Job<T>>,
        memo: &'m Memo<T>,
        options: &'a SchedulerOptions<'a, T>,
        sender: Sender<Notice<T>>,
    ) -> Self {
        Run {
            memo,
            options,
            sender,
            arrived: jobs.into(),
            ready: BinaryHeap::new(),
            busy: Vec::new(),
            waiting: KeyMap::default(),
            failed: KeyMap::default(),
            responses: Responses::default(),
            running: 0,
            queued_ever: 0,
            unsolved: Vec::new(),
            summary: Summary::default(),
        }
    }

    fn interrupted(&self) -> bool {
        self.options.interrupt.is_some_and(|flag| flag.load(Memory::Relaxed))
    }

    /// Whether jobs are left that no worker of this run is at.
    pub fn is_incomplete(&self) -> bool {
        !self.arrived.is_empty() || self.waiting.values().any(|awaited| !awaited.running)
    }

    /// Until nothing is left: looks up, hands tasks to workers with `spawn`, and takes in what comes back.
    pub fn work<X>(
        &mut self,
        notices: &Receiver<Notice<T>>,
        threads: usize,
        expand: &mut X,
        mut spawn: impl FnMut(Assignment<'m, T>),
    ) where
        X: FnMut(usize, &T::Record) -> Vec<Job<T>>,
    {
        loop {
            self.settle_known(expand);
            if self.interrupted() {
                self.let_go();
            }
            self.assign(threads, &mut spawn);
            if self.waiting.is_empty() {
                return;
            }
            let tick = if self.busy.is_empty() { TICK } else { BUSY_TICK };
            self.ready.extend(self.busy.drain(..));
            // Only who has to wait needs a clock, which is not to be had everywhere.
            match notices.try_recv().or_else(|_| notices.recv_timeout(tick)) {
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

    /// Gives up all that no worker is at.
    fn let_go(&mut self) {
        self.summary.interrupted |= self.is_incomplete();
        self.arrived.clear();
        // The dropped tickets let other runs on the same memo take these tasks over.
        self.ready.clear();
        self.busy.clear();
        self.waiting.retain(|_, awaited| awaited.running);
    }

    /// Gives every idle worker a task, unless another process has solved it or is at it.
    fn assign(&mut self, threads: usize, spawn: &mut impl FnMut(Assignment<'m, T>)) {
        let patience = self.memo.store().map_or(Duration::ZERO, Store::patience);
        while self.running < threads
            && let Some(queued) = self.ready.pop()
        {
            match queued.claim(patience) {
                Next::Assigned(assignment) => {
                    self.running += 1;
                    self.waiting.entry(assignment.ticket.key()).or_default().running = true;
                    self.report();
                    spawn(assignment);
                }
                Next::Busy(queued) => self.busy.push(queued),
                Next::Stored => {}
            }
        }
    }

    /// Looks up every job that has arrived, and those that follow from the ones known, until all that is left waits.
    pub fn settle_known<X>(&mut self, expand: &mut X)
    where
        X: FnMut(usize, &T::Record) -> Vec<Job<T>>,
    {
        while !self.interrupted()
            && let Some(job) = self.arrived.pop_front()
        {
            let canonical = self.memo.canonical(&job.task);
            self.note_shift(job.task.size(), canonical.size());
            let key = self.memo.key(&canonical);
            if let Some(failure) = self.failed.get(&key) {
                let failure = failure.clone();
                self.fail(&job, &failure);
                continue;
            }
            if let Some(awaited) = self.waiting.get_mut(&key) {
                awaited.jobs.push(job);
                continue;
            }
            match self.memo.request(key, &self.sender) {
                Request::Known(record) => {
                    self.summary.memo_hits += 1;
                    self.deliver(key, &job, &canonical, &record, expand);
                }
                Request::Stored(record) => {
                    self.summary.memo_hits += 1;
                    self.summary.store_hits += 1;
                    self.deliver(key, &job, &canonical, &record, expand);
                }
                Request::Pending => self.waiting.entry(key).or_default().jobs.push(job),
                Request::Yours(ticket) => {
                    self.waiting.entry(key).or_default().jobs.push(job);
                    self.queued_ever += 1;
                    let work = (self.options.expected_work)(&canonical);
                    let age = self.queued_ever;
                    self.ready.push(Queued { work, age, task: canonical, ticket, busy_since: None });
                }
            }
        }
    }

    fn note_shift(&mut self, size: f64, rounded: f64) {
        if size > 0.0 {
            self.summary.max_size_shift = self.summary.max_size_shift.max((rounded / size - 1.0).abs());
        }
    }

    fn take_in<X>(&mut self, notice: Notice<T>, expand: &mut X)
    where
        X: FnMut(usize, &T::Record) -> Vec<Job<T>>,
    {
        let Notice { key, news } = notice;
        // Nothing waits if an interrupt has let go of it.
        let Some(Awaited { running, jobs }) = self.waiting.remove(&key) else { return };
        if running {
            self.running -= 1;
        }
        match news {
            News::Solved(record) => {
                self.summary.solved += usize::from(running);
                self.summary.memo_hits += jobs.len() - usize::from(running);
                self.deliver_all(key, &jobs, &record, expand);
            }
            News::Stored(record) => {
                self.summary.store_hits += 1;
                self.summary.memo_hits += jobs.len();
                self.deliver_all(key, &jobs, &record, expand);
            }
            News::Failed(failure) => {
                for job in &jobs {
                    self.fail(job, &failure);
                }
                self.failed.insert(key, failure);
            }
            News::Abandoned => self.arrived.extend(jobs),
        }
        self.report();
    }

    fn deliver_all<X>(&mut self, key: Key, jobs: &[Job<T>], record: &T::Record, expand: &mut X)
    where
        X: FnMut(usize, &T::Record) -> Vec<Job<T>>,
    {
        for job in jobs {
            let canonical = self.memo.canonical(&job.task);
            self.deliver(key, job, &canonical, record, expand);
        }
    }

    fn deliver<X>(&mut self, key: Key, job: &Job<T>, canonical: &T, record: &T::Record, expand: &mut X)
    where
        X: FnMut(usize, &T::Record) -> Vec<Job<T>>,
    {
        self.summary.jobs += 1;
        self.responses.note(self.memo, key, canonical, record);
        let factor = job.task.size() / canonical.size();
        // Most sizes are on the grid already, and their records need no copy.
        let following = if factor == 1.0 { expand(job.id, record) } else { expand(job.id, &record.scaled(factor)) };
        self.arrived.extend(following);
        if self.summary.jobs.is_multiple_of(1024) {
            self.report();
        }
    }

    fn fail(&mut self, Job { id, task }: &Job<T>, failure: &Failure<T::Error>) {
        self.unsolved.push(Unsolved { id: *id, size: task.size(), failure: failure.clone() });
    }

    fn report(&self) {
        if let Some(progress) = self.options.progress {
            progress(Progress {
                solved: self.summary.solved,
                running: self.running,
                queued: self.ready.len(),
                memo_hits: self.summary.memo_hits,
            });
        }
    }

    pub fn finish(mut self) -> Result<Summary, SchedulerError<T::Error>> {
        self.summary.interrupted |= self.is_incomplete();
        self.report();
        if let Some(store) = self.memo.store() {
            self.summary.corrupt = store.damaged();
            self.summary.warnings = store.take_warnings();
        }
        self.summary.shift_effect = self.responses.steepest_slope() * self.summary.max_size_shift;
        if self.unsolved.is_empty() {
            return Ok(self.summary);
        }
        // In an order that does not depend on which came first.
        self.unsolved.sort_by(|a, b| b.size.total_cmp(&a.size).then_with(|| a.id.cmp(&b.id)));
        Err(SchedulerError::Unsolved { jobs: self.unsolved, summary: Box::new(self.summary) })
    }
}
