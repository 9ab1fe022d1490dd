//! The activity above which perturbations of one azimuthal number grow, as a curve over a parameter.
//!
//! The threshold is a simple zero of the rightmost growth rate: the curve is followed by secants, and each of its
//! points is located independently. The thresholds of the preset `gao2026` are stored in a table.

use std::sync::LazyLock;

use furrow_bvp::{Gauss, Solution, mesh};

use super::azimuthal_scan::{CLOSE, Corrector, between, crossing, rate};
use super::branch::{BranchOptions, mesh_monitor};
use super::curves::{self, Curve, CurveEnd, CurvePoint};
use super::error::{CellName, PointKind, Result, ShapeError, resolved, with_paper_law};
use super::point::{ShapePoint, XI};
use super::primary;
use super::stationary::{PINCHING, waist};
use crate::cortex::symmetry::unfold;
use crate::cortex::{Cortex, Domain};
use furrow_cell::{Cell, Numerics, Parameter};

/// First and longest steps along a curve, as fractions of its range, and the step below which the curve is abandoned.
const FIRST_STEP: f64 = 1.0 / 24.0;
const LONGEST_STEP: f64 = 1.0 / 12.0;
const SMALLEST_STEP: f64 = 1e-4;
/// Largest relative deviation of a threshold from its prediction, and the deviation below which the next step is
/// lengthened.
const FAR: f64 = 0.03;
const NEAR: f64 = 0.005;
/// Most steps of the search for a point.
const SEARCH: usize = 12;
/// Relative step in ξ_s for the first slope of the growth rate.
const SLOPE_STEP: f64 = 1e-3;

/// R0 and ξ_s at which perturbations with m = 1 begin to grow in cells of the preset `gao2026` without a cue, as
/// located by `furrow branch --r0 R --azimuthal 1`.
const PRESET: &str = include_str!("../../data/gao2026.azimuthal.json");

/// The activity above which perturbations with m = 1, which deepen a furrow on one side, grow in a resting cell, from a
/// table to 0.1 %: for cells with the constants of the preset `gao2026` and without a cue. `None` for other cells, and
/// for R0 outside the table.
///
/// # Examples
/// ```
/// use furrow_cell::Cell;
/// use furrow_mechanics::equilibria::azimuthal_threshold::one_sided_from;
/// assert!((one_sided_from(&Cell::new(2.0)).unwrap() - 11.541).abs() < 0.012);
/// assert_eq!(one_sided_from(&Cell { epsilon: 0.8, ..Cell::new(2.0) }), None);
/// ```
pub fn one_sided_from(cell: &Cell) -> Option<f64> {
    let plain = Cell::new(cell.r0);
    if (Cell { xi_s: plain.xi_s, ..cell.clone() }) != plain {
        return None;
    }
    static TABLE: LazyLock<Vec<[f64; 2]>> = LazyLock::new(|| serde_json::from_str(PRESET).unwrap_or_default());
    let above = TABLE.partition_point(|[r0, _]| *r0 < cell.r0);
    let [[r0, xi_s], [next_r0, next_xi_s]] = *TABLE.get(above.checked_sub(1)?..=above)? else { return None };
    Some(xi_s + (cell.r0 - r0) / (next_r0 - r0) * (next_xi_s - xi_s))
}

/// Whether perturbations with m = 1 grow in a resting cell, by [`one_sided_from`]: it rests only while it stays
/// axisymmetric.
pub fn grows_one_sided(cell: &Cell) -> bool {
    one_sided_from(cell).is_some_and(|from| cell.xi_s > from)
}

/// A threshold, with the data that predict the next one.
struct Threshold {
    value: f64,
    xi_s: f64,
    /// Slope of the growth rate in ξ_s.
    slope: f64,
    shape: Solution,
}

