//! Lifetimes and doses that were measured: the clock fitted to the first, and the model beside both.

use furrow_analysis::compare::dose::{doses_to, over_dose};
use furrow_analysis::compare::lifetimes::lifetimes_beside;
use furrow_analysis::fit::fit_clock as fitted;
use furrow_input::open_file;
use furrow_lineage::batch::SchedulerOptions;
use furrow_measured::dose::{DoseGroup, Doses, by_condition, by_dose, trend};
use furrow_measured::lifetimes::{Lifetimes, mean_volumes};
use furrow_measured::published::{DOSE_SOURCE, SOURCE, jankele2021_lifetimes, jankele2021_volumes, rodrigues2024};
use furrow_measured::volumes::{ReadOptions, Volumes};
use pyo3::prelude::*;
use serde_json::json;

use crate::errors::Error;
use crate::inputs::{Given, Source, Tables, bad_cue, is_empty, lineage_of};
use crate::memo::Memo;
use crate::supervise::{Interrupt, supervised};
use crate::trees::GrownTree;

/// Lifetimes of a table or of an embryo that another program followed; default published means.
fn lifetimes_of(table: &Source, frame_minutes: Option<f64>) -> Result<Lifetimes, Error> {
    Ok(match table {
        (Some(text), _) => Lifetimes::read(text.as_bytes(), "lifetimes")?,
        (None, Some(file)) => Lifetimes::read_file(file, frame_minutes)?,
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

/// Measured lifetimes beside those of a tree, as JSON.
#[pyfunction]
pub fn compare_lifetimes(
    py: Python<'_>,
    tree: &GrownTree,
    table: Source,
    volumes: Tables,
    frame_minutes: Option<f64>,
) -> Result<String, Error> {
    py.detach(|| {
        let lifetimes = lifetimes_of(&table, frame_minutes)?;
        let published = [table == (None, None), is_empty(&volumes)].map(|published| published.then_some(SOURCE));
        let volumes = volumes_of(&volumes)?;
        let mut found = json!(lifetimes_beside(&tree.tree, &lifetimes, &mean_volumes(&volumes)));
        found["source"] = json!(published[0]);
        found["volumes_source"] = json!(published[1]);
        found["volumes_unit"] = json!(volumes.unit);
        found["used"] = json!(lifetimes.used);
        found["skipped"] = json!(lifetimes.skipped);
        found["skipped_count"] = json!(lifetimes.skipped_count);
        found["volumes_skipped"] = json!(volumes.skipped);
        found["volumes_skipped_count"] = json!(volumes.skipped_count);
        Ok(found.to_string())
    })
}

/// The clock of a lineage fitted to lifetimes and volumes, as JSON.
#[pyfunction]
pub fn fit_clock(
    py: Python<'_>,
    table: Source,
    volumes: Tables,
    lineage: Option<String>,
    frame_minutes: Option<f64>,
) -> Result<String, Error> {
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
        Ok(found.to_string())
    })
}

/// Divisions over a dose, their groups by condition and by dose, and what published them.
type Dosed = (Doses, [Vec<DoseGroup>; 2], Option<&'static str>);

fn doses_of(table: &Source, bins: Option<&[f64]>) -> Result<Dosed, Error> {
    let doses = match table {
        (Some(text), _) => Doses::read(text.as_bytes(), "doses")?,
        (None, Some(file)) => Doses::read(open_file(file)?, &file.display().to_string())?,
        (None, None) => return Ok((Doses::default(), rodrigues2024()?, Some(DOSE_SOURCE))),
    };
    let groups = [by_condition(&doses.divisions), by_dose(&doses.divisions, bins)];
    Ok((doses, groups, None))
}

/// Asymmetry over a dose beside the model's over the amplitude of a cue, as JSON.
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
) -> Result<String, Error> {
    let memo = memo.solved()?;
    supervised(py, Interrupt::Finishes, progress, move |watch| {
        let (doses, [conditions, bins], source) = doses_of(&table, bins.as_deref())?;
        let lineage = lineage_of(lineage.as_deref())?;
        let strongest = lineage.parse_cue(&cue).map_err(bad_cue)?;
        given.scale_radius(&lineage)?;
        let settings = given.for_divisions()?;
        let means: Vec<f64> = bins.iter().map(|bin| bin.dose.mean).collect();
        let single = doses.divisions.iter().map(|division| division.dose);
        let mut wanted = doses_to(single.chain(means.iter().copied()).fold(1.0, f64::max));
        let count = wanted.len();
        wanted.extend(means);
        let show = |progress| watch.divisions(progress);
        let interrupt = Some(&watch.stop);
        let options = SchedulerOptions { threads, interrupt, progress: Some(&show), ..SchedulerOptions::default() };
        let mut curve = over_dose(&settings.cell, &strongest, &wanted, (settings.numerics, 0), &memo, &options)?;
        let by_bin = curve.split_off(count);
        let beside = bins.iter().zip(&by_bin).map(|(bin, model)| {
            let mut row = json!(bin);
            row["model"] = json!(model);
            row
        });
        let found = json!({
            "source": source,
            "used": doses.divisions.len(),
            "skipped": doses.skipped,
            "skipped_count": doses.skipped_count,
            "conditions": conditions,
            "bins": beside.collect::<Vec<_>>(),
            "trend": trend(&doses.divisions),
            "model": { "r0": settings.cell.r0, "cue": cue, "points": curve },
        });
        Ok(found.to_string())
    })
}
