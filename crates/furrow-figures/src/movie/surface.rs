//! The division of a cell without axial symmetry, as a scene.

use furrow_cell::Cell;
use furrow_formats::film::grid;
use furrow_surface::film::Film;

use super::division::{ending, even_times, title};
use super::encode::MovieFormat;
use super::scene::Scene;
use crate::drawing::FigureError;
use crate::drawing::cell::{changes, cue_colours, strongest};

/// A division without axial symmetry as frames at evenly spaced times, up to its last shape. Its arrows are left out.
pub struct SurfaceMovie<'a> {
    /// The cell.
    pub cell: &'a Cell,
    /// Its division.
    pub film: &'a Film,
    /// Number of frames.
    pub frames: usize,
}

impl SurfaceMovie<'_> {
    /// The movie as a file in the given format; `shown` is called with the numbers of drawn and of all frames.
    ///
    /// # Errors
    /// [`FigureError`].
    pub fn bytes_shown(&self, format: MovieFormat, shown: &dyn Fn(usize, usize)) -> Result<Vec<u8>, FigureError> {
        let SurfaceMovie { cell, film, frames } = self;
        let length = film.steps.first().map_or(1.0, |step| step.shape.length);
        let surface = |t: f64| {
            let still = film.at(t);
            let changes = changes(&film.cell.cue, still.shape.length);
            grid(&still, |at| if t > 0.0 { strongest(&changes, at.share) } else { 0.0 })
        };
        let scene = Scene {
            title: title(cell),
            shell: film.wall.clone(),
            times: even_times(film.end(), *frames),
            surface: &surface,
            forces: &|_| Vec::new(),
            legend: cue_colours(&changes(&film.cell.cue, length)),
            outcome: ending(&film.found.division),
        };
        scene.bytes(format, shown)
    }
}