/// The first shape of the primary branch at which perturbations of azimuthal number m begin to grow as ξ_s rises. The
/// search ends at a fold beyond which the shapes pinch off.
///
/// # Errors
/// [`ShapeError`]; [`ShapeError::NoGrowth`] if they never grow.
pub fn first(cell: &Cell, numerics: &Numerics, m: usize) -> Result<(Cortex, ShapePoint, Solution)> {
    let cell = &*resolved(cell)?;
    with_paper_law(cell)?;
    let options = BranchOptions::default();
    let mut branch = primary::start(cell, numerics, &options.settings)?;
    let mut before = rate(&branch.problem, &branch.state.solution, m).map(|r| (r, branch.state.solution.clone()));
    let domain = branch.problem.domain;
    let mut found = None;
    let mut reached = 0.0f64;
    let ended = branch.follow(options.xi, options.points, |branch, advance| {
        let y = &branch.state.solution;
        reached = reached.max(y.scalars[XI]);
        let goes_on = !advance.passed_fold || waist(&branch.system.gauss, y, domain) > PINCHING * cell.r0;
        let Some(now) = rate(&branch.problem, y, m) else { return goes_on };
        if let Some((last, from)) = &before
            && *last < 0.0
            && now >= 0.0
            && y.scalars[XI] > from.scalars[XI]
        {
            found = crossing(&branch.problem, [from, y], m, [*last, now]);
        }
        before = Some((now, y.clone()));
        found.is_none() && goes_on
    });
    match found {
        Some((point, shape)) => Ok((branch.problem, point, shape)),
        None => {
            let cell = CellName::of(cell);
            ended.map_err(|source| ShapeError::Branch { cell, source })?;
            Err(ShapeError::NoGrowth { cell, m, xi_s: reached })
        }
    }
}

/// A curve of thresholds during its continuation.
struct Follower<'a> {
    cortex: Cortex,
    gauss: Gauss,
    parameter: Parameter,
    m: usize,
    points: &'a mut Vec<CurvePoint>,
}

impl Follower<'_> {
    /// The cortex with another value of the parameter.
    fn at(&self, value: f64, stages: usize) -> Corrector {
        let cell = curves::at_value(&self.cortex.cell, self.parameter, value);
        Corrector::of(&Cortex::new(&cell, self.cortex.domain, &[]), stages)
    }

    fn keep(&mut self, value: f64, at: &Cortex, shape: &Solution) {
        let ShapePoint { xi_s, elongation, .. } = ShapePoint::of(shape, at, &self.gauss);
        let Cell { r0, epsilon, .. } = at.cell;
        self.points.push(CurvePoint { r0, epsilon, value, xi_s, slope: 0.0, elongation, coefficient: None });
    }

    /// The first threshold, with the slope of its growth rate by a small step.
    fn begin(&mut self, value: f64, point: &ShapePoint, shape: Solution) -> Option<Threshold> {
        let mut at_rest = self.at(value, shape.m);
        let step = SLOPE_STEP * (1.0 + point.xi_s);
        let beyond = at_rest.rate(point.xi_s + step, &mut shape.clone(), self.m)?;
        let mut shape = shape;
        let here = at_rest.rate(point.xi_s, &mut shape, self.m)?;
        self.keep(value, &at_rest.cortex, &shape);
        Some(Threshold { value, xi_s: point.xi_s, slope: (beyond - here) / step, shape })
    }

    /// The threshold at a value, from a prediction of it and of the slope of the growth rate there; `None` if it is not
    /// close to the prediction.
    fn locate(&mut self, predicted: Threshold) -> Option<Threshold> {
        let Threshold { value, xi_s: guess, mut slope, mut shape } = predicted;
        let mut at_rest = self.at(value, shape.m);
        let mut xi_s = guess;
        let mut now = at_rest.rate(xi_s, &mut shape, self.m)?;
        for _ in 0..SEARCH {
            let next = xi_s - now / slope;
            if !((next - guess).abs() < FAR * (1.0 + guess.abs()) && slope > 0.0) {
                return None;
            }
            let step = next - xi_s;
            let then = at_rest.rate(next, &mut shape, self.m)?;
            xi_s = next;
            if then == 0.0 || step.abs() < CLOSE * (1.0 + xi_s.abs()) {
                self.keep(value, &at_rest.cortex, &shape);
                return Some(Threshold { value, xi_s, slope, shape: self.remeshed(&at_rest.cortex, shape) });
            }
            (slope, now) = ((then - now) / step, then);
        }
        None
    }

    fn remeshed(&self, cortex: &Cortex, y: Solution) -> Solution {
        let mut weight = Vec::new();
        mesh_monitor(cortex, &y, &mut weight);
        let above = BranchOptions::default().settings.remesh_above;
        match mesh::rebalanced(&y.mesh, &weight, above) {
            Some(grid) => y.on_mesh(&self.gauss, &grid),
            None => y,
        }
    }

    /// Follows the curve from its first threshold to a value; returns the value reached.
    fn follow(&mut self, first: Threshold, to: f64) -> f64 {
        let whole = to - first.value;
        let mut step = FIRST_STEP * whole;
        let (mut before, mut last): (Option<Threshold>, Threshold) = (None, first);
        while last.value != to {
            if step.abs() < SMALLEST_STEP * whole.abs() {
                return last.value;
            }
            let left = to - last.value;
            // The last step is not a very short one.
            let by = if step.abs() > 0.99 * left.abs() { left } else { step };
            let value = if by == left { to } else { last.value + by };
            let (xi_s, shape) = match &before {
                Some(before) => {
                    let share = (value - before.value) / (last.value - before.value);
                    let from = before.shape.on_mesh(&self.gauss, &last.shape.mesh);
                    (before.xi_s + share * (last.xi_s - before.xi_s), between(&from, &last.shape, share))
                }
                None => (last.xi_s, last.shape.clone()),
            };
            match self.locate(Threshold { value, xi_s, slope: last.slope, shape }) {
                Some(found) => {
                    if (found.xi_s - xi_s).abs() < NEAR * (1.0 + found.xi_s.abs()) {
                        step = (1.5 * step.abs()).min(LONGEST_STEP * whole.abs()).copysign(whole);
                    }
                    before = Some(std::mem::replace(&mut last, found));
                }
                None => step *= 0.5,
            }
        }
        to
    }
}

