//! `--movie` of a division, and `furrow movies`: the four kinds of division as movies.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use serde::Serialize;

use super::context::Context;
use super::error::CliError;
use super::interrupt;
use super::output::{answer, file_of_kind, writable_folder, write_unbroken};
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

/// Writes four movies: cells that divide into equal halves, into unequal ones, not at all, and with a cue
///
/// They differ in size and cue alone; constants are those of the preset, and of --config and --set.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  furrow movies --out movies --frames 4
  furrow movies --out drawn --format svg --frames 3")]
pub struct MoviesArgs {
    /// Folder for the movies
    #[arg(help_heading = "Output", long, value_name = "DIR")]
    out: PathBuf,
    /// Kind of the files
    #[arg(help_heading = "Output", long, value_name = "KIND", value_enum, default_value_t = Kind::Gif)]
    format: Kind,
    /// Frames of each, at even times; default 80, of SVG 20
    #[arg(help_heading = "Output", long, value_name = "N", value_parser = clap::value_parser!(u32).range(2..=2000))]
    frames: Option<u32>,
}

/// Kinds of movies by the extension of their files.
#[derive(Clone, Copy, Debug, ValueEnum)]
enum Kind {
    Gif,
    Png,
    Svg,
}

impl Kind {
    fn format(self) -> (MovieFormat, &'static str) {
        match self {
            Kind::Gif => (MovieFormat::Gif, "gif"),
            Kind::Png => (MovieFormat::Png, "png"),
            Kind::Svg => (MovieFormat::Svg, "svg"),
        }
    }
}

/// One movie in the answer.
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
    let (format, extension) = args.format.format();
    let frames = args.frames.map_or(format.usual_frames(), |frames| frames as usize);
    let scenes = scenes(&context.settings.cell);
    let names: Vec<String> = scenes.iter().map(|scene| format!("{}.{extension}", scene.name)).collect();
    writable_folder("--out", "out", &args.out, &names.iter().map(String::as_str).collect::<Vec<_>>())?;
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
    interrupt::unbroken(|| files.commit())?;
    let document = Answer { movies, out: args.out.display().to_string() };
    if context.json {
        return answer(&format!("{}\n", serde_json::to_string_pretty(&document)?));
    }
    let line = |shown: &Shown| {
        let chi = shown.chi.map_or(String::new(), |chi| format!(", χ = {chi:.3}"));
        format!("{:<18} R0 = {}: {}{chi}; {}\n", shown.file, shown.r0, shown.outcome, shown.shows)
    };
    let lines: String = document.movies.iter().map(line).collect();
    answer(&format!("{lines}files in {}\n", document.out))
}
