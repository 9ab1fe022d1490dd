//! Cells of one embryo, followed over time by other programs: their names, mothers, births, divisions and sizes.
//!
//! | file | reads |
//! |---|---|
//! | `acetree`, `archive` | nuclei of AceTree and StarryNite: a zip archive, or the folder in it |
//! | `cd` | CD tables of AceTree |
//! | `spot_tables` | spots and links of TrackMate and Mastodon as CSV |
//! | `geff`, `zarr`, `unpack` | GEFF, the graph exchange format, in Zarr arrays |
//! | `spots` | spots and links of any format, as cells |
//!
//! A cell is a chain of spots between two divisions. [`read_tracked`] recognises a format by the content of the file.
//!
//! # References
//! Murray, Bao, Boyle & Waterston, *Nat. Protoc.* 1, 1468 (2006) (AceTree); Ershov et al., *Nat. Methods* 19, 829 (2022)
//! (TrackMate); <https://live-image-tracking-tools.github.io/geff> (GEFF).

mod acetree;
mod archive;
mod cd;
mod geff;
mod lifetimes;
mod rounds;
mod spot_tables;
mod spots;
mod unpack;
mod zarr;

use std::io::Read;
use std::path::Path;

use furrow_input::{InputError, open_file};
use serde::Serialize;

pub use rounds::TrackedRounds;

use crate::volumes::{Skipped, Unit};

/// Unit of times.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum TimeUnit {
    /// Frames of the recording.
    Frames,
    /// Minutes.
    Minutes,
}

/// A cell, from its birth to its division.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TrackedCell {
    /// Its name; that of its first spot if it has none of Sulston's.
    pub name: String,
    /// The index of its mother; `None` if it was there from the start, or its mother is not known.
    pub mother: Option<usize>,
    /// The indices of its daughters: none, one or two.
    pub daughters: Vec<usize>,
    /// The time of its first spot.
    pub birth: f64,
    /// The time of its first daughter's first spot; `None` if it was not seen to divide.
    pub division: Option<f64>,
    /// The time of its last spot.
    pub last: f64,
    /// Mean volume over its spots; `None` if none has a size.
    pub volume: Option<f64>,
    /// Spots with a size.
    pub sizes: u64,
    /// Where its first spot is: the file and the line, from 1 (0 if the format has no lines).
    pub place: (String, u64),
}

impl TrackedCell {
    /// Time from birth to division; `None` unless both were seen.
    pub fn lifetime(&self) -> Option<f64> {
        self.mother?;
        Some(self.division? - self.birth)
    }
}

/// The cells of one embryo.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TrackedLineage {
    /// The embryo, named after the file.
    pub name: String,
    /// The format.
    pub format: Format,
    /// Mothers before daughters.
    pub cells: Vec<TrackedCell>,
    /// The unit of times.
    pub time: TimeUnit,
    /// The unit of volumes.
    pub volumes: Unit,
    /// What could not be used, at most [`MOST_PLACES`](crate::volumes::MOST_PLACES).
    pub skipped: Vec<Skipped>,
    /// How much there is of it.
    pub skipped_count: u64,
}

impl TrackedLineage {
    /// Whether sizes are those of nuclei rather than of cells.
    pub fn of_nuclei(&self) -> bool {
        matches!(self.format, Format::AceTree | Format::CdTable)
    }
}

/// A format of tracked cells.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Format {
    /// Nuclei of AceTree and StarryNite.
    AceTree,
    /// A CD table of AceTree.
    CdTable,
    /// Spots and edges of TrackMate.
    TrackMate,
    /// Spots and links of Mastodon.
    Mastodon,
    /// GEFF.
    Geff,
}

impl Format {
    /// Its name in messages.
    pub fn name(self) -> &'static str {
        match self {
            Format::AceTree => "nuclei of AceTree",
            Format::CdTable => "CD table",
            Format::TrackMate => "spots of TrackMate",
            Format::Mastodon => "spots of Mastodon",
            Format::Geff => "GEFF",
        }
    }
}

/// What files do not say.
#[derive(Clone, Copy, Debug, Default)]
pub struct TrackOptions {
    /// Edge of a pixel in µm, for sizes in pixels.
    pub pixel: Option<f64>,
    /// Minutes from one frame to the next, for times in frames.
    pub frame_minutes: Option<f64>,
}

