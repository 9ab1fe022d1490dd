//! Branches of bent stationary states, which bifurcate from the axisymmetric branch where the disturbance m = 1 becomes unstable.
//!
//! A bent state is mirror-symmetric, also under u → 1 − u. The branch is parametrised by its bend, the distance of the middle ring
//! from the axis divided by R0, which increases beyond the fold at which the activity turns back: with J the derivatives of the
//! balances, J x′ + ∂_ξF ξ′ = 0 and bend(x′) = 1. Disturbances that break the mirror symmetry become unstable at the odd pitchfork.

use furrow_bvp::{Gauss, Work};
use furrow_cell::{Cell, Cue, Numerics, Parameter};
use furrow_mechanics::cortex::Domain;
use furrow_mechanics::cortex::equations::{COMPONENTS, Constants, PRESSURE, PSI, R, V, Z};
use furrow_mechanics::cortex::symmetry::unfold;
use furrow_mechanics::equilibria::azimuthal_scan::AzimuthalScan;
use furrow_mechanics::equilibria::{Branch, BranchEnd, ShapeError, ShapePoint, azimuthal_threshold};
use ordered_float::OrderedFloat;

use crate::division::AtRest;
use crate::embed::{ContourPoint, embed};
use crate::linear::{Border, Singular};
use crate::neck::neck;
use crate::newton::NewtonError;
use crate::problem::{Problem, Residual, State};
use crate::rates::{Among, RatesError};
use crate::space::Space;

/// A bent stationary state.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BentPoint {
    /// Activity ξ_s of the state, in κ0/L_h.
    pub xi_s: f64,
    /// Distance of the middle ring from the axis, relative to R0.
    pub bend: f64,
    /// dξ_s/d bend along the branch: negative beyond the fold.
    pub slope: f64,
    /// Largest growth rate of disturbances that preserve the mirror symmetry, in 1/τ.
    pub even: f64,
    /// Largest growth rate of disturbances that break the mirror symmetry, in 1/τ.
    pub odd: f64,
    /// Length of the mean meridian, in L_h.
    pub length: f64,
    /// Pressure, in κ0/L_h³.
    pub pressure: f64,
    /// Distance of the poles over R0.
    pub elongation: f64,
    /// Length of the middle ring divided by 2π, in L_h.
    pub equator_radius: f64,
    /// Volume divided by the volume of a sphere with the same area.
    pub reduced_volume: f64,
    /// Energy of bending, in κ0.
    pub bending_energy: f64,
    /// Radius of the neck divided by R0, if there is a waist.
    pub neck: Option<f64>,
    /// Distance of the neck's centre from the axis, in L_h.
    pub neck_offset: Option<f64>,
}

impl BentPoint {
    /// The observables of axisymmetric shapes, with the bend instead of the arclength.
    pub fn shape(&self) -> ShapePoint {
        ShapePoint {
            xi_s: self.xi_s,
            elongation: self.elongation,
            length: self.length,
            pressure: self.pressure,
            equator_radius: self.equator_radius,
            arclength: self.bend,
            growth_rate: Some(self.even.max(self.odd)),
            delta_u: Some(0.0),
            reduced_volume: self.reduced_volume,
            bending_energy: self.bending_energy,
            ..ShapePoint::default()
        }
    }
}

/// The branch near the threshold: ξ_s = ξ₁ + c bend².
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NormalForm {
    /// Threshold ξ₁ of disturbances m = 1.
    pub xi_s: f64,
    /// c, in κ0/L_h: if it is positive, bent states exist above the threshold and are stable there.
    pub coefficient: f64,
    /// Distance of the poles divided by R0 at the threshold.
    pub elongation: f64,
}

impl NormalForm {
    /// The normal form of a cell, from two states near its threshold.
    ///
    /// # Errors
    /// [`BentError`].
    pub fn of(cell: &Cell, numerics: &Numerics) -> Result<NormalForm, BentError> {
        check(cell)?;
        Ok(begin(cell, numerics, &mut Work::default())?.0)
    }
}

