//! Results that only cells without axial symmetry have.

use super::error::CliError;
use super::interrupt;
use furrow_figures::movie::{even_times, grid};
use furrow_formats::frames::{About, FrameFiles, check_step, write_surfaces};
use furrow_formats::surface::SurfaceFrame;
use furrow_input::InputError;
use furrow_mechanics::division::{DivisionInput, uniform_times};
use furrow_report::FilmPage;
use furrow_surface::film::{Film, Observables, Step, Still};
use serde_json::{Value, json};
use std::io;
use std::path::Path;

/// The values of written surfaces.
const TENSION: &str = "mean active tension, in κ0/L_h²";

/// The number of azimuthal modes at the end, and the neck over time.
pub fn document(film: &Film) -> Value {
    let necks = &film.found.necks;
    let over_time = |value: fn(&furrow_surface::division::NeckAt) -> f64| necks.iter().map(value).collect::<Vec<_>>();
    json!({
        "modes": film.found.modes,
        "neck": {
            "t": over_time(|at| at.t),
            "radius": over_time(|at| at.neck.radius),
            "offset": over_time(|at| at.neck.offset),
            "position": over_time(|at| at.neck.height),
        },
    })
}

/// Writes the surfaces of a division, if a path is given: after every step, or every `every` τ and the last.
///
/// # Errors
/// Too small a step, or a file that cannot be written.
pub fn write(path: Option<&Path>, film: &Film, every: Option<f64>) -> Result<(), CliError> {
    let Some(path) = path else { return Ok(()) };
    check_step("--frame-step", film.found.division.t_end, every)?;
    let stills: Vec<Still> = match every {
        None => film.steps.iter().map(Step::still).collect(),
        Some(every) => uniform_times(film.end(), every).into_iter().map(|t| film.at(t)).collect(),
    };
    let frames: Vec<SurfaceFrame> = stills.iter().map(frame).collect();
    interrupt::defer(|| write_surfaces(&FrameFiles::of(path), &frames, TENSION))?;
    Ok(())
}

/// The film of a division as a page with `frames` frames.
///
/// # Errors
/// [`FilmPage::html`].
pub fn page(input: &DivisionInput, film: &Film, frames: usize) -> io::Result<String> {
    let frames: Vec<_> = even_times(film.end(), frames).into_iter().map(|t| frame(&film.at(t))).collect();
    FilmPage { input, division: &film.found.division, shell: film.shell, value: TENSION, frames: &frames }.html()
}

fn frame(still: &Still) -> SurfaceFrame {
    SurfaceFrame { surface: grid(still, |at| at.tension), about: about(&still.shape).fields() }
}

/// Refuses a folder of contours, which surfaces without axial symmetry do not have.
///
/// # Errors
/// Names the option and its allowed values.
pub fn check_frames(path: Option<&Path>) -> Result<(), InputError> {
    let contours = path.filter(|path| matches!(FrameFiles::of(path), FrameFiles::Csv(_)));
    let allowed = "a file whose name ends in .ply or .glb: without axial symmetry a cell has no contour";
    contours.map_or(Ok(()), |path| Err(InputError::not_allowed("--frames", "frames", format!("{path:?}"), allowed)))
}

/// The entry of a frame in the list.
fn about(shape: &Observables) -> About {
    let Observables { t, neck, asymmetry, length, pressure } = *shape;
    About {
        t,
        neck_radius: neck.map(|neck| neck.radius),
        neck_u: neck.map(|neck| neck.u),
        neck_offset: neck.map(|neck| neck.offset),
        length,
        pressure,
        chi: neck.map(|_| asymmetry.abs()),
    }
}
