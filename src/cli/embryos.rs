//! Input of measured embryos (files and folders, values for single embryos, names of cells) and reports about them.

use std::fmt::Write;
use std::path::PathBuf;

use clap::Args;
use furrow_analysis::compare::names_of;
use furrow_input::{InputError, listed};
use furrow_lineage::Lineage;
use furrow_measured::lifetimes::{EmbryoTimes, distortion};
use furrow_measured::matching::{Matched, Matching};
use furrow_measured::names::Names;
use furrow_measured::per_embryo::PerEmbryo;
use furrow_measured::tracked::{EmbryoFile, LeftOut, TableKind, embryo_files};
use furrow_measured::volumes::{EmbryoSize, Unit, Volumes};

use super::messages;
use super::output::{number, or_dash};

// Cells with names that differ from the lineage's.
#[derive(Debug, Args)]
#[command(next_help_heading = "Names")]
pub struct MatchArgs {
    /// Table (CSV) with the columns tracked (the name in the tables), name (the name in the lineage) and optionally embryo
    #[arg(long, value_name = "MAP.csv")]
    names: Option<PathBuf>,
    /// Cell of a tracked embryo and its name in the lineage; its descendants are named division by division. NAME alone refers to the
    /// only cell without a mother
    ///
    /// The larger daughter gets the name of the larger founder, or the first letter. If sizes are nearly equal or missing, the daughter
    /// that divides first gets the name of the cell that is known to divide first. Otherwise founders stay without names, and of other
    /// daughters the one that comes first in the file gets the first letter. Names in --names, and names of the lineage that cells already
    /// have, take precedence.
    #[arg(long, value_name = "TRACKED=NAME")]
    root: Vec<String>,
}

impl MatchArgs {
    /// Whether there is a table of names or a root.
    pub fn is_given(&self) -> bool {
        self.names.is_some() || !self.root.is_empty()
    }

    /// The names of a lineage's cells, to which others are matched.
    pub fn names(&self, lineage: &Lineage) -> Result<Names, InputError> {
        names_of(lineage).matched_by(Matching::read(self.names.as_deref(), &self.root, "--root")?)
    }
}

/// Largest number of omitted files with a separate warning; the rest is counted.
const MOST_LEFT_OUT: usize = 10;

/// The files of embryos and tables from paths, folders and patterns. Warnings list the omitted files.
pub fn files_of(paths: &[PathBuf], tables: TableKind) -> Result<Vec<EmbryoFile>, InputError> {
    let (files, left_out) = embryo_files(paths, tables)?;
    for LeftOut { why, .. } in left_out.iter().take(MOST_LEFT_OUT) {
        messages::warning!("not read: {why}");
    }
    if left_out.len() > MOST_LEFT_OUT {
        messages::warning!("not read: {} more files", left_out.len() - MOST_LEFT_OUT);
    }
    Ok(files)
}

/// A number for all embryos, or for one embryo.
pub type OfEmbryo = (Option<String>, f64);

/// Reads NUMBER or EMBRYO=NUMBER.
///
/// # Errors
/// As [`number`].
pub fn of_embryo(text: &str) -> Result<OfEmbryo, String> {
    match text.rsplit_once('=') {
        Some((embryo, value)) => Ok((Some(embryo.trim().to_owned()), number(value)?)),
        None => Ok((None, number(text)?)),
    }
}

/// The edge lengths of voxels.
pub fn voxels(given: &[OfEmbryo]) -> Result<PerEmbryo, InputError> {
    let voxels = PerEmbryo::of_list(given, "--voxel")?;
    voxels.require_in([1e-6, 1e6], ("--voxel", "voxel"), "a length in µm, from 1e-6 to 1e6")?;
    Ok(voxels)
}

/// Minutes per frame.
pub fn frame_minutes(given: &[OfEmbryo]) -> Result<PerEmbryo, InputError> {
    let minutes = PerEmbryo::of_list(given, "--frame-minutes")?;
    minutes.require_in([1e-6, 1e6], ("--frame-minutes", "frame_minutes"), "a time in minutes, from 1e-6 to 1e6")?;
    Ok(minutes)
}

