//! The values of one parameter that give a wanted division.

use furrow_analysis::solve::{Measure, Question, SolveError, default_range, solve as solved};
use furrow_cell::Parameter;
use furrow_input::{did_you_mean, shown};
use pyo3::prelude::*;

use crate::document::Document;
use crate::errors::Error;
use crate::inputs::Inputs;
use crate::memo::Memo;
use crate::supervise::{Interrupt, supervised};

/// The roots, jumps and gaps of an outcome, named `chi`, `chi_signed`, `u` or `t`, over one parameter.
#[pyfunction]
#[pyo3(signature = (inputs, memo, seed, unknown, wanted, range, points, threads, progress=None))]
pub fn solve(
    py: Python<'_>,
    inputs: &Inputs,
    memo: &Memo,
    seed: u64,
    unknown: &str,
    wanted: (String, f64),
    range: Option<[f64; 2]>,
    points: usize,
    threads: usize,
    progress: Option<&Bound<'_, PyAny>>,
) -> Result<Document, Error> {
    let parameter = parameter("unknown", unknown, inputs)?;
    let (name, wanted) = wanted;
    let measure = match &*name {
        "chi" => Measure::Chi,
        "chi_signed" => Measure::ChiSigned,
        "u" => Measure::UFurrow,
        _ => Measure::TEnd,
    };
    measure.validate(wanted).map_err(|allowed| Error::not_allowed(name, wanted, allowed))?;
    for end in range.into_iter().flatten() {
        parameter.validate(end).map_err(|allowed| Error::not_allowed("range", end, allowed))?;
    }
    let range = range.unwrap_or_else(|| default_range(parameter, &inputs.cell));
    if range[0] == range[1] {
        return Err(Error::not_allowed("range", range[1], "two different values"));
    }
    let settings = inputs.settings();
    settings.check_divisions(crate::errors::ARGUMENTS)?;
    let (cell, numerics) = (settings.cell, inputs.numerics);
    let question = Question { cell, numerics, seed, parameter, range, points, measure, wanted };
    let (of_call, memo) = (memo, memo.solved()?);
    let found = supervised(py, Interrupt::Finishes, progress, move |watch| {
        let found = watch.scheduled(threads, |options| solved(&question, &memo, options));
        let found = found.and_then(|found| found.with_roots(&question)).map_err(|error| match error {
            SolveError::Workers(error) => error.into(),
            SolveError::Interrupted { .. } => Error::Interrupted(0),
            error => Error::no_outcome(error),
        })?;
        Document::of(&found)
    });
    of_call.warned(py, found)
}

/// A parameter that the cell has, by its name.
pub fn parameter(field: &str, name: &str, inputs: &Inputs) -> Result<Parameter, Error> {
    let names = || Parameter::ALL.into_iter().map(Parameter::name);
    let unknown = |_| {
        let (known, nearest) = (names().collect::<Vec<_>>().join(", "), did_you_mean(name, names()));
        let allowed = format!("one of {known}, {}{nearest}", Parameter::OF_CUES.join(", "));
        Error::not_allowed(field, shown(name), allowed)
    };
    let parameter: Parameter = name.parse().map_err(unknown)?;
    match parameter.is_of(&inputs.cell) {
        true => Ok(parameter),
        false => {
            Err(Error::not_allowed(field, shown(name), format!("a number of the cell's cue, {}", inputs.cell.cue)))
        }
    }
}
