//! Work off the interpreter's lock, on a thread of its own, while the calling thread waits for it: it looks whether Ctrl-C was
//! pressed, and shows how far the work is.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use furrow_analysis::SweepProgress;
use furrow_lineage::batch::Progress;
use pyo3::prelude::*;

use crate::errors::{Error, defect, interrupted, raised};

/// How late Ctrl-C may be noticed, and how often progress is shown.
const TICK: Duration = Duration::from_millis(50);

/// How far work is, and whether it is to stop: what it shares with the thread that waits for it.
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

    /// Takes in where divisions stand.
    pub fn divisions(&self, progress: Progress) {
        let Progress { solved, running, queued, memo_hits } = progress;
        self.counts.solved.store(solved, Ordering::Relaxed);
        self.counts.done.store(solved + memo_hits, Ordering::Relaxed);
        self.counts.of.store(solved + memo_hits + running + queued, Ordering::Relaxed);
    }

    /// Takes in where a sweep stands, and whether what it has done is kept: divisions are, shapes are not.
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
    /// The work is told, finishes what is under way and says so.
    Tells,
    /// Nobody waits for the work any longer; what it solves meanwhile goes to the memo all the same.
    Leaves,
}

/// Does work on a thread of its own and waits for it.
///
/// `progress` is called, now and then and on the calling thread, with how many divisions or points are done and how many there are.
///
/// # Errors
/// What the work ends with; `Interrupted` after Ctrl-C; what `progress` raises.
pub fn supervised<T: Send + 'static>(
    py: Python<'_>,
    interrupt: Interrupt,
    progress: Option<&Bound<'_, PyAny>>,
    work: impl FnOnce(&Watch) -> Result<T, Error> + Send + 'static,
) -> PyResult<T> {
    let watch = Watch::default();
    let (sender, receiver) = channel();
    // Shared with a closure that waits off the lock, which may not hold what belongs to one thread.
    let receiver = Mutex::new(receiver);
    let own = watch.clone();
    let begun = std::thread::Builder::new().name("furrow".to_owned()).spawn(move || {
        let done = catch_unwind(AssertUnwindSafe(|| work(&own)));
        // Nobody may be waiting any longer.
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
                // A signal that came last is not lost: what was solved is in the memo.
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
            // The second time nobody wants to wait for what is under way.
            if interrupt == Interrupt::Leaves || stopped.is_some() {
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
