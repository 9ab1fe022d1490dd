//! Solved divisions, shared by calls and threads.

use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

use furrow_input::InputError;
use furrow_lineage::batch::{Memo as Solved, Quantisation, Store};
use pyo3::prelude::*;

use crate::errors::Error;

/// Solved divisions. With a store, which is a cache folder, they persist and are shared with other processes, including the
/// command line.
#[pyclass(frozen, module = "furrow._furrow")]
pub struct Memo {
    /// The divisions, and the process that knows them. The lock is held for moments and with the interpreter's, so that no fork
    /// finds it taken.
    solved: Mutex<(u32, Arc<Solved>)>,
    /// The folder of the store.
    #[pyo3(get)]
    store: Option<PathBuf>,
}

/// A pickled memo: its class and arguments.
type Reduced<'py> = (Bound<'py, PyAny>, (Option<PathBuf>, f64));

/// An empty memo.
fn empty(store: Option<&Path>, quantisation: Quantisation) -> Result<Solved, Error> {
    let memo = Solved::new(quantisation);
    Ok(match store {
        Some(folder) => memo.with_store(Store::open(folder)?),
        None => memo,
    })
}

impl Memo {
    /// The divisions that this process knows.
    ///
    /// After a fork the child begins anew, with the same store: a thread of the parent that held a lock of the old memo, or that was to
    /// solve a division, is not there to let go of it.
    ///
    /// # Errors
    /// The store cannot be opened again.
    pub fn solved(&self) -> Result<Arc<Solved>, Error> {
        let mut solved = self.solved.lock().unwrap_or_else(PoisonError::into_inner);
        let process = std::process::id();
        if solved.0 != process {
            let fresh = Arc::new(empty(self.store.as_deref(), solved.1.quantisation())?);
            let (_, of_parent) = std::mem::replace(&mut *solved, (process, fresh));
            // Dropping it would wait for these locks, and close files of the parent.
            std::mem::forget(of_parent);
        }
        Ok(Arc::clone(&solved.1))
    }
}

#[pymethods]
impl Memo {
    /// An empty memo; with `store` one over a folder. `r0_step` is the relative step to which R0 is rounded before a division is looked up.
    #[new]
    #[pyo3(signature = (store=None, r0_step=None))]
    fn new(py: Python<'_>, store: Option<PathBuf>, r0_step: Option<f64>) -> Result<Memo, Error> {
        let solved = py.detach(|| -> Result<Solved, Error> {
            let not_allowed = |step| InputError::not_allowed("memo", "r0_step", step, "from 0 to 0.5");
            let quantisation = r0_step.map_or(Ok(Quantisation::DEFAULT), Quantisation::with_relative_step);
            empty(store.as_deref(), quantisation.map_err(not_allowed)?)
        })?;
        Ok(Memo { solved: Mutex::new((std::process::id(), Arc::new(solved))), store })
    }

    /// Divisions known to this process.
    fn __len__(&self) -> Result<usize, Error> {
        Ok(self.solved()?.len())
    }

    /// An empty memo is true, too.
    fn __bool__(&self) -> bool {
        true
    }

    /// Relative step to which R0 is rounded; 0 without rounding.
    #[getter]
    fn r0_step(&self) -> Result<f64, Error> {
        Ok(self.solved()?.quantisation().relative_step())
    }

    /// An unpickled memo is empty, but has the same store.
    fn __reduce__<'py>(slf: &Bound<'py, Memo>) -> Result<Reduced<'py>, Error> {
        let memo = slf.get();
        Ok((slf.get_type().into_any(), (memo.store.clone(), memo.r0_step()?)))
    }

    fn __repr__(&self) -> Result<String, Error> {
        let store = self.store.as_ref().map_or(String::new(), |folder| format!(" on the store {folder:?}"));
        Ok(format!("<furrow.Memo of {} divisions{store}>", self.solved()?.len()))
    }
}