/// Bytes at the start of a file that decide its format.
const HEAD: u64 = 4096;

/// The format of a file or folder of tracked cells; `None` if it is none.
///
/// # Errors
/// A file that cannot be read.
pub fn format_of(path: &Path) -> Result<Option<Format>, InputError> {
    if path.is_dir() {
        let is_zarr = path.join("zarr.json").is_file() || path.join(".zgroup").is_file();
        return Ok(if is_zarr { Some(Format::Geff) } else { acetree::is_folder(path).then_some(Format::AceTree) });
    }
    // A pipe can be read only once: it is a plain table.
    if path.exists() && !path.is_file() {
        return Ok(None);
    }
    let mut head = Vec::new();
    let read = open_file(path)?.take(HEAD).read_to_end(&mut head);
    read.map_err(|e| InputError::Unreadable { file: path.display().to_string(), reason: e.to_string() })?;
    if head.starts_with(b"PK\x03\x04") || head.starts_with(b"PK\x05\x06") {
        return Ok(Some(Format::AceTree));
    }
    let line = head.split(|byte| *byte == b'\n').next().unwrap_or_default();
    let line = String::from_utf8_lossy(line.strip_prefix(b"\xef\xbb\xbf").unwrap_or(line));
    let columns: Vec<&str> =
        line.split([',', ';', '\t']).map(|name| name.trim_matches(|c: char| c == '"' || c.is_whitespace())).collect();
    let cd = cd::is_table(&columns).then_some(Format::CdTable);
    Ok(cd.or_else(|| spot_tables::format_of(&columns)))
}

/// Reads an embryo that was followed; as [`read_tracked`], but a file in none of the formats is an error.
///
/// # Errors
/// Those of [`read_tracked`], and a file in none of the [formats](Format).
pub fn read_embryo(path: &Path, options: &TrackOptions) -> Result<TrackedLineage, InputError> {
    let reason = "it is neither of AceTree, StarryNite, TrackMate, Mastodon nor GEFF";
    let other = || InputError::other_file(path.display(), "an embryo that was followed", reason);
    read_tracked(path, options)?.ok_or_else(other)
}

/// Reads a file or folder of tracked cells; `None` if it is in none of the [formats](Format).
///
/// # Errors
/// A file that cannot be read or does not follow its format: names the file, line, field, value and what is allowed.
pub fn read_tracked(path: &Path, options: &TrackOptions) -> Result<Option<TrackedLineage>, InputError> {
    let Some(format) = format_of(path)? else { return Ok(None) };
    let mut lineage = match format {
        Format::AceTree => acetree::read(path, options),
        Format::CdTable => cd::read(path, options),
        Format::TrackMate | Format::Mastodon => spot_tables::read(path, format, options),
        Format::Geff => geff::read(path, options),
    }?;
    if let Some(minutes) = options.frame_minutes.filter(|_| lineage.time == TimeUnit::Frames) {
        lineage.time = TimeUnit::Minutes;
        for cell in &mut lineage.cells {
            let times = [&mut cell.birth, &mut cell.last].into_iter().chain(&mut cell.division);
            times.for_each(|time| *time *= minutes);
        }
    }
    Ok(Some(lineage))
}

/// The volume of a sphere.
fn sphere(diameter: f64) -> f64 {
    std::f64::consts::FRAC_PI_6 * diameter.powi(3)
}

/// The volume of a sphere whose diameter is given in pixels, and its unit: µm³ where a pixel's edge is known.
fn sphere_of_pixels(diameter: f64, options: &TrackOptions) -> f64 {
    sphere(diameter * options.pixel.unwrap_or(1.0))
}

/// The unit of volumes from sizes in pixels.
fn unit_of_pixels(options: &TrackOptions) -> Unit {
    if options.pixel.is_some() { Unit::CubicMicrometres } else { Unit::Voxels }
}

/// The embryo of a file: its name without its extension.
fn embryo_of(path: &Path) -> String {
    path.file_stem().map_or_else(|| path.display().to_string(), |stem| stem.to_string_lossy().into_owned())
}

#[cfg(test)]
mod tests;
