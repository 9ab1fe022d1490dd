//! Files other than trees: the page that computes, a lineage to begin with, caches, parts of sweeps, the paper reproduced.

use std::path::PathBuf;

use furrow_analysis::hypotheses::{MergedSample, merge_parts};
use furrow_analysis::reproduce::measured::measured_divisions;
use furrow_analysis::reproduce::paper::selected;
use furrow_analysis::reproduce::{Context, ReproduceError, reproduce as reproduced};
use furrow_analysis::sweep_files::merge as merged;
use furrow_cell::settings::Settings;
use furrow_figures::drawing::Format;
use furrow_figures::plot;
use furrow_formats::files::{FileSet, WriteError};
use furrow_formats::write_atomically;
use furrow_lineage::TEMPLATE;
use furrow_lineage::batch::store::maintenance;
use furrow_report::reproduction::{markdown, stage};
use pyo3::prelude::*;
use serde_json::Value;

use crate::document::Document;
use crate::drawings::write;
use crate::errors::{ARGUMENTS, Error};
use crate::inputs::Given;
use crate::memo::Memo;
use crate::supervise::{Interrupt, supervised};
use crate::trees::{Labelled, one_of, scenarios};

/// Writes the page that computes divisions in a browser; returns its length in bytes.
#[pyfunction]
pub fn explore(
    py: Python<'_>,
    lineage: Labelled,
    given: Given,
    memo: &Memo,
    seed: u64,
    path: PathBuf,
) -> Result<usize, Error> {
    let quantisation = memo.solved()?.quantisation();
    py.detach(|| {
        let (scenarios, _) = scenarios(&[lineage], &[], &given, seed, quantisation)?;
        let first = scenarios.first().ok_or_else(|| Error::not_allowed("lineage", "none", "one lineage"))?;
        let settings = Settings::of(first.settings.cell.clone(), first.settings.numerics);
        settings.check_axisymmetric(ARGUMENTS)?;
        settings.check_paper_model("a page whose controls are its constants")?;
        let page = furrow_report::explorer(&first.lineage, &first.settings);
        write(&path, page.as_bytes())?;
        Ok(page.len())
    })
}

/// Writes a commented lineage file; an existing file stays.
#[pyfunction]
pub fn new_lineage(path: PathBuf) -> Result<(), Error> {
    if path.symlink_metadata().is_ok() {
        return Err(Error::not_allowed("path", path.display(), "a file that does not exist yet"));
    }
    write(&path, TEMPLATE.as_bytes())
}

/// Writes a text into a file, whole or not at all.
#[pyfunction]
pub fn write_text(py: Python<'_>, path: PathBuf, text: &str) -> Result<(), Error> {
    py.detach(|| write(&path, text.as_bytes()))
}

/// The JSON Schema of tree.json.
#[pyfunction]
pub fn tree_schema() -> Result<Document, Error> {
    Ok(Document(serde_json::from_str::<Value>(furrow_formats::TREE_SCHEMA)?))
}

/// Counts, checks, repairs or clears a cache folder.
#[pyfunction]
pub fn cache(py: Python<'_>, folder: PathBuf, action: &str) -> Result<Document, Error> {
    let run = one_of(
        "action",
        action,
        [
            ("verify", maintenance::verify as fn(&_) -> _),
            ("repair", maintenance::repair),
            ("clear", maintenance::clear),
        ],
    )?;
    py.detach(|| Document::of(run(&folder)?))
}

/// Merges the folders of a sweep's parts, or the tables (CSV) of the parts of a sample; returns the number of points.
#[pyfunction]
pub fn merge(py: Python<'_>, parts: Vec<PathBuf>, out: PathBuf) -> Result<usize, Error> {
    py.detach(|| {
        let whole = |path: &PathBuf| path.canonicalize().unwrap_or_else(|_| path.clone());
        if parts.is_empty() || parts.iter().any(|part| whole(part) == whole(&out)) {
            return Err(Error::not_allowed("out", out.display(), "another place than those of the parts"));
        }
        if parts.iter().any(|part| part.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("csv"))) {
            let MergedSample { csv, points, .. } = merge_parts(&parts)?;
            write_atomically(&out, csv.as_bytes()).map_err(Error::system)?;
            return Ok(points);
        }
        let table = merged(&parts)?;
        table.write(&out).map_err(Error::system)?;
        Ok(table.rows.len())
    })
}

/// The statements of the paper beside the computed values; with `out`, also writes pictures, tables and pages.
#[pyfunction]
#[pyo3(signature = (figures, data, given, memo, threads, out, format, progress=None))]
pub fn reproduce(
    py: Python<'_>,
    figures: Vec<String>,
    data: Option<PathBuf>,
    given: Given,
    memo: &Memo,
    threads: usize,
    out: Option<PathBuf>,
    format: &str,
    progress: Option<&Bound<'_, PyAny>>,
) -> Result<(Document, String), Error> {
    let statements = selected(&figures)?;
    let (extension, format) = one_of("format", format, Format::ALL.map(|one| (one.0, one)))?;
    let settings = given.for_divisions()?;
    settings.check_paper_model("the statements of the paper")?;
    let constants = given.named();
    let (of_call, memo) = (memo, memo.solved()?);
    let found = supervised(py, Interrupt::Finishes, progress, move |watch| {
        let measured = data.as_deref().map(measured_divisions).transpose()?;
        let context = Context {
            settings: &settings,
            memo: &memo,
            threads,
            cancel: &watch.stop,
            measured: measured.as_ref().map(|(name, divisions)| (name.as_str(), divisions.as_slice())),
            progress: &|_, done, of| watch.set([0, done, of]),
        };
        let found = reproduced(&context, &statements).map_err(|error| match error {
            ReproduceError::Input(error) => error.into(),
            ReproduceError::Workers(error) => error.into(),
            _ => Error::Interrupted(0),
        })?;
        let (document, page) = (found.document(&constants), markdown(&found, &constants));
        if let Some(folder) = &out {
            let mut files = FileSet::new(folder);
            let json = format!("{}\n", serde_json::to_string_pretty(&document)?);
            stage(&mut files, &found, (&page, &json), extension, |panel| {
                plot::reproduction::draw(panel).bytes(format).map_err(Error::system)
            })?;
            files.commit()?;
        }
        Ok((document.into(), page))
    });
    of_call.warned(py, found)
}

impl From<WriteError> for Error {
    fn from(error: WriteError) -> Error {
        Error::system(error)
    }
}
