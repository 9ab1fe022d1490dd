//! The library's errors as the exceptions of `furrow/_errors.py`, with field, value and the allowed values.

use std::fmt::Display;

use furrow_input::InputError;
use furrow_lineage::GrowError;
use furrow_lineage::batch::{Failure, SchedulerError, StoreError};
use furrow_mechanics::division::DivisionError;
use pyo3::exceptions::{PyOSError, PyRuntimeError};
use pyo3::prelude::*;

use crate::words::{error_of_python, of_python};

/// The source that errors name for arguments of a call.
pub const ARGUMENTS: &str = "furrow";

mod exceptions {
    pyo3::import_exception!(furrow._errors, InputError);
    pyo3::import_exception!(furrow._errors, NoOutcome);
    pyo3::import_exception!(furrow._errors, Interrupted);
}

/// Why a call failed.
#[derive(Debug)]
pub enum Error {
    /// Bad input.
    Input(InputError),
    /// The computation failed on valid input.
    NoOutcome(String),
    /// An error of the system: a folder, threads.
    System(String),
    /// Interrupted after this number of divisions, which are kept.
    Interrupted(usize),
    /// An exception of Python.
    Raised(PyErr),
}

impl Error {
    /// A failed computation.
    pub fn no_outcome(why: impl Display) -> Error {
        Error::NoOutcome(why.to_string())
    }

    /// An error of the system.
    pub fn system(why: impl Display) -> Error {
        Error::System(why.to_string())
    }

    /// An argument with a value that is not allowed.
    pub fn not_allowed(field: impl Into<String>, value: impl ToString, allowed: impl Into<String>) -> Error {
        InputError::not_allowed(ARGUMENTS, field, value, allowed).into()
    }

    /// A solver that panicked, which is a bug.
    pub fn defect(panic: &(dyn std::any::Any + Send)) -> Error {
        let text = panic.downcast_ref::<&str>().copied();
        let said = text.or_else(|| panic.downcast_ref::<String>().map(String::as_str)).unwrap_or_default();
        Error::NoOutcome(format!("internal error: the solver panicked: {said} (please report it)"))
    }
}

impl From<InputError> for Error {
    fn from(error: InputError) -> Error {
        Error::Input(error)
    }
}

impl From<PyErr> for Error {
    fn from(error: PyErr) -> Error {
        Error::Raised(error)
    }
}

/// A result that cannot be serialised: a bug.
impl From<serde_json::Error> for Error {
    fn from(error: serde_json::Error) -> Error {
        Error::Raised(PyRuntimeError::new_err(error.to_string()))
    }
}

impl From<DivisionError> for Error {
    fn from(error: DivisionError) -> Error {
        match error {
            DivisionError::BadInput { field, value, allowed } => {
                InputError::not_allowed("cell", field, value, allowed).into()
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
            SchedulerError::Unsolved { mut jobs, .. } => {
                jobs.pop().map_or_else(|| Error::no_outcome("no division is unsolved"), |job| job.failure.into())
            }
            error => Error::system(error),
        }
    }
}

impl From<GrowError> for Error {
    fn from(error: GrowError) -> Error {
        match error {
            GrowError::Workers(error) => error.into(),
            GrowError::Interrupted { .. } => Error::Interrupted(0),
        }
    }
}

impl From<StoreError> for Error {
    fn from(error: StoreError) -> Error {
        match error {
            StoreError::NotAFolder { folder } => {
                let allowed = "a folder, or a path where one can be made";
                InputError::not_allowed(ARGUMENTS, "store", folder.display(), allowed).into()
            }
            error => Error::system(error),
        }
    }
}

impl From<Error> for PyErr {
    fn from(error: Error) -> PyErr {
        match error {
            Error::Input(error) => input(error),
            Error::NoOutcome(why) => exceptions::NoOutcome::new_err(of_python(&why)),
            Error::System(why) => PyOSError::new_err(why),
            Error::Interrupted(solved) => exceptions::Interrupted::new_err(solved),
            Error::Raised(error) => error,
        }
    }
}

/// Bad input; the exception has message, field, value, allowed and source.
fn input(error: InputError) -> PyErr {
    let error = error_of_python(error);
    let message = error.to_string();
    match error {
        InputError::NotAllowed { source_name, field, value, allowed } => {
            // Parameters are keywords in Python, without a section.
            let plain = field.strip_prefix("physics.").or_else(|| field.strip_prefix("numerics."));
            let plain = plain.unwrap_or(&field).to_owned();
            let message = message.replacen(&format!(": {field} = "), &format!(": {plain} = "), 1);
            match value.parse::<f64>() {
                Ok(number) => exceptions::InputError::new_err((message, plain, number, allowed, source_name)),
                Err(_) => exceptions::InputError::new_err((message, plain, value, allowed, source_name)),
            }
        }
        InputError::Unreadable { file, .. }
        | InputError::OtherFile { file, .. }
        | InputError::Founders { file, .. }
        | InputError::Malformed { file, .. } => {
            exceptions::InputError::new_err((message, None::<String>, None::<String>, None::<String>, file))
        }
    }
}

/// An argument of the wrong Python type, such as a list in place of a number.
pub fn wrong_type(field: &str, value: &Bound<'_, PyAny>, allowed: &str) -> PyErr {
    let kind = value.get_type().name().map_or_else(|_| "?".to_owned(), |name| name.to_string());
    let message = format!("furrow: {field} is of the type {kind}: must be {allowed}");
    exceptions::InputError::new_err((message, field.to_owned(), value.clone().unbind(), allowed.to_owned(), ARGUMENTS))
}