/// The bent states of a cell.
///
/// ```no_run
/// use furrow_cell::{Cell, Numerics};
/// use furrow_surface::bent::branch;
///
/// // A few seconds.
/// let found = branch(&Cell::new(1.4), &Numerics { modes: 4, ..Numerics::default() }, 30.0)?;
/// assert!(found.threshold.coefficient > 0.0);
/// # Ok::<(), furrow_surface::bent::BentError>(())
/// ```
#[derive(Clone, Debug)]
pub struct BentBranch {
    /// The threshold.
    pub threshold: NormalForm,
    /// States along the branch, starting at the threshold.
    pub points: Vec<BentPoint>,
    /// Work for the states.
    pub work: Work,
    /// The state at which disturbances that break the mirror symmetry become unstable.
    pub pitchfork: Option<BentPoint>,
    /// The state of largest activity.
    pub fold: Option<BentPoint>,
    /// The reason why it ends.
    pub ended: BranchEnd,
}

impl BentBranch {
    /// The branch in terms of the observables of axisymmetric shapes, without contours and events.
    pub fn shapes(&self) -> Branch {
        Branch {
            points: self.points.iter().map(BentPoint::shape).collect(),
            contours: Vec::new(),
            azimuthal: AzimuthalScan::new(0),
            events: Vec::new(),
            hopf: Vec::new(),
            ended: self.ended.clone(),
            work: self.work,
        }
    }
}

