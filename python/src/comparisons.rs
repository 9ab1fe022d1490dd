//! The model beside measured embryos.

use std::path::PathBuf;
use std::sync::Arc;

use furrow_analysis::compare::counts::counts as counted;
use furrow_analysis::compare::volumes::{GroupBeside, Scale, ScaleFrom, add_bands, beside, model, scale};
use furrow_analysis::{Constants, grown, read_constants, scenarios_of, tree_settings};
use furrow_input::{InputError, open_file, read_text};
use furrow_lineage::batch::SchedulerOptions;
use furrow_measured::contour::Contour;
use furrow_measured::contour::polygons::Traced;
use furrow_measured::contour::series::{self, Series, series as laid_beside};
use furrow_measured::events::{Division, divisions, summaries};
use furrow_measured::published::jankele2021;
use furrow_measured::trend::{AdjacentTest, VolumeBin, adjacent_tests, volume_bins};
use furrow_measured::volumes::{ReadOptions, Skipped, Unit, Volumes};
use numpy::PyReadonlyArray2;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use serde::Serialize;

use crate::errors::{Error, raised, unwritable};
use crate::inputs::{ARGUMENTS, lineage_of, pairs, settings_of};
use crate::memo::Memo;
use crate::supervise::{Interrupt, Watch, supervised};
use crate::trees::GrownTree;

/// A tree beside the observed embryo, by every reading of "rounds", as JSON.
#[pyfunction]
pub fn compare_counts(py: Python<'_>, tree: &GrownTree) -> PyResult<String> {
    let found = py.detach(|| counted(&tree.tree)).map_err(|error| raised(py, error.into(), 0))?;
    serde_json::to_string(&found).map_err(unwritable)
}

/// Measured volumes beside the model.
#[derive(Serialize)]
struct VolumesFound {
    groups: Vec<GroupBeside>,
    used: u64,
    skipped: Vec<Skipped>,
    divisions: Vec<Division>,
    unit: Option<Unit>,
    length_scale: Option<Scale>,
    bins: Vec<VolumeBin>,
    tests: Vec<AdjacentTest>,
}

/// The input of a comparison of volumes.
struct VolumesPlan {
    files: Vec<PathBuf>,
    text: Option<String>,
    read: ReadOptions,
    lineage: Option<String>,
    constants: Option<(Option<String>, Option<PathBuf>)>,
    settings: furrow_cell::settings::Settings,
    length: Option<f64>,
    threads: usize,
}

/// Size asymmetries of measured divisions beside the model's, as JSON. Volumes are tables in files or one table as text; default the
/// published means.
#[pyfunction]
#[pyo3(signature = (files, text, voxel, group, lineage, constants, length, parameters, memo, preset, config, threads, progress=None))]
pub fn compare_volumes(
    py: Python<'_>,
    files: Vec<PathBuf>,
    text: Option<String>,
    voxel: Option<f64>,
    group: Option<String>,
    lineage: Option<String>,
    constants: Option<(Option<String>, Option<PathBuf>)>,
    length: Option<f64>,
    parameters: &Bound<'_, PyDict>,
    memo: &Memo,
    preset: &str,
    config: Option<PathBuf>,
    threads: usize,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<String> {
    let pairs = pairs(parameters)?;
    let settings = settings_of(preset, config.as_ref(), &pairs).map_err(|error| raised(py, error.into(), 0))?;
    let read = ReadOptions { voxel, group };
    let plan = VolumesPlan { files, text, read, lineage, constants, settings, length, threads };
    let memo = Arc::clone(&memo.solved);
    let found = supervised(py, Interrupt::Finishes, progress, move |watch| plan.compare(&memo, watch))?;
    serde_json::to_string(&found).map_err(unwritable)
}

type Solved = furrow_lineage::batch::Memo;

impl VolumesPlan {
    fn volumes(&self) -> Result<Volumes, InputError> {
        let mut volumes = Volumes::default();
        if let Some(text) = &self.text {
            volumes.read(text.as_bytes(), "volumes", &self.read)?;
        }
        for file in &self.files {
            volumes.read(open_file(file)?, &file.display().to_string(), &self.read)?;
        }
        Ok(volumes)
    }

    fn compare(&self, memo: &Solved, watch: &Watch) -> Result<VolumesFound, Error> {
        if let Some(length) = self.length.filter(|length| !(length.is_finite() && *length > 0.0)) {
            let allowed = "a length above 0, in the cube root of the tables' unit";
            return Err(InputError::not_allowed(ARGUMENTS, "length_scale", length, allowed).into());
        }
        let published = self.files.is_empty() && self.text.is_none();
        let volumes = self.volumes()?;
        let found = divisions(&volumes);
        let summed = if published { jankele2021()? } else { summaries(&found.divisions) };
        let lineage = lineage_of(self.lineage.as_deref())?;
        self.settings.check_activity(ARGUMENTS)?;
        self.settings.check_divisions(ARGUMENTS)?;
        let settings = tree_settings(self.settings.clone(), &lineage, 0, memo.quantisation());
        let show = |progress| watch.divisions(progress);
        let options = SchedulerOptions { threads: self.threads, progress: Some(&show), ..SchedulerOptions::default() };
        let (free, firsts) = model(&lineage, settings.cell.r0, &summed, |lineages| {
            let scenarios = scenarios_of(lineages, &self.settings, memo.quantisation());
            grown(&scenarios, false, memo, options, watch.stop()).map(|grown| grown.trees)
        })?;
        let mut groups = beside(summed, &found.divisions, &free, &firsts, None);
        let sets = self.sets()?;
        add_bands(&mut groups, &free, &lineage, &settings, &sets, self.threads, Some(watch.stop()))?;
        let bins = volume_bins(&found.divisions, None);
        let length_scale = match self.length {
            Some(length) => Some(Scale { length, from: ScaleFrom::Given }),
            None => scale(&found.divisions, &free, true),
        };
        Ok(VolumesFound {
            groups,
            used: volumes.used,
            skipped: volumes.skipped,
            divisions: found.divisions,
            unit: volumes.unit,
            length_scale,
            tests: adjacent_tests(&bins),
            bins,
        })
    }

    /// Sets of constants, if any.
    fn sets(&self) -> Result<Vec<Constants>, InputError> {
        match &self.constants {
            Some((Some(text), _)) => read_constants(text, "constants"),
            Some((None, Some(file))) => read_constants(&read_text(file)?, &file.display().to_string()),
            Some((None, None)) | None => Ok(Vec::new()),
        }
    }
}

/// A series of contours beside the model's, with each pair after alignment.
#[derive(Serialize)]
struct ContoursFound<'a> {
    #[serde(flatten)]
    series: &'a Series,
    laid: Vec<[Vec<[f64; 2]>; 2]>,
}