/// The report on the matching of cells.
pub fn matched_text(matched: &[Matched]) -> String {
    matched.iter().map(Matched::to_string).collect()
}

/// A factor and the scatter of the cells about it, in per cent.
fn factor_text(factor: Option<f64>, scatter: Option<f64>) -> String {
    let scatter = scatter.map_or(String::new(), |scatter| format!(" ± {:.1} %", 100.0 * scatter));
    or_dash(factor, 4) + &scatter
}

fn width(names: impl Iterator<Item = usize>) -> usize {
    names.fold(10, usize::max)
}

/// The size factors of embryos, if there are at least two.
pub fn sizes_text(sizes: &[EmbryoSize], unit: Option<Unit>) -> String {
    if sizes.len() < 2 {
        return String::new();
    }
    let wide = width(sizes.iter().map(|size| size.embryo.chars().count()));
    let of = if unit == Some(Unit::CubicMicrometres) { " (µm)" } else { "" };
    let is_scaled = sizes.iter().any(|size| size.length_scale.is_some());
    let last = if is_scaled { format!("   one L_h{of}") } else { String::new() };
    let mut out = format!("{:<wide$} cells  shared   voxel (µm)        size factor{last}\n", "embryo");
    for EmbryoSize { embryo, cells, shared, voxel, size_factor, scatter, length_scale, .. } in sizes {
        let (factor, voxel) = (factor_text(*size_factor, *scatter), or_dash(*voxel, 4));
        let length = if is_scaled { format!(" {:>9}", or_dash(*length_scale, 4)) } else { String::new() };
        let _ = writeln!(out, "{embryo:<wide$} {cells:>5} {shared:>7} {voxel:>12} {factor:>18}{length}");
    }
    out + "\n"
}

/// The time factors of embryos, if there are at least two.
pub fn times_text(times: &[EmbryoTimes]) -> String {
    if times.len() < 2 {
        return String::new();
    }
    let wide = width(times.iter().map(|times| times.embryo.chars().count()));
    let mut out = format!("{:<wide$} cells  shared   min a frame        time factor   minute 0\n", "embryo");
    for EmbryoTimes { embryo, cells, shared, frame_minutes, time_factor, scatter, shift_min } in times {
        let (factor, minutes) = (factor_text(*time_factor, *scatter), or_dash(*frame_minutes, 3));
        let shift = or_dash(*shift_min, 2);
        let _ = writeln!(out, "{embryo:<wide$} {cells:>5} {shared:>7} {minutes:>13} {factor:>18} {shift:>10}");
    }
    out + "\n"
}

/// Names embryos that share cells but have no size factor.
pub fn warn_of_sizes(sizes: &[EmbryoSize]) {
    let apart = sizes.iter().filter(|size| size.shared > 0 && size.size_factor.is_none());
    warn_of_apart(apart.map(|size| size.embryo.as_str()), "size factor");
}

/// Cells of embryos of other sizes change proportions of mean volumes by this factor at most without a warning.
const DISTORTED: f64 = 1.1;

/// Says which embryos have no size factor, and whether sizes distort mean volumes.
pub fn warn_of_averages(volumes: &Volumes) {
    warn_of_sizes(&volumes.sizes());
    let by = distortion(volumes);
    if !volumes.common_size && by > DISTORTED {
        messages::warning!(
            "embryos of different sizes lack different cells, which changes ratios of mean volumes by a factor of up to {by:.2}; \
             --common-size prevents this"
        );
    }
}

/// Names embryos that share cells but have no time factor.
pub fn warn_of_times(times: &[EmbryoTimes]) {
    let apart = times.iter().filter(|times| times.shared > 0 && times.time_factor.is_none());
    warn_of_apart(apart.map(|times| times.embryo.as_str()), "time factor or minute 0");
}

fn warn_of_apart<'a>(names: impl Iterator<Item = &'a str>, what: &str) {
    let names = listed(names, ", ");
    if !names.is_empty() {
        messages::warning!(
            "no {what} of {names}: they share cells with each other, but no cell connects them with the other embryos"
        );
    }
}
