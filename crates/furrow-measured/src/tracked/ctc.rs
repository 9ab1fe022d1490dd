//! Tracks of the Cell Tracking Challenge. A line has a label, the first frame, the last frame, and the mother's label, or 0 without a
//! mother. A track that comes from another one, alone and after a gap, is the same cell. Alone and without a gap it is a daughter: its
//! sister was lost.
//!
//! # References
//! <https://celltrackingchallenge.net>: naming and file content conventions.

use std::collections::HashMap;
use std::path::Path;

use furrow_input::foreign::{ctc_words, is_ctc_heading};
use furrow_input::table::malformed;
use furrow_input::{InputError, read_text};

use super::chains::{self, Chain, Only};
use super::rows::{FirstRows, contents_of, repeat};
use super::spots::{Spot, Spots};
use super::{Format, TimeUnit, TrackedLineage, whole};
use crate::volumes::Unit;

/// Where a folder of images and tracks has its tracks.
pub(super) const IN_FOLDER: [&str; 4] = ["man_track.txt", "res_track.txt", "TRA/man_track.txt", "TRA/res_track.txt"];

/// The format of a line.
pub(super) const LINE: &str = "four whole numbers: label, first and last frame, mother or 0";

/// Whether a file is called as such a file.
pub(super) fn is_called_so(path: &Path) -> bool {
    path.file_name().is_some_and(|name| IN_FOLDER.iter().any(|known| name == *known))
}

/// A whole number from 0, which NumPy may write as `1.0e+00`.
fn whole_number(word: &str) -> Option<u64> {
    let as_float = || {
        let number: f64 = word.parse().ok()?;
        (number.fract() == 0.0 && (0.0..9e15).contains(&number)).then_some(number as u64)
    };
    whole(word.as_bytes()).or_else(as_float)
}

pub(super) fn read(path: &Path, embryo: String) -> Result<TrackedLineage, InputError> {
    let file = path.display().to_string();
    let text = read_text(path)?.trim_start_matches('\u{feff}').replace("\r\n", "\n").replace('\r', "\n");
    let mut spots = Spots::of(&file);
    let (mut chains, mut mothers, mut places) = (Vec::new(), Vec::new(), HashMap::new());
    let (mut rows, mut has_gaps) = (FirstRows::new(), false);
    let lines = text.lines().enumerate().filter(|(_, line)| !line.trim().is_empty());
    for (line, row) in lines.skip_while(|(_, line)| is_ctc_heading(line)).map(|(k, row)| (k + 1, row)) {
        let numbers: Option<Vec<u64>> = ctc_words(row).map(whole_number).collect();
        let Some([label, first, last, mother]) =
            numbers.as_deref().and_then(|numbers| <[u64; 4]>::try_from(numbers).ok())
        else {
            spots.skip(&file, line as u64, "line", row, format!("must be {LINE}"));
            has_gaps = true;
            continue;
        };
        if first > last || label == 0 {
            let why = "the label must be above 0, and the first frame not after the last";
            spots.skip(&file, line as u64, "line", row, why);
            has_gaps = true;
            continue;
        }
        if let Some(before) = rows.repeated(label, line as u64, contents_of([first, last, mother])) {
            spots.skip(&file, line as u64, "label", &label.to_string(), repeat(before));
            continue;
        }
        if places.insert(label, chains.len()).is_some() {
            return Err(malformed(&file, line, format!("label = {label}: must be of one line only")));
        }
        let mut ends = vec![first];
        ends.extend(Some(last).filter(|last| *last > first));
        let name = label.to_string();
        let push = |frame: u64| {
            let (time, line) = (frame as f64, line as u64);
            spots.push(Spot { time, name: name.clone(), id: None, volume: None, file: 0, line })
        };
        let spots = ends.into_iter().map(push).collect();
        chains.push(Chain { name, spots, mother: None });
        mothers.push((line, mother));
    }
    for (chain, (line, mother)) in chains.iter_mut().zip(mothers).filter(|(_, (_, mother))| *mother > 0) {
        chain.mother = places.get(&mother).copied();
        let allowed = "must be 0 or a label of the file";
        match (chain.mother, has_gaps) {
            (Some(_), _) => {}
            // It may be on a line that is left out.
            (None, true) => spots.skip(&file, line as u64, "mother", &mother.to_string(), allowed),
            (None, false) => return Err(malformed(&file, line, format!("mother = {mother}: {allowed}"))),
        }
    }
    chains::link(&mut spots, &mut chains, (&file, "first frame"), Only::SameCellAfterGap)?;
    spots.lineage(embryo, Format::Ctc, TimeUnit::Frames, Unit::Voxels)
}
