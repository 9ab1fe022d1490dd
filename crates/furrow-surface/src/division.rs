//! One division without axial symmetry, from the passive shape to pinch-off or rest.

use furrow_bvp::{Gauss, Work};
use furrow_cell::{Cell, Numerics, Scheme};
use furrow_mechanics::cortex::equations::{COMPONENTS, Constants, PRESSURE, R, Z};
use furrow_mechanics::cortex::observables::PINCH_OFF;
use furrow_mechanics::division::{Division, DivisionError, DivisionInput, Ending, advice_on_motion};
use furrow_mechanics::equilibria::error::CellName;
use furrow_mechanics::{equilibria, law, polarity};

use crate::embed::{ContourPoint, embed};
use crate::neck::{Neck, asymmetry, neck};
use crate::newton::{Newton, NewtonError};
use crate::noise;
use crate::plane::{Plates, turned};
use crate::problem::{Problem, State};
use crate::rates::{Among, Rate};
use crate::space::Space;
use crate::stepper::{Level, Stepper};

/// The neck at a time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NeckAt {
    /// Time, in τ.
    pub t: f64,
    /// The neck.
    pub neck: Neck,
}

/// A stationary surface and its growth rates, the largest first.
#[derive(Clone, Debug)]
pub struct AtRest {
    /// The stationary problem.
    pub problem: Problem,
    /// Its solution.
    pub state: State,
    /// The leading growth rates.
    pub rates: Vec<Rate>,
}

/// A division, with the properties specific to surfaces without axial symmetry.
#[derive(Clone, Debug)]
pub struct SurfaceDivision {
    /// The division.
    pub division: Division,
    /// Largest azimuthal number of the shape at the end.
    pub modes: usize,
    /// The neck after every step.
    pub necks: Vec<NeckAt>,
    /// The state of a cell that does not divide.
    pub rest: Option<AtRest>,
}

/// A neck narrower than this, relative to R0, will close: volumes and time at the radius of M.20 are extrapolated from the last step.
pub const CLOSED: f64 = 0.015;
/// Radius, relative to R0, at which an off-axis neck, or a slit, counts as closed. It then becomes a thread close to the opposite
/// wall: the volumes no longer change, and the mesh does not resolve it.
pub const THREAD: f64 = 0.05;
/// Distance of the neck from the axis, relative to R0, above which it counts as off-axis.
const ONE_SIDED: f64 = 0.3;
/// A neck with a smaller roundness is a slit. Its walls touch while it is still wide, so the division ends at [`THREAD`].
const SLIT: f64 = 0.5;
/// A neck narrower than this, relative to R0, also counts as closed if the last steps cannot be computed.
const CLOSING: f64 = 0.08;
/// Local error of a step, relative to R0, for each unit of the numerics' tolerance.
const ERROR: f64 = 6.0;
/// Longest step, in τ at viscosity 1, so that growing modes are not damped. Motion slows in proportion to the viscosity.
const LONGEST: f64 = 0.05;
/// Longest step relative to the time since the start, because some initial motions are small and grow fast.
const EARLY: f64 = 0.03;
/// Change of the target mesh for a motion of R0 (root mean square over the surface), in units of the change when the neck narrows by
/// a factor e.
const MOVED: f64 = 50.0;
/// Rate at which the mesh follows the target mesh, for a change of 1. If the mesh moved by a fixed fraction in every step, shorter steps
/// would not be smoother.
const FOLLOWING: f64 = 1.2;
/// Relaxation times of the mesh, relative to R0² and at viscosity 1, for a neck on the axis and for an off-axis neck. Without drag the
/// rings of a deep one-sided furrow may have no equilibrium close to the previous one; with too much drag rings lag behind a closing
/// neck.
const DRAG: [f64; 2] = [0.005, 0.05];
/// A surface slower than this, relative to R0 and in 1/τ at viscosity 1, may take longer steps, limited by its fastest disturbance.
const CREEPING: f64 = 5e-3;
/// Longest step of a slowly moving surface, relative to the time in which its fastest disturbance grows by a factor e.
const GROWING: f64 = 0.1;
/// Number of steps after which the growth rates of a slowly moving surface are recomputed.
const CREPT: usize = 20;
/// Shortest step, in τ at viscosity 1.
const SHORTEST: f64 = 1e-9;
/// Largest relative narrowing of the neck in a step.
const NARROWING: f64 = 0.25;
/// A surface slower than this, relative to R0 and in 1/τ at viscosity 1, may be at rest.
const SLOW: f64 = 2e-5;
/// Largest distance of a slow surface from a stationary one, relative to R0, at which it counts as stationary.
const CLOSE: f64 = 0.02;
/// Largest number of steps of a division.
const MOST_STEPS: f64 = 4000.0;
/// Largest change of the flattening of a shell in one step of the search for a passive cell.
const CLOSING_PLATES: f64 = 0.05;
/// Largest azimuthal mode number of the initial shape.
const FIRST_MODES: usize = 2;
/// Size of the harmonics of the largest mode number, relative to R0, above which another mode is added.
const TAIL: f64 = 1e-4;

