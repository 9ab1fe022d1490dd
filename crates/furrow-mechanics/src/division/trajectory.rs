//! The trajectory of a division: every shape, with the forces on it, at any time.

use furrow_bvp::{Gauss, Solution};

use super::DivisionInput;
use super::outcome::{Division, DivisionError};
use super::run::{DivisionOptions, Frame, divide_with};
use crate::cortex::equations::{LENGTH, PRESSURE};
use crate::cortex::forces::{self, Place};
use crate::cortex::observables::{self, Neck};
use crate::cortex::{Cortex, Domain, Wall};
use crate::polarity;
use furrow_cell::Cell;
use std::borrow::Cow;

/// One accepted step: a shape, and the problem that it solves.
#[derive(Clone, Debug)]
struct Step {
    t: f64,
    shape: Solution,
    cortex: Cortex,
    neck: Option<Neck>,
}

/// A division with all its shapes.
///
/// ```
/// use furrow_cell::Cell;
/// use furrow_mechanics::division::{DivisionInput, Trajectory};
///
/// let trajectory = Trajectory::compute(&DivisionInput::new(Cell::new(2.5)))?;
/// let middle = trajectory.at(0.5 * trajectory.division.t_end);
/// assert!(middle.places.len() > 50);
/// assert!(middle.places.iter().all(|place| place.normal.residual().abs() < 0.1));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Trajectory {
    /// Its outcome.
    pub division: Division,
    cortex: Cortex,
    gauss: Gauss,
    steps: Vec<Step>,
    /// Number of places in each mesh interval, if they replace the collocation points.
    dense: Option<usize>,
}

/// The cell at one time.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Snapshot {
    /// Time, in τ.
    pub t: f64,
    /// Contour length L, in L_h.
    pub length: f64,
    /// Pressure p, in κ0/L_h³.
    pub pressure: f64,
    /// The contour from pole to pole, at the collocation points of its mesh or at the requested places, and at both
    /// ends.
    pub places: Vec<Place>,
    /// Its neck, if it has a waist.
    pub neck: Option<Neck>,
    /// (V_above − V_below)/V for the parts on both sides of the neck; 0 without a neck.
    pub asymmetry: f64,
}

impl Snapshot {
    /// The contour alone, as (r, z).
    pub fn contour(&self) -> Vec<[f64; 2]> {
        self.places.iter().map(|place| [place.r, place.z]).collect()
    }
}

/// Records the shapes of a division while it runs.
#[derive(Debug, Default)]
pub struct Recorder(Vec<Step>);

impl Recorder {
    /// Records a shape; called by the division's observer.
    pub fn record(&mut self, frame: Frame<'_>) {
        let Frame { t, shape, neck, cortex, .. } = frame;
        self.0.push(Step { t, shape: shape.clone(), cortex: cortex.clone(), neck });
    }

    /// The trajectory, once the division has ended.
    pub fn finish(self, input: &DivisionInput, division: Division) -> Trajectory {
        // The division has succeeded, so that the cue's position can be resolved.
        let cell = polarity::resolved(&input.cell).unwrap_or(Cow::Borrowed(&input.cell));
        let cortex = Cortex::new(&cell, Domain::Full, &[]);
        Trajectory {
            division,
            cortex,
            gauss: Gauss::new(input.numerics.stages).unwrap_or_default(),
            steps: self.0,
            dense: None,
        }
    }
}

impl Trajectory {
    /// Computes a division and keeps its shapes.
    ///
    /// # Errors
    /// [`DivisionError`], as [`divide`](super::divide).
    pub fn compute(input: &DivisionInput) -> Result<Trajectory, DivisionError> {
        let mut recorder = Recorder::default();
        let (division, _) = divide_with(input, DivisionOptions::observed_by(&mut |frame| recorder.record(frame)))?;
        Ok(recorder.finish(input, division))
    }

    /// The same with `count` evenly spaced places in each mesh interval, by the collocation polynomial.
    pub fn with_places(self, count: usize) -> Trajectory {
        Trajectory { dense: Some(count.max(1)), ..self }
    }

    /// The places of a step.
    fn profile(&self, step: &Step) -> Vec<Place> {
        match self.dense {
            None => forces::profile(&step.cortex, &self.gauss, &step.shape),
            Some(count) => forces::dense_profile(&step.cortex, &self.gauss, &step.shape, count),
        }
    }

    /// The cell, with the resolved position of its cue.
    pub fn cell(&self) -> &Cell {
        &self.cortex.cell
    }

    /// The wall of its shell.
    pub fn wall(&self) -> Wall {
        Wall::of(&self.cortex)
    }

    /// The times of all steps, the first at 0. At the last time the neck is narrower than at pinch-off, a little later
    /// than the end of the division.
    pub fn times(&self) -> Vec<f64> {
        self.steps.iter().map(|step| step.t).collect()
    }

    /// The cell at step `number` of [`times`](Self::times), counted from 0; the last one beyond the end.
    pub fn step(&self, number: usize) -> Snapshot {
        let Some(step) = self.steps.get(number).or(self.steps.last()) else { return Snapshot::default() };
        self.snapshot(step.t, step, None, self.profile(step))
    }