/// The reason why bent states were not found.
#[derive(Debug, thiserror::Error)]
pub enum BentError {
    /// The cue breaks the mirror symmetry, or needs equations that surfaces do not have.
    #[error(
        "bent states are followed without a cue, or with one that keeps the mirror symmetry u → 1 − u, not with {cue}"
    )]
    NoMirror {
        /// The cue.
        cue: String,
    },
    /// Bent states are implemented only for the paper's law.
    #[error("bent states have equations for the paper's law alone, not for {law:?}")]
    OwnLaw {
        /// The law's name.
        law: String,
    },
    /// A pitchfork or fold.
    #[error("the end of the stable bent states near a bend of {bend:.4} R0 is not located")]
    NotLocated {
        /// Bend of the last state tried.
        bend: f64,
    },
    /// The bent branch bifurcates towards smaller activities.
    #[error("bent states begin subcritically, at xi_s = {xi_s:.4}: none is stable there")]
    Subcritical {
        /// Activity of the first computed state.
        xi_s: f64,
    },
    /// No activity of the range is above the threshold.
    #[error("bent states begin at xi_s = {xi_s:.4}, beyond {xi_max}")]
    Beyond {
        /// Their threshold.
        xi_s: f64,
        /// The largest activity.
        xi_max: f64,
    },
    /// The bent states remain stable.
    #[error("the bent states are stable to the largest bend that is followed")]
    Unbounded,
    /// The disturbances m = 1 of the axisymmetric branch could not be computed.
    #[error(transparent)]
    Shape(#[from] ShapeError),
    /// A bent state.
    #[error("the bent states are followed to a bend of {bend:.4} R0: {reason}")]
    Lost {
        /// Bend of the state.
        bend: f64,
        /// Why.
        reason: NewtonError,
    },
    /// Growth rates.
    #[error(transparent)]
    Rates(#[from] RatesError),
}

/// The bend of one of the two states from which the normal form follows; the other has half of it.
const SMALL: f64 = 0.02;
/// Longest step in bend.
const STEP: f64 = 0.02;
/// Shortest step in bend.
const SHORTEST: f64 = 1e-4;
/// Largest bend.
const LARGEST: f64 = 0.6;
/// Range of bend beyond the fold over which states are followed.
const BEYOND: f64 = 0.06;
/// Accuracy of events in bend.
const CLOSE: f64 = 1e-7;
/// Number of inverse iterations for the disturbance at the threshold.
const INVERSE_ITERATIONS: usize = 6;
/// Largest number of steps of the search for an event.
const SEARCH: usize = 30;
/// Difference in bend of two states from which a nearby event is located.
const NEAR: f64 = 2e-3;
/// Largest number of Newton iterations.
const ITERATIONS: usize = 14;
/// Largest change of a coefficient, relative to R0, at convergence.
const TOLERANCE: f64 = 1e-7;

/// A bent state and the tangent of the branch, which predicts the next state.
#[derive(Clone, Debug)]
pub(crate) struct Bent {
    pub(crate) cell: Cell,
    problem: Problem,
    state: State,
    /// Derivatives with respect to the bend: surface, flow and pressure by unknown, and dξ_s/d bend.
    tangent: Vec<f64>,
    pressure_tangent: f64,
    slope: f64,
}

impl Bent {
    /// The axisymmetric state at the threshold.
    fn at_threshold(cell: &Cell, numerics: &Numerics) -> Result<Bent, BentError> {
        let (cortex, point, shape) = azimuthal_threshold::first(cell, numerics, 1)?;
        let full = match cortex.domain {
            Domain::Half => unfold(&shape),
            Domain::Full => shape,
        };
        let gauss = Gauss::new(numerics.stages).unwrap_or_default();
        let cell = Cell { xi_s: point.xi_s, ..cell.clone() };
        let mut problem = Problem::new(&cell, Space::new(numerics.elements, numerics.modes));
        let shares = problem.mesh.shares(&problem.space);
        let state = embed(&problem.space, &shares, full.scalars[PRESSURE], |u| {
            let mut y = [0.0; COMPONENTS];
            full.eval(&gauss, u, &mut y);
            let (sin, cos) = y[PSI].sin_cos();
            ContourPoint { r: y[R], z: y[Z], v_r: y[V] * cos, v_z: -y[V] * sin }
        });
        problem.spread(&state.surface);
        let mut bent = Bent { cell, problem, state, tangent: Vec::new(), pressure_tangent: 0.0, slope: 0.0 };
        bent.tangent = bent.growing().map_err(RatesError::from)?;
        Ok(bent)
    }

    /// The neutral disturbance m = 1 at the threshold, with bend 1, by inverse iteration.
    fn growing(&self) -> Result<Vec<f64>, Singular> {
        let factored = self.problem.jacobian(&self.state).factor()?;
        let row = self.row();
        let keep = self.problem.projection(Among::Azimuthal(1));
        let mut found = row.clone();
        for _ in 0..INVERSE_ITERATIONS {
            keep(&mut found);
            factored.solve(&mut found, &[0.0]);
            let bend: f64 = found.iter().zip(&row).map(|(x, row)| x * row).sum();
            found.iter_mut().for_each(|x| *x /= bend);
        }
        keep(&mut found);
        Ok(found)
    }

    /// Sets a parameter of the cell. A change of R0 scales the surface.
    pub(crate) fn set(&mut self, parameter: Parameter, value: f64) {
        let before = self.cell.r0;
        parameter.set(&mut self.cell, value);
        self.problem.constants = Constants::new(&self.cell, |_, value| value);
        if parameter == Parameter::R0 {
            let scale = value / before;
            self.state.surface.iter_mut().for_each(|x| *x *= scale);
        }
    }

    /// The bend as a row over the unknowns.
    fn row(&self) -> Vec<f64> {
        let space = &self.problem.space;
        let mut row = vec![0.0; space.unknowns()];
        let station = space.station(0.5);
        for (r, basis) in station.basis.iter().enumerate() {
            let unknown = space.centre()[0].and_then(|centre| space.unknown(station.element + r, 0, centre));
            if let Some(k) = unknown {
                row[k] += basis[0] / self.cell.r0;
            }
        }
        row
    }

    pub(crate) fn bend(&self) -> f64 {
        let space = &self.problem.space;
        let centre =
            space.centre()[0].map(|centre| space.function(&self.state.surface, &space.station(0.5), centre)[0]);
        centre.unwrap_or(0.0) / self.cell.r0
    }

    /// The residual and its derivative with respect to ξ_s, in which it is linear.
    fn residuals(&mut self) -> (Residual, Vec<f64>) {
        let (xi_s, here) = (self.cell.xi_s, self.problem.residual(&self.state));
        self.set(Parameter::XiS, xi_s + 1.0);
        let there = self.problem.residual(&self.state);
        self.set(Parameter::XiS, xi_s);
        let gained = there.balances.iter().zip(&here.balances).map(|(there, here)| there - here).collect();
        (here, gained)
    }

    /// Computes the state with this bend, which must be near.
    pub(crate) fn advance(&mut self, bend: f64, work: &mut Work) -> Result<(), BentError> {
        self.solved(bend, work).map_err(|reason| BentError::Lost { bend, reason })
    }

    /// The next state; the step is halved until it succeeds.
    fn onward(&self, step: &mut f64, work: &mut Work) -> Result<Bent, BentError> {
        loop {
            let mut next = self.clone();
            match next.advance(self.bend() + *step, work) {
                Ok(()) => return Ok(next),
                Err(lost) if 0.5 * *step <= SHORTEST => return Err(lost),
                Err(_) => *step *= 0.5,
            }
        }
    }

    fn solved(&mut self, bend: f64, work: &mut Work) -> Result<(), NewtonError> {
        let step = bend - self.bend();
        let change: Vec<f64> = self.tangent.iter().map(|t| t * step).collect();
        self.problem.change(&mut self.state, &change, self.pressure_tangent * step);
        self.set(Parameter::XiS, self.cell.xi_s + self.slope * step);
        // The mesh weights come from the predicted surface, because weights that change in every iteration would slow convergence.
        self.problem.spread(&self.state.surface);
        // At the pitchfork a disturbance that breaks the mirror symmetry also solves the linear equations.
        let even = self.problem.projection(Among::Even);
        let mut changed = f64::INFINITY;
        for iteration in 1..=ITERATIONS {
            let (Residual { mut balances, volume }, column) = self.residuals();
            let mut jacobian = self.problem.jacobian(&self.state);
            jacobian.borders.push(Border { column, row: self.row() });
            let factored = jacobian.factor()?;
            work.factorisations += 1;
            work.iterations += 1;
            balances.iter_mut().for_each(|b| *b = -*b);
            let border = factored.solve(&mut balances, &[-volume, bend - self.bend()]);
            even(&mut balances);
            changed = self.problem.change(&mut self.state, &balances, border[0]) / self.cell.r0;
            if !changed.is_finite() || changed > 1.0 {
                return Err(NewtonError::NotConverged { change: changed, iterations: iteration });
            }
            self.set(Parameter::XiS, self.cell.xi_s + border[1]);
            if changed < TOLERANCE {
                let mut tangent = vec![0.0; self.tangent.len()];
                let border = factored.solve(&mut tangent, &[0.0, 1.0]);
                even(&mut tangent);
                (self.tangent, self.pressure_tangent, self.slope) = (tangent, border[0], border[1]);
                return Ok(());
            }
        }
        Err(NewtonError::NotConverged { change: changed, iterations: ITERATIONS })
    }

    fn rate(&self, among: Among) -> Result<f64, RatesError> {
        Ok(self.problem.rates(&self.state, 3, among)?.first().map_or(f64::NEG_INFINITY, |rate| rate.re))
    }

    fn at_rest(&self) -> AtRest {
        AtRest { problem: self.problem.clone(), state: self.state.clone(), rates: Vec::new() }
    }

    /// Distance of the poles over R0.
    pub(crate) fn elongation(&self) -> f64 {
        self.at_rest().elongation()
    }

    fn point(&self) -> Result<BentPoint, RatesError> {
        let rest = self.at_rest();
        let neck = neck(&self.problem.space, &self.state.surface);
        let [reduced_volume, bending_energy] = rest.reduced_volume_and_bending();
        Ok(BentPoint {
            xi_s: self.cell.xi_s,
            bend: self.bend(),
            slope: self.slope,
            even: self.rate(Among::Even)?,
            odd: self.rate(Among::Odd)?,
            length: rest.length(),
            pressure: self.state.pressure,
            elongation: rest.elongation(),
            equator_radius: rest.equator_radius(),
            reduced_volume,
            bending_energy,
            neck: neck.map(|neck| neck.radius / self.cell.r0),
            neck_offset: neck.map(|neck| neck.offset.abs()),
        })
    }
}

/// The events that may end the stable bent states.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BentEvent {
    /// Disturbances that break the mirror symmetry become unstable.
    Pitchfork,
    /// The activity has its maximum.
    Fold,
}

