//! One division from the passive shape to pinch-off or rest.

use std::sync::atomic::{AtomicBool, Ordering};

use furrow_bvp::{Gauss, NewtonError, Solution, Work};

use super::noise::Noise;
use super::oscillation::Oscillation;
use super::outcome::{Division, DivisionError, Ending, StepFailure, advice_on_motion};
use super::rest::{EquilibriumDetector, REST_INTERVAL, Rest};
use super::sensitivity::{Sensitivity, Tangent};
use super::start::{FIRST_MESH, Start, check};
use super::step_size::StepSize;
use super::stepper::{Attempt, HistoryPoint, MAX_ORDER, ParityNorm, Stepper};
use super::{DivisionInput, limits, saddle};
use crate::cortex::equations::{LENGTH, PSI, R};
use crate::cortex::lanes::sin_cos;
use crate::cortex::observables::{self, Neck, PINCH_OFF};
use crate::cortex::{Cortex, Domain};
use crate::polarity;
use furrow_cell::{Cell, Numerics, Parameter, Scheme};

/// Length below which the first step is not shortened further, in τ.
const SHORTEST_FIRST_STEP: f64 = 1e-9;
/// The first step of the published scheme is lengthened by no smaller factor.
const LEAST_LENGTHENING: f64 = 1.02;
/// Longest first step after a skipped wait at a saddle, in τ: no mode that grows there is as fast.
const STEP_AFTER_SADDLE: f64 = 1.0;
/// Longest step under sustained noise, relative to the time between its sets of coefficients.
const NOISE_STEP: f64 = 0.25;
/// Largest relative narrowing of the neck per step.
const NECK_STEP: f64 = 0.4;
/// The same in the published scheme, which has no other error control.
const PUBLISHED_NECK_STEP: f64 = 0.08;
/// Below this neck radius, relative to R0, the closing of the neck is faster than all other changes.
const CLOSING: f64 = 0.3;
/// Errors allowed while the neck closes, in units of the time tolerance: they affect only the time of pinch-off.
const CLOSING_TOLERANCE: f64 = 4.0;
/// Size of the antisymmetric part of a shape, relative to R0, up to which its effect on the symmetric part is
/// neglected: the effect of its square on the volume stays below 1e-8 of the volume.
const NEARLY_SYMMETRIC: f64 = 1.5e-5;
/// The same while the neck closes, when the effect has no time to accumulate.
const NEARLY_SYMMETRIC_CLOSING: f64 = 4e-5;
/// Local error of the odd part relative to its size, in units of the time tolerance.
const ODD_TOLERANCE: f64 = 375.0;
/// An odd part below this, relative to R0, is rounding and is not resolved: without noise, rounding is all that is odd
/// at first.
const ODD_ROUNDING: f64 = 1e-12;

/// Times that differ by less than this fraction count as equal.
const ROUNDING: f64 = 1e-9;

/// A mesh is refined at a saddle with a growth rate below this, in 1/τ, because the rate must be right.
const NEAR_CRITICAL: f64 = 0.1;
/// Time until the next search for rest at a saddle, in 1/σ: a growing mode needs several of these to leave it.
const SADDLE_WAIT: f64 = 5.0;
/// Number of visits to a saddle after which the mesh is refined there.
const MOST_VISITS: usize = 3;
/// Time for a cell that has left a saddle to divide or come to rest elsewhere, in 1/σ.
const AFTERWARDS: f64 = 1e3;

/// The state of a division that an observer receives after every accepted step.
#[derive(Clone, Copy, Debug)]
pub struct Frame<'a> {
    /// Time, in τ.
    pub t: f64,
    /// The shape on the full contour.
    pub shape: &'a Solution,
    /// Its neck, if it has a waist.
    pub neck: Option<Neck>,
    /// The problem that the shape solves, with its motion: the input of [`forces`](crate::cortex::forces). At t = 0 it
    /// is the problem of the passive cell, or of the stationary shape at the start.
    pub cortex: &'a Cortex,
    /// The collocation scheme of the shape.
    pub gauss: &'a Gauss,
}

