//! `--plot`: what a command computes as a picture.

use std::path::PathBuf;

use clap::Args;

use super::error::CliError;
use super::interrupt::write_deferred;
use super::output::file_of_format;
use furrow_figures::drawing::{Canvas, Format};
use furrow_input::InputError;

/// The option of all commands that draw.
#[derive(Debug, Args)]
pub struct PlotArgs {
    /// Draws the result, as SVG or PNG by the file's extension
    #[arg(help_heading = "Output", long, value_name = "FILE.svg|.png")]
    plot: Option<PathBuf>,
}

/// The file and format of a picture, if one is asked for.
#[derive(Debug)]
pub struct Picture(Option<(PathBuf, Format)>);

impl PlotArgs {
    /// Checks the file before the work that it shows.
    ///
    /// # Errors
    /// Its extension is neither SVG nor PNG, or it cannot be written.
    pub fn file(&self) -> Result<Picture, InputError> {
        let allowed = "a file whose name ends in .svg or .png";
        let file = self.plot.as_ref().map(|path| file_of_format("--plot", path, Format::of(path), allowed));
        Ok(Picture(file.transpose()?))
    }
}

impl Picture {
    /// Whether one is asked for.
    pub fn is_wanted(&self) -> bool {
        self.0.is_some()
    }

    /// Draws and writes the picture, if one is asked for; an existing file is replaced, whole or not at all.
    ///
    /// # Errors
    /// It cannot be drawn or written.
    pub fn write(&self, draw: impl FnOnce() -> Canvas) -> Result<(), CliError> {
        match &self.0 {
            Some((path, format)) => write_deferred(path, &draw().bytes(*format)?),
            None => Ok(()),
        }
    }
}
