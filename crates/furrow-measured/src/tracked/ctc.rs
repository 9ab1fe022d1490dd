//! Tracks of the Cell Tracking Challenge. A line has a label, the first frame, the last frame, and the mother's label, or 0 without a
//! mother.
//!
//! # References
//! <https://celltrackingchallenge.net>: naming and file content conventions.

use std::collections::HashMap;
use std::path::Path;

use furrow_input::table::malformed;
use furrow_input::{InputError, read_text};

use super::chains::{self, Chain, Only};
use super::spots::{Spot, Spots};
use super::{Format, TimeUnit, TrackedLineage, whole};
use crate::volumes::Unit;

/// Where a folder of images and tracks has its tracks.
pub(super) const IN_FOLDER: [&str; 4] = ["man_track.txt", "res_track.txt", "TRA/man_track.txt", "TRA/res_track.txt"];

pub(super) fn read(path: &Path, embryo: String) -> Result<TrackedLineage, InputError> {
    let file = path.display().to_string();
    let text = read_text(path)?;
    let mut spots = Spots::of(&file);
    let (mut chains, mut mothers, mut places) = (Vec::new(), Vec::new(), HashMap::new());
    let lines = text.lines().enumerate().filter(|(_, line)| !line.trim().is_empty());
    for (line, row) in lines.map(|(k, row)| (k + 1, row)) {
        let numbers: Option<Vec<u64>> = row.split_whitespace().map(|word| whole(word.as_bytes())).collect();
        let Some([label, first, last, mother]) =
            numbers.as_deref().and_then(|numbers| <[u64; 4]>::try_from(numbers).ok())
        else {
            return Err(malformed(&file, line, "must be four whole numbers: label, first and last frame, mother or 0"));
        };
        if first > last {
            return Err(malformed(&file, line, format!("first frame = {first}: must not be after the last, {last}")));
        }
        if places.insert(label, chains.len()).is_some() || label == 0 {
            let why = format!("label = {label}: must be above 0 and of one line only");
            return Err(malformed(&file, line, why));
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
        let refused = || malformed(&file, line, format!("mother = {mother}: must be 0 or a label of the file"));
        chain.mother = Some(*places.get(&mother).ok_or_else(refused)?);
    }
    chains::link(&mut spots, &mut chains, (&file, "first frame"), Only::SameCell)?;
    spots.lineage(embryo, Format::Ctc, TimeUnit::Frames, Unit::Voxels)
}
