//! The evolution of a perturbed stationary shape: the paper's test of stability (its figure S5).
//!
//! The cell starts at a stationary shape with activity instead of the passive shape, and the noise of the first step is
//! the perturbation. Its distance from the start,
//!
//! * \[distance\] dis(t) = ‖r − r₀‖ + ‖z − z₀‖, L² norms over u,
//!
//! decreases if the shape is stable and increases if it is unstable, at the rate of the leading mode while it is small.

use furrow_bvp::{Gauss, Solution};

use crate::cortex::Domain;
use crate::cortex::equations::{R, Z};
use crate::cortex::symmetry::unfold;
use crate::division::run::run;
use crate::division::start::Start;
use crate::division::{Division, DivisionError, DivisionInput, DivisionOptions, Frame, Outcome};
use crate::equilibria::{StationaryError, StationaryShape, stationary};
use crate::stability::StabilityError;

/// Duration of the paper's tests, in τ.
pub const WATCHED: f64 = 40.0;
/// Fewest steps in that time.
const STEPS: f64 = 200.0;
/// Distances below this, in L_h, are within the accuracy of time steps, so that their growth is not significant.
const SOLVED: f64 = 1e-8;
/// Growth rates below this, in 1/τ, may have the wrong sign on the mesh of a division, which shifts them by up to 5e-4.
const RESOLVED: f64 = 1e-3;
/// Longest step times the growth rate of the perturbation.
const GROWTH_PER_STEP: f64 = 0.1;

/// The evolution of a perturbed stationary shape.
#[derive(Clone, Debug, PartialEq)]
pub struct Perturbation {
    /// Its outcome: divided, or `failed` if it has not divided within the observed time. The growth rate of an
    /// undivided cell is the rate of the nearest stationary shape, and absent if no such shape is near.
    pub division: Division,
    /// [t, dis(t)] after every step, the first at t = 0.
    pub distances: Vec<[f64; 2]>,
    /// Leading growth rate of the initial shape, in 1/τ, from its spectrum.
    pub start_growth_rate: f64,
}

impl Perturbation {
    /// Whether the cell has returned: it has not divided, is nearer to its start than the noise had moved it, and at
    /// the end is no further away than at half-time. The last condition detects a mode that grows slowly from a tiny
    /// amplitude.
    pub fn returned(&self) -> bool {
        let end = self.distances.last().copied().unwrap_or_default();
        let half = self.distances.iter().find(|[t, _]| *t >= 0.5 * end[0]).map_or(0.0, |[_, distance]| *distance);
        let noise = self.distances.get(1).map_or(0.0, |[_, distance]| *distance);
        self.division.outcome() == Outcome::Arrested && end[1] < noise && (end[1] <= half || end[1] < SOLVED)
    }

    /// Whether the mesh resolves the motion. It does not if the cell contradicts the sign of a slow growth rate.
    pub fn is_resolved(&self) -> bool {
        let agrees = self.returned() == (self.start_growth_rate < 0.0);
        agrees || self.division.outcome() != Outcome::Arrested || self.start_growth_rate.abs() > RESOLVED
    }

    /// The rate at which dis(t) increases (or, if negative, decreases) while it lies between `low` and `high` for the
    /// first time: the slope of ln dis by least squares. `None` with fewer than three steps in the interval.
    pub fn rate_between(&self, low: f64, high: f64) -> Option<f64> {
        let inside = |[_, distance]: &&[f64; 2]| (low..=high).contains(distance);
        let skipped = self.distances.iter().skip(1).skip_while(|point| !inside(point));
        let points: Vec<[f64; 2]> = skipped.take_while(inside).map(|[t, distance]| [*t, distance.ln()]).collect();
        let n = points.len() as f64;
        let (t_mean, d_mean) = points.iter().fold((0.0, 0.0), |(t, d), point| (t + point[0] / n, d + point[1] / n));
        let spread: f64 = points.iter().map(|point| (point[0] - t_mean).powi(2)).sum();
        let along: f64 = points.iter().map(|point| (point[0] - t_mean) * (point[1] - d_mean)).sum();
        (points.len() >= 3).then(|| along / spread)
    }
}

