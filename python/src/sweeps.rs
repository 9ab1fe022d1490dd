//! Many points: divisions, trees, thresholds or critical radii over axes of parameters.

use std::path::PathBuf;

use furrow_analysis::sweep_files::SweepTable;
use furrow_analysis::table::csv_text;
use furrow_analysis::{AxisValue, Kind, ListedSweep, Row, Run, Sweep, SweepProgress, SweepResult};
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};
use serde_json::Value;

use crate::errors::{ARGUMENTS, Error};
use crate::inputs::{Given, fixed, shard_of};
use crate::memo::{Memo, run_warnings};
use crate::supervise::{Interrupt, supervised};
use crate::trees::one_of;

/// A table: columns by name (numbers as arrays, words as lists), reasons of undecided points by row, the text of the CSV, the numbers
/// of points solved and reused, and warnings.
type Table<'py> = (Bound<'py, PyDict>, Vec<(usize, String)>, String, (usize, usize), Vec<String>);

/// A sweep: its file, or lists of values. Python gives it as a dict.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct Asked {
    file: Option<PathBuf>,
    kind: String,
    axes: Vec<(String, Vec<AxisGiven>)>,
    cue: Option<String>,
    replicates: u32,
    seed: u64,
    lineage: Option<PathBuf>,
}

/// A value of an axis; Python has separated numbers from words.
#[derive(FromPyObject)]
enum AxisGiven {
    Word(String),
    Number(f64),
}

impl From<AxisGiven> for AxisValue {
    fn from(given: AxisGiven) -> AxisValue {
        match given {
            AxisGiven::Word(word) => AxisValue::Text(word),
            AxisGiven::Number(number) => AxisValue::Number(number),
        }
    }
}

impl Asked {
    fn read(self, given: &Given) -> Result<Sweep, Error> {
        let (base, set) = (given.base()?, given.parameters.overrides()?);
        if let Some(file) = &self.file {
            return Ok(Sweep::read(file, &base, &set)?);
        }
        let kind = one_of("kind", &self.kind, Kind::NAMED)?;
        let values = |list: Vec<AxisGiven>| list.into_iter().map(AxisValue::from).collect();
        let axes = self.axes.into_iter().map(|(name, list)| (name, values(list))).collect();
        let Asked { cue, replicates, seed, lineage, .. } = self;
        Ok(Sweep::over(ListedSweep { kind, axes, cue, replicates, seed, lineage }, ARGUMENTS, &base, &set)?)
    }
}

/// Solves a sweep given as a file or as lists of values. With `out` its files are written there; `shard` is the part (k, n) that is solved.
#[pyfunction]
#[pyo3(signature = (asked, given, memo, out, shard, threads, progress=None))]
pub fn sweep<'py>(
    py: Python<'py>,
    asked: Asked,
    given: Given,
    memo: &Memo,
    out: Option<PathBuf>,
    shard: Option<(u64, u64)>,
    threads: usize,
    progress: Option<&Bound<'py, PyAny>>,
) -> Result<Table<'py>, Error> {
    let shard = shard.map(shard_of);
    let (shard, memo) = (shard.transpose()?, memo.solved()?);
    let (sweep, done, warnings) = supervised(py, Interrupt::Finishes, progress, move |watch| {
        let sweep = asked.read(&given)?;
        if matches!(sweep.kind, Kind::Pitchfork) {
            sweep.settings.check_axisymmetric(ARGUMENTS)?;
        }
        let mut warnings = sweep.doubts();
        warnings.extend(sweep.lacks_regulator());
        // Divisions are stored when they are finished, shapes are not.
        let kept = out.is_some() || matches!(sweep.kind, Kind::Division | Kind::Tree);
        let show = |SweepProgress { done, of }| watch.set([if kept { done } else { 0 }, done, of]);
        let journal = out
            .as_deref()
            .map(|folder| SweepTable::new(&sweep, memo.quantisation(), shard, Vec::new()).open_journal(folder));
        let journal = journal.transpose().map_err(Error::system)?;
        let run =
            Run { shard, threads, journal: journal.as_ref(), progress: &show, ..Run::new(&sweep, &memo, &watch.stop) };
        let mut done = run.solve()?;
        if done.summary.interrupted {
            return Err(Error::Interrupted(0));
        }
        if let Some(folder) = out {
            let rows = std::mem::take(&mut done.rows);
            let table = SweepTable::new(&sweep, memo.quantisation(), shard, rows);
            table.write(&folder).map_err(Error::system)?;
            journal.map_or(Ok(()), |journal| journal.finish()).map_err(Error::system)?;
            done.rows = table.rows;
        }
        warnings.extend(run_warnings(&done.summary, &memo));
        warnings.extend(done.undecided_points());
        Ok((sweep, done, warnings))
    })?;
    let SweepResult { rows, resumed, summary } = done;
    let names = sweep.columns();
    let csv = csv_text(&names, &rows);
    let dict = PyDict::new(py);
    for (place, name) in names.iter().enumerate() {
        dict.set_item(name, column(py, &rows, place)?)?;
    }
    let why = rows.iter().enumerate().filter_map(|(k, row)| Some((k, row.why.clone()?))).collect();
    Ok((dict, why, csv, (summary.solved, summary.memo_hits + resumed), warnings))
}

/// One column: an array if it is numeric, with NaN for missing values, else a list.
fn column<'py>(py: Python<'py>, rows: &[Row], place: usize) -> PyResult<Bound<'py, PyAny>> {
    let cells = || rows.iter().map(|row| row.cells.get(place).unwrap_or(&Value::Null));
    if cells().any(Value::is_string) {
        let words = cells().map(|cell| match cell {
            Value::Null => None,
            Value::String(text) => Some(text.clone()),
            other => Some(other.to_string()),
        });
        return Ok(PyList::new(py, words.collect::<Vec<_>>())?.into_any());
    }
    let numbers = cells().map(|cell| cell.as_f64().unwrap_or(f64::NAN)).collect();
    Ok(fixed(PyArray1::from_vec(py, numbers))?.into_any())
}
