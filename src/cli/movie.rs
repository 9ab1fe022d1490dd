//! `--movie` of a division.

use std::path::PathBuf;

use clap::Args;

use super::error::CliError;
use super::interrupt::write_deferred;
use super::output::file_of_format;
use furrow_cell::Cell;
use furrow_figures::movie::{Movie, MovieFormat};
use furrow_input::InputError;
use furrow_mechanics::division::Trajectory;

/// Places of each mesh interval in pictures and movies.
pub const DENSE: usize = 6;

/// The options of a movie.
#[derive(Debug, Args)]
pub struct MovieArgs {
    /// Writes a movie of the first replicate: GIF, animated PNG or animated SVG by the file's extension
    #[arg(help_heading = "Output", long = "movie", value_name = "FILE.gif|.png|.svg")]
    movie: Option<PathBuf>,
    /// Frames of the movie, evenly spaced in time; default 80, for SVG 20
    #[arg(help_heading = "Output", long, value_name = "N", requires = "movie", value_parser = clap::value_parser!(u32).range(2..=2000))]
    movie_frames: Option<u32>,
}

/// The file and format of a movie, if one is asked for, and its frames.
#[derive(Debug)]
pub struct MovieFile {
    file: Option<(PathBuf, MovieFormat)>,
    frames: Option<u32>,
}

impl MovieArgs {
    /// Checks the file before the work that it shows.
    ///
    /// # Errors
    /// Its extension is no format of movies, or it cannot be written.
    pub fn file(&self) -> Result<MovieFile, InputError> {
        let allowed = "a file whose name ends in .gif, .png, .apng or .svg";
        let file = self.movie.as_ref().map(|path| file_of_format("--movie", path, MovieFormat::of(path), allowed));
        Ok(MovieFile { file: file.transpose()?, frames: self.movie_frames })
    }
}

impl MovieFile {
    /// Whether one is asked for.
    pub fn is_wanted(&self) -> bool {
        self.file.is_some()
    }

    /// Writes the movie of a division, if one is asked for; an existing file is replaced, whole or not at all.
    ///
    /// # Errors
    /// It cannot be drawn or written.
    pub fn write(&self, cell: &Cell, film: &Trajectory) -> Result<(), CliError> {
        let Some((path, format)) = &self.file else { return Ok(()) };
        let frames = self.frames.map_or(format.usual_frames(), |frames| frames as usize);
        write_deferred(path, &Movie { cell, film, frames }.bytes(*format)?)
    }
}
