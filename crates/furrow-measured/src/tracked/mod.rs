//! Cells of one embryo, followed over time by other programs: their names, mothers, births, divisions and sizes.
//!
//! | file | reads |
//! |---|---|
//! | `acetree`, `archive` | nuclei of AceTree and StarryNite: a zip archive, or the folder in it |
//! | `cd` | CD tables of AceTree |
//! | `spot_tables` | spots and links of TrackMate and Mastodon as CSV |
//! | `xml` | the files of TrackMate and MaMuT |
//! | `track_tables` | tables of tracks of napari, ultrack, btrack, funtracks and ilastik |
//! | `ctc` | tracks of the Cell Tracking Challenge |
//! | `exported` | cells with their mothers, as furrow exports trees and embryos |
//! | `geff`, `geff_units`, `zarr`, `shards`, `unpack` | GEFF, the graph exchange format, in Zarr arrays |
//! | `container` | the GEFF inside a folder |
//! | `files` | the embryos in folders and patterns |
//! | `chains` | links spots, where the file lists the spots of a cell together |
//! | `rows` | rows that are given twice, and links past spots that cannot be used |
//! | `spots` | spots and links of any format, as cells |
//! | `lengths`, `times` | units of lengths and times, volumes of spheres |
//! | `namesakes` | the order of several cells of one name |
//! | `kin` | links that contradict names, births of sisters |
//!
//! A cell is a chain of spots between two divisions. [`read_tracked`] recognises a format by the content of the file.
//!
//! # References
//! Murray, Bao, Boyle & Waterston, *Nat. Protoc.* 1, 1468 (2006) (AceTree); Ershov et al., *Nat. Methods* 19, 829 (2022)
//! (TrackMate); <https://live-image-tracking-tools.github.io/geff> (GEFF).

mod acetree;
#[cfg_attr(target_arch = "wasm32", path = "archive_without_files.rs")]
mod archive;
mod cd;
mod chains;
mod container;
mod ctc;
mod exported;
mod files;
mod geff;
mod geff_units;
mod kin;
pub(crate) mod lengths;
mod lifetimes;
mod namesakes;
mod rounds;
mod rows;
mod shards;
mod spot_tables;
mod spots;
mod times;
mod track_tables;
mod unpack;
mod xml;
mod zarr;

use std::collections::HashMap;
use std::io::{Cursor, Read};
use std::path::{Path, PathBuf};

use furrow_input::table::text;
use furrow_input::{InputError, foreign, open_file};
use serde::Serialize;

pub use files::{EmbryoFile, LeftOut, TableKind, embryo_files};
pub use lifetimes::TrackedLifetimes;
pub use rounds::{Absent, FollowedRounds, TrackedRounds};

use crate::matching::Matched;
use crate::names::Names;
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
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct TrackedCell {
    /// Its name in Sulston's lineage or one that it is matched to, or else its first spot's name.
    pub name: String,
    /// Its name in the file.
    pub tracked: String,
    /// The index of its mother; `None` if it was there from the start, or its mother is not known.
    pub mother: Option<usize>,
    /// The indices of its daughters, at most two.
    pub daughters: Vec<usize>,
    /// The time of its first spot, or of its sister's, whichever is earlier.
    pub birth: f64,
    /// The time of its first spot.
    #[serde(skip)]
    pub(crate) first: f64,
    /// The time of its first daughter's first spot; `None` if it was not seen to divide.
    pub division: Option<f64>,
    /// The time of its last spot.
    pub last: f64,
    /// Mean volume over its spots; `None` if no spot has a size.
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

    /// The report of this cell as unused.
    pub(crate) fn unused(&self, why: &str) -> Skipped {
        let (file, line) = self.place.clone();
        Skipped {
            file,
            line,
            column: "name".to_owned(),
            value: self.name.chars().take(80).collect(),
            why: why.to_owned(),
        }
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
    /// How its cells were [matched](crate::matching) to a lineage; `None` if they were not.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub matched: Option<Matched>,
    /// The names and ids of all spots, with the cell that each is of.
    #[serde(skip)]
    pub(crate) spots: SpotNames,
    /// Which options say something of the file.
    #[serde(skip)]
    pub(crate) takes: Takes,
    /// The time from one frame to the next.
    #[serde(skip)]
    pub(crate) frame: f64,
    /// Why its sizes are left out, where all spots have one: only what needs sizes has to say so.
    #[serde(skip)]
    pub unknown_sizes: Option<Skipped>,
}

/// Which of the [`TrackOptions`] a file lacks, so that they say something of it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Takes {
    /// Minutes from one frame to the next: its times are frames.
    pub frame_minutes: bool,
    /// The edge of a pixel: its sizes are in pixels or voxels.
    pub pixel: bool,
    /// A unit, since it has volumes without one.
    pub unit: bool,
}

