//! Runs work on a separate thread without the interpreter's lock, while the calling thread checks for Ctrl-C and reports progress.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use furrow_analysis::SweepProgress;
use furrow_lineage::batch::Progress;
use pyo3::prelude::*;

use crate::errors::{Error, defect, interrupted, raised};

/// Interval of checks for Ctrl-C and of progress reports.
const TICK: Duration = Duration::from_millis(50);

/// Progress and the stop request, shared by the work and the waiting thread.
#[derive(Clone)]
pub struct Watch {
    stop: &'static AtomicBool,
    counts: Arc<Counts>,
}

#[derive(Default)]
struct Counts {
    solved: AtomicUsize,
    done: AtomicUsize,
    of: AtomicUsize,
}

impl Watch {
    fn new() -> Watch {
        Watch { stop: Flags::take(), counts: Arc::default() }
    }

    /// Set to stop the work.
    pub fn stop(&self) -> &'static AtomicBool {
        self.stop
    }

    /// Records the progress of divisions.
    pub fn divisions(&self, progress: Progress) {
        let Progress { solved, running, queued, memo_hits } = progress;
        self.counts.solved.store(solved, Ordering::Relaxed);
        self.counts.done.store(solved + memo_hits, Ordering::Relaxed);
        self.counts.of.store(solved + memo_hits + running + queued, Ordering::Relaxed);
    }

    /// Records the progress of a sweep, and whether its results are kept: divisions are, shapes are not.
    pub fn points(&self, progress: SweepProgress, kept: bool) {
        self.counts.solved.store(if kept { progress.done } else { 0 }, Ordering::Relaxed);
        self.counts.done.store(progress.done, Ordering::Relaxed);
        self.counts.of.store(progress.of, Ordering::Relaxed);
    }

    fn solved(&self) -> usize {
        self.counts.solved.load(Ordering::Relaxed)
    }
}

/// Flags that no work uses now. Searches for critical radii want one that lives for ever; there are as many as calls at one time.
struct Flags;

static FREE: Mutex<Vec<&'static AtomicBool>> = Mutex::new(Vec::new());

impl Flags {
    fn take() -> &'static AtomicBool {
        let free = FREE.lock().unwrap_or_else(PoisonError::into_inner).pop();
        let flag = free.unwrap_or_else(|| Box::leak(Box::new(AtomicBool::new(false))));
        flag.store(false, Ordering::SeqCst);
        flag
    }

    fn give(flag: &'static AtomicBool) {
        FREE.lock().unwrap_or_else(PoisonError::into_inner).push(flag);
    }
}

/// The effect of Ctrl-C on work.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Interrupt {
    /// The work finishes divisions in progress and stops.
    Tells,
    /// The call returns; the work continues and its result goes to the memo.
    Leaves,
}

/// Runs work on a separate thread and waits for it.
///
/// `progress` is called regularly on the calling thread with the numbers of finished and of all divisions or points.
///
/// # Errors
/// The error of the work; `Interrupted` after Ctrl-C; an exception of `progress`.
pub fn supervised<T: Send + 'static>(
    py: Python<'_>,
    interrupt: Interrupt,
    progress: Option<&Bound<'_, PyAny>>,
    work: impl FnOnce(&Watch) -> Result<T, Error> + Send + 'static,
) -> PyResult<T> {
    let watch = Watch::new();
    let (sender, receiver) = channel();
    // A closure that runs without the lock may only hold values that can be sent between threads.
    let receiver = Mutex::new(receiver);
    let own = watch.clone();
    let begun = std::thread::Builder::new().name("furrow".to_owned()).spawn(move || {
        let done = catch_unwind(AssertUnwindSafe(|| work(&own)));
        Flags::give(own.stop);
        // The receiver may be gone.
        let _ = sender.send(done);
    });
    if let Err(error) = begun {
        return Err(raised(py, Error::System(format!("cannot start a thread: {error}")), 0));
    }
    let mut stopped: Option<PyErr> = None;
    loop {
        let news = py.detach(|| receiver.lock().unwrap_or_else(PoisonError::into_inner).recv_timeout(TICK));
        match news {
            Ok(Ok(done)) => {
                // An interrupted call raises even if the work has finished: the memo has the results.
                return match stopped {
                    Some(error) => Err(explained(py, error, watch.solved())),
                    None => done.map_err(|error| raised(py, error, watch.solved())),
                };
            }
            Ok(Err(panic)) => return Err(defect(py, &*panic)),
            Err(RecvTimeoutError::Disconnected) => return Err(defect(py, &"its thread is gone")),
            Err(RecvTimeoutError::Timeout) => {}
        }
        let heard = py.check_signals().and_then(|()| match progress {
            Some(show) if stopped.is_none() => show_progress(show, &watch),
            _ => Ok(()),
        });
        if let Err(error) = heard {
            watch.stop.store(true, Ordering::SeqCst);
            // A second Ctrl-C does not wait for divisions in progress.
            if interrupt == Interrupt::Leaves || stopped.is_some() {
                return Err(explained(py, error, watch.solved()));
            }
            stopped = Some(error);
        }
    }
}

/// Turns a KeyboardInterrupt into one with what was kept; leaves other exceptions.
fn explained(py: Python<'_>, error: PyErr, solved: usize) -> PyErr {
    if error.is_instance_of::<pyo3::exceptions::PyKeyboardInterrupt>(py) { interrupted(py, solved) } else { error }
}

fn show_progress(show: &Bound<'_, PyAny>, watch: &Watch) -> PyResult<()> {
    let counts = &watch.counts;
    show.call1((counts.done.load(Ordering::Relaxed), counts.of.load(Ordering::Relaxed))).map(drop)
}
