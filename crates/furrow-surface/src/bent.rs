//! Branches of bent states at rest, which leave the axisymmetric branch where a disturbance m = 1 begins to grow.
//!
//! A bent state is mirror-symmetric, in u → 1 − u too. The branch is followed by its bend, the distance of the middle ring from the
//! axis over R0, which goes on to grow where the activity turns back at a fold: with J the derivatives of the balances,
//! J x′ + ∂_ξF ξ′ = 0 and bend(x′) = 1. Disturbances that break the mirror symmetry begin to grow at the odd pitchfork.

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

/// A bent state at rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BentPoint {
    /// Activity ξ_s at which it rests, in κ0/L_h.
    pub xi_s: f64,
    /// Distance of the middle ring from the axis, relative to R0.
    pub bend: f64,
    /// dξ_s/d bend along the branch: negative beyond the fold.
    pub slope: f64,
    /// Largest growth rate of disturbances that keep the mirror symmetry, in 1/τ.
    pub even: f64,
    /// The same of those that break it.
    pub odd: f64,
    /// Length of the mean meridian, in L_h.
    pub length: f64,
    /// Pressure, in κ0/L_h³.
    pub pressure: f64,
    /// Distance of the poles over R0.
    pub elongation: f64,
    /// Length over 2π of the middle ring, in L_h.
    pub equator_radius: f64,
    /// Radius of the neck over R0, if there is a waist.
    pub neck: Option<f64>,
    /// Distance of the neck's centre from the axis, in L_h.
    pub neck_offset: Option<f64>,
}

impl BentPoint {
    /// The observables of axisymmetric shapes, with the bend in place of the arclength.
    pub fn shape(&self) -> ShapePoint {
        ShapePoint {
            xi_s: self.xi_s,
            elongation: self.elongation,
            length: self.length,
            pressure: self.pressure,
            equator_radius: self.equator_radius,
            arclength: self.bend,
            growth_rate: Some(self.even.max(self.odd)),
            // Not computed.
            reduced_volume: f64::NAN,
            bending_energy: f64::NAN,
            ..ShapePoint::default()
        }
    }
}

/// The branch near the threshold: ξ_s = ξ₁ + c bend².
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NormalForm {
    /// Threshold ξ₁ of disturbances m = 1.
    pub xi_s: f64,
    /// c, in κ0/L_h: bent states lie above the threshold, and are stable there, if it is positive.
    pub coefficient: f64,
    /// Distance of the poles over R0 at the threshold.
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
    /// States, from the threshold on.
    pub points: Vec<BentPoint>,
    /// Work of the states.
    pub work: Work,
    /// Where disturbances that break the mirror symmetry begin to grow.
    pub pitchfork: Option<BentPoint>,
    /// Where the activity is largest.
    pub fold: Option<BentPoint>,
    /// Why it ends.
    pub ended: BranchEnd,
}

impl BentBranch {
    /// The branch by the observables of axisymmetric shapes, without contours and events.
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

/// Why bent states were not found.
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
    /// Surfaces have the paper's law alone.
    #[error("bent states have equations for the paper's law alone, not for {law:?}")]
    OwnLaw {
        /// The law's name.
        law: String,
    },
    /// A pitchfork or fold.
    #[error("the end of the stable bent states near a bend of {bend:.4} R0 is not located")]
    NotLocated {
        /// Bend of the last state that was tried.
        bend: f64,
    },
    /// The bent branch begins towards smaller activities.
    #[error("bent states begin subcritically, at xi_s = {xi_s:.4}: none is stable there")]
    Subcritical {
        /// Activity of the first state that was computed.
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
    /// The bent states stay stable.
    #[error("the bent states are stable to the largest bend that is followed")]
    Unbounded,
    /// Disturbances m = 1 of the axisymmetric branch.
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

/// Bend, beside its half, from which the normal form follows.
const SMALL: f64 = 0.02;
/// Longest step in bend.
const STEP: f64 = 0.02;
/// Shortest step in bend.
const SHORTEST: f64 = 1e-4;
/// Largest bend.
const LARGEST: f64 = 0.6;
/// Bend beyond the fold to which states are followed.
const BEYOND: f64 = 0.06;
/// Accuracy of points in bend.
const CLOSE: f64 = 1e-7;
/// Iterations that bring out the disturbance at the threshold.
const INVERSE_ITERATIONS: usize = 6;
/// Most steps of the search for a point.
const SEARCH: usize = 30;
/// Distance in bend of two states from which an event near them is found.
const NEAR: f64 = 2e-3;
/// Most iterations of Newton's method.
const ITERATIONS: usize = 14;
/// Largest change of a coefficient, relative to R0, at which they end.
const TOLERANCE: f64 = 1e-7;

/// A bent state and the tangent of the branch, from which the next state follows.
#[derive(Clone, Debug)]
pub(crate) struct Bent {
    pub(crate) cell: Cell,
    problem: Problem,
    state: State,
    /// Derivatives by the bend: surface, flow and pressure by unknown, and dξ_s/d bend.
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

    /// The disturbance m = 1 with bend 1 that neither grows nor decays at the threshold, by inverse iteration.
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

    /// The residual, and its derivative by ξ_s, in which it is linear.
    fn residuals(&mut self) -> (Residual, Vec<f64>) {
        let (xi_s, here) = (self.cell.xi_s, self.problem.residual(&self.state));
        self.set(Parameter::XiS, xi_s + 1.0);
        let there = self.problem.residual(&self.state);
        self.set(Parameter::XiS, xi_s);
        let gained = there.balances.iter().zip(&here.balances).map(|(there, here)| there - here).collect();
        (here, gained)
    }

    /// Goes on to the state with this bend, which is near.
    pub(crate) fn advance(&mut self, bend: f64, work: &mut Work) -> Result<(), BentError> {
        self.solved(bend, work).map_err(|reason| BentError::Lost { bend, reason })
    }

    /// The state a step further, which is halved until it succeeds.
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
        // The mesh keeps to the predicted surface: weights that changed in every iteration would slow it down.
        self.problem.spread(&self.state.surface);
        // At the pitchfork a disturbance that breaks the mirror symmetry solves the linear equations too.
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
            neck: neck.map(|neck| neck.radius / self.cell.r0),
            neck_offset: neck.map(|neck| neck.offset.abs()),
        })
    }
}

/// What may end the stable bent states.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BentEvent {
    /// Disturbances that break the mirror symmetry begin to grow.
    Pitchfork,
    /// The activity is largest.
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

    /// A value that vanishes at the event and is positive before it.
    fn before(self, bent: &Bent) -> Result<f64, RatesError> {
        match self {
            BentEvent::Pitchfork => Ok(-bent.rate(Among::Odd)?),
            BentEvent::Fold => Ok(bent.slope),
        }
    }

    /// The event between two states with these values.
    fn between(self, [from, to]: [&Bent; 2], values: [f64; 2], work: &mut Work) -> Result<Option<Bent>, BentError> {
        let passed = values[0] > 0.0 && values[1] <= 0.0;
        passed.then(|| self.secant(from, [from.bend(), to.bend()], values, work)).transpose()
    }

    /// The event close to a state.
    pub(crate) fn near(self, bent: &Bent, work: &mut Work) -> Result<Bent, BentError> {
        let mut there = bent.clone();
        there.advance(bent.bend() + NEAR, work)?;
        let values = [self.before(bent)?, self.before(&there)?];
        self.secant(&there, [bent.bend(), there.bend()], values, work)
    }

    /// The event, by the secant through two bends.
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

/// The events of the bent states of a cell in order, up to the fold; `only_first` ends at the first.
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
