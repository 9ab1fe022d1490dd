//! The model beside measured embryos.

use std::path::PathBuf;

use furrow_analysis::compare::counts::counts as counted;
use furrow_analysis::compare::volumes::{GroupBeside, Scale, ScaleFrom, add_bands, beside, model, scale};
use furrow_analysis::{grown, read_constants, scenarios_of, tree_settings};
use furrow_lineage::batch::SchedulerOptions;
use furrow_measured::contour::Contour;
use furrow_measured::contour::polygons::Traced;
use furrow_measured::contour::series::{ModelContour, Series, series as laid_beside};
use furrow_measured::events::{Division, divisions, summaries};
use furrow_measured::published::jankele2021;
use furrow_measured::trend::{AdjacentTest, VolumeBin, adjacent_tests, volume_bins};
use furrow_measured::volumes::{ReadOptions, Skipped, Unit, Volumes};
use numpy::PyReadonlyArray2;
use pyo3::prelude::*;
use serde::Serialize;

use crate::errors::Error;
use crate::inputs::{Given, Source, lineage_of, text_of};
use crate::memo::Memo;
use crate::supervise::{Interrupt, supervised};
use crate::trees::GrownTree;

/// A tree beside the observed embryo, by every reading of "rounds", as JSON.
#[pyfunction]
pub fn compare_counts(py: Python<'_>, tree: &GrownTree) -> Result<String, Error> {
    Ok(serde_json::to_string(&py.detach(|| counted(&tree.tree, "tree"))?)?)
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

/// One L_h in a unit that the user has.
fn length_scale(length: Option<f64>, unit: &str) -> Result<(), Error> {
    match length.filter(|length| !(length.is_finite() && *length > 0.0)) {
        Some(length) => Err(Error::not_allowed("length_scale", length, format!("a length above 0, in the {unit}"))),
        None => Ok(()),
    }
}

/// Size asymmetries of measured divisions beside the model's, as JSON. Volumes are tables in files or one table as text; default the
/// published means.
#[pyfunction]
#[pyo3(signature = (files, text, voxel, group, lineage, constants, length, given, memo, threads, progress=None))]
pub fn compare_volumes(
    py: Python<'_>,
    files: Vec<PathBuf>,
    text: Option<String>,
    voxel: Option<f64>,
    group: Option<String>,
    lineage: Option<String>,
    constants: Option<Source>,
    length: Option<f64>,
    given: Given,
    memo: &Memo,
    threads: usize,
    progress: Option<&Bound<'_, PyAny>>,
) -> Result<String, Error> {
    let settings = given.settings()?;
    let memo = memo.solved()?;
    supervised(py, Interrupt::Finishes, progress, move |watch| {
        length_scale(length, "cube root of the tables' unit")?;
        let published = files.is_empty() && text.is_none();
        let (mut volumes, options) = (Volumes::default(), ReadOptions { voxel, group });
        if let Some(text) = &text {
            volumes.read(text.as_bytes(), "volumes", &options)?;
        }
        for file in &files {
            volumes.read_file(file, &options)?;
        }
        if !published {
            volumes.require_used("volumes")?;
        }
        let divisions = divisions(&volumes).divisions;
        let summed = if published { jankele2021()? } else { summaries(&divisions) };
        let lineage = lineage_of(lineage.as_deref())?;
        given.for_divisions()?;
        let tree_settings = tree_settings(settings.clone(), &lineage, 0, memo.quantisation());
        let show = |progress| watch.divisions(progress);
        let options = SchedulerOptions { threads, progress: Some(&show), ..SchedulerOptions::default() };
        let (free, firsts) = model(&lineage, tree_settings.cell.r0, &summed, |lineages| {
            let scenarios = scenarios_of(lineages, &settings, memo.quantisation());
            grown(&scenarios, false, &memo, options, &watch.stop).map(|grown| grown.trees)
        })?;
        let mut groups = beside(summed, &divisions, &free, &firsts, None);
        let sets = match text_of(&constants.unwrap_or_default(), "constants")? {
            Some((text, name)) => read_constants(&text, &name)?,
            None => Vec::new(),
        };
        add_bands(&mut groups, &free, &lineage, &tree_settings, &sets, threads, &watch.stop)?;
        let bins = volume_bins(&divisions, None);
        let length_scale = match length {
            Some(length) => Some(Scale { length, from: ScaleFrom::Given }),
            None => scale(&divisions, &free, true),
        };
        let Volumes { used, skipped, unit, .. } = volumes;
        let tests = adjacent_tests(&bins);
        let found = VolumesFound { groups, used, skipped, divisions, unit, length_scale, tests, bins };
        Ok(serde_json::to_string(&found)?)
    })
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
) -> Result<String, Error> {
    let points = |array: &PyReadonlyArray2<'_, f64>| -> Vec<[f64; 2]> {
        array.as_array().rows().into_iter().filter_map(|row| Some([*row.get(0)?, *row.get(1)?])).collect()
    };
    let measured: Vec<Vec<[f64; 2]>> = measured.iter().map(points).collect();
    let model: Vec<(f64, Vec<[f64; 2]>)> = model.iter().map(|(t, array)| (*t, points(array))).collect();
    supervised(py, Interrupt::Abandons, None, move |_| {
        length_scale(length, "unit of the contours")?;
        let contour = |of: &str, k: usize, points| match Contour::new(points) {
            Ok((contour, _)) => Ok(contour),
            Err(why) => Err(Error::not_allowed(format!("{of}[{k}]"), why, "a contour of three points or more")),
        };
        let traced = measured.into_iter().enumerate().map(|(k, points)| {
            let contour = contour("contours", k, points)?;
            Ok(Traced { file: k.to_string(), name: String::new(), contour, pixel: None, notes: Vec::new() })
        });
        let frames = model.into_iter().enumerate().map(|(k, (t, points))| {
            Ok(ModelContour { frame: k.to_string(), t, contour: contour("frames", k, points)? })
        });
        let (traced, frames) = (traced.collect::<Result<Vec<_>, Error>>()?, frames.collect::<Result<Vec<_>, Error>>()?);
        let series = laid_beside(&traced, &frames, length)
            .ok_or_else(|| Error::not_allowed("contours", "none", "at least one contour and one frame"))?;
        let points = |contour: &Contour| contour.points().iter().map(|p| [p.x, p.y]).collect();
        let laid = series.contours.iter().map(|one| one.laid.each_ref().map(points)).collect();
        Ok(serde_json::to_string(&ContoursFound { series: &series, laid })?)
    })
}
