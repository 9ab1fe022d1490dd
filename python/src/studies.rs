//! Constants from thresholds, ensembles of admissible constants, and lineages over them.

use furrow_analysis::fit::CalibrationStudy;
use furrow_analysis::{ConstantsSearch, EnsembleError, read_constants_of, write_constants};
use furrow_analysis::{ensemble as sampled, ranges as ranges_over};
use furrow_cell::settings::Settings;
use furrow_figures::plot;
use furrow_input::parse_document;
use furrow_mechanics::calibration::{Targets, Unknown};
use pyo3::prelude::*;
use serde_json::json;

use crate::document::Document;
use crate::drawings::Drawing;
use crate::errors::{ARGUMENTS, Error};
use crate::inputs::{Given, Source, text_of};
use crate::memo::Memo;
use crate::supervise::{Interrupt, supervised};
use crate::trees::{Labelled, scenarios};

/// Targets, with other constants to vary if they are named, and the settings of everything else.
pub fn read(source: &Source, unknowns: Option<&[String]>, given: &Given) -> Result<(Targets, Settings), Error> {
    let missing = || Error::not_allowed("targets", "None", "a file of targets, or its text");
    let (text, name) = text_of(source, ARGUMENTS)?.ok_or_else(missing)?;
    let mut targets: Targets = parse_document(&text, &name, "a file of targets", "Targets")?;
    if let Some(names) = unknowns {
        let unknown = |name: &String| match name.parse() {
            Ok(parameter) => Ok(Unknown { parameter, start: None }),
            Err(_) => Err(Error::not_allowed("unknowns", name, "names of parameters")),
        };
        targets.unknowns = names.iter().map(unknown).collect::<Result<_, Error>>()?;
    }
    targets.check(&name)?;
    let settings = given.settings()?;
    settings.check_axisymmetric(ARGUMENTS)?;
    settings.check_paper_model("constants calibrated with it")?;
    Ok((targets, settings))
}

/// Constants from thresholds.
#[pyfunction]
pub fn calibrate(
    py: Python<'_>,
    source: Source,
    unknowns: Option<Vec<String>>,
    given: Given,
) -> Result<Document, Error> {
    supervised(py, Interrupt::Abandons, None, move |_| {
        let (targets, settings) = read(&source, unknowns.as_deref(), &given)?;
        Document::of(CalibrationStudy::of(&targets, &settings).map_err(Error::no_outcome)?)
    })
}

/// Sets of constants that agree with the targets; `csv` is the table that `furrow tree --constants` reads.
#[pyfunction]
pub fn ensemble(
    py: Python<'_>,
    source: Source,
    unknowns: Option<Vec<String>>,
    count: usize,
    seed: u64,
    given: Given,
    threads: usize,
) -> Result<Document, Error> {
    supervised(py, Interrupt::Finishes, None, move |watch| {
        let (targets, Settings { cell, numerics, .. }) = read(&source, unknowns.as_deref(), &given)?;
        let search = ConstantsSearch::new(&targets, &cell, &numerics, (count, seed), &watch.stop);
        let found = sampled(&ConstantsSearch { threads, ..search })?;
        let found = json!({
            "parameters": found.parameters.iter().map(ToString::to_string).collect::<Vec<_>>(),
            "values": found.members.iter().map(|member| &member.values).collect::<Vec<_>>(),
            "weights": found.members.iter().map(|member| member.weight).collect::<Vec<_>>(),
            "effective_sample_size": found.effective_sample_size,
            "draws": found.draws,
            "csv": write_constants(&found.constants()),
            "excluded": found.excluded,
        });
        Ok(found.into())
    })
}

/// A lineage over sets of constants, which are a table as text or in a file.
#[pyfunction]
pub fn ranges(
    py: Python<'_>,
    lineage: Labelled,
    cues: Vec<String>,
    source: Source,
    given: Given,
    memo: &Memo,
    seed: u64,
    threads: usize,
) -> Result<(Document, Drawing), Error> {
    let memo = memo.solved()?;
    supervised(py, Interrupt::Finishes, None, move |watch| {
        let (text, name) =
            text_of(&source, "constants")?.ok_or_else(|| Error::not_allowed("constants", "None", "a table"))?;
        let (scenarios, _) = scenarios(&[lineage], &cues, &given, seed, memo.quantisation())?;
        let first = scenarios.first().ok_or_else(|| Error::not_allowed("lineage", "none", "one lineage"))?;
        let sets = read_constants_of(&text, &name, &first.lineage)?;
        given.check_beside(&sets, &name)?;
        let found = ranges_over(&first.lineage, &first.settings, &sets, threads, &watch.stop, &|| ())?;
        let drawing = Drawing::of(plot::rounds::draw_ranges(&first.lineage, &found));
        Ok((Document::of(&found)?, drawing))
    })
}

impl From<EnsembleError> for Error {
    fn from(error: EnsembleError) -> Error {
        match error {
            EnsembleError::Interrupted => Error::Interrupted(0),
            EnsembleError::Workers(_) => Error::system(error),
            error => Error::no_outcome(error),
        }
    }
}