/// Options of a division: observation and cancellation. The default has neither.
#[derive(Default)]
pub struct DivisionOptions<'a> {
    /// Called with the start shape and after every accepted step.
    pub observer: Option<&'a mut dyn FnMut(Frame<'_>)>,
    /// Once set, the division stops after the current step with [`DivisionError::Cancelled`].
    pub cancel: Option<&'a AtomicBool>,
    /// Parameters by which the outcome is differentiated: see [`sensitivity`](super::sensitivity).
    pub parameters: &'a [Parameter],
}

impl<'a> DivisionOptions<'a> {
    /// With an observer alone.
    pub fn observed_by(observer: &'a mut dyn FnMut(Frame<'_>)) -> DivisionOptions<'a> {
        DivisionOptions { observer: Some(observer), ..DivisionOptions::default() }
    }
}

/// A division, with its derivatives by each requested parameter.
pub type Divided = Result<(Division, Option<Vec<Sensitivity>>), DivisionError>;

/// Computes one division.
///
/// # Errors
/// [`DivisionError`], which names the cell and the attempts.
pub fn divide(input: &DivisionInput) -> Result<Division, DivisionError> {
    Ok(divide_with(input, DivisionOptions::default())?.0)
}

/// [`divide`] with options, and the exact derivatives of the outcome by each parameter in them. There are no
/// derivatives where the outcome is not smooth: if the cell does not divide, or if its wait at a stationary shape was
/// skipped.
///
/// # Errors
/// See [`divide`].
///
/// # Examples
/// Derivatives of χ of a cell with the germline's cue by its size and by the strength of the cue:
///
/// ```
/// use furrow_cell::{Cell, Cue, Parameter};
/// use furrow_mechanics::division::{DivisionInput, DivisionOptions, divide_with};
/// let input = DivisionInput::new(Cell::new(3.3).with_cue(Cue::published()));
/// let parameters = [Parameter::R0, "cue.amplitude".parse()?];
/// let options = DivisionOptions { parameters: &parameters, ..DivisionOptions::default() };
/// let (division, sensitivities) = divide_with(&input, options)?;
/// let by = sensitivities.ok_or("does not divide")?;
/// println!("χ = {:?}; ∂χ/∂R0 = {}, ∂χ/∂Δκ = {}", division.chi_signed(), by[0].chi_signed, by[1].chi_signed);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn divide_with(input: &DivisionInput, options: DivisionOptions<'_>) -> Divided {
    if input.cell.cue.follows_par() && !options.parameters.is_empty() {
        return super::followed::divide(input, options);
    }
    run(input, &Start::Passive, options)
}

