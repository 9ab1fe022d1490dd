//! Higher derivatives by differences of lower ones, of fourth order in the step.

use crate::dimensions::Dimensions;

use super::directional::{Directional, EndDerivatives, EndValues, PointDirection};
use super::statement::{BoundaryValueProblem, CollocationPoints, End, conditions_at};

/// Steps relative to the unknowns, of first differences and of second ones: rounding and truncation are about alike.
const FIRST: f64 = 3e-4;
const SECOND: f64 = 2e-3;
/// The same of second differences that are of second order.
const MIXED: f64 = 1e-4;

/// The step along a direction that changes values by a share of their size; `None` for the zero direction.
fn step<'a>(share: f64, pairs: impl Iterator<Item = (&'a [f64], &'a [f64])>) -> Option<f64> {
    let (mut value, mut change) = (1.0f64, 0.0f64);
    for (values, along) in pairs {
        value = values.iter().fold(value, |largest, v| largest.max(v.abs()));
        change = along.iter().fold(change, |largest, d| largest.max(d.abs()));
    }
    let step = share * value / change;
    (change > 0.0 && step.is_finite() && step > 0.0).then_some(step)
}

/// values + t · direction.
fn moved(values: &[f64], t: f64, along: &[f64]) -> Vec<f64> {
    values.iter().zip(along).map(|(v, d)| v + t * d).collect()
}

/// Whether a direction changes the scalar unknowns, and with them what `prepare` computes.
fn changes_scalars(along: &[f64]) -> bool {
    along.iter().any(|d| *d != 0.0)
}

/// The slope at 0 of what `values` gives at t.
pub(super) fn slope(t: f64, mut values: impl FnMut(f64) -> Vec<f64>) -> Vec<f64> {
    let mut sum = Vec::new();
    for (place, weight) in [(1.0, 8.0), (-1.0, -8.0), (2.0, -1.0), (-2.0, 1.0)] {
        let values = values(place * t);
        sum.resize(values.len(), 0.0);
        sum.iter_mut().zip(&values).for_each(|(sum, value)| *sum += weight * value / (12.0 * t));
    }
    sum
}

/// Mixed second derivatives by differences of the right-hand sides, of second order in the steps.
pub(super) fn second<P: BoundaryValueProblem + ?Sized>(
    problem: &mut P,
    points: CollocationPoints<'_>,
    p: &[f64],
    [a, b]: [PointDirection; 2],
    [f2, g2]: [&mut [f64]; 2],
) {
    let steps = [a, b].map(|d| step(MIXED, [(points.y, d.y), (p, d.p)].into_iter()));
    let [Some(s), Some(t)] = steps else { return };
    problem.prepare_points(points.x, p);
    let (mut f, mut g) = (vec![0.0; f2.len()], vec![0.0; g2.len()]);
    for [i, j] in [[1.0, 1.0], [1.0, -1.0], [-1.0, 1.0], [-1.0, -1.0]] {
        let both = |values: &[f64], a: &[f64], b: &[f64]| moved(&moved(values, i * s, a), j * t, b);
        let (y, p) = (both(points.y, a.y, b.y), both(p, a.p, b.p));
        if changes_scalars(a.p) || changes_scalars(b.p) {
            problem.prepare(&p);
        }
        problem.rhs_many(CollocationPoints { y: &y, ..points }, &p, &mut f, &mut g);
        let weight = i * j / (4.0 * s * t);
        f2.iter_mut().chain(&mut *g2).zip(f.iter().chain(&g)).for_each(|(out, value)| *out += weight * value);
    }
    if changes_scalars(a.p) || changes_scalars(b.p) {
        problem.prepare(p);
    }
}

/// Second derivatives along a twice, and third ones by differences of these.
pub(super) fn third<P: Directional + ?Sized>(
    problem: &mut P,
    points: CollocationPoints<'_>,
    p: &[f64],
    along: PointDirection,
    [[f2, g2], [f3, g3]]: [[&mut [f64]; 2]; 2],
) {
    for out in [&mut *f2, &mut *g2, &mut *f3, &mut *g3] {
        out.fill(0.0);
    }
    problem.second_many(points, p, [along, along], [&mut *f2, &mut *g2]);
    let Some(t) = step(FIRST, [(points.y, along.y), (p, along.p)].into_iter()) else { return };
    let slopes = slope(t, |t| {
        let (y, p) = (moved(points.y, t, along.y), moved(p, t, along.p));
        if changes_scalars(along.p) {
            problem.prepare(&p);
        }
        let mut values = vec![0.0; f2.len() + g2.len()];
        let (f, g) = values.split_at_mut(f2.len());
        problem.second_many(CollocationPoints { y: &y, ..points }, &p, [along, along], [f, g]);
        values
    });
    f3.iter_mut().chain(g3).zip(slopes).for_each(|(out, slope)| *out = slope);
    if changes_scalars(along.p) {
        problem.prepare(p);
    }
}

