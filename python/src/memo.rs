//! Solved divisions, shared by calls and threads.

use std::path::PathBuf;
use std::sync::Arc;

use furrow_input::InputError;
use furrow_lineage::batch::{Memo as Solved, Quantisation, Store};
use pyo3::prelude::*;

use crate::errors::Error;

/// Solved divisions. With a store, which is a cache folder, they persist and are shared with other processes, including the
/// command line.
#[pyclass(frozen, module = "furrow._furrow")]
pub struct Memo {
    /// The divisions.
    pub solved: Arc<Solved>,
    /// The folder of the store.
    #[pyo3(get)]
    store: Option<PathBuf>,
}

/// A pickled memo: its class and arguments.
type Reduced<'py> = (Bound<'py, PyAny>, (Option<PathBuf>, f64));

#[pymethods]
impl Memo {
    /// An empty memo; with `store` one over a folder. `r0_step` is the relative step to which R0 is rounded before a division is looked up.
    #[new]
    #[pyo3(signature = (store=None, r0_step=None))]
    fn new(py: Python<'_>, store: Option<PathBuf>, r0_step: Option<f64>) -> Result<Memo, Error> {
        let solved = py.detach(|| -> Result<Solved, Error> {
            let refused = |step| InputError::not_allowed("memo", "r0_step", step, "from 0 to 0.5");
            let quantisation = r0_step.map_or(Ok(Quantisation::DEFAULT), Quantisation::with_relative_step);
            let memo = Solved::new(quantisation.map_err(refused)?);
            Ok(match &store {
                Some(folder) => memo.with_store(Store::open(folder)?),
                None => memo,
            })
        })?;
        Ok(Memo { solved: Arc::new(solved), store })
    }

    /// Divisions known to this process.
    fn __len__(&self) -> usize {
        self.solved.len()
    }

    /// An empty memo is true, too.
    fn __bool__(&self) -> bool {
        true
    }

    /// Relative step to which R0 is rounded; 0 if it is not.
    #[getter]
    fn r0_step(&self) -> f64 {
        self.solved.quantisation().relative_step()
    }

    /// An unpickled memo is empty, but has the same store.
    fn __reduce__<'py>(slf: &Bound<'py, Memo>) -> Reduced<'py> {
        let memo = slf.get();
        (slf.get_type().into_any(), (memo.store.clone(), memo.r0_step()))
    }

    fn __repr__(&self) -> String {
        let store = self.store.as_ref().map_or(String::new(), |folder| format!(" on the store {folder:?}"));
        format!("<furrow.Memo of {} divisions{store}>", self.solved.len())
    }
}
