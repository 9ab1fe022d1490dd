//! Runs work on its own thread, without the interpreter's lock. The calling thread waits, polls for Ctrl-C and shows progress.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use furrow_lineage::batch::{Progress, SchedulerOptions};
use pyo3::exceptions::PyKeyboardInterrupt;
use pyo3::prelude::*;

use crate::errors::Error;

/// Interval between polls for Ctrl-C and updates of progress.
const TICK: Duration = Duration::from_millis(50);

/// Progress and the stop flag, shared with the thread that waits.
#[derive(Default)]
pub struct Watch {
    /// Set when the work is to stop.
    pub stop: AtomicBool,
    /// Results that are kept, and finished and all divisions or points.
    counts: [AtomicUsize; 3],
}

impl Watch {
    /// Records the progress of divisions.
    fn divisions(&self, Progress { solved, running, queued, memo_hits }: Progress) {
        self.set([solved, solved + memo_hits, solved + memo_hits + running + queued]);
    }

    /// Runs work whose divisions are solved on these threads, until the stop flag is set, and recorded.
    pub fn scheduled<T>(&self, threads: usize, work: impl FnOnce(&SchedulerOptions<'_>) -> T) -> T {
        let show = |progress| self.divisions(progress);
        let (interrupt, progress): (_, Option<&dyn Fn(Progress)>) = (Some(&self.stop), Some(&show));
        work(&SchedulerOptions { threads, interrupt, progress, ..SchedulerOptions::default() })
    }

    /// Records how many results are kept, and how many divisions or points are finished and how many there are.
    pub fn set(&self, counts: [usize; 3]) {
        self.counts.iter().zip(counts).for_each(|(counter, count)| counter.store(count, Ordering::Relaxed));
    }

    fn count(&self, which: usize) -> usize {
        self.counts[which].load(Ordering::Relaxed)
    }
}

/// What Ctrl-C does to work.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Interrupt {
    /// The work finishes divisions that have begun.
    Finishes,
    /// The call returns at once; divisions that finish later still reach the memo.
    Abandons,
}

/// Runs work on its own thread and waits for it.
///
/// `progress` is called regularly, on the calling thread, with the numbers of finished and of all divisions or points, as soon as there
/// are any, and at the end of successful work with the number of all.
///
/// # Errors
/// The error of the work; `Interrupted` after Ctrl-C; what `progress` raises.
pub fn supervised<T: Send + 'static>(
    py: Python<'_>,
    interrupt: Interrupt,
    progress: Option<&Bound<'_, PyAny>>,
    work: impl FnOnce(&Watch) -> Result<T, Error> + Send + 'static,
) -> Result<T, Error> {
    let watch = Arc::new(Watch::default());
    let (sender, receiver) = channel();
    // The closure that waits without the lock must be Send, which a receiver alone is not.
    let receiver = Mutex::new(receiver);
    let own = Arc::clone(&watch);
    let begun = std::thread::Builder::new().name("furrow".to_owned()).spawn(move || {
        let done = catch_unwind(AssertUnwindSafe(|| work(&own)));
        // The caller may have returned.
        let _ = sender.send(done);
    });
    begun.map_err(|error| Error::System(format!("cannot start a thread: {error}")))?;
    // A KeyboardInterrupt reports the kept divisions; other exceptions stay unchanged.
    let explained = |error: PyErr| match error.is_instance_of::<PyKeyboardInterrupt>(py) {
        true => Error::Interrupted(watch.count(0)),
        false => error.into(),
    };
    let mut stopped: Option<PyErr> = None;
    loop {
        match py.detach(|| receiver.lock().unwrap_or_else(PoisonError::into_inner).recv_timeout(TICK)) {
            // A late signal still raises; solved divisions are in the memo.
            Ok(Ok(done)) => {
                return match (stopped, done) {
                    (Some(error), _) => Err(explained(error)),
                    (None, Err(Error::Interrupted(_))) => Err(Error::Interrupted(watch.count(0))),
                    (None, Ok(done)) => {
                        // All is finished, also of a run that was too short to tell.
                        let of = watch.count(2);
                        let told = progress.filter(|_| of > 0).map(|show| show.call1((of, of)));
                        told.transpose().map(|_| done).map_err(explained)
                    }
                    (None, done) => done,
                };
            }
            Ok(Err(panic)) => return Err(Error::defect(&*panic)),
            Err(RecvTimeoutError::Disconnected) => return Err(Error::defect(&"its thread has ended")),
            Err(RecvTimeoutError::Timeout) => {}
        }
        let heard = py.check_signals().and_then(|()| match progress {
            Some(show) if stopped.is_none() && watch.count(2) > 0 => {
                show.call1((watch.count(1), watch.count(2))).map(drop)
            }
            _ => Ok(()),
        });
        if let Err(error) = heard {
            watch.stop.store(true, Ordering::SeqCst);
            // The second Ctrl-C does not wait.
            if interrupt == Interrupt::Abandons || stopped.is_some() {
                return Err(explained(error));
            }
            stopped = Some(error);
        }
    }
}
