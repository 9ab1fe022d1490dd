//! Constants from thresholds, ensembles of admissible constants, and lineages over them.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use furrow_analysis::scenarios::Scenario;
use furrow_analysis::{EnsembleError, Exclusion, check_constraints, ensemble as sampled, ranges as ranges_over};
use furrow_analysis::{read_constants, write_constants};
use furrow_cell::settings::Settings;
use furrow_input::{InputError, parse_document, read_text};
use furrow_mechanics::calibration::{CalibrateError, Calibration, Targets, calibrate as calibrated};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use serde::Serialize;
use serde_json::{Map, Value};

use crate::errors::{Error, unwritable};
use crate::inputs::{ARGUMENTS, Pairs, pairs, settings_of};
use crate::memo::Memo;
use crate::supervise::{Interrupt, supervised};
use crate::trees::Plan;

/// Targets from a text, or from a file.
fn targets_of(text: Option<&str>, file: Option<&Path>) -> Result<Targets, InputError> {
    let (text, name) = match (text, file) {
        (Some(text), _) => (text.to_owned(), ARGUMENTS.to_owned()),
        (None, Some(file)) => (read_text(file)?, file.display().to_string()),
        (None, None) => {
            return Err(InputError::not_allowed(ARGUMENTS, "targets", "None", "a file of targets, or its text"));
        }
    };
    let targets: Targets = parse_document(&text, &name, "a file of targets", "Targets")?;
    targets.check(&name)?;
    Ok(targets)
}

/// Targets, and the settings of everything that they do not name.
fn read(
    text: Option<&str>,
    file: Option<&Path>,
    preset: &str,
    config: Option<&PathBuf>,
    pairs: &Pairs,
) -> Result<(Targets, Settings), Error> {
    Ok((targets_of(text, file)?, settings_of(preset, config, pairs)?))
}

#[derive(Serialize)]
struct Found {
    parameters: Map<String, Value>,
    residuals: Vec<furrow_mechanics::calibration::ThresholdResidual>,
    rms: f64,
    combinations: Vec<furrow_mechanics::calibration::Combination>,
    iterations: usize,
    excluded: Vec<Exclusion>,
}

/// Constants from thresholds, as JSON.
#[pyfunction]
pub fn calibrate(
    py: Python<'_>,
    text: Option<String>,
    file: Option<PathBuf>,
    parameters: &Bound<'_, PyDict>,
    preset: String,
    config: Option<PathBuf>,
) -> PyResult<String> {
    let pairs = pairs(parameters)?;
    let found = supervised(py, Interrupt::Abandons, None, move |_| {
        let (targets, settings) = read(text.as_deref(), file.as_deref(), &preset, config.as_ref(), &pairs)?;
        let failed = |error: CalibrateError| Error::no_outcome(error);
        let found = calibrated(&targets, &settings.cell, &settings.numerics).map_err(failed)?;
        let excluded = check_constraints(&targets, &found.cell, &settings.numerics, true).excluded;
        let Calibration { parameters, residuals, rms, combinations, iterations, .. } = found;
        let parameters = parameters.iter().map(|(parameter, value)| (parameter.to_string(), Value::from(*value)));
        Ok(Found { parameters: parameters.collect(), residuals, rms, combinations, iterations, excluded })
    })?;
    serde_json::to_string(&found).map_err(unwritable)
}

#[derive(Serialize)]
struct Sample {
    parameters: Vec<String>,
    values: Vec<Vec<f64>>,
    weights: Vec<f64>,
    effective_sample_size: f64,
    draws: usize,
    excluded: std::collections::BTreeMap<String, usize>,
    /// As the table that `furrow tree --constants` reads.
    csv: String,
}

/// Sets of constants that agree with the targets, as JSON.
#[pyfunction]
pub fn ensemble(
    py: Python<'_>,
    text: Option<String>,
    file: Option<PathBuf>,
    count: usize,
    seed: u64,
    parameters: &Bound<'_, PyDict>,
    preset: String,
    config: Option<PathBuf>,
    threads: usize,
) -> PyResult<String> {
    let pairs = pairs(parameters)?;
    let found = supervised(py, Interrupt::Finishes, None, move |watch| {
        let (targets, settings) = read(text.as_deref(), file.as_deref(), &preset, config.as_ref(), &pairs)?;
        let Settings { cell, numerics } = &settings;
        let failed = |error| match error {
            EnsembleError::Interrupted => Error::Interrupted,
            EnsembleError::Workers(_) => Error::System(error.to_string()),
            error => Error::no_outcome(error),
        };
        let found = sampled(&targets, cell, numerics, count, seed, threads, watch.stop()).map_err(failed)?;
        Ok(Sample {
            parameters: found.parameters.iter().map(ToString::to_string).collect(),
            values: found.members.iter().map(|member| member.values.clone()).collect(),
            weights: found.members.iter().map(|member| member.weight).collect(),
            effective_sample_size: found.effective_sample_size,
            draws: found.draws,
            csv: write_constants(&found.constants()),
            excluded: found.excluded,
        })
    })?;
    serde_json::to_string(&found).map_err(unwritable)
}

/// A lineage over sets of constants, which are a table as text or in a file, as JSON.
#[pyfunction]
pub fn ranges(
    py: Python<'_>,
    lineage: (String, Option<String>),
    cues: Vec<String>,
    text: Option<String>,
    file: Option<PathBuf>,
    parameters: &Bound<'_, PyDict>,
    memo: &Memo,
    preset: String,
    config: Option<PathBuf>,
    seed: u64,
    threads: usize,
) -> PyResult<String> {
    let plan = Plan { lineages: vec![lineage], cues, preset, config, pairs: pairs(parameters)?, seed };
    let memo = Arc::clone(&memo.solved);
    let found = supervised(py, Interrupt::Finishes, None, move |watch| {
        let sets = match (text, file) {
            (Some(text), _) => read_constants(&text, "constants")?,
            (None, Some(file)) => read_constants(&read_text(&file)?, &file.display().to_string())?,
            (None, None) => return Err(InputError::not_allowed(ARGUMENTS, "constants", "None", "a table").into()),
        };
        let scenarios = plan.scenarios(memo.quantisation())?;
        let Some(Scenario { lineage, settings, .. }) = scenarios.first() else {
            return Err(InputError::not_allowed(ARGUMENTS, "lineage", "none", "one lineage").into());
        };
        Ok(ranges_over(lineage, settings, &sets, threads, Some(watch.stop()))?)
    })?;
    serde_json::to_string(&found).map_err(unwritable)
}
