//! Lifetimes and doses that were measured: the clock fitted to the first, and the model beside both.

use furrow_analysis::compare::dose::{MeasuredDoses, document, over_dose};
use furrow_analysis::compare::lifetimes::{self, compare_lifetimes as compared};
use furrow_analysis::fit::fit_clock as fitted;
use furrow_figures::plot;
use furrow_input::{listed, open_file};
use furrow_lineage::Lineage;
use furrow_measured::dose::Doses;
use furrow_measured::lifetimes::{LifetimeOptions, Lifetimes, mean_volumes};
use furrow_measured::names::Names;
use furrow_measured::published::{SOURCE, jankele2021_lifetimes, jankele2021_volumes};
use furrow_measured::tracked::{TableKind, embryo_files};
use furrow_measured::volumes::{ReadOptions, Volumes};
use pyo3::prelude::*;
use serde_json::json;

use crate::document::Document;
use crate::drawings::Drawing;
use crate::errors::Error;
use crate::inputs::{
    Given, MatchAsked, OfEmbryos, Source, Tables, bad_cue, is_empty, lineage_of, matched_names, of_embryos,
};
use crate::memo::Memo;
use crate::supervise::{Interrupt, supervised};
use crate::trees::GrownTree;

/// The arguments that lifetimes and volumes share; Python gives them as a dict.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct TimesAsked {
    table: Tables,
    volumes: Tables,
    frame_minutes: OfEmbryos,
    common_pace: bool,
    common_size: bool,
    matching: MatchAsked,
}

impl TimesAsked {
    /// Lifetimes of tables and of embryos that other programs followed, and volumes of these; default published means, which are used
    /// `only_of_worm`, or of any lineage.
    fn read(&self, lineage: &Lineage, only_of_worm: bool) -> Result<(Lifetimes, Volumes), Error> {
        let names = matched_names(lineage, &self.matching)?;
        let frame_minutes = of_embryos("frame_minutes", &self.frame_minutes, "a time in minutes above 0")?;
        let options = LifetimeOptions { frame_minutes, common_pace: self.common_pace, names: names.clone() };
        let lifetimes = match &self.table {
            (_, Some(text)) => Lifetimes::read_with(text.as_bytes(), "lifetimes", &options)?,
            (files, None) if files.is_empty() => jankele2021_lifetimes()?,
            (files, None) => Lifetimes::read_files(&embryo_files(files, TableKind::Lifetimes)?.0, &options)?,
        };
        let mut volumes = self.read_volumes(&names, only_of_worm)?;
        volumes.common_size = self.common_size;
        names.require_met()?;
        Ok((lifetimes, volumes))
    }

    fn read_volumes(&self, names: &Names, only_of_worm: bool) -> Result<Volumes, Error> {
        if is_empty(&self.volumes) {
            return Ok(if names.are_of_worm() || !only_of_worm { jankele2021_volumes()? } else { Volumes::default() });
        }
        let ((files, text), mut volumes) = (&self.volumes, Volumes::default());
        let options = ReadOptions { names: names.clone(), ..ReadOptions::default() };
        if let Some(text) = text {
            volumes.read(text.as_bytes(), "volumes", &options)?;
        }
        embryo_files(files, TableKind::Volumes)?.0.iter().try_for_each(|file| volumes.read_file(file, &options))?;
        volumes.require_used("volumes")?;
        Ok(volumes)
    }
}

/// What errors and results call tables.
fn name_of((files, text): &Tables) -> String {
    let files: Vec<String> = files.iter().map(|file| file.display().to_string()).collect();
    match text {
        Some(_) => "the table".to_owned(),
        None if files.is_empty() => SOURCE.to_owned(),
        None => listed(files.iter().map(String::as_str), ", "),
    }
}

/// Compares measured lifetimes with a tree.
#[pyfunction]
pub fn compare_lifetimes(py: Python<'_>, tree: &GrownTree, asked: TimesAsked) -> Result<Document, Error> {
    py.detach(|| {
        let (lifetimes, volumes) = asked.read(&tree.tree.lineage, true)?;
        let published = [is_empty(&asked.table), is_empty(&asked.volumes) && lifetimes.names.are_of_worm()];
        let found = compared(&tree.tree, &lifetimes, &mean_volumes(&volumes));
        Ok(lifetimes::document(&found, &lifetimes, &volumes, published).into())
    })
}

/// The clock of a lineage fitted to lifetimes and volumes.
#[pyfunction]
pub fn fit_clock(py: Python<'_>, asked: TimesAsked, lineage: Option<String>) -> Result<(Document, Drawing), Error> {
    py.detach(|| {
        let of = lineage_of(lineage.as_deref())?;
        let (lifetimes, volumes) = asked.read(&of, false)?;
        let names = if is_empty(&asked.volumes) { "the published volumes" } else { "volumes" };
        let clock = fitted(&of, &lifetimes, &volumes, names)?;
        let mut found = json!(clock);
        found["lifetimes"] = json!(name_of(&asked.table));
        found["skipped_rows"] = lifetimes.skipped.iter().chain(&volumes.skipped).map(|row| json!(row)).collect();
        found["skipped_row_count"] = json!(lifetimes.skipped_count + volumes.skipped_count);
        found["embryos"] = json!(lifetimes.embryos);
        found["matched"] = json!(lifetimes.matched);
        found["ron"] = json!(clock.as_ron(lineage.is_none().then_some("c_elegans")));
        Ok((found.into(), Drawing::of(plot::clock::draw(&clock))))
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
    let (of_call, memo) = (memo, memo.solved()?);
    let found = supervised(py, Interrupt::Finishes, progress, move |watch| {
        let measured = doses_of(&table, bins.as_deref())?;
        let lineage = lineage_of(lineage.as_deref())?;
        let strongest = lineage.parse_cue(&cue).map_err(bad_cue)?;
        given.parameters.scale_radius(&lineage)?;
        let settings = given.for_divisions()?;
        let model = watch.scheduled(threads, |options| {
            over_dose(&settings.cell, &strongest, &measured, settings.numerics, &memo, options)
        })?;
        Ok(document(&measured, &model, (settings.cell.r0, &cue)).into())
    });
    of_call.warned(py, found)
}