/// Computes one division with the azimuthal modes allowed by the numerics; `observe` is called with the surface after every step.
///
/// # Errors
/// [`DivisionError`].
pub fn divide(
    input: &DivisionInput,
    observe: &mut dyn FnMut(&Problem, &Level),
) -> Result<SurfaceDivision, DivisionError> {
    run(input, false, observe)
}

/// [`divide`]; `symmetric` omits the noise that breaks the mirror symmetry u → 1 − u, so that a cell may come to rest in a
/// state that is unstable to such disturbances.
pub(crate) fn run(
    input: &DivisionInput,
    symmetric: bool,
    observe: &mut dyn FnMut(&Problem, &Level),
) -> Result<SurfaceDivision, DivisionError> {
    let DivisionInput { cell, numerics, seed } = input;
    check(cell, numerics)?;
    let cell = &*polarity::resolved(cell).map_err(|source| DivisionError::Polarity { source })?;
    let (cell, plates) = &turned(cell)?;
    let (problem, state) = start(cell, *plates, numerics)?;
    let mut stepper = Stepper::new(problem, state);
    stepper.problem.drag = DRAG[0] / (cell.r0 * cell.r0);
    stepper.contact = numerics.contact;
    let first = &stepper.history[0].state.surface;
    stepper.problem.noise = noise::factors(&stepper.problem, first, numerics, *seed, symmetric);
    observe(&stepper.problem, &stepper.history[0]);
    let viscosity = stepper.problem.viscosity();
    let mut run = Run {
        r0: cell.r0,
        viscosity,
        epsilon: cell.epsilon,
        advice: advice_on_motion(&cell.cue),
        numerics,
        // The local error is of third order.
        tolerance: ERROR * numerics.time_tolerance * cell.r0 * numerics.step_factor.powi(3),
        dt: numerics.first_step,
        longest: LONGEST * viscosity,
        crept: 0,
        necks: Vec::new(),
        speed: f64::INFINITY,
        drift: 0.0,
        looked: f64::INFINITY,
        symmetric,
    };
    loop {
        if let Err(error) = run.advance(&mut stepper) {
            return run.divided(&stepper, true).ok_or(error);
        }
        observe(&stepper.problem, &stepper.history[0]);
        if let Some(found) = run.divided(&stepper, false).or_else(|| run.rested(&mut stepper)) {
            return Ok(found);
        }
        run.creep(&stepper);
        run.limits(&stepper)?;
        run.take_modes(&mut stepper);
    }
}

fn check(cell: &Cell, numerics: &Numerics) -> Result<(), DivisionError> {
    let unsupported = |what, instead| Err(DivisionError::Unsupported { what, instead });
    if cell.cue.regulator().is_some() {
        return unsupported(
            "a regulator that the flow carries has no equations without axial symmetry",
            "paint the cue, or leave out --three-dimensional",
        );
    }
    law::check_without_axis(cell).map_err(|source| DivisionError::Law { r0: cell.r0, source })?;
    if numerics.scheme == Scheme::Published {
        return unsupported("the published scheme has axial symmetry alone", "set scheme = converged");
    }
    if numerics.noise_time > 0.0 && numerics.noise != 0.0 {
        return unsupported("sustained noise has axial symmetry alone", "set noise_time = 0");
    }
    Ok(())
}

/// The error if no shorter step is accurate.
fn stalled(r0: f64, [t, dt, neck]: [f64; 3], reason: String) -> DivisionError {
    DivisionError::SurfaceStalled { r0, t, dt, neck, reason }
}

