//! Pictures and movies, as the command line draws them.

use std::path::{Path, PathBuf};

use furrow_figures::drawing::{Canvas, Format};
use furrow_figures::movie::{Movie, MovieFormat, SurfaceMovie};
use furrow_figures::plot;
use furrow_formats::film::{check_path, write_film};
use furrow_formats::frames::{check_step, write_frames};
use furrow_formats::write_atomically;
use furrow_mechanics::division::Trajectory;
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use crate::errors::{ARGUMENTS, Error};
use crate::inputs::{Inputs, positive};
use crate::memo::Memo;
use crate::supervise::{Interrupt, supervised};
use crate::surfaces::filmed;

/// A picture, as the command line draws it. Notebooks show it.
#[pyclass(frozen, module = "furrow._furrow")]
pub struct Drawing(Picture);

/// A picture before it is drawn, or after it was pickled.
enum Picture {
    Canvas(Canvas),
    Written { svg: String, png: Vec<u8>, pdf: Vec<u8> },
}

impl Drawing {
    /// A picture of a canvas.
    pub fn of(canvas: Canvas) -> Drawing {
        Drawing(Picture::Canvas(canvas))
    }

    fn bytes(&self, format: Format) -> Result<Vec<u8>, Error> {
        match (&self.0, format) {
            (Picture::Canvas(canvas), format) => canvas.bytes(format).map_err(Error::system),
            (Picture::Written { svg, .. }, Format::Svg) => Ok(svg.clone().into_bytes()),
            (Picture::Written { pdf, .. }, Format::Pdf) => Ok(pdf.clone()),
            (Picture::Written { png, .. }, Format::Png) => Ok(png.clone()),
        }
    }
}

#[pymethods]
impl Drawing {
    /// As SVG.
    fn svg(&self) -> String {
        match &self.0 {
            Picture::Canvas(canvas) => canvas.svg(),
            Picture::Written { svg, .. } => svg.clone(),
        }
    }

    /// As PNG.
    fn png<'py>(&self, py: Python<'py>) -> Result<Bound<'py, PyBytes>, Error> {
        Ok(PyBytes::new(py, &py.detach(|| self.bytes(Format::Png))?))
    }

    /// As PDF.
    fn pdf<'py>(&self, py: Python<'py>) -> Result<Bound<'py, PyBytes>, Error> {
        Ok(PyBytes::new(py, &py.detach(|| self.bytes(Format::Pdf))?))
    }

    /// Writes it, as SVG, PDF or PNG by the file's extension.
    fn save(&self, py: Python<'_>, path: PathBuf) -> Result<(), Error> {
        let format = Format::of(&path).ok_or_else(|| Error::not_allowed("path", path.display(), Format::ALLOWED))?;
        py.detach(|| write(&path, &self.bytes(format)?))
    }

    /// The drawing that a notebook shows.
    fn _repr_svg_(&self) -> String {
        self.svg()
    }

    /// Reads what was pickled.
    #[staticmethod]
    fn _written(svg: String, png: Vec<u8>, pdf: Vec<u8>) -> Drawing {
        Drawing(Picture::Written { svg, png, pdf })
    }

    fn __reduce__<'py>(slf: &Bound<'py, Drawing>) -> Result<Pickled<'py>, Error> {
        let drawing = slf.get();
        Ok((slf.get_type().getattr("_written")?, (drawing.svg(), drawing.png(slf.py())?, drawing.pdf(slf.py())?)))
    }
}

/// What reads a pickled drawing, with its SVG, PNG and PDF.
type Pickled<'py> = (Bound<'py, PyAny>, (String, Bound<'py, PyBytes>, Bound<'py, PyBytes>));

/// Writes a file whole or not at all.
pub fn write(path: &Path, bytes: &[u8]) -> Result<(), Error> {
    write_atomically(path, bytes).map_err(Error::system)
}

/// Places of each mesh interval in pictures and movies, as the command line draws them.
const DENSE: usize = 6;

/// Computes a division and writes it as a movie, with the given or the usual number of frames, in the format of the file's extension.
#[pyfunction]
#[pyo3(signature = (inputs, memo, seed, path, frames=None, progress=None))]
pub fn write_movie(
    py: Python<'_>,
    inputs: &Inputs,
    memo: &Memo,
    seed: u64,
    path: PathBuf,
    frames: Option<usize>,
    progress: Option<&Bound<'_, PyAny>>,
) -> Result<(), Error> {
    let input = inputs.division(seed)?;
    let allowed = "a file that ends in .gif, .png, .apng or .svg";
    let format = MovieFormat::of(&path).ok_or_else(|| Error::not_allowed("path", path.display(), allowed))?;
    let memo = memo.solved()?;
    supervised(py, Interrupt::Abandons, progress, move |watch| {
        let (cell, frames) = (&input.cell, frames.unwrap_or(format.usual_frames()));
        let shown = |done, of| watch.set([0, done, of]);
        let bytes = if input.numerics.modes > 0 {
            let (_, film) = filmed(&input, &memo)?;
            SurfaceMovie { cell, film: &film, frames }.bytes_shown(format, &shown)
        } else {
            let film = Trajectory::compute(&input)?.with_places(DENSE);
            Movie { cell, film: &film, frames }.bytes_shown(format, &shown)
        };
        let bytes = bytes.map_err(Error::system)?;
        // Whoever interrupted the call expects no file.
        if watch.stop.load(std::sync::atomic::Ordering::SeqCst) {
            return Err(Error::Interrupted(0));
        }
        write(&path, &bytes)
    })
}

/// Computes a division and writes its shapes into a folder, as `furrow divide --frames` does.
#[pyfunction]
#[pyo3(signature = (inputs, memo, seed, folder, every=None))]
pub fn write_shapes(
    py: Python<'_>,
    inputs: &Inputs,
    memo: &Memo,
    seed: u64,
    folder: PathBuf,
    every: Option<f64>,
) -> Result<(), Error> {
    let input = inputs.division(seed)?;
    every.map(|step| positive("every", step, "a finite number of τ above 0")).transpose()?;
    if input.numerics.modes > 0 {
        check_path(ARGUMENTS, "folder", &folder)?;
    }
    let memo = memo.solved()?;
    supervised(py, Interrupt::Abandons, None, move |_| {
        if input.numerics.modes > 0 {
            let (division, film) = filmed(&input, &memo)?;
            check_step(ARGUMENTS, division.t_end, every)?;
            return write_film(&folder, &film, every).map_err(Error::system);
        }
        let film = Trajectory::compute(&input)?;
        check_step(ARGUMENTS, film.division.t_end, every)?;
        write_frames(&folder, &film, every).map_err(Error::system)
    })
}

/// Computes a division and draws its contours or sections, its asymmetry, and its balance of forces or its neck.
#[pyfunction]
pub fn draw_division(py: Python<'_>, inputs: &Inputs, memo: &Memo, seed: u64) -> Result<Drawing, Error> {
    let input = inputs.division(seed)?;
    let memo = memo.solved()?;
    supervised(py, Interrupt::Abandons, None, move |_| {
        if input.numerics.modes > 0 {
            return Ok(Drawing::of(plot::surface::draw(&input.cell, &filmed(&input, &memo)?.1)));
        }
        let film = Trajectory::compute(&input)?.with_places(DENSE);
        Ok(Drawing::of(plot::division::draw(&input.cell, &film)))
    })
}
