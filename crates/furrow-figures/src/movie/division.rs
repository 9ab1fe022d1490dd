//! The division of a cell that keeps its axis, as a scene.

use super::encode::MovieFormat;
use super::scene::{Force, Scene};
use crate::drawing::FigureError;
use crate::drawing::cell::{changes, cue_colours, strongest};
use crate::drawing::regulator::PhiRange;
use crate::drawing::style;
use furrow_cell::Cell;
use furrow_formats::surface::SurfaceGrid;
use furrow_mechanics::cortex::forces::Place;
use furrow_mechanics::division::{Division, Outcome, Snapshot, Trajectory};

/// Columns of the surface.
const COLUMNS: usize = 96;
/// Arrows on each side of the axis.
const ARROWS: usize = 44;

/// A division as frames at evenly spaced times, up to its last shape.
pub struct Movie<'a> {
    /// The cell.
    pub cell: &'a Cell,
    /// Its division.
    pub film: &'a Trajectory,
    /// Number of frames.
    pub frames: usize,
}

impl Movie<'_> {
    /// The movie as a file in the given format.
    ///
    /// # Errors
    /// [`FigureError`].
    pub fn bytes(&self, format: MovieFormat) -> Result<Vec<u8>, FigureError> {
        self.bytes_shown(format, &|_, _| ())
    }

    /// The same; `shown` is called with the numbers of drawn and of all frames.
    ///
    /// # Errors
    /// [`FigureError`].
    pub fn bytes_shown(&self, format: MovieFormat, shown: &dyn Fn(usize, usize)) -> Result<Vec<u8>, FigureError> {
        self.with_scene(|scene| scene.bytes(format, shown))
    }

    /// Its scene, for a picture of one time or for a movie.
    pub fn with_scene<T>(&self, use_it: impl FnOnce(&Scene<'_>) -> T) -> T {
        let Movie { cell, film, frames } = self;
        let times = even_times(film.times().last().copied().unwrap_or(0.0), *frames);
        let last = times.len() - 1;
        let stills: Vec<Snapshot> = times.iter().map(|t| film.at(*t)).collect();
        let phi = PhiRange::of(stills.iter().flat_map(|still| &still.places));
        let cue = &film.cell().cue;
        let length = stills.first().map_or(1.0, |still| still.length);
        let legend = cue_colours(&changes(cue, length)).into_iter().chain(phi.into_iter().flat_map(PhiRange::colours));
        let still = |t: f64| &stills[times.partition_point(|time| *time < t).min(last)];
        let surface = |t: f64| surface(still(t), film, phi);
        let forces = |t: f64| forces(still(t));
        use_it(&Scene {
            title: title(cell),
            shell: film.wall(),
            times: times.clone(),
            surface: &surface,
            forces: &forces,
            legend: legend.collect(),
            outcome: ending(&film.division),
        })
    }
}

/// At least two times, evenly spaced from 0 to `end`.
pub fn even_times(end: f64, frames: usize) -> Vec<f64> {
    let last = frames.max(2) - 1;
    (0..=last).map(|k| end * k as f64 / last as f64).collect()
}

pub(super) fn title(cell: &Cell) -> String {
    let Cell { r0, epsilon, xi_s, .. } = cell;
    let cued = if cell.has_cue() { "with a cue" } else { "no cue" };
    let law = cell.law.as_ref().map_or(String::new(), |law| format!(", law {}", law.name()));
    format!("R₀ = {r0}, ε = {epsilon}, ξₛ = {xi_s}{law}, {cued}")
}

/// When a movie says how the division ends, in which words and colour.
pub(super) fn ending(division: &Division) -> (f64, String, style::Colour) {
    let (word, colour) = match (division.outcome(), division.chi()) {
        (Outcome::Arrested, _) => ("stays at rest".to_owned(), style::MUTED),
        (outcome, Some(chi)) => (format!("{outcome}, χ = {chi:.2}"), style::outcome(outcome)),
        (outcome, None) => (outcome.to_string(), style::outcome(outcome)),
    };
    (0.999 * division.t_end, word, colour)
}

/// The surface of a shape, tinted by the cue or by its regulator, whichever is stronger.
fn surface(shape: &Snapshot, film: &Trajectory, phi: Option<PhiRange>) -> SurfaceGrid {
    let changes = changes(&film.cell().cue, shape.length);
    SurfaceGrid::revolved(&shape.places, COLUMNS, |place| {
        let of_cue = if shape.t > 0.0 { strongest(&changes, place.u) } else { 0.0 };
        let carried = phi.zip(place.phi).map_or(0.0, |(range, phi)| range.share(phi));
        if carried.abs() > of_cue.abs() { carried } else { of_cue }
    })
}

/// The active forces on both sides of the axis.
fn forces(shape: &Snapshot) -> Vec<Force> {
    let evenly = (0..ARROWS).map(|k| (k as f64 + 0.5) / ARROWS as f64);
    let places = evenly.filter_map(|u| shape.places.get(shape.places.partition_point(|place| place.u < u)));
    let force = |place: &Place| {
        let ([x, z], r) = (place.active_force(), place.r);
        [1.0, -1.0].map(|side| Force { at: [side * r, 0.0, place.z], vector: [side * x, 0.0, z] })
    };
    places.flat_map(force).collect()
}
