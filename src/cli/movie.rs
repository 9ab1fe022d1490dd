//! `--movie` of a division.

use std::path::PathBuf;

use clap::Args;

use super::error::CliError;
use super::output::{file_of_kind, write_unbroken};
use crate::cell::Cell;
use crate::division::Film;
use crate::input::InputError;
use crate::movie::{Movie, MovieFormat};

/// Places of each mesh interval in pictures and movies.
pub const DENSE: usize = 6;

/// The options of a movie.
#[derive(Debug, Args)]
pub struct MovieArgs {
    /// Shows the first replicate as a movie: GIF, animated PNG or animated SVG by the file's extension
    #[arg(help_heading = "Output", long = "movie", value_name = "FILE.gif|.png|.svg")]
    movie: Option<PathBuf>,
    /// Frames of the movie, at even times; default 80, of SVG 20
    #[arg(help_heading = "Output", long, value_name = "N", requires = "movie", value_parser = clap::value_parser!(u32).range(2..=2000))]
    movie_frames: Option<u32>,
}

/// Where a movie goes, and as what.
#[derive(Debug)]
pub struct MovieFile {
    path: PathBuf,
    format: MovieFormat,
    frames: usize,
}

impl MovieArgs {
    /// The file, if one is asked for, before the work that it is to show.
    ///
    /// # Errors
    /// Its name says of no kind of movie, or it cannot be written.
    pub fn file(&self) -> Result<Option<MovieFile>, InputError> {
        let Some(path) = &self.movie else { return Ok(None) };
        let allowed = "a file whose name ends in .gif, .png, .apng or .svg";
        let (path, format) = file_of_kind("--movie", "movie", path, MovieFormat::of(path), allowed)?;
        let frames = self.movie_frames.map_or(format.usual_frames(), |frames| frames as usize);
        Ok(Some(MovieFile { path, format, frames }))
    }
}

impl MovieFile {
    /// Writes the movie of a division; a file of that name is replaced, whole or not at all.
    ///
    /// # Errors
    /// It cannot be drawn or written.
    pub fn write(&self, cell: &Cell, film: &Film) -> Result<(), CliError> {
        write_unbroken(&self.path, &Movie { cell, film, frames: self.frames }.bytes(self.format)?)
    }
}