/// One division from any start.
pub(crate) fn run(input: &DivisionInput, start: &Start<'_>, options: DivisionOptions<'_>) -> Divided {
    let DivisionOptions { observer, cancel, parameters } = options;
    let mut unobserved = |_: Frame<'_>| {};
    let observe = observer.unwrap_or(&mut unobserved);
    require_axial_symmetry(input)?;
    let cell = &*polarity::resolved(&input.cell).map_err(|source| DivisionError::Polarity { source })?;
    let mut stepper = start.stepper(cell, &input.numerics)?;
    let tangent = (!parameters.is_empty()).then(|| Tangent::of_start(&stepper, parameters));
    let (shape, gauss) = (&stepper.history[0].y, &stepper.system.gauss);
    observe(Frame { t: 0.0, shape, neck: None, cortex: &start.cortex(cell), gauss });
    let mut run = Run::begin(input, start, &mut stepper, tangent, observe)?;
    let division = loop {
        if cancel.is_some_and(|cancel| cancel.load(Ordering::Relaxed)) {
            return Err(DivisionError::Cancelled { r0: cell.r0, t: stepper.history[0].t });
        }
        if let Some([until, longest_step]) = start.watched() {
            let factor = if run.fixed.is_some() { 1.0 } else { run.factor };
            run.dt = run.dt.min(longest_step.min(until - stepper.history[0].t) / factor);
        }
        run.advance(&mut stepper)?;
        // The equations may have solutions beyond this point, but they have no physical meaning.
        if let Some(error) = limits::taken_away(&stepper, 0.0).or_else(|| limits::short_waves(&stepper)) {
            return Err(error);
        }
        let newest = &stepper.history[0];
        let (cortex, gauss) = (&stepper.cortex, &stepper.system.gauss);
        observe(Frame { t: newest.t, shape: &newest.y, neck: run.neck, cortex, gauss });
        if let Some(division) = run.ended(&mut stepper, start, &input.numerics)? {
            break division;
        }
        stepper.adapt(run.parity, 1.5);
    };
    let smooth = matches!(division.ending, Ending::Divided { .. }) && division.slow_growth_rate.is_none();
    Ok((division, run.tangent.filter(|_| smooth).and_then(|tangent| tangent.read(&stepper))))
}

/// Requires a valid cell and numerics that the equations with axial symmetry can describe.
fn require_axial_symmetry(input: &DivisionInput) -> Result<(), DivisionError> {
    check(&input.cell)?;
    if !input.cell.has_axis() {
        let what = "a flattened shell, or a cue at one side of the axis, needs equations without axial symmetry";
        return Err(DivisionError::Unsupported { what, instead: "compute it with --three-dimensional" });
    }
    if input.numerics.modes > 0 {
        let instead = "leave out --three-dimensional, and set modes = 0";
        return Err(DivisionError::Unsupported { what: "these equations have axial symmetry", instead });
    }
    Ok(())
}

/// The regulator at u in one of the last shapes.
fn phi_at(stepper: &Stepper, level: usize, u: f64) -> Option<f64> {
    observables::regulator_at(&stepper.system.gauss, &stepper.history.get(level)?.y, Domain::Full, u)
}

/// Controls of one run.
#[derive(Default)]
struct Run {
    tolerance: f64,
    factor: f64,
    /// Whether there is a regulator, which changes at the neck until it closes.
    regulated: bool,
    /// Whether the shape is nearly mirror-symmetric, with its odd part resolved relative to its own size.
    parity: bool,
    odd_floor: f64,
    dt: f64,
    step_size: StepSize,
    /// The step of the published scheme.
    fixed: Option<f64>,
    /// Sustained noise.
    noise: Option<Noise>,
    steps: usize,
    /// Steps on a mesh that has grown count several times in the step budget.
    spent: f64,
    rejected: usize,
    detector: EquilibriumDetector,
    drift: f64,
    neck: Option<Neck>,
    neck_rate: f64,
    /// Largest time of the numerics, in τ.
    longest: f64,
    /// Largest time of this cell: later for a cell that has waited at a saddle.
    t_max: f64,
    /// Number of times that the shape was found at a saddle.
    saddle_visits: usize,
    /// Growth rate of that saddle.
    slow_growth_rate: Option<f64>,
    /// Derivatives of the shape by parameters, if requested.
    tangent: Option<Tangent>,
    /// Detector of oscillations in the length of the contour.
    oscillation: Oscillation,
}

