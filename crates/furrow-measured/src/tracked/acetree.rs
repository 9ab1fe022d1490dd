//! Nuclei of AceTree and StarryNite: one file per frame, `nuclei/t001-nuclei` and so on, in a zip archive or a folder.
//!
//! A line is a nucleus: its number in the frame (from 1), whether it is valid, the number of its predecessor in the frame before
//! (−1 or `nill` without one), the numbers of one or two successors in the frame after, x, y and z in pixels and planes, the
//! diameter in pixels, its name, the weight, and more; column 15 is a name given by hand, which replaces the other. Nuclei
//! that are not valid were deleted in AceTree and are no cells.

use std::collections::HashMap;
use std::fs;
use std::io::Read;
use std::path::{Path, PathBuf};

use csv::ByteRecord;
use furrow_input::{InputError, open_file, shown};

use super::lengths::{sphere_of_pixels, unit_of_pixels};
use super::spots::{Spot, Spots};
use super::{Format, TimeUnit, TrackOptions, TrackedLineage, archive, embryo_of, whole};
use furrow_input::table::{Table, malformed, number, text};

/// Columns that every line has.
const COLUMNS: [&str; 10] =
    ["number", "valid", "predecessor", "successor 1", "successor 2", "x", "y", "z", "size", "name"];

/// The column of a name given by hand, from 0.
const ASSIGNED: usize = 14;

/// Nuclei of one frame: where each is among the spots, and whom it says it becomes; `None` if it is not valid.
type Frame = HashMap<u64, Option<Nucleus>>;

/// A valid nucleus.
struct Nucleus {
    spot: usize,
    predecessor: Option<u64>,
    successors: [Option<u64>; 2],
}

/// The frame of a file of nuclei.
fn frame_of(name: &str) -> Option<u32> {
    let name = name.rsplit('/').next()?.strip_prefix('t')?;
    let digits = name.find(|c: char| !c.is_ascii_digit())?;
    // A number that is too large counts as the largest. The frames before it are then reported as missing.
    (digits > 0 && name[digits..].starts_with("-nuclei")).then(|| name[..digits].parse().unwrap_or(u32::MAX))
}

/// The folders with files of nuclei: this one, and `nuclei` in it.
fn folders_of(path: &Path) -> Vec<PathBuf> {
    let has_nuclei = |folder: &PathBuf| {
        let mut entries = fs::read_dir(folder).into_iter().flatten().flatten();
        entries.any(|entry| frame_of(&entry.file_name().to_string_lossy()).is_some())
    };
    [path.join("nuclei"), path.to_owned()].into_iter().filter(has_nuclei).collect()
}

/// Whether a file in a folder or an archive has the nuclei of a frame.
pub(super) fn is_of_nuclei(name: &str) -> bool {
    frame_of(name).is_some()
}

/// Whether a folder holds files of nuclei.
pub(super) fn is_folder(path: &Path) -> bool {
    !folders_of(path).is_empty()
}

/// The files of nuclei in a folder or an archive: their frames, names and texts.
fn files(path: &Path) -> Result<Vec<(u32, String, Vec<u8>)>, InputError> {
    let folders = folders_of(path);
    if folders.is_empty() {
        let file = path.display().to_string();
        let named = |(frame, name, text)| (frame, format!("{file}/{name}"), text);
        return Ok(archive::files(path, frame_of)?.into_iter().map(named).collect());
    }
    let (mut found, mut length) = (Vec::new(), 0);
    for folder in folders {
        for entry in fs::read_dir(&folder).map_err(|e| InputError::unreadable(&folder, e))? {
            let path = entry.map_err(|e| InputError::unreadable(&folder, e))?.path();
            let frame = path.file_name().and_then(|name| frame_of(&name.to_string_lossy()));
            let Some(frame) = frame.filter(|_| path.is_file()) else { continue };
            let mut text = Vec::new();
            let left = archive::LONGEST - length;
            let read = open_file(&path)?.take(left + 1).read_to_end(&mut text);
            length += read.map_err(|e| InputError::unreadable(&path, e))? as u64;
            if length > archive::LONGEST {
                let reason = format!("the files of nuclei are longer than {} MB", archive::LONGEST >> 20);
                return Err(InputError::unreadable(&folder, reason));
            }
            found.push((frame, path.display().to_string(), text));
        }
    }
    Ok(found)
}

