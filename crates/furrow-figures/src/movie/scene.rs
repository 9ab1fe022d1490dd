//! The contents of a movie.

use super::encode::{self, MovieFormat};
use crate::drawing::FigureError;
use crate::drawing::style::Colour;
use furrow_formats::surface::SurfaceGrid;
use furrow_mechanics::cortex::Wall;

/// A force on the surface.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Force {
    /// Its place: x, y and z, in L_h.
    pub at: [f64; 3],
    /// Its parts along x, y and z, in units of its own.
    pub vector: [f64; 3],
}

/// A dividing cell in its shell, whether it keeps its axis or not: what every kind of division is drawn from.
pub struct Scene<'a> {
    /// The cell in words.
    pub title: String,
    /// The wall of its shell.
    pub shell: Wall,
    /// The times of the frames, in τ.
    pub times: Vec<f64>,
    /// The surface at one of these times. Its values, from −1 (blue) to 1 (orange), set its tint.
    pub surface: &'a (dyn Fn(f64) -> SurfaceGrid + Sync),
    /// The active forces at one of these times, which are drawn as arrows.
    pub forces: &'a (dyn Fn(f64) -> Vec<Force> + Sync),
    /// The colours of the surface with their meanings.
    pub legend: Vec<(Colour, String)>,
    /// How the division ends, with its colour, and the time from which it is said.
    pub outcome: (f64, String, Colour),
}

impl Scene<'_> {
    /// The movie as a file in the given format; `shown` is called with the numbers of drawn and of all frames.
    ///
    /// # Errors
    /// [`FigureError`], also of a surface that is not closed.
    pub fn bytes(&self, format: MovieFormat, shown: &dyn Fn(usize, usize)) -> Result<Vec<u8>, FigureError> {
        encode::bytes(self, format, shown)
    }

    /// The frame at a time as a PNG, with `density` pixels for each unit of its size of 680 × 460.
    ///
    /// # Errors
    /// As [`bytes`](Self::bytes).
    pub fn png(&self, t: f64, density: f64) -> Result<Vec<u8>, FigureError> {
        encode::png(self, t, density)
    }
}
