//! The contour of a dividing cell, step by step.

use super::files::{WriteError, write_atomically};
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

/// Computes a division and writes into `folder` one `frame_NNNN.csv` a step with the contour (u, r, z; r and z in L_h, at
/// the nodes of the step's mesh), and `frames.json` with the time of each, in τ, and its neck radius.
pub fn write_frames(folder: &Path, input: &DivisionInput) -> Result<(), FramesError> {
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
        let file = format!("frame_{:04}.csv", entries.len());
        failed = write_atomically(&folder.join(&file), csv.as_bytes()).err();
        entries.push(Entry { file, t: frame.t, neck_radius: frame.neck.map(|neck| neck.radius) });
    })?;
    if let Some(error) = failed {
        return Err(error.into());
    }
    let index = serde_json::to_string_pretty(&entries)?;
    write_atomically(&folder.join("frames.json"), format!("{index}\n").as_bytes())?;
    Ok(())
}
