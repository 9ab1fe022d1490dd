//! The library's errors as the exceptions of `furrow/_errors.py`, with field, value and what is allowed.

use std::fmt::Display;

use furrow_input::InputError;
use furrow_lineage::GrowError;
use furrow_lineage::batch::{Failure, SchedulerError, StoreError, Unsolved};
use furrow_mechanics::division::DivisionError;
use pyo3::exceptions::{PyOSError, PyRuntimeError};
use pyo3::prelude::*;

/// Why a call failed. Free of Python types, so that work without the interpreter's lock can return it.
#[derive(Debug)]
pub enum Error {
    /// Bad input.
    Input(InputError),
    /// The computation failed on valid input.
    NoOutcome(String),
    /// An error of the system: a folder, threads.
    System(String),
    /// Interrupted; solved divisions are kept.
    Interrupted,
}

impl Error {
    /// A failed computation.
    pub fn no_outcome(why: impl Display) -> Error {
        Error::NoOutcome(why.to_string())
    }
}

impl From<InputError> for Error {
    fn from(error: InputError) -> Error {
        Error::Input(error)
    }
}

impl From<DivisionError> for Error {
    fn from(error: DivisionError) -> Error {
        match error {
            DivisionError::BadInput { field, value, allowed } => {
                Error::Input(InputError::not_allowed("cell", field, value, allowed))
            }
            error => Error::no_outcome(error),
        }
    }
}

impl From<Failure> for Error {
    fn from(failure: Failure) -> Error {
        match failure {
            Failure::Unsolved(error) => error.into(),
            failure => Error::no_outcome(failure),
        }
    }
}

impl From<SchedulerError> for Error {
    fn from(error: SchedulerError) -> Error {
        match error {
            SchedulerError::Unsolved { mut jobs, .. } => match jobs.pop() {
                Some(Unsolved { failure, .. }) => failure.into(),
                None => Error::no_outcome("no division is unsolved"),
            },
            error => Error::System(error.to_string()),
        }
    }
}

impl From<GrowError> for Error {
    fn from(error: GrowError) -> Error {
        match error {
            GrowError::Workers(error) => error.into(),
            GrowError::Interrupted { .. } => Error::Interrupted,
        }
    }
}

impl From<StoreError> for Error {
    fn from(error: StoreError) -> Error {
        match error {
            StoreError::NotAFolder { folder } => {
                let folder = folder.display().to_string();
                Error::Input(InputError::not_allowed(
                    "memo",
                    "store",
                    folder,
                    "a folder, or a path where one can be made",
                ))
            }
            error => Error::System(error.to_string()),
        }
    }
}

/// The exception of `furrow/_errors.py` with this name and arguments, or the error of creating it.
fn exception<'py>(py: Python<'py>, name: &str, arguments: impl pyo3::call::PyCallArgs<'py>) -> PyErr {
    let made =
        py.import("furrow._errors").and_then(|module| module.getattr(name)).and_then(|class| class.call1(arguments));
    made.map_or_else(|error| error, PyErr::from_value)
}

/// An error as a Python exception, after `solved` divisions.
pub fn raised(py: Python<'_>, error: Error, solved: usize) -> PyErr {
    match error {
        Error::Input(error) => input(py, &error),
        Error::NoOutcome(why) => exception(py, "NoOutcome", (why,)),
        Error::System(why) => PyOSError::new_err(why),
        Error::Interrupted => interrupted(py, solved),
    }
}

/// The exception for a run that Ctrl-C stopped.
pub fn interrupted(py: Python<'_>, solved: usize) -> PyErr {
    exception(py, "Interrupted", (solved,))
}

/// The exception for a solver that panicked, which is a bug.
pub fn defect(py: Python<'_>, panic: &(dyn std::any::Any + Send)) -> PyErr {
    let said =
        panic.downcast_ref::<&str>().map(|text| (*text).to_owned()).or_else(|| panic.downcast_ref::<String>().cloned());
    let said = said.unwrap_or_default();
    exception(py, "NoOutcome", (format!("internal error: the solver panicked: {said} (please report it)"),))
}

/// Bad input; the exception has message, field, value, allowed and source.
fn input(py: Python<'_>, error: &InputError) -> PyErr {
    let message = error.to_string();
    match error {
        InputError::NotAllowed { source_name, field, value, allowed } => {
            // Parameters are keywords in Python, without a section.
            let plain = field.strip_prefix("physics.").or_else(|| field.strip_prefix("numerics."));
            let plain = plain.unwrap_or(field);
            let message = message.replacen(&format!(": {field} = "), &format!(": {plain} = "), 1);
            match value.parse::<f64>() {
                Ok(number) => exception(py, "InputError", (message, plain, number, allowed, source_name)),
                Err(_) => exception(py, "InputError", (message, plain, value, allowed, source_name)),
            }
        }
        InputError::Unreadable { file, .. }
        | InputError::OtherFile { file, .. }
        | InputError::Founders { file, .. }
        | InputError::Malformed { file, .. } => {
            exception(py, "InputError", (message, None::<&str>, None::<&str>, None::<&str>, file))
        }
    }
}

/// An argument of the wrong Python type, such as a list in place of a number.
pub fn refused(py: Python<'_>, field: &str, value: &Bound<'_, PyAny>, allowed: &str) -> PyErr {
    let kind = value.get_type().name().map_or_else(|_| "?".to_owned(), |name| name.to_string());
    let message = format!("furrow: {field} is of the type {kind}: must be {allowed}");
    exception(py, "InputError", (message, field, value, allowed, "furrow"))
}

/// A result that cannot be serialised: a bug.
pub fn unwritable(error: impl Display) -> PyErr {
    PyRuntimeError::new_err(error.to_string())
}