/// The slope of a curve at each of its points, by the parabola through it and its neighbours; NaN for curves of fewer
/// than three points.
fn fill_slopes(points: &mut [CurvePoint]) {
    let places: Vec<[f64; 2]> = points.iter().map(|point| [point.value, point.xi_s]).collect();
    for (k, point) in points.iter_mut().enumerate() {
        let first = k.saturating_sub(1).min(places.len().saturating_sub(3));
        point.slope = match places.get(first..first + 3) {
            Some([a, b, c]) => {
                let chord = |p: &[f64; 2], q: &[f64; 2]| (q[1] - p[1]) / (q[0] - p[0]);
                let bend = (chord(b, c) - chord(a, b)) / (c[0] - a[0]);
                chord(a, b) + bend * (2.0 * point.value - a[0] - b[0])
            }
            _ => f64::NAN,
        };
    }
}

/// Follows the threshold of perturbations of azimuthal number m from one value of a parameter, where it is located
/// along the primary branch, to another. A curve that ends on the way keeps its points.
///
/// # Examples
/// Larger cells lose their axisymmetry at a smaller activity:
///
/// ```
/// use furrow_cell::{Cell, Numerics, Parameter};
/// use furrow_mechanics::equilibria::azimuthal_threshold::threshold_curve;
/// let curve = threshold_curve(&Cell::new(2.0), &Numerics::default(), Parameter::R0, [1.9, 2.0], 1)?;
/// assert!((curve.points.last().unwrap().xi_s - 11.541).abs() < 1e-3);
/// # Ok::<(), furrow_mechanics::equilibria::ShapeError>(())
/// ```
///
/// # Errors
/// [`ShapeError`]; `NoGrowth` if they do not grow at either end of the range.
pub fn threshold_curve(
    cell: &Cell,
    numerics: &Numerics,
    parameter: Parameter,
    [from, to]: [f64; 2],
    m: usize,
) -> Result<Curve> {
    curves::refuse_par(cell, PointKind::Fold)?;
    let forwards = follow(cell, numerics, parameter, [from, to], m);
    forwards.or_else(|error| {
        let mut curve = follow(cell, numerics, parameter, [to, from], m).map_err(|_| error)?;
        curve.points.reverse();
        Ok(curve)
    })
}