/// Derivatives along `b` of the left conditions, the right ones and the parts h(p), in one vector.
pub(super) fn slopes_at_ends<P: BoundaryValueProblem + ?Sized>(problem: &P, at: EndValues, b: EndValues) -> Vec<f64> {
    let Dimensions { components: n, scalars: np, left, right, integrals, .. } = problem.dimensions();
    let product = |row: &[f64], d: &[f64]| row.iter().zip(d).map(|(r, d)| r * d).sum::<f64>();
    let mut slopes = Vec::with_capacity(left + right + integrals);
    for (end, y, along) in [(End::Left, at.left, b.left), (End::Right, at.right, b.right)] {
        let [r, ry, rp] = conditions_at(problem, end, y, at.p);
        let by_y = |k: usize| product(&ry[k * n..(k + 1) * n], along);
        slopes.extend((0..r.len()).map(|k| by_y(k) + product(&rp[k * np..(k + 1) * np], b.p)));
    }
    let mut hp = vec![0.0; np];
    for k in 0..integrals {
        hp.fill(0.0);
        problem.integral_offset(k, at.p, &mut hp);
        slopes.push(product(&hp, b.p));
    }
    slopes
}

/// The same at `at` + t · `a`.
pub(super) fn slopes_displaced<P: BoundaryValueProblem + ?Sized>(
    problem: &mut P,
    at: EndValues,
    [a, b]: [EndValues; 2],
    t: f64,
) -> Vec<f64> {
    let [left, right, p] =
        [(at.left, a.left), (at.right, a.right), (at.p, a.p)].map(|(values, along)| moved(values, t, along));
    if changes_scalars(a.p) {
        problem.prepare(&p);
    }
    slopes_at_ends(problem, EndValues { left: &left, right: &right, p: &p }, b)
}

/// The step along `a` at the ends.
fn step_at_ends(share: f64, at: EndValues, a: EndValues) -> Option<f64> {
    step(share, [(at.left, a.left), (at.right, a.right), (at.p, a.p)].into_iter())
}

/// Adds weighted slopes to the derivatives.
fn add(out: &mut EndDerivatives<'_>, slopes: impl Iterator<Item = f64>) {
    let EndDerivatives { left, right, offsets } = out;
    left.iter_mut().chain(right.iter_mut()).chain(offsets.iter_mut()).zip(slopes).for_each(|(out, s)| *out += s);
}

/// Differences of first derivatives along b.
pub(super) fn second_at_ends<P: BoundaryValueProblem + ?Sized>(
    problem: &mut P,
    at: EndValues,
    [a, b]: [EndValues; 2],
    mut out: EndDerivatives<'_>,
) {
    let Some(t) = step_at_ends(FIRST, at, a) else { return };
    let slopes = slope(t, |t| slopes_displaced(problem, at, [a, b], t));
    add(&mut out, slopes.into_iter());
    if changes_scalars(a.p) {
        problem.prepare(at.p);
    }
}

/// Second differences of first derivatives along a.
pub(super) fn third_at_ends<P: BoundaryValueProblem + ?Sized>(
    problem: &mut P,
    at: EndValues,
    a: EndValues,
    mut out: EndDerivatives<'_>,
) {
    let Some(t) = step_at_ends(SECOND, at, a) else { return };
    let centre = slopes_at_ends(problem, at, a);
    for (place, weight) in [(1.0, 16.0), (-1.0, 16.0), (2.0, -1.0), (-2.0, -1.0)] {
        let slopes = slopes_displaced(problem, at, [a, a], place * t);
        add(&mut out, slopes.iter().zip(&centre).map(|(s, c)| weight * (s - c) / (12.0 * t * t)));
    }
    if changes_scalars(a.p) {
        problem.prepare(at.p);
    }
}
