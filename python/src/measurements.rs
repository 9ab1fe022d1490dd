//! Lifetimes and doses that were measured: the clock fitted to the first, and the model beside both.

use furrow_analysis::compare::dose::{MeasuredDoses, document, over_dose};
use furrow_analysis::compare::lifetimes::{self, compare_lifetimes as compared};
use furrow_analysis::fit::fit_clock as fitted;
use furrow_input::open_file;
use furrow_measured::dose::Doses;
use furrow_measured::lifetimes::{Lifetimes, mean_volumes};
use furrow_measured::names::Names;
use furrow_measured::published::{SOURCE, jankele2021_lifetimes, jankele2021_volumes};
use furrow_measured::volumes::{ReadOptions, Volumes};
use pyo3::prelude::*;
use serde_json::json;

use crate::document::Document;
use crate::errors::Error;
use crate::inputs::{Given, Source, Tables, bad_cue, is_empty, lineage_of};
use crate::memo::Memo;
use crate::supervise::{Interrupt, supervised};
use crate::trees::GrownTree;

/// Lifetimes of a table or of an embryo that another program followed; default published means.
fn lifetimes_of(table: &Source, frame_minutes: Option<f64>) -> Result<Lifetimes, Error> {
    Ok(match table {
        (Some(text), _) => Lifetimes::read(text.as_bytes(), "lifetimes")?,
        (None, Some(file)) => Lifetimes::read_file(file, frame_minutes, &Names::default())?,
        (None, None) => jankele2021_lifetimes()?,
    })
}

/// Volumes of tables and of embryos that other programs followed; default published means.
fn volumes_of(tables: &Tables) -> Result<Volumes, Error> {
    if is_empty(tables) {
        return Ok(jankele2021_volumes()?);
    }
    let ((files, text), mut volumes) = (tables, Volumes::default());
    if let Some(text) = text {
        volumes.read(text.as_bytes(), "volumes", &ReadOptions::default())?;
    }
    files.iter().try_for_each(|file| volumes.read_file(file, &ReadOptions::default()))?;
    volumes.require_used("volumes")?;
    Ok(volumes)
}

/// What errors and results call a table.
fn name_of((text, file): &Source) -> String {
    match (text, file) {
        (Some(_), _) => "the table".to_owned(),
        (None, Some(file)) => file.display().to_string(),
        (None, None) => SOURCE.to_owned(),
    }
}

/// Compares measured lifetimes with a tree.
#[pyfunction]
pub fn compare_lifetimes(
    py: Python<'_>,
    tree: &GrownTree,
    table: Source,
    volumes: Tables,
    frame_minutes: Option<f64>,
) -> Result<Document, Error> {
    py.detach(|| {
        let lifetimes = lifetimes_of(&table, frame_minutes)?;
        let published = [table == (None, None), is_empty(&volumes)];
        let volumes = volumes_of(&volumes)?;
        let found = compared(&tree.tree, &lifetimes, &mean_volumes(&volumes));
        Ok(lifetimes::document(&found, &lifetimes, &volumes, published).into())
    })
}

/// The clock of a lineage fitted to lifetimes and volumes.
#[pyfunction]
pub fn fit_clock(
    py: Python<'_>,
    table: Source,
    volumes: Tables,
    lineage: Option<String>,
    frame_minutes: Option<f64>,
) -> Result<Document, Error> {
    py.detach(|| {
        let of = lineage_of(lineage.as_deref())?;
        let lifetimes = lifetimes_of(&table, frame_minutes)?;
        let names = if is_empty(&volumes) { "the published volumes" } else { "volumes" };
        let volumes = volumes_of(&volumes)?;
        let clock = fitted(&of, &lifetimes, &volumes, names)?;
        let mut found = json!(clock);
        found["lifetimes"] = json!(name_of(&table));
        found["skipped_rows"] = lifetimes.skipped.iter().chain(&volumes.skipped).map(|row| json!(row)).collect();
        found["skipped_row_count"] = json!(lifetimes.skipped_count + volumes.skipped_count);
        found["ron"] = json!(clock.as_ron(lineage.is_none().then_some("c_elegans")));
        Ok(found.into())
    })
}

fn doses_of(table: &Source, bins: Option<&[f64]>) -> Result<MeasuredDoses, Error> {
    let doses = match table {
        (Some(text), _) => Doses::read(text.as_bytes(), "doses")?,
        (None, Some(file)) => Doses::read(open_file(file)?, &file.display().to_string())?,
        (None, None) => return Ok(MeasuredDoses::published()?),
    };
    Ok(MeasuredDoses::of(doses, bins))
}

/// Asymmetry over a dose beside the model's over the amplitude of a cue.
#[pyfunction]
#[pyo3(signature = (table, bins, cue, lineage, given, memo, threads, progress=None))]
pub fn compare_dose(
    py: Python<'_>,
    table: Source,
    bins: Option<Vec<f64>>,
    cue: String,
    lineage: Option<String>,
    mut given: Given,
    memo: &Memo,
    threads: usize,
    progress: Option<&Bound<'_, PyAny>>,
) -> Result<Document, Error> {
    let memo = memo.solved()?;
    supervised(py, Interrupt::Finishes, progress, move |watch| {
        let measured = doses_of(&table, bins.as_deref())?;
        let lineage = lineage_of(lineage.as_deref())?;
        let strongest = lineage.parse_cue(&cue).map_err(bad_cue)?;
        given.scale_radius(&lineage)?;
        let settings = given.for_divisions()?;
        let model = watch.scheduled(threads, |options| {
            over_dose(&settings.cell, &strongest, &measured, settings.numerics, &memo, options)
        })?;
        Ok(document(&measured, &model, (settings.cell.r0, &cue)).into())
    })
}
