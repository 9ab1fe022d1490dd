//! Curves, over R0 or ε, of the thresholds of bent states and of the pitchforks and folds at which they end, and the critical
//! radius.

use furrow_bvp::{Bracket, Work};
use furrow_cell::{Cell, Numerics, Parameter};
use furrow_mechanics::critical::{BoundaryKind, CriticalRadius, Method};
use furrow_mechanics::equilibria::at_rest::{Edge, RestShapes};
use furrow_mechanics::equilibria::curves::{Curve, CurveEnd, CurvePoint};
use furrow_mechanics::equilibria::error::CellName;
use furrow_mechanics::equilibria::{ShapeError, StepBudget};

use crate::bent::{Bent, BentError, BentEvent, NormalForm, can_follow, events};
use crate::division::divide;

/// Number of steps over a range if every step succeeds.
const STEPS: f64 = 12.0;
/// Shortest step, relative to the first.
const SHORTEST: f64 = 1e-2;
/// Starting radii of the search for the critical radius, in order.
const STARTS: [f64; 3] = [1.4, 2.2, 0.9];
/// Largest relative change of R0 in a step of that search.
const LARGEST: f64 = 0.12;
/// Relative accuracy of the critical radius.
const CLOSE: f64 = 1e-7;
/// Largest number of steps of a search for the critical radius from one start, or for a change of criticality.
const SEARCH: usize = 30;
/// Accuracy of a change of criticality, relative to the distance between the two values that bracket it.
const CRITICALITY: f64 = 1e-4;

/// Critical radii of cells without axial symmetry, at which the stable bent states end at the cell's activity.
pub const WITHOUT_AXIS: Method = Method {
    name: "without axial symmetry 1",
    applies: can_follow,
    radius: critical_radius,
    divide: |input, _| divide(input, &mut |_, _| ()).map(|found| found.division),
    refined: |numerics| Numerics { modes: numerics.modes + 2, ..*numerics },
};

/// The activities up to `xi_max` at which a cell comes to rest, straight or bent. They extend to the first event of the bent states.
///
/// # Errors
/// [`ShapeError`].
pub fn resting_bent(cell: &Cell, numerics: &Numerics, xi_max: f64) -> Result<RestShapes, ShapeError> {
    let found = match events(cell, numerics, false) {
        Ok(found) => found,
        // The straight states are stable up to the end of the range.
        Err(BentError::Shape(ShapeError::NoGrowth { xi_s, .. })) if xi_s >= xi_max => Vec::new(),
        Err(error) => return Err(error.of(cell)),
    };
    let edge = |(event, bent): &(BentEvent, Bent)| match event {
        BentEvent::Pitchfork => Edge::BentPitchfork { xi_s: bent.cell.xi_s },
        BentEvent::Fold => Edge::BentFold { xi_s: bent.cell.xi_s },
    };
    let edges: Vec<Edge> = found.iter().map(edge).collect();
    let end = edges.iter().map(Edge::xi_s).fold(xi_max, f64::min);
    Ok(RestShapes {
        intervals: vec![[0.0, end]],
        edges: edges.into_iter().filter(|edge| edge.xi_s() <= xi_max).collect(),
    })
}

/// A located event.
#[derive(Clone, Debug)]
struct Located {
    event: BentEvent,
    bent: Bent,
    /// Derivative of its bend with respect to the parameter.
    drift: f64,
}

impl Located {
    /// The event at another value of a parameter.
    fn moved(&self, parameter: Parameter, value: f64, work: &mut Work) -> Result<Located, BentError> {
        let step = value - parameter.get(&self.bent.cell);
        let mut bent = self.bent.clone();
        bent.set(parameter, value);
        bent.advance(self.bent.bend() + self.drift * step, work)?;
        let bent = self.event.near(&bent, work)?;
        let drift = (bent.bend() - self.bent.bend()) / step;
        Ok(Located { event: self.event, bent, drift })
    }

