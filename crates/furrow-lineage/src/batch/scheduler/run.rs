//! One run: what has arrived, what waits, what is being solved, and what came of it.

use std::{
    cmp::Ordering,
    collections::{BinaryHeap, VecDeque},
    sync::{
        atomic::Ordering as Memory,
        mpsc::{Receiver, RecvTimeoutError, Sender},
    },
    time::Duration,
};

use super::{Job, Progress, SchedulerError, SchedulerOptions, Step, Summary, Unsolved, effect::Responses};
use crate::batch::{
    key::{Key, KeyMap},
    memo::{Completion, Event, Failure, Lease, Memo, Request, scaled},
};
use furrow_mechanics::division::{Division, DivisionInput};

/// How late an interrupt may be noticed.
const TICK: Duration = Duration::from_millis(20);

/// The jobs that wait for one key.
#[derive(Default)]
struct Awaited {
    /// Whether one of this run's workers is at it.
    running: bool,
    /// With their inputs before rounding.
    jobs: Vec<Job>,
}

/// A division in the queue, ordered by expected work, then by radius and age.
pub struct Assignment<'m> {
    work: f64,
    /// Number in the order of arrival.
    age: usize,
    /// Its input, the radius rounded.
    pub input: DivisionInput,
    /// The duty to solve it.
    pub lease: Lease<'m>,
}

impl Ord for Assignment<'_> {
    fn cmp(&self, other: &Self) -> Ordering {
        self.work
            .total_cmp(&other.work)
            .then_with(|| self.input.cell.r0.total_cmp(&other.input.cell.r0))
            .then_with(|| other.age.cmp(&self.age))
    }
}