fn follow(cell: &Cell, numerics: &Numerics, parameter: Parameter, range: [f64; 2], m: usize) -> Result<Curve> {
    let [from, to] = range;
    let (cortex, point, shape) = first(&curves::at_value(cell, parameter, from), numerics, m)?;
    // A shape that is mirror-symmetric only at one value needs the whole contour.
    let whole = curves::domain_along(cell, parameter) != cortex.domain;
    let (cortex, shape) = match whole {
        true => (Cortex::new(&cortex.cell, Domain::Full, &[]), unfold(&shape)),
        false => (cortex, shape),
    };
    let mut curve = Curve::default();
    let gauss = shape.gauss();
    let mut follower = Follower { cortex, gauss, parameter, m, points: &mut curve.points };
    let reached = match follower.begin(from, &point, shape) {
        Some(first) => follower.follow(first, to),
        None => from,
    };
    if reached != to {
        curve.ended = CurveEnd::Stopped(ShapeError::ThresholdLost { m, parameter, reached, value: to });
    }
    fill_slopes(&mut curve.points);
    Ok(curve)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The thresholds of single cells from `branch --azimuthal`, on other meshes.
    #[test]
    fn the_curve_passes_the_thresholds_of_single_cells() {
        let numerics = Numerics::default();
        let at = |parameter, cell: &Cell, range: [f64; 2], expected: [f64; 2]| {
            let curve = threshold_curve(cell, &numerics, parameter, range, 1).unwrap();
            assert_eq!(curve.ended, CurveEnd::Reached);
            let ends = [curve.points[0], curve.points[curve.points.len() - 1]];
            for ((point, value), expected) in ends.iter().zip(range).zip(expected) {
                assert_eq!(point.value, value);
                assert!((point.xi_s - expected).abs() < 6e-4, "{point:?}: {expected}");
            }
            for point in curve.points.iter().skip(3).step_by(4) {
                let alone = first(&curves::at_value(cell, parameter, point.value), &numerics, 1).unwrap().1;
                assert!((alone.xi_s - point.xi_s).abs() < 1e-7 * point.xi_s, "{point:?}: {}", alone.xi_s);
            }
            curve
        };
        let over_r0 = at(Parameter::R0, &Cell::new(1.64), [1.64, 5.4], [13.461, 8.202]);
        assert!(over_r0.points.iter().any(|point| point.slope < -5.0));
        at(Parameter::Epsilon, &Cell::new(2.22), [0.88, 0.64], [11.674, 5.316]);
    }

    #[test]
    fn perturbations_that_decay_have_no_curve() {
        let error = threshold_curve(&Cell::new(2.0), &Numerics::default(), Parameter::R0, [1.9, 2.0], 4).unwrap_err();
        assert!(matches!(error, ShapeError::NoGrowth { m: 4, .. }), "{error}");
    }

    #[test]
    fn the_table_of_the_preset_agrees_with_the_computation() {
        let table: Vec<[f64; 2]> = serde_json::from_str(PRESET).unwrap();
        assert!(table.len() > 40 && table.is_sorted_by(|[a, _], [b, _]| a < b));
        let [first_r0, last_r0] = [table[0][0], table[table.len() - 1][0]];
        for r0 in [first_r0 + 0.01, 1.75, last_r0 - 0.1] {
            let xi_s = first(&Cell::new(r0), &Numerics::default(), 1).unwrap().1.xi_s;
            let found = one_sided_from(&Cell::new(r0)).unwrap();
            assert!((found - xi_s).abs() < 1e-3 * xi_s, "R0 = {r0}: {found}, {xi_s}");
        }
        for r0 in [f64::NAN, 0.0, first_r0 - 0.01, last_r0 + 0.01, f64::INFINITY] {
            assert_eq!(one_sided_from(&Cell::new(r0)), None, "{r0}");
        }
        // The preset's critical radius is 1.72: cells just below it furrow from one side, the smallest do not.
        assert!(grows_one_sided(&Cell::new(1.7)) && !grows_one_sided(&Cell::new(0.7)));
    }
}