pub(super) fn read(path: &Path, options: &TrackOptions) -> Result<TrackedLineage, InputError> {
    let file = path.display().to_string();
    let mut found = files(path)?;
    found.sort_by(|a, b| (a.0, &a.1).cmp(&(b.0, &b.1)));
    let wanted = "an archive of AceTree's nuclei";
    let (Some(&(first, ..)), Some(&(last, ..))) = (found.first(), found.last()) else {
        return Err(InputError::other_file(file, wanted, "it has no file nuclei/t001-nuclei or of another frame"));
    };
    for pair in found.windows(2) {
        let [(frame, one, _), (next, other, _)] = pair else { continue };
        if frame == next {
            let why = format!("{one} and {other} are both of frame {frame}: one of them must be removed");
            return Err(InputError::other_file(file, wanted, why));
        }
        if frame + 1 < *next {
            let missing = frame + 1;
            let why =
                format!("it has files from t{first:03}-nuclei to t{last:03}-nuclei, but not t{missing:03}-nuclei");
            return Err(InputError::other_file(file, wanted, why));
        }
    }
    let mut spots = Spots::default();
    let mut before: Option<(u32, Frame)> = None;
    for (frame, name, text) in found {
        spots.files.push(name);
        let nuclei = read_frame(&mut spots, frame, &text, options)?;
        if let Some((frame, before)) = &before {
            link(&mut spots, *frame, before, &nuclei)?;
        }
        before = Some((frame, nuclei));
    }
    spots.lineage(embryo_of(path), Format::AceTree, TimeUnit::Frames, unit_of_pixels(options))
}

/// Adds the nuclei of a frame. Its file was added last.
fn read_frame(spots: &mut Spots, frame: u32, text: &[u8], options: &TrackOptions) -> Result<Frame, InputError> {
    let file = spots.files.len() - 1;
    let name = spots.files[file].clone();
    let mut nuclei = Frame::new();
    let mut table = Table::open(text, &name)?;
    while let Some((line, row)) = table.next()? {
        if row.len() < COLUMNS.len() {
            let why =
                format!("{} columns; a nucleus has at least {}: {}", row.len(), COLUMNS.len(), COLUMNS.join(", "));
            return Err(malformed(&name, line as usize, why));
        }
        let link = |at: usize| link_at(row, at, &name, line);
        let (index, valid) = (link(0)?, text_at(row, 1));
        let Some(index) = index else {
            return Err(refused(&name, line, 0, &text_at(row, 0), "a whole number from 1"));
        };
        let is_valid = number(valid.as_bytes()).ok_or_else(|| refused(&name, line, 1, &valid, "0 or 1"))? >= 1.0;
        let nucleus = if is_valid {
            let (given, found) = (text_at(row, ASSIGNED), text_at(row, 9));
            // A nucleus without a name is called by its frame and number, so that it can be named as a root.
            let place = || format!("{frame}:{index}");
            let cell = [given, found].into_iter().find(|name| !name.is_empty()).unwrap_or_else(place);
            let size = text_at(row, 8);
            let diameter = number(size.as_bytes()).filter(|size| *size > 0.0 && *size < 1e30);
            if diameter.is_none() {
                spots.skip(&name, line, "9 (size)", &size, "must be a diameter above 0, in pixels");
            }
            let volume = diameter.map(|diameter| sphere_of_pixels(diameter, options));
            let spot = spots.push(Spot { time: frame.into(), id: None, name: cell, volume, file, line });
            Some(Nucleus { spot, predecessor: link(2)?, successors: [link(3)?, link(4)?] })
        } else {
            None
        };
        if nuclei.insert(index, nucleus).is_some() {
            let index = index.to_string();
            return Err(refused(&name, line, 0, &index, "a number that no other nucleus of the frame has"));
        }
    }
    Ok(nuclei)
}