impl Run {
    /// Makes the first step, and shows it.
    fn begin(
        DivisionInput { numerics, seed, .. }: &DivisionInput,
        start: &Start<'_>,
        stepper: &mut Stepper,
        tangent: Option<Tangent>,
        observe: &mut dyn FnMut(Frame<'_>),
    ) -> Result<Run, DivisionError> {
        let mut run = Run {
            tolerance: numerics.time_tolerance,
            factor: numerics.step_factor,
            parity: stepper.cortex.cell.is_mirror_symmetric(),
            dt: Noise::first_step(numerics),
            fixed: (numerics.scheme == Scheme::Published).then_some(numerics.dt),
            longest: numerics.t_max,
            t_max: numerics.t_max,
            tangent,
            ..Run::default()
        };
        if start.watched().is_none() {
            stepper.adapt(run.parity, FIRST_MESH);
        }
        stepper.extrapolates = numerics.scheme == Scheme::Converged;
        let mut noise = Noise::new(*seed, numerics);
        run.first_step(stepper, &mut noise)?;
        let (newest, gauss) = (&stepper.history[0], &stepper.system.gauss);
        let neck = observables::neck(gauss, &newest.y);
        observe(Frame { t: newest.t, shape: &newest.y, neck, cortex: &stepper.cortex, gauss });
        stepper.cortex.noise.clear();
        run.regulated = stepper.cortex.is_regulated();
        run.noise = Some(noise).filter(|noise| noise.sustained().is_some());
        // Sustained noise keeps exciting the antisymmetric part. Without noise the antisymmetric part consists of rounding
        // errors, which must grow as they do on the whole contour.
        if run.parity && stepper.extrapolates && numerics.noise != 0.0 && run.noise.is_none() {
            stepper.nearly_symmetric = NEARLY_SYMMETRIC;
            stepper.halve();
        }
        Ok(run)
    }

    /// The first step, with noisy activity. The noise acts in a step of given length, independent of the step factor.
    /// If this step cannot be solved, for example because a strong cue makes the cortex a hundred times faster, the
    /// length is reduced by factors of ten; perturbations from the noise then grow correspondingly sooner. The step of the
    /// published scheme is so long that the noise may decide the outcome, so it is [lengthened](Self::lengthen) again.
    fn first_step(&mut self, stepper: &mut Stepper, noise: &mut Noise) -> Result<(), DivisionError> {
        stepper.cortex.noise = noise.factors(0.0, &stepper.history[0].y, &stepper.system.gauss);
        let mut first = loop {
            match stepper.attempt(self.dt, 1) {
                Ok(first) => break first,
                Err(_) if self.dt > SHORTEST_FIRST_STEP => {
                    self.rejected += 1;
                    self.dt *= 0.1;
                }
                Err(error) => return Err(self.stalled(stepper, error.into())),
            }
        };
        if let Some(fixed) = self.fixed.filter(|fixed| self.dt < *fixed) {
            first = self.lengthen(stepper, fixed)?;
        }
        self.odd_floor = f64::max(0.3 * first.odd_size, ODD_ROUNDING * stepper.cortex.cell.r0);
        stepper.accept();
        self.tangent.iter_mut().for_each(|tangent| tangent.follow(stepper));
        stepper.restart();
        self.steps = 1;
        Ok(())
    }

    /// Lengthens the first step to `fixed`: each solution is the guess for the next, longer one.
    fn lengthen(&mut self, stepper: &mut Stepper, fixed: f64) -> Result<Attempt, DivisionError> {
        let mut factor = 2.0f64;
        loop {
            let dt = (self.dt * factor).min(fixed);
            match stepper.lengthen(dt) {
                Ok(attempt) if dt >= fixed => return Ok(attempt),
                Ok(_) => {}
                Err(error) if factor < LEAST_LENGTHENING => return Err(self.stalled(stepper, error.into())),
                Err(_) => {
                    self.rejected += 1;
                    factor = factor.sqrt();
                    continue;
                }
            }
            self.dt = dt;
        }
    }

    fn stalled(&self, stepper: &Stepper, source: StepFailure) -> DivisionError {
        let (r0, t) = (stepper.cortex.cell.r0, stepper.history[0].t);
        let stalled = DivisionError::Stalled { r0, t, dt: self.dt, source };
        let taken_away = limits::taken_away(stepper, limits::TAKEN_AWAY).or_else(|| limits::short_waves(stepper));
        taken_away.or_else(|| limits::collapsed(stepper)).unwrap_or(stalled)
    }

    /// One step of the published scheme. Steps have a fixed length, but are shorter if a step cannot be solved or while
    /// the neck closes.
    fn advance_fixed(&mut self, stepper: &mut Stepper, fixed: f64) -> Result<(), DivisionError> {
        while let Err(error) = self.attempt(stepper, self.dt, 1) {
            self.rejected += 1;
            self.dt *= 0.5;
            if self.dt < 1e-12 {
                return Err(self.stalled(stepper, error.into()));
            }
        }
        self.accept(stepper, 2.0);
        self.dt = self.dt.min(fixed);
        Ok(())
    }

    /// Attempts a step with the noise at its end.
    fn attempt(&mut self, stepper: &mut Stepper, dt: f64, order: usize) -> Result<Attempt, NewtonError> {
        if let Some(noise) = &mut self.noise {
            let newest = &stepper.history[0];
            stepper.cortex.noise = noise.factors(newest.t + dt, &newest.y, &stepper.system.gauss);
        }
        stepper.attempt(dt, order)
    }

    /// One accepted step.
    fn advance(&mut self, stepper: &mut Stepper) -> Result<(), DivisionError> {
        if let Some(fixed) = self.fixed {
            return self.advance_fixed(stepper, fixed);
        }
        let r0 = stepper.cortex.cell.r0;
        let mut failures = 0;
        loop {
            let order = MAX_ORDER.min(stepper.history.len());
            let longest =
                self.noise.as_ref().and_then(Noise::sustained).map_or(f64::INFINITY, |time| NOISE_STEP * time);
            let dt = self.dt.min(longest) * self.factor;
            let attempt = self.attempt(stepper, dt, order);
            let shrink = match &attempt {
                Ok(a) => {
                    // The step factor scales steps chosen for the tolerance: a smaller error does not make them longer.
                    let error = self.error_ratio(a, r0) / self.factor.powi(order as i32 + 1);
                    if error <= 1.0 || stepper.history.len() == 1 {
                        let growth = self.step_size.growth(self.dt, error, order);
                        self.accept(stepper, growth);
                        return Ok(());
                    }
                    StepSize::shrinkage(error, order)
                }
                Err(_) => 0.4,
            };
            self.rejected += 1;
            failures += 1;
            self.dt *= shrink;
            if failures > 3 {
                stepper.restart();
            }
            if self.dt < 1e-12 {
                return Err(
                    self.stalled(stepper, attempt.map_or_else(StepFailure::Newton, |_| StepFailure::Inaccurate))
                );
            }
        }
    }

    /// The division if it ends with the newest shape: at pinch-off, at rest, or at the end of the time.
    fn ended(
        &mut self,
        stepper: &mut Stepper,
        start: &Start<'_>,
        numerics: &Numerics,
    ) -> Result<Option<Division>, DivisionError> {
        let r0 = stepper.cortex.cell.r0;
        if let Some(neck) = self.neck.filter(|neck| neck.radius < PINCH_OFF * r0) {
            return Ok(Some(self.divided(stepper, neck, numerics.chi_symmetric)));
        }
        if let Some([until, _]) = start.watched() {
            let is_over = stepper.history[0].t >= until * (1.0 - ROUNDING);
            // With the growth rate of the nearest stationary shape.
            let growth_rate = || Rest::near(stepper, 0, self.parity).map(|rest| rest.growth_rate);
            return Ok(is_over.then(|| self.arrested(stepper, growth_rate())));
        }
        if let Some(rest) = self.detector.look(stepper, self.parity) {
            // The published scheme cannot leave every unstable shape: backward Euler multiplies a mode by 1/(1 − σΔt).
            if rest.growth_rate < 0.0 || self.fixed.is_some_and(|dt| rest.growth_rate * dt > 2.0) {
                return Ok(Some(self.arrested(stepper, Some(rest.growth_rate))));
            }
            // Sustained noise moves the cell away from the saddle.
            if self.noise.is_none() {
                self.wait_at_saddle(stepper, &rest);
            }
        }
        let newest = &stepper.history[0];
        if let Some(period) = self.oscillation.note(newest.t, newest.y.scalars[LENGTH]) {
            return Err(DivisionError::Oscillates { r0, period });
        }
        self.spent += (newest.y.intervals() as f64 / numerics.intervals as f64).max(1.0);
        if self.spent > limits::most_steps(numerics) as f64 {
            let advice = advice_on_motion(&stepper.cortex.cell.cue);
            return Err(DivisionError::Restless { r0, t: newest.t, steps: self.steps, advice });
        }
        if newest.t > self.t_max { self.out_of_time(stepper) } else { Ok(None) }
    }

    /// The end of a cell that has reached the largest time. A cell that still creeps gets more time.
    fn out_of_time(&mut self, stepper: &Stepper) -> Result<Option<Division>, DivisionError> {
        let Cell { r0, epsilon, .. } = stepper.cortex.cell;
        let drifts = if self.fixed.is_none() { limits::neutral_drift(stepper) } else { None };
        match (drifts, self.slow_growth_rate) {
            (Some(_), _) => Ok(Some(self.arrested(stepper, drifts))),
            (None, Some(growth_rate)) => Err(DivisionError::Critical { r0, growth_rate }),
            (None, None) if self.fixed.is_none() && limits::creeps(stepper, self.longest) => {
                self.t_max = stepper.history[0].t + self.longest;
                Ok(None)
            }
            (None, None) => Err(DivisionError::Undecided { r0, epsilon, t_max: self.t_max }),
        }
    }

    fn closes(&self, r0: f64) -> bool {
        self.neck.is_some_and(|neck| neck.radius < CLOSING * r0)
    }

    /// Error of a step in units of the tolerance: N.14 while the shape is nearly mirror-symmetric.
    fn error_ratio(&self, attempt: &Attempt, r0: f64) -> f64 {
        let Attempt { error: ParityNorm { even, odd }, odd_size } = *attempt;
        // Once the neck closes, the outcome is decided and no odd mode has time to grow.
        let closing = self.closes(r0);
        let tolerance = self.tolerance * if closing && !self.regulated { CLOSING_TOLERANCE } else { 1.0 };
        let absolute = even.hypot(odd) / (tolerance * r0);
        if self.parity && !closing {
            absolute.max(odd / (ODD_TOLERANCE * self.tolerance * odd_size.max(self.odd_floor)))
        } else {
            absolute
        }
    }

    fn accept(&mut self, stepper: &mut Stepper, growth: f64) {
        let (factor, neck_step) =
            if self.fixed.is_some() { (1.0, PUBLISHED_NECK_STEP) } else { (self.factor, NECK_STEP) };
        let dt = self.dt * factor;
        stepper.accept();
        self.tangent.iter_mut().for_each(|tangent| tangent.follow(stepper));
        self.steps += 1;
        self.dt *= growth;
        let (y, gauss) = (&stepper.history[0].y, &stepper.system.gauss);
        let mut area = 0.0;
        for (k, interval) in y.mesh.windows(2).enumerate() {
            for (j, b) in gauss.b.iter().enumerate() {
                let s = y.stage(k, j);
                area += (interval[1] - interval[0]) * b * s[R] * s[R] * sin_cos(s[PSI]).0;
            }
        }
        let volume = std::f64::consts::PI * y.scalars[LENGTH] * area;
        self.drift = self.drift.max((volume / stepper.cortex.constants().volume - 1.0).abs());
        let neck = observables::neck(gauss, y);
        if let (Some(new), Some(old)) = (neck, self.neck) {
            self.neck_rate = (old.radius - new.radius) / dt;
            if self.neck_rate > 0.0 {
                self.dt = self.dt.min(neck_step * new.radius / self.neck_rate);
            }
        }
        self.neck = neck;
        self.parity &= stepper.history[0].size.is_some_and(|size| size.odd < 0.05 * size.even);
        if self.closes(stepper.cortex.cell.r0) {
            stepper.nearly_symmetric = NEARLY_SYMMETRIC_CLOSING;
            // The closing neck needs no mesh refined for a saddle.
            stepper.halvings = 0;
        }
    }

    /// At a saddle: waits until the shape leaves it or, if this would take too long, skips the wait.
    fn wait_at_saddle(&mut self, stepper: &mut Stepper, rest: &Rest) {
        let (growth, t) = (rest.growth_rate, stepper.history[0].t);
        self.detector.next = t + (SADDLE_WAIT / growth).max(REST_INTERVAL);
        self.saddle_visits += 1;
        if growth < NEAR_CRITICAL || self.saddle_visits > MOST_VISITS {
            stepper.halvings = stepper.halvings.max(rest.halvings);
        }
        if self.detector.next > self.longest && self.slow_growth_rate.is_none() {
            self.skip_linear_growth(stepper, rest);
        }
        // It may come to rest at a slightly asymmetric shape, as slowly as it leaves the saddle.
        self.t_max = self.t_max.max(stepper.history[0].t + AFTERWARDS / growth);
    }

    fn skip_linear_growth(&mut self, stepper: &mut Stepper, rest: &Rest) {
        let growth = rest.growth_rate;
        self.slow_growth_rate = Some(growth);
        // Without the direction the division continues unchanged.
        let Ok(departure) = saddle::leave(&stepper.cortex, &rest.here, &rest.stationary, growth) else { return };
        let t = stepper.history[0].t + departure.waited;
        stepper.restart();
        stepper.history[0] = HistoryPoint { t, y: departure.shape, size: None };
        self.dt = STEP_AFTER_SADDLE.min(0.01 / growth);
        self.step_size = StepSize::default();
        self.parity = stepper.cortex.cell.is_mirror_symmetric();
        self.detector.next = t + SADDLE_WAIT / growth;
    }

    fn division(&self, stepper: &Stepper, ending: Ending) -> Division {
        Division {
            ending,
            t_end: stepper.history[0].t,
            slow_growth_rate: self.slow_growth_rate,
            neck_offset: None,
            second_neck: None,
            phi: phi_at(stepper, 0, 0.5),
            volume_drift: self.drift,
            work: Work { steps: self.steps, rejected: self.rejected, ..stepper.work },
        }
    }

    fn arrested(&self, stepper: &Stepper, growth_rate: Option<f64>) -> Division {
        self.division(stepper, Ending::Arrested { growth_rate })
    }

    fn divided(&self, stepper: &Stepper, neck: Neck, symmetric_below: f64) -> Division {
        let (y, r0) = (&stepper.history[0].y, stepper.cortex.cell.r0);
        let chi_signed = observables::asymmetry(&stepper.system.gauss, y, neck.u);
        let symmetric = chi_signed.abs() < symmetric_below;
        // The neck passed the threshold within the last step.
        let past = (PINCH_OFF * r0 - neck.radius) / self.neck_rate;
        let dt = stepper.history[0].t - stepper.history[1].t;
        let ending = Ending::Divided { symmetric, chi_signed, u_furrow: neck.u, daughters: [0.0; 2] };
        let past = past.clamp(0.0, dt);
        let t_end = stepper.history[0].t - past;
        let phi = phi_at(stepper, 0, neck.u).zip(phi_at(stepper, 1, neck.u));
        let phi = phi.map(|(now, before)| now + past / dt * (before - now));
        let second_neck = observables::second_neck(&stepper.system.gauss, y, neck, r0);
        Division { t_end, phi, second_neck, ..self.division(stepper, ending) }.with_daughters_of(r0)
    }
}