impl BentEvent {
    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            BentEvent::Pitchfork => "pitchfork",
            BentEvent::Fold => "fold",
        }
    }

    /// A test function that vanishes at the event and is positive before it.
    fn before(self, bent: &Bent) -> Result<f64, RatesError> {
        match self {
            BentEvent::Pitchfork => Ok(-bent.rate(Among::Odd)?),
            BentEvent::Fold => Ok(bent.slope),
        }
    }

    /// The event between two states with these test values.
    fn between(self, [from, to]: [&Bent; 2], values: [f64; 2], work: &mut Work) -> Result<Option<Bent>, BentError> {
        let passed = values[0] > 0.0 && values[1] <= 0.0;
        passed.then(|| self.secant(from, [from.bend(), to.bend()], values, work)).transpose()
    }

    /// The event near a state.
    pub(crate) fn near(self, bent: &Bent, work: &mut Work) -> Result<Bent, BentError> {
        let mut there = bent.clone();
        there.advance(bent.bend() + NEAR, work)?;
        let values = [self.before(bent)?, self.before(&there)?];
        self.secant(&there, [bent.bend(), there.bend()], values, work)
    }

    /// The event, by the secant method from two bends.
    fn secant(
        self,
        from: &Bent,
        [mut last, mut bend]: [f64; 2],
        [mut before, mut value]: [f64; 2],
        work: &mut Work,
    ) -> Result<Bent, BentError> {
        let mut bent = from.clone();
        for _ in 0..SEARCH {
            let next = bend - ((bend - last) * value / (value - before)).clamp(-STEP, STEP);
            bent.advance(next, work)?;
            (last, before, bend, value) = (bend, value, next, self.before(&bent)?);
            if value == 0.0 || (bend - last).abs() < CLOSE {
                return Ok(bent);
            }
        }
        Err(BentError::NotLocated { bend })
    }
}