impl PartialOrd for Assignment<'_> {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Assignment<'_> {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Assignment<'_> {}

/// What a worker is given.
// Few tasks exist at a time; boxing would cost an allocation for each division.
#[allow(clippy::large_enum_variant)]
pub enum Task<'m, 's> {
    /// A division.
    Solve(Assignment<'m>),
    /// A preparation and the number of its job.
    Prepare(usize, Box<dyn FnOnce() + Send + 's>),
}

pub struct Run<'a, 'm, 's> {
    memo: &'m Memo,
    options: &'a SchedulerOptions<'a>,
    sender: Sender<Event>,
    /// Jobs not looked up yet.
    arrived: VecDeque<Job>,
    /// Preparations that wait for a worker.
    preparations: VecDeque<(usize, Box<dyn FnOnce() + Send + 's>)>,
    /// How many workers prepare.
    preparing: usize,
    /// Divisions that wait for a worker.
    ready: BinaryHeap<Assignment<'m>>,
    waiting: KeyMap<Awaited>,
    /// Failures of this run: a second job with the same input is not tried again.
    failed: KeyMap<Failure>,
    responses: Responses,
    running: usize,
    queued_ever: usize,
    unsolved: Vec<Unsolved>,
    summary: Summary,
}

impl<'a, 'm, 's> Run<'a, 'm, 's> {
    pub fn new(steps: Vec<Step<'s>>, memo: &'m Memo, options: &'a SchedulerOptions<'a>, sender: Sender<Event>) -> Self {
        let mut run = Run {
            memo,
            options,
            sender,
            arrived: VecDeque::new(),
            preparations: VecDeque::new(),
            preparing: 0,
            ready: BinaryHeap::new(),
            waiting: KeyMap::default(),
            failed: KeyMap::default(),
            responses: Responses::default(),
            running: 0,
            queued_ever: 0,
            unsolved: Vec::new(),
            summary: Summary::default(),
        };
        run.arrive(steps);
        run
    }

    fn arrive(&mut self, steps: Vec<Step<'s>>) {
        for step in steps {
            match step {
                Step::Solve(job) => self.arrived.push_back(job),
                Step::Prepare(id, work) => self.preparations.push_back((id, work)),
            }
        }
    }

    fn interrupted(&self) -> bool {
        self.options.interrupt.is_some_and(|flag| flag.load(Memory::Relaxed))
    }

    /// Whether jobs are left that no worker of this run is at.
    pub fn is_incomplete(&self) -> bool {
        !self.arrived.is_empty()
            || self.preparing + self.preparations.len() > 0
            || self.waiting.values().any(|awaited| !awaited.running)
    }

    /// Until nothing is left: looks up, hands divisions to workers with `spawn`, and takes in what comes back.
    pub fn work(
        &mut self,
        events: &Receiver<Event>,
        threads: usize,
        expand: &mut impl FnMut(usize, Option<&Division>) -> Vec<Step<'s>>,
        mut spawn: impl FnMut(Task<'m, 's>),
    ) {
        loop {
            self.settle_known(expand);
            if self.interrupted() {
                self.release();
            }
            // Preparations come first: divisions wait for them.
            while self.running + self.preparing < threads
                && let Some((id, work)) = self.preparations.pop_front()
            {
                self.preparing += 1;
                spawn(Task::Prepare(id, work));
            }
            while self.running + self.preparing < threads
                && let Some(assignment) = self.ready.pop()
            {
                self.running += 1;
                self.waiting.entry(assignment.lease.key()).or_default().running = true;
                self.report();
                spawn(Task::Solve(assignment));
            }
            if self.waiting.is_empty() && self.preparing == 0 && self.preparations.is_empty() {
                return;
            }
            // Only who has to wait needs a clock, which is not to be had everywhere.
            match events.try_recv().or_else(|_| events.recv_timeout(TICK)) {
                Ok(event) => self.take_in(event, expand),
                Err(RecvTimeoutError::Timeout) => {}
                // Cannot be, as `self` holds a sender.
                Err(RecvTimeoutError::Disconnected) => return,
            }
            while let Ok(event) = events.try_recv() {
                self.take_in(event, expand);
            }
        }
    }

    /// Gives up all that no worker is at. The dropped leases let other runs on the same memo take these divisions over.
    fn release(&mut self) {
        self.summary.interrupted |= self.is_incomplete();
        self.arrived.clear();
        self.preparations.clear();
        self.ready.clear();
        self.waiting.retain(|_, awaited| awaited.running);
    }

    /// Looks up every job that has arrived, and those that follow from the ones known, until all that is left waits.
    pub fn settle_known(&mut self, expand: &mut impl FnMut(usize, Option<&Division>) -> Vec<Step<'s>>) {
        while !self.interrupted()
            && let Some(job) = self.arrived.pop_front()
        {
            let canonical = self.memo.canonical(&job.input);
            let (r0, rounded) = (job.input.cell.r0, canonical.cell.r0);
            if r0 > 0.0 {
                self.summary.max_size_shift = self.summary.max_size_shift.max((rounded / r0 - 1.0).abs());
            }
            let key = Key::new(&canonical);
            if let Some(failure) = self.failed.get(&key) {
                self.unsolved.push(Unsolved { id: job.id, r0, failure: failure.clone() });
                continue;
            }
            if let Some(awaited) = self.waiting.get_mut(&key) {
                awaited.jobs.push(job);
                continue;
            }
            match self.memo.request(key, &self.sender) {
                Request::Known(division) => {
                    self.summary.memo_hits += 1;
                    self.deliver(key, &job, &canonical, &division, expand);
                }
                Request::Stored(division) => {
                    self.summary.memo_hits += 1;
                    self.summary.store_hits += 1;
                    self.deliver(key, &job, &canonical, &division, expand);
                }
                Request::Pending => self.waiting.entry(key).or_default().jobs.push(job),
                Request::Leased(lease) => {
                    self.waiting.entry(key).or_default().jobs.push(job);
                    self.queued_ever += 1;
                    let work = (self.options.expected_work)(&canonical);
                    self.ready.push(Assignment { work, age: self.queued_ever, input: canonical, lease });
                }
            }
        }
    }

    fn take_in(&mut self, event: Event, expand: &mut impl FnMut(usize, Option<&Division>) -> Vec<Step<'s>>) {
        let (key, completion) = match event {
            Event::Completed { key, completion } => (key, completion),
            Event::Prepared(id) => {
                self.preparing -= 1;
                self.arrive(expand(id, None));
                return;
            }
        };
        // Nothing waits if an interrupt has released it.
        let Some(Awaited { running, jobs }) = self.waiting.remove(&key) else { return };
        if running {
            self.running -= 1;
        }
        match completion {
            Completion::Solved(division) => {
                self.summary.solved += usize::from(running);
                self.summary.memo_hits += jobs.len() - usize::from(running);
                self.deliver_all(key, &jobs, &division, expand);
            }
            Completion::Stored(division) => {
                self.summary.store_hits += 1;
                self.summary.memo_hits += jobs.len();
                self.deliver_all(key, &jobs, &division, expand);
            }
            Completion::Failed(failure) => {
                let unsolved = |job: &Job| Unsolved { id: job.id, r0: job.input.cell.r0, failure: failure.clone() };
                self.unsolved.extend(jobs.iter().map(unsolved));
                self.failed.insert(key, failure);
            }
            Completion::Abandoned => self.arrived.extend(jobs),
        }
        self.report();
    }

    fn deliver_all(
        &mut self,
        key: Key,
        jobs: &[Job],
        division: &Division,
        expand: &mut impl FnMut(usize, Option<&Division>) -> Vec<Step<'s>>,
    ) {
        for job in jobs {
            let canonical = self.memo.canonical(&job.input);
            self.deliver(key, job, &canonical, division, expand);
        }
    }

    fn deliver(
        &mut self,
        key: Key,
        job: &Job,
        canonical: &DivisionInput,
        division: &Division,
        expand: &mut impl FnMut(usize, Option<&Division>) -> Vec<Step<'s>>,
    ) {
        self.summary.jobs += 1;
        self.responses.note(key, canonical, division);
        let factor = job.input.cell.r0 / canonical.cell.r0;
        // Most radii are on the grid already, and their divisions need no copy.
        let following = if factor == 1.0 {
            expand(job.id, Some(division))
        } else {
            expand(job.id, Some(&scaled(division, factor)))
        };
        self.arrive(following);
        if self.summary.jobs.is_multiple_of(1024) {
            self.report();
        }
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

    pub fn finish(mut self) -> Result<Summary, SchedulerError> {
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
        self.unsolved.sort_by(|a, b| b.r0.total_cmp(&a.r0).then_with(|| a.id.cmp(&b.id)));
        Err(SchedulerError::Unsolved { jobs: self.unsolved, summary: Box::new(self.summary) })
    }
}
