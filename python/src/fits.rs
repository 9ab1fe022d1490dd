//! Constants, activities and a cue fitted to observations.

use furrow_analysis::fit::{FitError, FitProgress, FitRun, Reading, SearchBudget, Targets};
use furrow_analysis::fit::{activities, fit_constants as fitted_constants, fit_cue as fitted_cue};
use furrow_analysis::{ConstantsSearch, front as searched, tree_settings};
use furrow_cell::settings::Settings;
use furrow_figures::plot;
use furrow_input::parse_document;
use furrow_lineage::Lineage;
use furrow_lineage::batch::Memo as Solved;
use pyo3::prelude::*;

use crate::document::Document;
use crate::drawings::Drawing;
use crate::errors::{ARGUMENTS, Error};
use crate::inputs::{Given, Source, bad_cue, lineage_of, text_of};
use crate::memo::Memo;
use crate::studies::read as read_thresholds;
use crate::supervise::{Interrupt, Watch, supervised};
use crate::trees::one_of;

/// Particles, moves and seed of a search.
type Search = (usize, u64, u64);

fn budget((particles, moves, seed): Search) -> SearchBudget {
    SearchBudget { particles, moves, seed }
}

impl From<FitError> for Error {
    fn from(error: FitError) -> Error {
        match error {
            FitError::Interrupted { .. } => Error::Interrupted(0),
            FitError::Grow(error) => error.into(),
            error => Error::no_outcome(error),
        }
    }
}

/// Runs a fit of a lineage with the parameters of its divisions.
fn fitted<T>(
    watch: &Watch,
    (lineage, given, threads): (Option<&str>, &Given, usize),
    memo: &Solved,
    fit: impl FnOnce(&FitRun<'_>) -> Result<T, Error>,
) -> Result<T, Error> {
    let lineage = lineage_of(lineage)?;
    let settings = given.for_divisions()?;
    settings.check_axisymmetric(ARGUMENTS)?;
    let settings = tree_settings(settings, &lineage, 0, memo.quantisation());
    let show = |FitProgress { done, of, .. }| watch.set([0, done, of]);
    fit(&FitRun { progress: Some(&show), ..FitRun::new(&lineage, &settings, threads, &watch.stop) })
}

/// Observations of a file or a text, and their name; default the built-in ones.
fn targets(source: &Source, lineage: &Lineage) -> Result<(Targets, String), Error> {
    let (targets, name) = match text_of(source, ARGUMENTS)? {
        None => (Targets::embryo()?, "embryo.ron (built in)".to_owned()),
        Some((text, name)) => (parse_document(&text, &name, "a file of targets of a fit", "Fit")?, name),
    };
    targets.check(&name, lineage)?;
    Ok((targets, name))
}

/// One set of constants for the observed embryo: the result, its picture and a configuration file.
#[pyfunction]
#[pyo3(signature = (source, lineage, given, memo, search, threads, progress=None))]
pub fn fit_constants(
    py: Python<'_>,
    source: Source,
    lineage: Option<String>,
    given: Given,
    memo: &Memo,
    search: Search,
    threads: usize,
    progress: Option<&Bound<'_, PyAny>>,
) -> Result<(Document, Drawing, String), Error> {
    given.settings()?.check_paper_model("constants fitted with it")?;
    let (of_call, memo) = (memo, memo.solved()?);
    let found = supervised(py, Interrupt::Finishes, progress, move |watch| {
        fitted(watch, (lineage.as_deref(), &given, threads), &memo, |run| {
            let (targets, name) = targets(&source, run.lineage)?;
            targets.check_searched(&name)?;
            let found = fitted_constants(run, &targets, &memo, budget(search))?;
            let drawing = Drawing::of(plot::fit::draw_constants(&found));
            Ok((found.document(&targets).into(), drawing, found.best.as_ron()))
        })
    });
    of_call.warned(py, found)
}

/// The activity that each founder alone would need for its observed rounds.
#[pyfunction]
#[pyo3(signature = (lineage, given, memo, rounds, range, threads, progress=None))]
pub fn fit_activity(
    py: Python<'_>,
    lineage: Option<String>,
    given: Given,
    memo: &Memo,
    rounds: &str,
    range: [f64; 2],
    threads: usize,
    progress: Option<&Bound<'_, PyAny>>,
) -> Result<(Document, Drawing), Error> {
    let reading = one_of("rounds", rounds, Reading::NAMED)?;
    for xi_s in range {
        let mut settings = given.settings()?;
        settings.cell.xi_s = xi_s;
        if xi_s.is_nan() || xi_s <= 0.0 {
            return Err(Error::not_allowed("range", xi_s, "numbers above 0"));
        }
        settings.check_activity(ARGUMENTS)?;
    }
    if range[1] <= range[0] {
        return Err(Error::not_allowed("range", range[1], format!("above the first value, {}", range[0])));
    }
    let (of_call, memo) = (memo, memo.solved()?);
    let found = supervised(py, Interrupt::Finishes, progress, move |watch| {
        fitted(watch, (lineage.as_deref(), &given, threads), &memo, |run| {
            let found = activities(run, &memo, reading, range)?;
            let drawing = Drawing::of(plot::fit::draw_activities(&found.founders, run.settings.cell.xi_s));
            Ok((Document::of(&found)?, drawing))
        })
    });
    of_call.warned(py, found)
}

/// The cue that gives the measured χ of the germline.
#[pyfunction]
#[pyo3(signature = (cue, source, lineage, given, memo, search, threads, progress=None))]
pub fn fit_cue(
    py: Python<'_>,
    cue: String,
    source: Source,
    lineage: Option<String>,
    given: Given,
    memo: &Memo,
    search: Search,
    threads: usize,
    progress: Option<&Bound<'_, PyAny>>,
) -> Result<(Document, Drawing), Error> {
    let (of_call, memo) = (memo, memo.solved()?);
    let found = supervised(py, Interrupt::Finishes, progress, move |watch| {
        fitted(watch, (lineage.as_deref(), &given, threads), &memo, |run| {
            let (targets, _) = targets(&source, run.lineage)?;
            let template = run.lineage.parse_cue(&cue).map_err(bad_cue)?;
            if template.is_none() {
                return Err(Error::not_allowed("cue", cue, "a cue with at least one term"));
            }
            if targets.chi.is_empty() {
                return Err(Error::not_allowed("targets", "[]", "targets with at least one measured χ"));
            }
            let found = fitted_cue(run, &targets, &template, budget(search))?;
            let drawing = Drawing::of(plot::fit::draw_cue(&found));
            Ok((Document::of(&found)?, drawing))
        })
    });
    of_call.warned(py, found)
}

/// The front between the worst threshold and the number of statements met, among `count` sets of constants.
#[pyfunction]
#[pyo3(signature = (source, unknowns, count, seed, given, threads))]
pub fn front(
    py: Python<'_>,
    source: Source,
    unknowns: Option<Vec<String>>,
    count: usize,
    seed: u64,
    given: Given,
    threads: usize,
) -> Result<Document, Error> {
    supervised(py, Interrupt::Finishes, None, move |watch| {
        let (targets, Settings { cell, numerics, .. }) = read_thresholds(&source, unknowns.as_deref(), &given)?;
        let search = ConstantsSearch::new(&targets, &cell, &numerics, (count, seed), &watch.stop);
        Document::of(searched(&ConstantsSearch { threads, ..search })?)
    })
}
