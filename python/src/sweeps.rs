//! Many points: divisions, trees, thresholds or critical radii over axes of parameters.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use furrow_analysis::sweep_files::SweepTable;
use furrow_analysis::table::csv_text;
use furrow_analysis::{Kind, Row, Run, Sweep, SweepResult};
use furrow_cell::settings::Settings;
use furrow_formats::files::WriteError;
use furrow_input::InputError;
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};
use serde_json::Value;

use crate::columns::or_nan;
use crate::errors::Error;
use crate::inputs::{ARGUMENTS, Pairs, pairs};
use crate::memo::Memo;
use crate::supervise::{Interrupt, supervised};

/// A table: columns by name (numbers as arrays, words as lists), reasons of undecided points by row, the text of the CSV, and the
/// numbers of points solved and reused.
type Table<'py> = (Bound<'py, PyDict>, Vec<(usize, String)>, String, (usize, usize));

/// Solves a sweep given as a file or as text. With `out` its files are written there.
#[pyfunction]
#[pyo3(signature = (text, file, parameters, memo, preset, config, out, threads, progress=None))]
pub fn sweep<'py>(
    py: Python<'py>,
    text: Option<String>,
    file: Option<PathBuf>,
    parameters: &Bound<'py, PyDict>,
    memo: &Memo,
    preset: String,
    config: Option<PathBuf>,
    out: Option<PathBuf>,
    threads: usize,
    progress: Option<&Bound<'py, PyAny>>,
) -> PyResult<Table<'py>> {
    let pairs = pairs(parameters)?;
    let memo = Arc::clone(&memo.solved);
    let (sweep, done) = supervised(py, Interrupt::Finishes, progress, move |watch| {
        let base = Settings::load(&preset, config.as_deref(), &[])?;
        let sweep = read(text.as_deref(), file.as_deref(), &base, &pairs)?;
        let kept = out.is_some() || matches!(sweep.kind, Kind::Division | Kind::Tree);
        let show = |progress| watch.points(progress, kept);
        let failed = |error: WriteError| Error::System(error.to_string());
        let journal = out
            .as_deref()
            .map(|folder| SweepTable::new(&sweep, memo.quantisation(), None, Vec::new()).open_journal(folder));
        let journal = journal.transpose().map_err(failed)?;
        let run = Run { threads, journal: journal.as_ref(), progress: &show, ..Run::new(&sweep, &memo, watch.stop()) };
        let mut done = run.solve()?;
        if done.interrupted {
            return Err(Error::Interrupted);
        }
        if let Some(folder) = out {
            let rows = std::mem::take(&mut done.rows);
            let table = SweepTable::new(&sweep, memo.quantisation(), None, rows);
            table.write(&folder).map_err(failed)?;
            journal.map_or(Ok(()), |journal| journal.finish()).map_err(failed)?;
            done.rows = table.rows;
        }
        Ok((sweep, done))
    })?;
    let SweepResult { rows, solved, reused, resumed, .. } = done;
    let names = sweep.columns();
    let csv = csv_text(&names, &rows);
    let dict = PyDict::new(py);
    for (place, name) in names.iter().enumerate() {
        dict.set_item(name, column(py, &rows, place)?)?;
    }
    let why = rows.iter().enumerate().filter_map(|(k, row)| Some((k, row.why.clone()?))).collect();
    Ok((dict, why, csv, (solved, reused + resumed)))
}

fn read(text: Option<&str>, file: Option<&Path>, base: &Settings, pairs: &Pairs) -> Result<Sweep, InputError> {
    let overrides: Vec<String> = pairs.iter().map(|(name, value)| format!("{name}={value}")).collect();
    match (text, file) {
        (Some(text), _) => Sweep::parse(text, ARGUMENTS, base, &overrides),
        (None, Some(file)) => Sweep::read(file, base, &overrides),
        (None, None) => Err(InputError::not_allowed(ARGUMENTS, "sweep", "None", "a file, or axes")),
    }
}

/// One column: an array if it is numeric, with NaN for missing values, else a list.
fn column<'py>(py: Python<'py>, rows: &[Row], place: usize) -> PyResult<Bound<'py, PyAny>> {
    let cells = || rows.iter().map(|row| row.cells.get(place).unwrap_or(&Value::Null));
    if cells().any(|cell| cell.is_string()) {
        let words = cells().map(|cell| match cell {
            Value::Null => None,
            Value::String(text) => Some(text.clone()),
            other => Some(other.to_string()),
        });
        return Ok(PyList::new(py, words.collect::<Vec<_>>())?.into_any());
    }
    let numbers = cells().map(|cell| or_nan(cell.as_f64())).collect();
    Ok(PyArray1::from_vec(py, numbers).into_any())
}
