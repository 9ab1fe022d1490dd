//! A division with all its shapes, for pictures and files.

use furrow_cell::Cell;
use furrow_mechanics::cortex::Wall;
use furrow_mechanics::division::{DivisionError, DivisionInput, uniform_times};
use furrow_mechanics::polarity;

use crate::division::{SurfaceDivision, divide};
use crate::neck::{Neck, asymmetry, neck};
use crate::problem::{Problem, State};
use crate::sample::{Sample, sample};
use crate::stepper::Level;

/// Number of rings of samples, including both poles.
pub const ROWS: usize = 129;
/// Number of meridians of samples.
pub const COLUMNS: usize = 64;

/// The shape after one step.
#[derive(Clone, Debug)]
pub struct Step {
    /// Its observables.
    pub shape: Observables,
    problem: Problem,
    state: State,
}

/// The observables of a shape.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Observables {
    /// Time, in τ.
    pub t: f64,
    /// The neck, with u as a fraction of the mean meridian; `None` without a waist.
    pub neck: Option<Neck>,
    /// (V_above − V_below)/V for the parts on both sides of the neck; 0 without a neck.
    pub asymmetry: f64,
    /// Length of the mean meridian, in L_h.
    pub length: f64,
    /// Pressure, in κ0/L_h³.
    pub pressure: f64,
}

/// The surface at one time.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Still {
    /// Its observables.
    pub shape: Observables,
    /// Samples at [`ROWS`] × [`COLUMNS`] points, row by row from the pole u = 0. Column j is the meridian φ = 2π j / [`COLUMNS`].
    pub samples: Vec<Sample>,
}

/// A division with its shapes.
///
/// ```
/// use furrow_cell::{Cell, Numerics};
/// use furrow_mechanics::division::DivisionInput;
/// use furrow_surface::film::Film;
///
/// let numerics = Numerics { modes: 2, elements: 32, ..Numerics::default() };
/// let film = Film::compute(&DivisionInput { numerics, ..DivisionInput::new(Cell::new(2.5)) })?;
/// let middle = film.at(0.5 * film.found.division.t_end);
/// assert!(middle.shape.neck.is_some_and(|neck| neck.radius < 2.5));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Film {
    /// The division.
    pub found: SurfaceDivision,
    /// The cell, with the resolved position of its cue.
    pub cell: Cell,
    /// The wall of the shell; y = 0 is the mirror plane.
    pub wall: Wall,
    /// The shapes after every step, the first at t = 0.
    pub steps: Vec<Step>,
}

impl Film {
    /// Computes a division and keeps its shapes.
    ///
    /// # Errors
    /// [`DivisionError`].
    pub fn compute(input: &DivisionInput) -> Result<Film, DivisionError> {
        let mut steps = Vec::new();
        let found = divide(input, &mut |problem, level| steps.push(Step::of(problem, level)))?;
        let cell = polarity::resolved(&input.cell).map_err(|source| DivisionError::Polarity { source })?.into_owned();
        let axes = steps.first().map_or([f64::NAN; 3], |step: &Step| step.problem.inverse_axes2());
        let profile = cell.shell_profile.as_ref().map(|profile| profile.factor().clone());
        let wall = Wall { axes: axes.map(|inverse: f64| inverse.recip().sqrt()), profile };
        Ok(Film { found, cell, wall, steps })
    }

    /// The last time, in τ.
    pub fn end(&self) -> f64 {
        self.steps.last().map_or(0.0, |step| step.shape.t)
    }

    /// The surfaces after every step, or every `every` τ and the last.
    pub fn stills(&self, every: Option<f64>) -> Vec<Still> {
        match every {
            None => self.steps.iter().map(Step::still).collect(),
            Some(every) => uniform_times(self.end(), every).into_iter().map(|t| self.at(t)).collect(),
        }
    }