/// The reason why a stationary shape could not be perturbed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PerturbationError {
    /// There is no such shape.
    #[error(transparent)]
    Stationary(#[from] StationaryError),
    /// Its growth rates could not be computed.
    #[error(transparent)]
    Stability(#[from] StabilityError),
    /// Its evolution could not be computed.
    #[error(transparent)]
    Division(#[from] DivisionError),
}

/// Perturbs the first stationary shape at the cell's activity on its primary branch, and follows it for a time `until`,
/// in τ.
///
/// # Errors
/// [`PerturbationError`], with [`StationaryError::OutOfReach`] if the cell has no such shape.
///
/// # Examples
/// A cell with R0 = 2 leaves its symmetric shape above its pitchfork, and returns to it below:
///
/// ```
/// use furrow_cell::Cell;
/// use furrow_mechanics::division::DivisionInput;
/// use furrow_mechanics::perturbation::perturbed;
/// let returned = |xi_s: f64| {
///     let cell = Cell { xi_s, ..Cell::new(2.0) };
///     perturbed(&DivisionInput::new(cell), 40.0).map(|watched| watched.returned())
/// };
/// assert!(returned(20.0)? && !returned(25.0)?);
/// # Ok::<(), furrow_mechanics::perturbation::PerturbationError>(())
/// ```
pub fn perturbed(input: &DivisionInput, until: f64) -> Result<Perturbation, PerturbationError> {
    perturb(input, &stationary(&input.cell, &input.numerics)?, until, DivisionOptions::default())
}

/// [`perturbed`] from any stationary shape of the cell, with options. Parameters in the options have no effect:
/// sensitivities of a perturbed shape are not available.
///
/// # Errors
/// See [`perturbed`].
pub fn perturb(
    input: &DivisionInput,
    start: &StationaryShape,
    until: f64,
    options: DivisionOptions<'_>,
) -> Result<Perturbation, PerturbationError> {
    if !(until.is_finite() && until > input.numerics.first_step) {
        let allowed = "a finite time, in τ, above that of the first step";
        return Err(DivisionError::BadInput { field: "until", value: until, allowed }.into());
    }
    let start_growth_rate = start.spectrum()?.growth_rate();
    let unfolded = (start.cortex.domain == Domain::Half).then(|| unfold(&start.solution));
    let shape = unfolded.as_ref().unwrap_or(&start.solution);
    let longest_step = (until / STEPS).min(GROWTH_PER_STEP / start_growth_rate.max(0.0));
    let mut reference: Option<Solution> = None;
    let mut distances = Vec::new();
    let mut observer = options.observer;
    let mut note = |frame: Frame<'_>| {
        let from = reference.get_or_insert_with(|| frame.shape.clone());
        distances.push([frame.t, distance(frame.gauss, frame.shape, from)]);
        if let Some(observe) = &mut observer {
            observe(frame);
        }
    };
    let start = Start::Stationary { shape, until, longest_step };
    let options = DivisionOptions { observer: Some(&mut note), cancel: options.cancel, parameters: &[] };
    let (division, _) = run(input, &start, options)?;
    Ok(Perturbation { division, distances, start_growth_rate })
}

/// \[distance\], by the quadrature of the shape's own mesh.
fn distance(gauss: &Gauss, shape: &Solution, from: &Solution) -> f64 {
    let from = if shape.mesh == from.mesh { from } else { &from.on_mesh(gauss, &shape.mesh) };
    let (mut r, mut z) = (0.0, 0.0);
    let places = shape.stages.chunks_exact(shape.components).zip(from.stages.chunks_exact(shape.components));
    for (k, (here, there)) in places.enumerate() {
        let interval = k / shape.m;
        let weight = (shape.mesh[interval + 1] - shape.mesh[interval]) * gauss.b[k % shape.m];
        r += weight * (here[R] - there[R]).powi(2);
        z += weight * (here[Z] - there[Z]).powi(2);
    }
    r.sqrt() + z.sqrt()
}