/// Names and ids of spots, with the cell that each is of; `None` if it is of several.
pub(crate) type SpotNames = HashMap<String, Option<usize>>;

/// The result of a search for a tracked name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Place {
    /// No cell.
    Nowhere,
    /// A cell.
    Cell(usize),
    /// Several cells.
    Several,
}

impl TrackedLineage {
    /// Leaves out all sizes, if a report says why they are unknown.
    fn leave_out_sizes(&mut self, report: Option<Skipped>) {
        let Some(report) = report else { return };
        self.cells.iter_mut().for_each(|cell| (cell.volume, cell.sizes) = (None, 0));
        self.unknown_sizes.get_or_insert(report);
    }

    /// The cell of this name, or with a spot of this name or id.
    pub(crate) fn place_of(&self, name: &str) -> Place {
        let mut named = self.cells.iter().enumerate().filter(|(_, cell)| cell.name == name).map(|(k, _)| k);
        match (named.next(), named.next(), self.spots.get(name)) {
            (Some(cell), None, _) => Place::Cell(cell),
            (None, _, Some(Some(cell))) => Place::Cell(*cell),
            (None, _, None) => Place::Nowhere,
            _ => Place::Several,
        }
    }

    /// Requires that options that were given say something of the file.
    ///
    /// # Errors
    /// Minutes per frame for times in minutes, or a pixel's edge for sizes that are in no pixels.
    pub fn require_options(&self, options: &TrackOptions) -> Result<(), InputError> {
        let given = "(given)";
        let fine = options.frame_minutes.is_none() || self.takes.frame_minutes;
        let allowed = format!("left out: the times of {} are in minutes", self.name);
        InputError::require(fine, "--frame-minutes", "frame_minutes", given, allowed)?;
        let allowed = format!("left out: {} has no sizes in voxels or pixels", self.name);
        InputError::require(options.pixel.is_none() || self.takes.pixel, "--voxel", "voxel", given, allowed)
    }

    /// Whether sizes belong to nuclei rather than to cells.
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
    /// The file of TrackMate or MaMuT.
    TrackMateXml,
    /// A table of tracks of napari, ultrack or btrack.
    Tracks,
    /// Tracks of the Cell Tracking Challenge.
    Ctc,
    /// Cells with their mothers, as furrow exports them.
    Exported,
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
            Format::TrackMateXml => "spots of TrackMate or MaMuT",
            Format::Tracks => "table of tracks",
            Format::Ctc => "tracks of the Cell Tracking Challenge",
            Format::Exported => "table of cells of furrow export",
        }
    }
}

/// Information that files lack.
#[derive(Clone, Copy, Debug, Default)]
pub struct TrackOptions {
    /// Edge of a pixel in µm, for sizes in pixels.
    pub pixel: Option<f64>,
    /// Minutes from one frame to the next, for times in frames.
    pub frame_minutes: Option<f64>,
    /// Sizes are not needed: those in an unknown unit of length count as pixels.
    pub without_sizes: bool,
    /// Unit of the file's volumes without a unit.
    pub unit: Option<Unit>,
}

/// Bytes at the start of a file that decide its format.
const HEAD: u64 = 4096;

