//! Runs work on its own thread, without the interpreter's lock. The calling thread waits, polls for Ctrl-C and shows progress.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use furrow_analysis::SweepProgress;
use furrow_lineage::batch::Progress;
use pyo3::prelude::*;

use crate::errors::{Error, defect, interrupted, raised};

/// Interval between polls for Ctrl-C and updates of progress.
const TICK: Duration = Duration::from_millis(50);

/// Progress and the stop flag, shared with the thread that waits.
#[derive(Clone, Default)]
pub struct Watch {
    stop: Arc<AtomicBool>,
    counts: Arc<Counts>,
}

#[derive(Default)]
struct Counts {
    solved: AtomicUsize,
    done: AtomicUsize,
    of: AtomicUsize,
}

impl Watch {
    /// Set when the work is to stop.
    pub fn stop(&self) -> &AtomicBool {
        &self.stop
    }

    /// Records the progress of divisions.
    pub fn divisions(&self, progress: Progress) {
        let Progress { solved, running, queued, memo_hits } = progress;
        self.counts.solved.store(solved, Ordering::Relaxed);
        self.counts.done.store(solved + memo_hits, Ordering::Relaxed);
        self.counts.of.store(solved + memo_hits + running + queued, Ordering::Relaxed);
    }

    /// Records the progress of a sweep. `kept`: finished points are stored (divisions are, shapes are not).
    pub fn points(&self, progress: SweepProgress, kept: bool) {
        self.counts.solved.store(if kept { progress.done } else { 0 }, Ordering::Relaxed);
        self.counts.done.store(progress.done, Ordering::Relaxed);
        self.counts.of.store(progress.of, Ordering::Relaxed);
    }

    fn solved(&self) -> usize {
        self.counts.solved.load(Ordering::Relaxed)
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
/// `progress` is called regularly, on the calling thread, with the numbers of finished and of all divisions or points.
///
/// # Errors
/// The error of the work; `Interrupted` after Ctrl-C; what `progress` raises.
pub fn supervised<T: Send + 'static>(
    py: Python<'_>,
    interrupt: Interrupt,
    progress: Option<&Bound<'_, PyAny>>,
    work: impl FnOnce(&Watch) -> Result<T, Error> + Send + 'static,
) -> PyResult<T> {
    let watch = Watch::default();
    let (sender, receiver) = channel();
    // The closure that waits without the lock must be Send, which a receiver alone is not.
    let receiver = Mutex::new(receiver);
    let own = watch.clone();
    let begun = std::thread::Builder::new().name("furrow".to_owned()).spawn(move || {
        let done = catch_unwind(AssertUnwindSafe(|| work(&own)));
        // The caller may have returned.
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
                // A late signal still raises; solved divisions are in the memo.
                return match stopped {
                    Some(error) => Err(explained(py, error, watch.solved())),
                    None => done.map_err(|error| raised(py, error, watch.solved())),
                };
            }
            Ok(Err(panic)) => return Err(defect(py, &*panic)),
            Err(RecvTimeoutError::Disconnected) => return Err(defect(py, &"its thread has ended")),
            Err(RecvTimeoutError::Timeout) => {}
        }
        let heard = py.check_signals().and_then(|()| match progress {
            Some(show) if stopped.is_none() => show_progress(show, &watch),
            _ => Ok(()),
        });
        if let Err(error) = heard {
            watch.stop.store(true, Ordering::SeqCst);
            // The second Ctrl-C does not wait.
            if interrupt == Interrupt::Abandons || stopped.is_some() {
                return Err(explained(py, error, watch.solved()));
            }
            stopped = Some(error);
        }
    }
}

/// A KeyboardInterrupt that says what was kept; any other exception as it is.
fn explained(py: Python<'_>, error: PyErr, solved: usize) -> PyErr {
    if error.is_instance_of::<pyo3::exceptions::PyKeyboardInterrupt>(py) { interrupted(py, solved) } else { error }
}

fn show_progress(show: &Bound<'_, PyAny>, watch: &Watch) -> PyResult<()> {
    let counts = &watch.counts;
    show.call1((counts.done.load(Ordering::Relaxed), counts.of.load(Ordering::Relaxed))).map(drop)
}
