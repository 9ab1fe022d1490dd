//! `--movie` of a division, and `furrow movies`: the four kinds of division as movies.

use std::path::PathBuf;

use clap::Args;
use serde::Serialize;

use super::cell::one_of;
use super::context::Context;
use super::error::CliError;
use super::interrupt::{self, write_deferred};
use super::output::{file_of_format, print_as, writable_folder};
use crate::cell::Cell;
use crate::division::{DivisionInput, Film, Outcome, film};
use crate::input::InputError;
use crate::io::files::FileSet;
use crate::movie::supplement::scenes;
use crate::movie::{Movie, MovieFormat};

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
    pub fn write(&self, cell: &Cell, film: &Film) -> Result<(), CliError> {
        let Some((path, format)) = &self.file else { return Ok(()) };
        let frames = self.frames.map_or(format.usual_frames(), |frames| frames as usize);
        write_deferred(path, &Movie { cell, film, frames }.bytes(*format)?)
    }
}

/// Writes four movies: a symmetric division, an asymmetric one, a cell that does not divide, and one with a cue
///
/// The cells differ only in size and cue.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  furrow movies --out movies --frames 4
  furrow movies --out drawn --format svg --frames 3")]
pub struct MoviesArgs {
    /// Output folder
    #[arg(help_heading = "Output", long, value_name = "DIR")]
    out: PathBuf,
    /// File format
    #[arg(help_heading = "Output", long, value_name = "KIND", default_value = "gif",
        value_parser = one_of(FORMATS.map(|format| (format.0, format))))]
    format: (&'static str, MovieFormat),
    /// Frames of each movie, evenly spaced in time; default 80, for SVG 20
    #[arg(help_heading = "Output", long, value_name = "N", value_parser = clap::value_parser!(u32).range(2..=2000))]
    frames: Option<u32>,
}

/// Formats of movies by the extension of their files.
const FORMATS: [(&str, MovieFormat); 3] =
    [("gif", MovieFormat::Gif), ("png", MovieFormat::Png), ("svg", MovieFormat::Svg)];

/// One movie in the result.
#[derive(Serialize)]
struct Shown {
    file: String,
    shows: &'static str,
    r0: f64,
    cue: String,
    outcome: Outcome,
    chi: Option<f64>,
}

/// What `--json` prints.
#[derive(Serialize)]
struct Answer {
    movies: Vec<Shown>,
    out: String,
}

pub fn run(args: &MoviesArgs, context: Context) -> Result<(), CliError> {
    context.settings.check_divisions("settings")?;
    let (extension, format) = args.format;
    let frames = args.frames.map_or(format.usual_frames(), |frames| frames as usize);
    let scenes = scenes(&context.settings.cell);
    let names: Vec<String> = scenes.iter().map(|scene| format!("{}.{extension}", scene.name)).collect();
    writable_folder("--out", args.out.as_path(), &names.iter().map(String::as_str).collect::<Vec<_>>())?;
    let mut files = FileSet::new(&args.out);
    let mut movies = Vec::new();
    for (scene, file) in scenes.into_iter().zip(names) {
        let numerics = context.settings.numerics;
        let film = film(&DivisionInput { cell: scene.cell.clone(), numerics, seed: 0 })?.with_places(DENSE);
        files.stage(&file, &Movie { cell: &scene.cell, film: &film, frames }.bytes(format)?)?;
        let cue = scene.cell.cue.to_string();
        let (outcome, chi) = (film.division.outcome, film.division.chi);
        movies.push(Shown { file, shows: scene.shows, r0: scene.cell.r0, cue, outcome, chi });
    }
    interrupt::defer(|| files.commit())?;
    let document = Answer { movies, out: args.out.display().to_string() };
    let line = |shown: &Shown| {
        let chi = shown.chi.map_or(String::new(), |chi| format!(", χ = {chi:.3}"));
        format!("{:<18} R0 = {}: {}{chi}; {}\n", shown.file, shown.r0, shown.outcome, shown.shows)
    };
    print_as(context.json, &document, || {
        document.movies.iter().map(line).chain([format!("files in {}\n", document.out)]).collect()
    })
}