/// The format of a file or folder of tracked cells, and the folder in it that has the cells; `None` for other files.
fn located(path: &Path) -> Result<Option<(Format, PathBuf)>, InputError> {
    let here = |format: Format| Some((format, path.to_owned()));
    if path.is_dir() {
        if acetree::is_folder(path) {
            return Ok(here(Format::AceTree));
        }
        if let Some(tracks) = ctc::IN_FOLDER.iter().map(|name| path.join(name)).find(|tracks| tracks.is_file()) {
            return Ok(Some((Format::Ctc, tracks)));
        }
        return Ok(Some((Format::Geff, container::geff_in(path)?)));
    }
    located_file(path)
}

/// As [`located`], of a file.
fn located_file(path: &Path) -> Result<Option<(Format, PathBuf)>, InputError> {
    let here = |format: Format| Some((format, path.to_owned()));
    // A pipe can be read only once: it is a plain table.
    if path.exists() && !path.is_file() {
        return Ok(None);
    }
    let mut head = Vec::new();
    open_file(path)?.take(HEAD).read_to_end(&mut head).map_err(|e| InputError::unreadable(path, e))?;
    if head.starts_with(b"PK\x03\x04") || head.starts_with(b"PK\x05\x06") {
        let names = archive::names(path)?;
        if !names.iter().any(|name| acetree::is_of_nuclei(name)) {
            foreign::refuse_archive(path, &names)?;
        }
        return Ok(here(Format::AceTree));
    }
    let text = text(head.strip_prefix(b"\xef\xbb\xbf").unwrap_or(&head));
    if xml::is_model(&text) {
        return Ok(here(Format::TrackMateXml));
    }
    if foreign::is_ctc(&text) {
        return Ok(here(Format::Ctc));
    }
    if ctc::is_called_so(path) && foreign::has_only_numbers(&text) {
        let reason = format!("a line of it must be {}", ctc::LINE);
        return Err(InputError::other_file(path.display(), Format::Ctc.name(), reason));
    }
    foreign::refuse(&path.display().to_string(), &head, foreign::WANTED)?;
    if path.file_name().is_some_and(|name| acetree::is_of_nuclei(&name.to_string_lossy())) {
        let reason = "it has the nuclei of one frame: the folder or the archive with all frames must be given";
        return Err(InputError::other_file(path.display(), "an embryo that was followed", reason));
    }
    Ok(format_by_columns(&text).and_then(here))
}

/// The format of a table by the names of its columns. Lines of separators alone, as spreadsheets write empty rows, are no heading.
fn format_by_columns(text: &str) -> Option<Format> {
    let is_filled = |line: &str| line.contains(|c: char| !c.is_whitespace() && ![',', ';', '"'].contains(&c));
    let is_heading = |line: &&str| is_filled(line) && !line.starts_with(['#']) && !line.starts_with("sep=");
    let line = text.split(['\n', '\r']).find(is_heading).unwrap_or_default();
    let separators: &[char] = if line.contains([',', ';', '\t']) { &[',', ';', '\t'] } else { &[' '] };
    let columns: Vec<&str> =
        line.split(separators).map(|name| name.trim_matches(|c: char| c == '"' || c.is_whitespace())).collect();
    let cd = cd::is_table(&columns).then_some(Format::CdTable);
    let tracks = || track_tables::is_table(&columns).then_some(Format::Tracks);
    cd.or_else(|| spot_tables::format_of(&columns)).or_else(tracks)
}

/// Why an embryo must be a file.
const NO_PIPE: &str = "must be a file and no pipe, which can be read only once";

/// Opens a table, which may be a pipe.
///
/// # Errors
/// A file that cannot be read; a pipe with an embryo that was followed.
pub(crate) fn open_table(path: &Path) -> Result<Box<dyn Read>, InputError> {
    let mut opened = open_file(path)?;
    if path.is_file() {
        return Ok(Box::new(opened));
    }
    let mut head = Vec::new();
    (&mut opened).take(HEAD).read_to_end(&mut head).map_err(|e| InputError::unreadable(path, e))?;
    let text = text(&head);
    let format = match () {
        () if head.starts_with(b"PK\x03\x04") => Some(Format::AceTree),
        () if xml::is_model(&text) => Some(Format::TrackMateXml),
        () if foreign::is_ctc(&text) => Some(Format::Ctc),
        () => format_by_columns(&text),
    };
    match format {
        Some(format) => {
            let reason = format!("an embryo that was followed ({}) {NO_PIPE}", format.name());
            Err(InputError::other_file(path.display(), "a table", reason))
        }
        None => Ok(Box::new(Cursor::new(head).chain(opened))),
    }
}

