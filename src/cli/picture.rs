//! `--plot` and `--movie`: results of a command as a picture or a movie.

use std::io;
use std::path::{Path, PathBuf};

use clap::Args;

use super::error::CliError;
use super::interrupt::write_deferred;
use super::output::writable_file;
use super::progress::ProgressLine;
use furrow_figures::drawing::{Canvas, FigureError, Format};
use furrow_figures::movie::MovieFormat;
use furrow_formats::files::WriteError;
use furrow_input::InputError;

/// Sample points per mesh interval in pictures and movies.
pub const DENSE: usize = 6;

// The option of all commands that draw.
#[derive(Debug, Args)]
pub struct PlotArgs {
    /// Draws the result, as SVG, PDF or PNG by the file's extension
    #[arg(help_heading = "Output", long, value_name = "FILE.svg|.pdf|.png")]
    plot: Option<PathBuf>,
}

// The options of a movie.
#[derive(Debug, Args)]
pub struct MovieArgs {
    /// Writes a movie of the first replicate: GIF, animated PNG, animated SVG or a page by the file's extension
    ///
    /// The page FILE.html is a single file that needs no network. It shows the cell, coloured by the mean
    /// tension, and the numbers of the current frame. The cell can be rotated.
    #[arg(help_heading = "Output", long = "movie", value_name = "FILE.gif|.png|.svg|.html")]
    movie: Option<PathBuf>,
    /// Frames of the movie, evenly spaced in time; default 80, for SVG 20
    #[arg(help_heading = "Output", long, value_name = "N", requires = "movie", value_parser = clap::value_parser!(u32).range(2..=2000))]
    movie_frames: Option<u32>,
}

/// The file of an option, if given, and the format derived from its extension.
#[derive(Debug)]
pub struct FormatFile<F>(Option<(PathBuf, F)>);

/// The file of a picture.
pub type Picture = FormatFile<Format>;

/// The file of a movie, with its number of frames; a page has no picture format.
pub type MovieFile = FormatFile<(Option<MovieFormat>, usize)>;

impl PlotArgs {
    /// Checks the file before the work that it shows.
    ///
    /// # Errors
    /// The extension is not a picture format, or the file cannot be written.
    pub fn file(&self) -> Result<Picture, InputError> {
        FormatFile::new("--plot", self.plot.as_deref(), Format::of, Format::ALLOWED)
    }
}

impl MovieArgs {
    /// Checks the file before the work that it shows.
    ///
    /// # Errors
    /// The extension is not a movie format, or the file cannot be written.
    pub fn file(&self) -> Result<MovieFile, InputError> {
        let format = |path: &Path| {
            let page = path.extension().is_some_and(|name| name.eq_ignore_ascii_case("html"));
            let format = if page { None } else { Some(MovieFormat::of(path)?) };
            let usual = format.unwrap_or(MovieFormat::Gif).usual_frames();
            Some((format, self.movie_frames.map_or(usual, |frames| frames as usize)))
        };
        let allowed = "a file whose name ends in .gif, .png, .apng, .svg or .html";
        FormatFile::new("--movie", self.movie.as_deref(), format, allowed)
    }
}

impl<F> FormatFile<F> {
    fn new(
        option: &str,
        file: Option<&Path>,
        format: impl FnOnce(&Path) -> Option<F>,
        allowed: &str,
    ) -> Result<FormatFile<F>, InputError> {
        let Some(file) = file else { return Ok(FormatFile(None)) };
        let field = option.trim_start_matches('-');
        let format =
            format(file).ok_or_else(|| InputError::not_allowed(option, field, format!("{file:?}"), allowed))?;
        // A mistyped folder must not be created.
        let missing =
            file.parent().filter(|folder| !folder.as_os_str().is_empty() && folder.symlink_metadata().is_err());
        if let Some(folder) = missing {
            let allowed = format!("a file in a folder that exists ({folder:?} does not)");
            return Err(InputError::not_allowed(option, field, format!("{file:?}"), allowed));
        }
        writable_file(option, file)?;
        Ok(FormatFile(Some((file.to_owned(), format))))
    }

    /// Whether the option is given.
    pub fn is_wanted(&self) -> bool {
        self.0.is_some()
    }
}

impl Picture {
    /// Rejects a picture that would replace one of the files that `--out` writes into a folder.
    ///
    /// # Errors
    /// Names the picture.
    pub fn check_apart(&self, folder: Option<&Path>, names: &[&str]) -> Result<(), InputError> {
        let (Some((path, _)), Some(folder)) = (&self.0, folder) else { return Ok(()) };
        let same = |name: &&str| folder.join(name).components().eq(path.components());
        let apart = !names.iter().any(same);
        InputError::require(apart, "--plot", "plot", format!("{path:?}"), "another file: --out writes this one")
    }

    /// Draws and writes the picture, if requested; an existing file is replaced completely or not at all.
    ///
    /// # Errors
    /// It cannot be drawn or written.
    pub fn write(&self, draw: impl FnOnce() -> Canvas) -> Result<(), CliError> {
        let Some((path, format)) = &self.0 else { return Ok(()) };
        write_deferred(path, &draw().bytes(*format)?)
    }
}

impl MovieFile {
    /// Writes the movie of a division, if requested; an existing file is replaced completely or not at all. If `progress` is set, a
    /// progress line counts the frames. `movie` creates the movie from the format and the number of frames, and reports finished
    /// frames; `page` creates a page from the number of frames.
    ///
    /// # Errors
    /// It cannot be drawn or written.
    pub fn write(
        &self,
        movie: impl FnOnce(MovieFormat, usize, &dyn Fn(usize, usize)) -> Result<Vec<u8>, FigureError>,
        page: impl FnOnce(usize) -> io::Result<String>,
        progress: bool,
    ) -> Result<(), CliError> {
        let Some((path, (format, frames))) = &self.0 else { return Ok(()) };
        let line = ProgressLine::new(progress);
        let shown = |done, of| line.show_share(done, of, || "frames".to_owned());
        let failed = |source| WriteError { path: path.display().to_string(), source };
        let bytes = match format {
            Some(format) => movie(*format, *frames, &shown)?,
            None => page(*frames).map_err(failed)?.into_bytes(),
        };
        drop(line);
        write_deferred(path, &bytes)
    }
}
