//! `--plot`: what a command computes as a picture.

use std::path::PathBuf;

use clap::Args;

use super::error::CliError;
use super::output::{file_of_kind, write_unbroken};
use crate::drawing::{Canvas, Format};
use crate::input::InputError;

/// The option of all commands that draw.
#[derive(Debug, Args)]
pub struct PlotArgs {
    /// Draws what is computed, as SVG or PNG by the file's extension
    #[arg(help_heading = "Output", long = "plot", value_name = "FILE.svg|.png")]
    plot: Option<PathBuf>,
}

/// Where a picture goes, and as what.
#[derive(Debug)]
pub struct PlotFile {
    path: PathBuf,
    format: Format,
}

impl PlotArgs {
    /// The file, if one is asked for, before the work that it is to show.
    ///
    /// # Errors
    /// It is neither SVG nor PNG by its name, or cannot be written.
    pub fn file(&self) -> Result<Option<PlotFile>, InputError> {
        let Some(path) = &self.plot else { return Ok(None) };
        let allowed = "a file whose name ends in .svg or .png";
        let (path, format) = file_of_kind("--plot", "plot", path, Format::of(path), allowed)?;
        Ok(Some(PlotFile { path, format }))
    }
}

impl PlotFile {
    /// Writes a picture; a file of that name is replaced, whole or not at all.
    ///
    /// # Errors
    /// It cannot be drawn or written.
    pub fn write(&self, drawing: &Canvas) -> Result<(), CliError> {
        write_unbroken(&self.path, &drawing.bytes(self.format)?)
    }
}
