//! Solved divisions, shared by calls and threads.

use std::ffi::CString;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

use furrow_input::InputError;
use furrow_lineage::batch::{Memo as Solved, Quantisation, Store, Summary};
use pyo3::exceptions::PyUserWarning;
use pyo3::prelude::*;

use crate::errors::{ARGUMENTS, Error, wrong_type};
use crate::words::of_python;

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

/// The steps to which radii may be rounded.
const STEPS: &str = "from 0 to 0.5";

/// The warnings of a run: its own, and that the store of its memo is not used, whichever call found that out.
pub fn run_warnings(summary: &Summary, memo: &Solved) -> Vec<String> {
    let unused = memo.store().and_then(Store::given_up).filter(|unused| !summary.warnings.contains(unused));
    let unused = unused.map(|unused| unused.to_string());
    unused.into_iter().chain(summary.described()).map(|warning| of_python(&warning)).collect()
}

/// Warns the caller of a function of Python that the store of a memo is not used.
fn warn_of_store(py: Python<'_>, memo: &Solved) -> PyResult<()> {
    let Some(unused) = memo.store().and_then(Store::given_up) else { return Ok(()) };
    let text = CString::new(of_python(&unused.to_string())).unwrap_or_default();
    // Level 2 is the line that calls the function.
    PyErr::warn(py, &py.get_type::<PyUserWarning>(), &text, 2)
}

/// An empty memo.
fn empty(store: Option<&Path>, quantisation: Quantisation) -> Result<Solved, Error> {
    let memo = Solved::new(quantisation);
    Ok(match store {
        Some(folder) => memo.with_store(Store::open(folder)?),
        None => memo,
    })
}

impl Memo {
    /// The result of a call, after a warning if the store is not used.
    ///
    /// # Errors
    /// The error of the call, or a warning that Python turns into an error.
    pub fn warned<T>(&self, py: Python<'_>, found: Result<T, Error>) -> Result<T, Error> {
        let found = found?;
        warn_of_store(py, &*self.solved()?)?;
        Ok(found)
    }

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
    fn new(py: Python<'_>, store: Option<Bound<'_, PyAny>>, r0_step: Option<Bound<'_, PyAny>>) -> Result<Memo, Error> {
        let folder = "a folder, or a path where one can be made";
        let path = |given: &Bound<'_, PyAny>| given.extract().map_err(|_| wrong_type("store", given, folder));
        let number = |given: &Bound<'_, PyAny>| given.extract().map_err(|_| wrong_type("r0_step", given, STEPS));
        let store: Option<PathBuf> = store.as_ref().map(path).transpose()?;
        let r0_step: Option<f64> = r0_step.as_ref().map(number).transpose()?;
        let solved = py.detach(|| -> Result<Solved, Error> {
            let not_allowed = |step| InputError::not_allowed(ARGUMENTS, "r0_step", step, STEPS);
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
