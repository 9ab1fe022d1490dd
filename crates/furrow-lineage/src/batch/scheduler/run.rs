//! One run: its new jobs, waiting jobs and jobs in progress, and their results.

use std::cmp::Ordering;
use std::collections::{BinaryHeap, VecDeque};
use std::sync::atomic::Ordering::Relaxed;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender};
use std::time::Duration;

use super::{Job, Progress, SchedulerError, SchedulerOptions, Step, Summary, Unsolved, Work, effect::Responses};
use crate::batch::key::{Key, KeyMap};
use crate::batch::memo::{Completion, Event, Failure, Lease, Memo, Request};
use furrow_mechanics::division::{Division, DivisionInput};

/// Largest delay in noticing an interrupt.
const TICK: Duration = Duration::from_millis(20);

/// The jobs that wait for one key.
#[derive(Default)]
struct Awaited {
    /// Whether one of this run's workers is solving it.
    running: bool,
    /// The jobs, with their inputs before rounding.
    jobs: Vec<Job>,
}

/// A division in the queue, ordered by expected work, then by radius and age.
pub struct Assignment<'m> {
    work: f64,
    /// Number in the order of arrival.
    age: usize,
    /// Its input, with a rounded radius.
    pub input: DivisionInput,
    /// The lease for solving it.
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

/// The jobs that follow from a job's division, or from its preparation.
type Expand<'a, 's> = &'a mut dyn FnMut(usize, Option<&Division>) -> Vec<Step<'s>>;

pub struct Run<'a, 'm, 's> {
    memo: &'m Memo,
    options: &'a SchedulerOptions<'a>,
    sender: Sender<Event>,
    /// Jobs not looked up yet.
    arrived: VecDeque<Job>,
    /// Preparations that wait for a worker.
    preparations: VecDeque<(usize, Work<'s>)>,
    /// The number of workers busy with preparations.
    preparing: usize,
    /// Divisions that wait for a worker.
    ready: BinaryHeap<Assignment<'m>>,
    waiting: KeyMap<Awaited>,
    /// Failures of this run, so that a second job with the same input is not tried again.
    failed: KeyMap<Failure>,
    responses: Responses,
    running: usize,
    queued_ever: usize,
    unsolved: Vec<Unsolved>,
    summary: Summary,
    expand: Expand<'a, 's>,
}

impl<'a, 'm, 's> Run<'a, 'm, 's> {
    pub fn new(
        steps: Vec<Step<'s>>,
        memo: &'m Memo,
        options: &'a SchedulerOptions<'a>,
        sender: Sender<Event>,
        expand: Expand<'a, 's>,
    ) -> Self {
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
            expand,
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
        self.options.interrupt.is_some_and(|flag| flag.load(Relaxed))
    }

    /// Whether jobs remain on which no worker of this run is busy.
    pub fn is_incomplete(&self) -> bool {
        !self.arrived.is_empty()
            || self.preparing + self.preparations.len() > 0
            || self.waiting.values().any(|awaited| !awaited.running)
    }

    /// Until no job remains: looks up divisions, passes unknown ones to workers with `spawn`, and receives the results.
    pub fn work(&mut self, events: &Receiver<Event>, threads: usize, mut spawn: impl FnMut(Step<'s, Assignment<'m>>)) {
        loop {
            self.settle_known();
            if self.interrupted() {
                self.release();
            }
            // Preparations come first: divisions wait for them.
            while self.running + self.preparing < threads
                && let Some((id, work)) = self.preparations.pop_front()
            {
                self.preparing += 1;
                spawn(Step::Prepare(id, work));
            }
            while self.running + self.preparing < threads
                && let Some(assignment) = self.ready.pop()
            {
                self.running += 1;
                self.waiting.entry(assignment.lease.key()).or_default().running = true;
                self.report();
                spawn(Step::Solve(assignment));
            }
            if self.waiting.is_empty() && self.preparing == 0 && self.preparations.is_empty() {
                return;
            }
            // Only a waiting thread needs a clock, which some platforms lack.
            match events.try_recv().or_else(|_| events.recv_timeout(TICK)) {
                Ok(event) => self.take_in(event),
                Err(RecvTimeoutError::Timeout) => {}
                // This cannot happen, because `self` holds a sender.
                Err(RecvTimeoutError::Disconnected) => return,
            }
            events.try_iter().for_each(|event| self.take_in(event));
        }
    }

    /// Abandons all jobs on which no worker is busy. The dropped leases let other runs on the same memo take over these divisions.
    fn release(&mut self) {
        self.summary.interrupted |= self.is_incomplete();
        self.arrived.clear();
        self.preparations.clear();
        self.ready.clear();
        self.waiting.retain(|_, awaited| awaited.running);
    }

    /// Looks up every new job, and the jobs that follow from known ones, until only waiting jobs remain.
    pub fn settle_known(&mut self) {
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
                Request::Known { division, stored } => {
                    self.summary.memo_hits += 1;
                    self.summary.store_hits += usize::from(stored);
                    self.deliver(key, &job, &canonical, &division);
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

    fn take_in(&mut self, event: Event) {
        let (key, completion) = match event {
            Event::Completed { key, completion } => (key, completion),
            Event::Prepared(id) => {
                self.preparing -= 1;
                let steps = (self.expand)(id, None);
                return self.arrive(steps);
            }
        };
        // There are no waiting jobs if an interrupt has released them.
        let Some(Awaited { running, jobs }) = self.waiting.remove(&key) else { return };
        if running {
            self.running -= 1;
        }
        match completion {
            Completion::Known { division, stored } => {
                let solved = usize::from(running && !stored);
                self.summary.solved += solved;
                self.summary.store_hits += usize::from(stored);
                self.summary.memo_hits += jobs.len() - solved;
                for job in jobs {
                    let canonical = self.memo.canonical(&job.input);
                    self.deliver(key, &job, &canonical, &division);
                }
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

    fn deliver(&mut self, key: Key, job: &Job, canonical: &DivisionInput, division: &Division) {
        self.summary.jobs += 1;
        self.summary.three_parts += usize::from(division.second_neck.is_some());
        self.responses.note(key, canonical, division);
        let factor = job.input.cell.r0 / canonical.cell.r0;
        // Most radii are on the grid already, and their divisions need no copy.
        let division = if factor == 1.0 { division } else { &division.clone().with_daughters_scaled(factor) };
        let following = (self.expand)(job.id, Some(division));
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
        // Sorted, so that the order does not depend on timing.
        self.unsolved.sort_by(|a, b| b.r0.total_cmp(&a.r0).then_with(|| a.id.cmp(&b.id)));
        Err(SchedulerError::Unsolved { jobs: self.unsolved, summary: Box::new(self.summary) })
    }
}