/// The bent states of a cell without a cue that breaks the mirror symmetry, from the threshold up to `xi_max` and beyond the fold.
///
/// # Errors
/// [`BentError`]; a branch that is lost beyond its fold ends there.
pub fn branch(cell: &Cell, numerics: &Numerics, xi_max: f64) -> Result<BentBranch, BentError> {
    check(cell)?;
    let mut work = Work::default();
    let (threshold, [near, mut bent]) = begin(cell, numerics, &mut work)?;
    if threshold.xi_s.max(near.cell.xi_s) > xi_max {
        return Err(BentError::Beyond { xi_s: threshold.xi_s, xi_max });
    }
    let mut before = bent.point()?;
    let points = vec![near.point()?, before];
    let mut found = BentBranch { threshold, points, work, pitchfork: None, fold: None, ended: BranchEnd::Enough };
    let mut step = STEP;
    while bent.bend() < LARGEST && bent.cell.xi_s <= xi_max {
        let next = match bent.onward(&mut step, &mut found.work) {
            Ok(next) => next,
            Err(_) if found.fold.is_some() => break,
            Err(lost) => return Err(lost),
        };
        let now = next.point()?;
        let pair = [&bent, &next];
        if found.pitchfork.is_none() {
            let at = BentEvent::Pitchfork.between(pair, [-before.odd, -now.odd], &mut found.work)?;
            found.pitchfork = at.map(|bent| bent.point()).transpose()?;
        }
        if found.fold.is_none() {
            let at = BentEvent::Fold.between(pair, [before.slope, now.slope], &mut found.work)?;
            found.fold = at.map(|bent| bent.point()).transpose()?;
        }
        found.points.push(now);
        found.work.steps += 1;
        if found.fold.is_some_and(|fold| now.bend > fold.bend + BEYOND) {
            found.ended = BranchEnd::PassedFold;
            break;
        }
        (bent, before, step) = (next, now, (1.5 * step).min(STEP));
    }
    if before.xi_s > xi_max {
        found.points.retain(|point| point.xi_s <= xi_max);
        found.ended = BranchEnd::Bound(xi_max);
    }
    Ok(found)
}