/// The passive surface of a cell, in a problem with its activity and cue.
///
/// # Errors
/// [`DivisionError`].
pub fn start(cell: &Cell, plates: Plates, numerics: &Numerics) -> Result<(Problem, State), DivisionError> {
    let name = CellName::of(cell);
    let (full, _) = equilibria::passive_whole(cell, numerics)
        .map_err(|source| DivisionError::NoPassiveShape { cell: name, source })?;
    let gauss = Gauss::new(numerics.stages).unwrap_or_default();
    let round = cell.shell.flattening == 1.0;
    let space = Space::new(numerics.elements, if round { numerics.modes.min(FIRST_MODES) } else { numerics.modes });
    let mut problem = Problem::new(&cell.passive(), space);
    let contour = |u: f64| {
        let mut y = [0.0; COMPONENTS];
        full.eval(&gauss, u, &mut y);
        ContourPoint { r: y[R], z: y[Z], ..ContourPoint::default() }
    };
    let shares = problem.mesh.shares(&problem.space);
    let mut state = embed(&problem.space, &shares, full.scalars[PRESSURE], contour);
    // The plates approach a passive cell in a round shell step by step.
    let steps = ((1.0 - cell.shell.flattening) / CLOSING_PLATES).ceil();
    for step in 0..=steps as usize {
        let closed = if round { 0.0 } else { step as f64 / steps };
        let flattening = 1.0 + (cell.shell.flattening - 1.0) * closed;
        problem.plates = plates.factors(flattening);
        problem
            .settle(&mut state, Problem::wanted_density, &mut Work::default())
            .map_err(|source| DivisionError::NoPassiveSurface { r0: cell.r0, reason: source.to_string() })?;
    }
    problem.constants = Constants::new(cell, |_, value| value);
    Ok((problem, state))
}

/// Number of mesh adaptations of a stationary surface.
const SETTLING: usize = 8;

impl Problem {
    /// Makes a state stationary. Each mesh adaptation goes half of the way to the density `wanted`.
    ///
    /// # Errors
    /// [`NewtonError`].
    pub fn settle(
        &mut self,
        state: &mut State,
        wanted: impl Fn(&Problem, &[f64]) -> Vec<f64>,
        work: &mut Work,
    ) -> Result<(), NewtonError> {
        let newton = Newton { tolerance: 1e-7, share: 1.0, iterations: 25, slow: 0.5 };
        for round in 0..=SETTLING {
            self.spread(&state.surface);
            self.solve(&newton, state, &mut None, work)?;
            let way = match SETTLING - round {
                0 => break,
                1 => 1.0,
                _ => 0.5,
            };
            let wanted = wanted(self, &state.surface);
            let densities = self.mesh.density.iter_mut().zip(wanted);
            densities.for_each(|(density, wanted)| *density += way * (wanted - *density));
        }
        Ok(())
    }
}

/// Largest number of steps like the last one for the extrapolation of the end of a division.
const MOST_LEFT: f64 = 10.0;

/// Largest change of the neck's u in a step.
const SAME_WAIST: f64 = 0.1;

/// The number of steps like the last one until the neck has a given radius, negative if it is already narrower; 0 if it does not
/// narrow.
fn steps_left(before: f64, now: f64, target: f64) -> f64 {
    let narrowed = before - now;
    if narrowed > 0.0 { ((now - target) / narrowed).clamp(-1.0, MOST_LEFT) } else { 0.0 }
}

/// A division in progress.
struct Run<'a> {
    r0: f64,
    /// The larger of the viscosities, by which times scale.
    viscosity: f64,
    epsilon: f64,
    /// The message for a cell that continues to move.
    advice: &'static str,
    numerics: &'a Numerics,
    tolerance: f64,
    /// Length of the next step, in τ.
    dt: f64,
    /// Longest step, in τ.
    longest: f64,
    /// Steps of a slowly moving surface since its growth rates were computed.
    crept: usize,
    necks: Vec<NeckAt>,
    /// Normal speed in the last step, as a root mean square over the surface relative to R0, in 1/τ at viscosity 1.
    speed: f64,
    /// Largest relative deviation of the volume.
    drift: f64,
    /// Speed at which the current slow shape was last found not to be at rest.
    looked: f64,
    /// Whether the noise is even about u = ½, so that the cell may rest in a state that is unstable to odd disturbances.
    symmetric: bool,
}