    /// The point of the curve, with its slope if known.
    fn point(&self, parameter: Parameter, slope: f64) -> CurvePoint {
        let cell = &self.bent.cell;
        let (value, elongation) = (parameter.get(cell), self.bent.elongation());
        let Cell { r0, epsilon, xi_s, .. } = *cell;
        CurvePoint { r0, epsilon, value, xi_s, slope, elongation, coefficient: None }
    }
}

/// The curves over R0 or ε at which bent states become unstable to disturbances that break the mirror symmetry, and of their folds.
///
/// # Errors
/// [`ShapeError`] at the first value; if the continuation fails later, the curve ends there.
pub fn curves(
    cell: &Cell,
    numerics: &Numerics,
    parameter: Parameter,
    [from, to]: [f64; 2],
) -> Result<Vec<(BentEvent, Curve)>, ShapeError> {
    let mut first = cell.clone();
    parameter.set(&mut first, from);
    let found = events(&first, numerics, false).map_err(|error| error.of(&first))?;
    let along = |(event, bent)| {
        let mut curve = Curve::default();
        let mut work = Work::default();
        if let Err(error) = follow(Located { event, bent, drift: 0.0 }, parameter, [from, to], &mut curve, &mut work) {
            curve.ended = CurveEnd::Stopped(error.of(&first));
        }
        curve.iterations = work.iterations;
        (event, curve)
    };
    Ok(found.into_iter().map(along).collect())
}

fn follow(
    mut at: Located,
    parameter: Parameter,
    [from, to]: [f64; 2],
    curve: &mut Curve,
    work: &mut Work,
) -> Result<(), BentError> {
    let whole = (to - from) / STEPS;
    let mut step = whole;
    let mut value = from;
    curve.points.push(at.point(parameter, 0.0));
    while (to - value) * whole.signum() > 1e-9 * whole.abs() {
        let next = if (to - value).abs() < 1.5 * step.abs() { to } else { value + step };
        match at.moved(parameter, next, work) {
            Ok(there) => {
                let slope = (there.bent.cell.xi_s - at.bent.cell.xi_s) / (next - value);
                curve.points.push(there.point(parameter, slope));
                (at, value, step) = (there, next, (1.5 * step.abs()).min(whole.abs()).copysign(whole));
            }
            Err(lost) => {
                step = 0.5 * (next - value);
                if step.abs() < SHORTEST * whole.abs() {
                    return Err(lost);
                }
            }
        }
    }
    if let [first, second, ..] = curve.points.as_mut_slice() {
        first.slope = second.slope;
    }
    Ok(())
}

/// The threshold of bent states at a value of R0 or ε, with the coefficient of the normal form; its slope is unknown.
///
/// # Errors
/// [`ShapeError`].
pub fn threshold(cell: &Cell, numerics: &Numerics, parameter: Parameter, value: f64) -> Result<CurvePoint, ShapeError> {
    let mut cell = cell.clone();
    parameter.set(&mut cell, value);
    let found = NormalForm::of(&cell, numerics).map_err(|error| error.of(&cell))?;
    let Cell { r0, epsilon, .. } = cell;
    let NormalForm { xi_s, coefficient, elongation } = found;
    Ok(CurvePoint { r0, epsilon, value, xi_s, slope: f64::NAN, elongation, coefficient: Some(coefficient) })
}

/// The curve through thresholds in the order of their values, and the points where their coefficient changes its sign; `at` computes
/// the threshold at another value. Also returns the reasons why values are missing.
pub fn threshold_curve(
    found: Vec<Result<CurvePoint, ShapeError>>,
    at: impl Fn(f64) -> Result<CurvePoint, ShapeError>,
) -> (Curve, Vec<ShapeError>) {
    let (mut curve, mut missing) = (Curve::default(), Vec::new());
    let mut last: Option<CurvePoint> = None;
    for point in found {
        match point {
            Ok(mut point) => {
                if let Some(last) = last {
                    point.slope = (point.xi_s - last.xi_s) / (point.value - last.value);
                    match change_of_criticality([last, point], &at) {
                        Ok(found) => curve.degenerate.extend(found),
                        Err(error) => missing.push(error),
                    }
                }
                curve.points.push(point);
                last = Some(point);
            }
            Err(error) => {
                missing.push(error);
                last = None;
            }
        }
    }
    (curve, missing)
}