/// The events of the bent states of a cell in order, up to the fold; with `only_first` only the first.
///
/// # Errors
/// [`BentError`]; [`BentError::Subcritical`] if no bent state is stable, [`BentError::Unbounded`] if there is no event.
pub(crate) fn events(cell: &Cell, numerics: &Numerics, only_first: bool) -> Result<Vec<(BentEvent, Bent)>, BentError> {
    check(cell)?;
    let (mut work, mut bent) = (Work::default(), Bent::at_threshold(cell, numerics)?);
    bent.advance(SMALL, &mut work)?;
    let all = [BentEvent::Pitchfork, BentEvent::Fold];
    let values = |bent: &Bent| -> Result<[f64; 2], RatesError> { Ok([all[0].before(bent)?, all[1].before(bent)?]) };
    let mut before = values(&bent)?;
    if before[1] <= 0.0 {
        return Err(BentError::Subcritical { xi_s: bent.cell.xi_s });
    }
    let mut found: Vec<(BentEvent, Bent)> = Vec::new();
    let mut step = 2.0 * STEP;
    while bent.bend() < LARGEST && before[1] > 0.0 && (found.is_empty() || !only_first) {
        let next = bent.onward(&mut step, &mut work)?;
        let now = values(&next)?;
        for (k, event) in all.into_iter().enumerate() {
            let at = event.between([&bent, &next], [before[k], now[k]], &mut work)?;
            found.extend(at.map(|at| (event, at)));
        }
        (bent, before) = (next, now);
    }
    found.sort_by_cached_key(|(_, state)| OrderedFloat(state.bend()));
    found.truncate(if only_first { 1 } else { 2 });
    if found.is_empty() { Err(BentError::Unbounded) } else { Ok(found) }
}

/// Whether bent states of cells with a cue can be followed.
pub(crate) fn can_follow(cue: &Cue) -> bool {
    cue.is_mirror_symmetric() && cue.regulator().is_none() && !cue.is_one_sided()
}

fn check(cell: &Cell) -> Result<(), BentError> {
    if let Some(law) = &cell.law {
        return Err(BentError::OwnLaw { law: law.name().to_owned() });
    }
    match can_follow(&cell.cue) {
        true => Ok(()),
        false => Err(BentError::NoMirror { cue: cell.cue.to_string() }),
    }
}

/// The normal form, from ξ_s = ξ₁ + c bend² + d bend⁴ with the slopes of two states, and these states.
fn begin(cell: &Cell, numerics: &Numerics, work: &mut Work) -> Result<(NormalForm, [Bent; 2]), BentError> {
    let mut far = Bent::at_threshold(cell, numerics)?;
    let elongation = far.elongation();
    far.advance(0.5 * SMALL, work)?;
    let near = far.clone();
    far.advance(SMALL, work)?;
    let [b, b_far] = [near.bend(), far.bend()];
    let [s, s_far] = [near.slope / b, far.slope / b_far];
    let d = (s_far - s) / (4.0 * (b_far * b_far - b * b));
    let coefficient = 0.5 * s - 2.0 * d * b * b;
    let xi_s = near.cell.xi_s - (coefficient + d * b * b) * b * b;
    Ok((NormalForm { xi_s, coefficient, elongation }, [near, far]))
}