/// Measured contours beside those of frames, which are sections through the axis with their times, as JSON.
#[pyfunction]
pub fn compare_contours(
    py: Python<'_>,
    measured: Vec<PyReadonlyArray2<'_, f64>>,
    model: Vec<(f64, PyReadonlyArray2<'_, f64>)>,
    length: Option<f64>,
) -> PyResult<String> {
    let points = |array: &PyReadonlyArray2<'_, f64>| -> Vec<[f64; 2]> {
        array.as_array().rows().into_iter().filter_map(|row| Some([*row.get(0)?, *row.get(1)?])).collect()
    };
    let measured: Vec<Vec<[f64; 2]>> = measured.iter().map(points).collect();
    let model: Vec<(f64, Vec<[f64; 2]>)> = model.iter().map(|(t, array)| (*t, points(array))).collect();
    supervised(py, Interrupt::Abandons, None, move |_| {
        if let Some(length) = length.filter(|length| !(length.is_finite() && *length > 0.0)) {
            let allowed = "a length above 0, in the unit of the contours";
            return Err(InputError::not_allowed(ARGUMENTS, "length_scale", length, allowed).into());
        }
        let refused = |field: String, why: &dyn std::fmt::Display| {
            InputError::not_allowed(ARGUMENTS, field, why.to_string(), "a contour of three points or more")
        };
        let mut traced = Vec::new();
        for (k, points) in measured.into_iter().enumerate() {
            let (contour, _) = Contour::new(points).map_err(|why| refused(format!("contours[{k}]"), &why))?;
            traced.push(Traced { file: k.to_string(), name: String::new(), contour, pixel: None, notes: Vec::new() });
        }
        let mut frames = Vec::new();
        for (k, (t, points)) in model.into_iter().enumerate() {
            let (contour, _) = Contour::new(points).map_err(|why| refused(format!("frames[{k}]"), &why))?;
            frames.push(series::Modelled { frame: k.to_string(), t, contour });
        }
        let none = || InputError::not_allowed(ARGUMENTS, "contours", "none", "at least one contour and one frame");
        let series = laid_beside(&traced, &frames, length).ok_or_else(none)?;
        let points = |contour: &Contour| contour.points().iter().map(|p| [p.x, p.y]).collect();
        let laid = series.contours.iter().map(|one| [points(&one.laid[0]), points(&one.laid[1])]).collect();
        serde_json::to_string(&ContoursFound { series: &series, laid }).map_err(Error::no_outcome)
    })
}