/// The nuclei of a frame that are valid, by their numbers.
fn in_order(nuclei: &Frame) -> Vec<(u64, &Nucleus)> {
    let valid = nuclei.iter().filter_map(|(index, nucleus)| Some((*index, nucleus.as_ref()?)));
    let mut order: Vec<(u64, &Nucleus)> = valid.collect();
    order.sort_by_key(|(index, _)| *index);
    order
}

/// Links the nuclei of a frame to the nuclei of the frame before, `frame`.
fn link(spots: &mut Spots, frame: u32, before: &Frame, nuclei: &Frame) -> Result<(), InputError> {
    report_one_sided(spots, frame, before, nuclei);
    let order = in_order(nuclei);
    for (index, nucleus) in order {
        let Some(predecessor) = nucleus.predecessor else { continue };
        let Spot { file, line, .. } = *spots.get(nucleus.spot);
        let (file, shown) = (spots.files[file].clone(), predecessor.to_string());
        match before.get(&predecessor) {
            Some(Some(mother)) => {
                if !mother.successors.contains(&Some(index)) {
                    let why = format!("nucleus {predecessor} of frame {frame} does not name {index} as a successor");
                    spots.skip(&file, line, "3 (predecessor)", &shown, why);
                    continue;
                }
                spots.link(mother.spot, nucleus.spot, &file, line)?;
            }
            Some(None) => {
                let why = format!("nucleus {predecessor} of frame {frame} is not valid");
                spots.skip(&file, line, "3 (predecessor)", &shown, why);
            }
            None => return Err(refused(&file, line, 2, &shown, &format!("-1 or a nucleus of frame {frame}"))),
        }
    }
    Ok(())
}

/// Reports each successor that a nucleus names and that does not name this nucleus as its predecessor.
fn report_one_sided(spots: &mut Spots, frame: u32, before: &Frame, nuclei: &Frame) {
    for (index, nucleus) in in_order(before) {
        for (k, successor) in nucleus.successors.iter().enumerate() {
            let Some(successor) = *successor else { continue };
            let why = match nuclei.get(&successor) {
                Some(Some(daughter)) if daughter.predecessor == Some(index) => continue,
                Some(Some(_)) => {
                    format!("nucleus {successor} of frame {} does not name {index} as where it comes from", frame + 1)
                }
                Some(None) => format!("nucleus {successor} of frame {} is not valid", frame + 1),
                None => format!("frame {} has no nucleus {successor}", frame + 1),
            };
            let Spot { file, line, .. } = *spots.get(nucleus.spot);
            let (file, column) = (spots.files[file].clone(), format!("{} ({})", 4 + k, COLUMNS[3 + k]));
            spots.skip(&file, line, &column, &successor.to_string(), why);
        }
    }
}

/// The text in a column, from 0; empty if the line is shorter.
fn text_at(row: &ByteRecord, column: usize) -> String {
    text(row.get(column).unwrap_or_default().trim_ascii()).into_owned()
}

/// The nucleus in a column; `None` for −1 and `nill`.
fn link_at(row: &ByteRecord, column: usize, file: &str, line: u64) -> Result<Option<u64>, InputError> {
    let text = text_at(row, column);
    if ["", "-1", "nill"].contains(&text.as_str()) {
        return Ok(None);
    }
    let number = whole(text.as_bytes()).filter(|number| *number >= 1);
    number.map(Some).ok_or_else(|| refused(file, line, column, &text, "-1 or a whole number from 1"))
}

/// The error for a value, by its column from 0.
fn refused(file: &str, line: u64, column: usize, value: &str, allowed: &str) -> InputError {
    let name = COLUMNS[column];
    malformed(file, line as usize, format!("{name} (column {}) = {}: must be {allowed}", column + 1, shown(value)))
}