impl Run<'_> {
    /// One accepted step.
    fn advance(&mut self, stepper: &mut Stepper) -> Result<(), DivisionError> {
        let noisy = self.numerics.first_step;
        if stepper.history[0].t >= noisy * (1.0 - 1e-9) && !stepper.problem.noise.is_empty() {
            stepper.problem.noise.clear();
            stepper.restart();
        }
        loop {
            let reason = match stepper.attempt(self.dt) {
                Ok((level, error)) => {
                    let relative = error.map(|error| error / self.tolerance);
                    let Some(large) = relative.filter(|error| *error > 1.5) else {
                        self.accept(stepper, level, relative);
                        return Ok(());
                    };
                    self.dt *= 0.5;
                    format!("the local error is {large:.1} times what is allowed")
                }
                Err(source) => {
                    self.dt *= 0.25;
                    stepper.slow_down();
                    source.to_string()
                }
            };
            stepper.work.rejected += 1;
            if self.dt < SHORTEST * self.viscosity {
                let neck = self.necks.last().map_or(1.0, |at| at.neck.radius / self.r0);
                return Err(stalled(self.r0, [stepper.history[0].t, self.dt, neck], reason));
            }
        }
    }

    fn accept(&mut self, stepper: &mut Stepper, level: Level, error: Option<f64>) {
        let problem = &stepper.problem;
        self.drift = self.drift.max((problem.volume(&level.state.surface) / problem.constants.volume - 1.0).abs());
        let t = level.t;
        let found = neck(&problem.space, &level.state.surface);
        let moved = problem.normal_distance(&level.state.surface, &stepper.history[0].state.surface);
        let mut growth = error.map_or(1.0, |error| (0.8 / error.max(1e-3).cbrt()).clamp(0.5, 2.0));
        self.speed = moved / (t - stepper.history[0].t) / self.r0 * self.viscosity;
        let mut change = MOVED * moved / self.r0;
        let mut drag = DRAG[0];
        if let Some(neck) = found {
            if let Some(before) = self.necks.last() {
                let speed = (before.neck.radius - neck.radius) / (t - before.t);
                if speed > 0.0 {
                    growth = growth.min(NARROWING * self.numerics.step_factor * neck.radius / speed / self.dt);
                    change += (before.neck.radius / neck.radius).ln();
                }
            }
            let one_sided = (neck.offset.abs() / (ONE_SIDED * self.r0)).min(1.0);
            drag += one_sided * (DRAG[1] - DRAG[0]);
            self.necks.push(NeckAt { t, neck });
        }
        stepper.problem.drag = drag / (self.r0 * self.r0);
        stepper.accept(level, 1.0 - (-FOLLOWING * change).exp());
        // With equal steps the derivatives of the last step can be reused.
        if !(0.9..1.25).contains(&growth) {
            let longest = self.longest.min(2.0 * self.numerics.first_step + EARLY * t);
            self.dt = (self.dt * growth).min(longest * self.numerics.step_factor);
        }
    }

    /// Sets the longest step of a slowly moving surface, so that its growing disturbances are resolved.
    fn creep(&mut self, stepper: &Stepper) {
        let usual = LONGEST * self.viscosity;
        if self.speed > CREEPING {
            (self.longest, self.crept) = (usual, 0);
            self.dt = self.dt.min(usual * self.numerics.step_factor);
            return;
        }
        self.crept += 1;
        if self.crept < CREPT || !stepper.problem.noise.is_empty() {
            return;
        }
        self.crept = 0;
        let rates = stepper.problem.rates(&stepper.history[0].state, 1, Among::All);
        let fastest = rates.ok().and_then(|rates| rates.first().map(|rate| rate.re)).unwrap_or(f64::INFINITY);
        self.longest = (GROWING / fastest.max(0.0)).clamp(usual, (2.0 * self.longest).max(usual));
    }

    /// The division, if the neck has closed; `failed` if no further step can be computed.
    fn divided(&self, stepper: &Stepper, failed: bool) -> Option<SurfaceDivision> {
        let [.., before, now] = self.necks.as_slice() else { return None };
        let thread = now.neck.offset.abs() > ONE_SIDED * self.r0 || now.neck.roundness < SLIT;
        let [closed, target] = match thread {
            true => [THREAD; 2],
            false => [CLOSED, PINCH_OFF],
        };
        if now.neck.radius >= if failed { CLOSING } else { closed } * self.r0 {
            return None;
        }
        // With two waists, another one may have been narrower before.
        let same = (now.neck.u - before.neck.u).abs() < SAME_WAIST;
        let left =
            if failed || !same { 0.0 } else { steps_left(before.neck.radius, now.neck.radius, target * self.r0) };
        let [level, last, ..] = stepper.history.as_slice() else { return None };
        let space = &stepper.problem.space;
        let chi = asymmetry(space, &level.state.surface, &now.neck);
        let chi_signed = chi + left * (chi - asymmetry(space, &last.state.surface, &before.neck));
        let share = stepper.problem.mean_meridian(&level.state.surface).share_at(now.neck.u);
        let symmetric = chi_signed.abs() < self.numerics.chi_symmetric;
        let ending = Ending::Divided { symmetric, chi_signed, u_furrow: share, daughters: [0.0; 2] };
        let division = self.division(stepper, ending, now.t + left * (now.t - before.t)).with_daughters_of(self.r0);
        Some(self.result(stepper, division))
    }

    fn division(&self, stepper: &Stepper, ending: Ending, t_end: f64) -> Division {
        let work = stepper.work;
        let waist = neck(&stepper.problem.space, &stepper.history[0].state.surface);
        let neck_offset = waist.filter(|_| self.numerics.modes > 0).map(|neck| neck.offset.abs());
        let volume_drift = self.drift;
        Division {
            ending,
            t_end,
            slow_growth_rate: None,
            phi: None,
            neck_offset,
            second_neck: None,
            volume_drift,
            work,
        }
    }

    fn result(&self, stepper: &Stepper, division: Division) -> SurfaceDivision {
        SurfaceDivision { division, modes: stepper.problem.space.modes, necks: self.necks.clone(), rest: None }
    }

    /// The division, if the cell is at rest: its surface is close to a stationary one that is stable to all disturbances of this cell.
    fn rested(&mut self, stepper: &mut Stepper) -> Option<SurfaceDivision> {
        let now = stepper.history.first()?;
        if self.speed > SLOW {
            self.looked = f64::INFINITY;
            return None;
        }
        if self.speed > 0.1 * self.looked {
            return None;
        }
        self.looked = self.speed;
        let mut problem = stepper.problem.clone();
        let mut state = now.state.clone();
        problem.motion = Default::default();
        // It must be stable to all modes allowed by the numerics.
        problem.take_modes(self.numerics.modes, [&mut state]);
        let before = state.surface.clone();
        // Stationary shapes have no small features, so equidistant rings are most accurate. Some bent surfaces have no such mesh.
        let moved = (problem.clone(), state.clone());
        let equal = |problem: &Problem, _: &[f64]| vec![1.0; problem.mesh.density.len()];
        let settled = problem.settle(&mut state, equal, &mut stepper.work);
        if settled.is_err() || problem.normal_distance(&state.surface, &before) > CLOSE * self.r0 {
            (problem, state) = moved;
            problem.settle(&mut state, |problem, _| problem.mesh.density.clone(), &mut stepper.work).ok()?;
        }
        if problem.normal_distance(&state.surface, &before) > CLOSE * self.r0 {
            return None;
        }
        let rates = problem.rates(&state, 6, Among::All).ok()?;
        let growth_rate = rates.first()?.re;
        let is_left =
            growth_rate >= 0.0 && (!self.symmetric || problem.rates(&state, 1, Among::Even).ok()?.first()?.re >= 0.0);
        if is_left {
            return None;
        }
        let division = self.division(stepper, Ending::Arrested { growth_rate: Some(growth_rate) }, now.t);
        let rest = Some(AtRest { problem, state, rates });
        Some(SurfaceDivision { rest, ..self.result(stepper, division) })
    }

    fn limits(&self, stepper: &Stepper) -> Result<(), DivisionError> {
        let (t, steps, r0) = (stepper.history[0].t, stepper.work.steps, self.r0);
        if t > self.numerics.t_max {
            return Err(DivisionError::Undecided { r0, epsilon: self.epsilon, t_max: self.numerics.t_max });
        }
        if steps as f64 > MOST_STEPS / self.numerics.step_factor {
            Err(DivisionError::Restless { r0, t, steps, advice: self.advice })
        } else {
            Ok(())
        }
    }

    /// Adds an azimuthal mode if the largest one is in use.
    fn take_modes(&self, stepper: &mut Stepper) {
        let modes = stepper.problem.space.modes;
        let tail = stepper.problem.space.tail(&stepper.history[0].state.surface);
        if modes < self.numerics.modes && tail > TAIL * self.r0 {
            stepper.take_modes(modes + 1);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_neck_that_hardly_narrows_is_not_extrapolated_far() {
        assert!((steps_left(0.02, 0.015, 0.01) - 1.0).abs() < 1e-12);
        assert_eq!(steps_left(0.015, 0.01499, 0.001), MOST_LEFT);
        assert_eq!(steps_left(0.015, 0.015, 0.01), 0.0);
        assert_eq!(steps_left(0.014, 0.015, 0.01), 0.0);
        assert!((steps_left(0.051, 0.02, 0.05) + 30.0 / 31.0).abs() < 1e-12);
    }
}