    /// The cell at any time between the first step and the last: at the places of the next step, interpolated in time
    /// at fixed u.
    pub fn at(&self, t: f64) -> Snapshot {
        let behind = self.steps.partition_point(|step| step.t < t);
        if behind == 0 || behind >= self.steps.len() {
            return self.step(behind);
        }
        let (before, after) = (&self.steps[behind - 1], &self.steps[behind]);
        let dt = after.t - before.t;
        let share = (t - before.t) / dt;
        let blend =
            |place: Place| forces::at(&before.cortex, &self.gauss, &before.shape, place.u).between(&place, share, dt);
        let places = self.profile(after).into_iter().map(blend).collect();
        self.snapshot(t, before, Some((after, share)), places)
    }

    /// [`uniform_times`] up to the last one.
    pub fn uniform_times(&self, step: f64) -> Vec<f64> {
        uniform_times(self.steps.last().map_or(0.0, |step| step.t), step)
    }

    fn snapshot(&self, t: f64, before: &Step, after: Option<(&Step, f64)>, places: Vec<Place>) -> Snapshot {
        let blend = |of: &dyn Fn(&Step) -> f64| {
            after.map_or(of(before), |(after, share)| of(before) + share * (of(after) - of(before)))
        };
        let neck = match after {
            None => before.neck,
            Some((after, share)) => before
                .neck
                .zip(after.neck)
                .map(|(a, b)| Neck { u: a.u + share * (b.u - a.u), radius: a.radius + share * (b.radius - a.radius) }),
        };
        Snapshot {
            t,
            length: blend(&|step| step.shape.scalars[LENGTH]),
            pressure: blend(&|step| step.shape.scalars[PRESSURE]),
            asymmetry: blend(&|step| {
                step.neck.map_or(0.0, |neck| observables::asymmetry(&self.gauss, &step.shape, neck.u))
            }),
            neck,
            places,
        }
    }
}

/// The times k·step below `end`, and `end`; only `end` if `step` is not above 0.
pub fn uniform_times(end: f64, step: f64) -> Vec<f64> {
    let count = if step > 0.0 { ((end - 1e-9 * step) / step).ceil().max(0.0) as usize } else { 0 };
    let mut times: Vec<f64> = (0..count).map(|k| k as f64 * step).collect();
    times.push(end);
    times
}

#[cfg(test)]
mod tests {
    use super::*;
    use furrow_cell::Cue;

    #[test]
    fn between_steps_the_contour_agrees_with_a_finer_division() {
        let cell = Cell::gao2026_thresholds(4.0).with_cue(Cue::published());
        let coarse = Trajectory::compute(&DivisionInput::new(cell.clone())).unwrap();
        let mut input = DivisionInput::new(cell);
        input.numerics.step_factor = 0.25;
        let fine = Trajectory::compute(&input).unwrap();
        for t in [0.05, 0.2, 0.35] {
            let (a, b) = (coarse.at(t), fine.at(t));
            let at = |snapshot: &Snapshot, u: f64| {
                let k = snapshot.places.partition_point(|place| place.u < u).clamp(1, snapshot.places.len() - 1);
                let (left, right) = (&snapshot.places[k - 1], &snapshot.places[k]);
                let share = (u - left.u) / (right.u - left.u);
                [left.r + share * (right.r - left.r), left.z + share * (right.z - left.z)]
            };
            for k in 0..=20 {
                let ([r, z], [r2, z2]) = (at(&a, k as f64 / 20.0), at(&b, k as f64 / 20.0));
                assert!((r - r2).abs() < 0.01 && (z - z2).abs() < 0.01, "{t} {k}: {r} {r2} {z} {z2}");
            }
        }
    }

    #[test]
    fn uniform_times_begin_at_zero_and_end_with_the_division() {
        let trajectory = Trajectory::compute(&DivisionInput::new(Cell::gao2026_thresholds(2.5))).unwrap();
        let times = trajectory.uniform_times(0.25);
        assert_eq!(times[..3], [0.0, 0.25, 0.5]);
        assert_eq!(times.last(), trajectory.times().last());
        let last = trajectory.at(*times.last().unwrap());
        assert!(last.neck.unwrap().radius < 1e-3 * 2.5);
        assert!((last.asymmetry.abs() - trajectory.division.chi().unwrap()).abs() < 1e-3);
    }

    /// A cue that follows PAR polarity is drawn at its position in the division.
    #[test]
    fn the_cell_has_the_resolved_cue() {
        let cue = "kappa:par_band,amplitude=0.1".parse().unwrap();
        let trajectory = Trajectory::compute(&DivisionInput::new(Cell::new(5.4).with_cue(cue))).unwrap();
        let drawn = &trajectory.cell().cue;
        let divided = &trajectory.steps.last().unwrap().cortex.cell.cue;
        assert!(!drawn.follows_par() && drawn == divided && drawn.terms()[0].at(0.47, 10.0)[0] > 0.09, "{drawn}");
    }
}
