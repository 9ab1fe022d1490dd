//! The contour of a dividing cell, step by step.

use super::files::{FileSet, WriteError};
use crate::cortex::equations::{R, Z};
use crate::division::{DivisionError, DivisionInput, run::divide_observed};
use serde::Serialize;
use std::fmt::Write;
use std::path::Path;

/// Why frames could not be written.
#[derive(Debug, thiserror::Error)]
pub enum FramesError {
    /// The division could not be computed.
    #[error(transparent)]
    Division(#[from] DivisionError),
    /// A file could not be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// The index could not be put into JSON.
    #[error(transparent)]
    Json(#[from] serde_json::Error),
}

#[derive(Serialize)]
struct Entry {
    file: String,
    t: f64,
    neck_radius: Option<f64>,
}

/// Name of the list of frames.
pub const INDEX: &str = "frames.json";

/// Name of a frame, counted from 0.
fn name(number: usize) -> String {
    format!("frame_{number:04}.csv")
}

/// Computes a division and writes into `folder` one `frame_NNNN.csv` a step with the contour (u, r, z; r and z in L_h, at
/// the nodes of the step's mesh), and `frames.json` with the time of each, in τ, and its neck radius.
///
/// All of them or none: they replace the frames of an earlier division, of which none are left once the new are in place.
pub fn write_frames(folder: &Path, input: &DivisionInput) -> Result<(), FramesError> {
    let mut files = FileSet::new(folder);
    let mut entries: Vec<Entry> = vec![];
    let mut failed = None;
    divide_observed(input, |frame| {
        if failed.is_some() {
            return;
        }
        let mut csv = String::from("u,r,z\n");
        for (i, u) in frame.shape.mesh.iter().enumerate() {
            let node = frame.shape.node(i);
            let _ = writeln!(csv, "{u},{},{}", node[R], node[Z]);
        }
        let file = name(entries.len());
        failed = files.stage(&file, csv.as_bytes()).err();
        entries.push(Entry { file, t: frame.t, neck_radius: frame.neck.map(|neck| neck.radius) });
    })?;
    if let Some(error) = failed {
        return Err(error.into());
    }
    let index = serde_json::to_string_pretty(&entries)?;
    files.stage(INDEX, format!("{index}\n").as_bytes())?;
    files.commit()?;
    remove_from(folder, entries.len())?;
    Ok(())
}

/// Removes frames of an earlier division, from a number on; nothing that is not named exactly like one.
fn remove_from(folder: &Path, first: usize) -> Result<(), WriteError> {
    let failed = |source| WriteError { path: folder.display().to_string(), source };
    for entry in std::fs::read_dir(folder).map_err(failed)? {
        let entry = entry.map_err(failed)?;
        let file = entry.file_name();
        let number = file.to_str().and_then(|file| file.strip_prefix("frame_")?.strip_suffix(".csv")?.parse().ok());
        if number.is_some_and(|number| number >= first && *file == *name(number)) {
            std::fs::remove_file(entry.path()).map_err(failed)?;
        }
    }
    Ok(())
}
