//! The surfaces of a division without axial symmetry as files.

use super::files::WriteError;
use super::frames::{About, FrameFiles, write_surfaces};
use super::surface::{SurfaceFrame, SurfaceGrid};
use furrow_input::InputError;
use furrow_surface::film::{COLUMNS, Film, Observables, ROWS, Still};
use furrow_surface::sample::Sample;
use std::path::Path;

/// The values of written surfaces.
pub const TENSION: &str = "mean active tension, in κ0/L_h²";

/// Refuses a folder of contours, which surfaces without axial symmetry do not have. Errors name `source_name` and `field`.
///
/// # Errors
/// The path names a folder of contours.
pub fn check_path(source_name: &str, field: &str, path: &Path) -> Result<(), InputError> {
    let allowed = "a file whose name ends in .ply or .glb: without axial symmetry a cell has no contour";
    let surfaces = !matches!(FrameFiles::of(path), FrameFiles::Csv(_));
    InputError::require(surfaces, source_name, field, format!("{path:?}"), allowed)
}

/// Writes the surfaces of a division, after every step, or every `every` τ and the last, as
/// [`write_frames`](super::frames::write_frames) does.
///
/// # Errors
/// [`WriteError`].
pub fn write_film(path: &Path, film: &Film, every: Option<f64>) -> Result<(), WriteError> {
    write_surfaces(&FrameFiles::of(path), &film.stills(every).iter().map(frame).collect::<Vec<_>>(), TENSION)
}

/// The sampled surface with [`TENSION`].
pub fn frame(still: &Still) -> SurfaceFrame {
    SurfaceFrame { surface: grid(still, |at| at.tension), about: about(&still.shape).fields() }
}

/// The sampled surface as a grid with a value at each place.
pub fn grid(still: &Still, value: impl Fn(&Sample) -> f64) -> SurfaceGrid {
    SurfaceGrid {
        rows: ROWS,
        columns: COLUMNS,
        points: still.samples.iter().map(|at| at.x).collect(),
        normals: still.samples.iter().map(|at| at.normal).collect(),
        values: still.samples.iter().map(value).collect(),
    }
}

/// The entry of a frame in the list.
fn about(shape: &Observables) -> About {
    let Observables { t, neck, length, pressure, .. } = *shape;
    About {
        t,
        neck_radius: neck.map(|neck| neck.radius),
        neck_u: neck.map(|neck| neck.u),
        neck_offset: neck.map(|neck| neck.offset),
        length,
        pressure,
        chi: shape.chi(),
    }
}