/// Reads an embryo that was followed, with its cells [matched](crate::matching) to these names; a file in another format is an error. A
/// table of cells with their mothers, as furrow exports trees and embryos, is such an embryo too.
///
/// # Errors
/// As [`read_tracked`] and [`TrackedLineage::match_names`]; a file outside the [formats](Format).
pub fn read_embryo(path: &Path, options: &TrackOptions, names: &Names) -> Result<TrackedLineage, InputError> {
    let reason = "it is neither of AceTree, StarryNite, TrackMate, MaMuT, Mastodon, napari, ultrack, the Cell Tracking Challenge nor GEFF";
    let reason = if path.is_file() { reason.to_owned() } else { format!("it {NO_PIPE}") };
    let other = || InputError::other_file(path.display(), "an embryo that was followed", reason);
    let exported = || if path.is_file() { exported::read(path) } else { Ok(None) };
    let embryo = read_tracked(path, options)?.map_or_else(exported, |embryo| Ok(Some(embryo)))?;
    let mut embryo = embryo.ok_or_else(other)?;
    embryo.match_names(names)?;
    Ok(embryo)
}

/// Reads a file or folder of tracked cells; `None` for a file outside the [formats](Format).
///
/// # Errors
/// A file that cannot be read or does not follow its format: names the file, line, field, value and the allowed values.
pub fn read_tracked(path: &Path, options: &TrackOptions) -> Result<Option<TrackedLineage>, InputError> {
    let Some((format, place)) = located(path)? else { return Ok(None) };
    let mut lineage = match format {
        Format::AceTree => acetree::read(path, options),
        Format::CdTable => cd::read(path, options),
        Format::TrackMate | Format::Mastodon => spot_tables::read(path, format, options),
        Format::Geff => geff::read(&place, options),
        Format::TrackMateXml => xml::read(path, options),
        Format::Tracks => track_tables::read(path, options),
        Format::Ctc => ctc::read(&place, name_of(path)),
        Format::Exported => return exported::read(path),
    }?;
    if let Some(minutes) = options.frame_minutes.filter(|_| lineage.time == TimeUnit::Frames) {
        lineage.time = TimeUnit::Minutes;
        lineage.frame *= minutes;
        for cell in &mut lineage.cells {
            let times = [&mut cell.birth, &mut cell.first, &mut cell.last].into_iter().chain(&mut cell.division);
            times.for_each(|time| *time *= minutes);
        }
    }
    Ok(Some(lineage))
}

/// A whole number from 0, to the last digit; also as `12.0`, which some programs make of it.
fn whole(text: &[u8]) -> Option<u64> {
    let text = str::from_utf8(text).ok()?;
    let digits = text.split_once('.').filter(|(_, rest)| rest.bytes().all(|b| b == b'0')).map_or(text, |(n, _)| n);
    digits.parse().ok()
}

/// The embryo of a file: its name without its extension.
fn embryo_of(path: &Path) -> String {
    path.file_stem().map_or_else(|| path.display().to_string(), |stem| stem.to_string_lossy().into_owned())
}

/// The embryo of a file or folder. The files of the Cell Tracking Challenge have one name each: the folder's is the sequence's.
pub(crate) fn name_of(path: &Path) -> String {
    let is_common = |path: &&Path| {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        ["man_track.txt", "res_track.txt", "TRA"].contains(&&*name)
    };
    let named = path.ancestors().find(|path| !is_common(path) && path.file_name().is_some());
    embryo_of(named.unwrap_or(path))
}

#[cfg(test)]
mod tests;