/// The zero of the coefficient between two points of a curve, by the Illinois method. `None` if the sign does not change, or if it
/// changes through infinity.
fn change_of_criticality(
    points: [CurvePoint; 2],
    at: &impl Fn(f64) -> Result<CurvePoint, ShapeError>,
) -> Result<Option<CurvePoint>, ShapeError> {
    let of = |point: &CurvePoint| point.coefficient.unwrap_or(f64::NAN);
    let ends = points.each_ref().map(|point| [point.value, of(point)]);
    if ends[0][1] * ends[1][1] >= 0.0 {
        return Ok(None);
    }
    let smaller = ends[0][1].abs().min(ends[1][1].abs());
    let accuracy = CRITICALITY * (ends[1][0] - ends[0][0]).abs();
    let (mut bracket, mut last) = (Bracket::new(ends), ends[0][0]);
    for _ in 0..SEARCH {
        let next = at(bracket.secant())?;
        let value = of(&next);
        if value == 0.0 || (next.value - last).abs() < accuracy {
            return Ok((value.abs() < smaller).then_some(next));
        }
        last = next.value;
        bracket.keep([next.value, value]);
    }
    Ok(None)
}

/// The radius below which cells with the parameters of `cell`, except its radius, come to rest bent.
///
/// # Errors
/// [`ShapeError`] if there is no such radius.
pub fn critical_radius(
    cell: &Cell,
    numerics: &Numerics,
    budget: &StepBudget<'_>,
) -> Result<CriticalRadius, ShapeError> {
    let mut last = None;
    for r0 in STARTS {
        budget.check(cell)?;
        let start = Cell { r0, ..cell.clone() };
        match critical_from(&start, numerics, budget) {
            Ok(found) => return Ok(found),
            Err(error @ ShapeError::Interrupted) => return Err(error),
            Err(error) => last = Some(error),
        }
    }
    Err(last.unwrap_or(ShapeError::Interrupted))
}

fn critical_from(cell: &Cell, numerics: &Numerics, budget: &StepBudget<'_>) -> Result<CriticalRadius, ShapeError> {
    let wrong = |error: BentError| error.of(cell);
    let mut work = Work::default();
    let first = events(cell, numerics, true).map_err(wrong)?.into_iter().next();
    let (event, bent) = first.ok_or(BentError::Unbounded).map_err(wrong)?;
    let mut at = Located { event, bent, drift: 0.0 };
    // ξ_s decreases approximately as 1/R0.
    let mut slope = -at.bent.cell.xi_s / cell.r0;
    let mut largest = LARGEST;
    for _ in 0..SEARCH {
        budget.check(cell)?;
        let (r0, xi_s) = (at.bent.cell.r0, at.bent.cell.xi_s);
        let step = ((cell.xi_s - xi_s) / slope).clamp(-largest * r0, largest * r0);
        if step.abs() < CLOSE * r0 {
            let kind = match event {
                BentEvent::Pitchfork => BoundaryKind::BentPitchfork,
                BentEvent::Fold => BoundaryKind::BentFold,
            };
            return Ok(CriticalRadius { cue: cell.cue.clone(), kind, r0: r0 + step, slope });
        }
        match at.moved(Parameter::R0, r0 + step, &mut work) {
            Ok(there) => at = there,
            Err(lost) if largest < SHORTEST * LARGEST => return Err(wrong(lost)),
            Err(_) => {
                largest *= 0.5;
                continue;
            }
        }
        slope = (at.bent.cell.xi_s - xi_s) / step;
    }
    Err(BentError::NotLocated { bend: at.bent.bend() }.of(&at.bent.cell))
}

impl BentError {
    /// The corresponding error of stationary shapes.
    pub fn of(self, cell: &Cell) -> ShapeError {
        match self {
            BentError::Shape(error) => error,
            other => ShapeError::Bent { cell: CellName::of(cell), reason: other.to_string() },
        }
    }
}