    /// The surface at a time between the first step and the last, interpolated between two steps.
    pub fn at(&self, t: f64) -> Still {
        let behind = self.steps.partition_point(|step| step.shape.t < t);
        match (behind.checked_sub(1).and_then(|k| self.steps.get(k)), self.steps.get(behind)) {
            (Some(before), Some(after)) => {
                let share = (t - before.shape.t) / (after.shape.t - before.shape.t);
                before.still().between(&after.still(), share)
            }
            (None, Some(step)) | (Some(step), None) => step.still(),
            (None, None) => Still::default(),
        }
    }
}

impl Step {
    fn of(problem: &Problem, level: &Level) -> Step {
        let surface = &level.state.surface;
        let neck = neck(&problem.space, surface);
        let along = |neck: Neck| Neck { u: problem.mean_meridian(surface).share_at(neck.u), ..neck };
        let shape = Observables {
            t: level.t,
            neck: neck.map(along),
            asymmetry: neck.map_or(0.0, |neck| asymmetry(&problem.space, surface, &neck)),
            length: problem.contour_length(surface),
            pressure: level.state.pressure,
        };
        Step { shape, problem: problem.clone(), state: level.state.clone() }
    }

    /// The samples of the surface.
    pub fn still(&self) -> Still {
        let mut samples = sample(&self.problem, &self.state, ROWS, COLUMNS);
        if self.shape.t == 0.0 {
            // The cell is passive until the first step.
            samples.iter_mut().for_each(|at| at.tension = 0.0);
        }
        Still { shape: self.shape, samples }
    }
}

impl Observables {
    /// |V_above − V_below|/V about the neck; `None` without a waist.
    pub fn chi(&self) -> Option<f64> {
        self.neck.map(|_| self.asymmetry.abs())
    }

    /// Observables interpolated towards others by a given fraction.
    fn between(&self, other: &Observables, share: f64) -> Observables {
        let blend = |a: f64, b: f64| a + share * (b - a);
        let neck = |(a, b): (Neck, Neck)| Neck {
            u: blend(a.u, b.u),
            radius: blend(a.radius, b.radius),
            offset: blend(a.offset, b.offset),
            height: blend(a.height, b.height),
            tilt: blend(a.tilt, b.tilt),
            roundness: blend(a.roundness, b.roundness),
        };
        Observables {
            t: blend(self.t, other.t),
            neck: self.neck.zip(other.neck).map(neck),
            asymmetry: blend(self.asymmetry, other.asymmetry),
            length: blend(self.length, other.length),
            pressure: blend(self.pressure, other.pressure),
        }
    }
}

impl Still {
    /// The still interpolated towards another by a given fraction.
    fn between(&self, other: &Still, share: f64) -> Still {
        let blend = |a: f64, b: f64| a + share * (b - a);
        let vector = |a: [f64; 3], b: [f64; 3]| std::array::from_fn(|k| blend(a[k], b[k]));
        let sample = |(a, b): (&Sample, &Sample)| {
            let normal: [f64; 3] = vector(a.normal, b.normal);
            let size = normal.iter().map(|x| x * x).sum::<f64>().sqrt().max(f64::MIN_POSITIVE);
            Sample {
                share: blend(a.share, b.share),
                x: vector(a.x, b.x),
                normal: normal.map(|x| x / size),
                tension: blend(a.tension, b.tension),
            }
        };
        Still {
            shape: self.shape.between(&other.shape, share),
            samples: self.samples.iter().zip(&other.samples).map(sample).collect(),
        }
    }

    /// The section by the plane y = 0, the plane of one-sided bends: (x, z) from the pole u = 0 along φ = 0 and back along φ = π.
    pub fn section(&self) -> Vec<[f64; 2]> {
        let meridian = |column: usize| self.samples.iter().skip(column).step_by(COLUMNS).map(|at| [at.x[0], at.x[2]]);
        let back: Vec<_> = meridian(COLUMNS / 2).collect();
        meridian(0).chain(back.into_iter().rev()).collect()
    }
}
