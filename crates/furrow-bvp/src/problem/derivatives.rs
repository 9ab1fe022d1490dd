//! Second and third derivatives of all equations along given directions, for singular points and their normal forms.

use crate::direction::{Direction, Residual};
use crate::gauss::Gauss;
use crate::solution::Solution;

use super::differences;
use super::directional::{Directional, EndDerivatives, EndValues, PointDirection};
use super::statement::{BoundaryValueProblem, CollocationPoints};

/// Outputs in f and in g.
type Pair<'a> = [&'a mut [f64]; 2];

/// D²F\[a, b\] of all equations, with zeros in `conditions` linear conditions.
pub(crate) fn second_residual(
    gauss: &Gauss,
    problem: &mut dyn Directional,
    y: &Solution,
    along: [&Direction; 2],
    conditions: usize,
    out: &mut Residual,
) {
    residuals(
        gauss,
        problem,
        y,
        (along, conditions),
        [out],
        |problem, points, p, along, [out]| problem.second_many(points, p, along, out),
        |problem, at, along, [out]| problem.second_at_ends(at, along, out),
    );
}

/// [`second_residual`] of any problem, by differences.
pub(crate) fn second_differences(
    gauss: &Gauss,
    problem: &mut dyn BoundaryValueProblem,
    y: &Solution,
    along: [&Direction; 2],
    conditions: usize,
    out: &mut Residual,
) {
    residuals(
        gauss,
        problem,
        y,
        (along, conditions),
        [out],
        |problem, points, p, along, [out]| differences::second(problem, points, p, along, out),
        |problem, at, along, [out]| differences::second_at_ends(problem, at, along, out),
    );
}

/// D²F\[a, a\] of all equations into the first of `out` and D³F\[a, a, a\] into the second, with zeros in `conditions` linear
/// conditions.
pub(crate) fn power_residuals(
    gauss: &Gauss,
    problem: &mut dyn Directional,
    y: &Solution,
    a: &Direction,
    conditions: usize,
    out: [&mut Residual; 2],
) {
    residuals(
        gauss,
        problem,
        y,
        ([a], conditions),
        out,
        |problem, points, p, [a], out| problem.third_many(points, p, a, out),
        |problem, at, [a], [second, third]| {
            problem.second_at_ends(at, [a, a], second);
            problem.third_at_ends(at, a, third);
        },
    );
}

/// One derivative: its residual, and its integrands and parts h(p).
struct Part<'a> {
    residual: &'a mut Residual,
    integrands: Vec<f64>,
    offsets: Vec<f64>,
}

/// Derivatives along D directions by functions for the equations at the collocation points, and for the conditions.
fn residuals<P: BoundaryValueProblem + ?Sized, const D: usize, const K: usize>(
    gauss: &Gauss,
    problem: &mut P,
    y: &Solution,
    (along, conditions): ([&Direction; D], usize),
    out: [&mut Residual; K],
    at_points: impl FnOnce(&mut P, CollocationPoints<'_>, &[f64], [PointDirection<'_>; D], [Pair<'_>; K]),
    at_ends: impl FnOnce(&mut P, EndValues<'_>, [EndValues<'_>; D], [EndDerivatives<'_>; K]),
) {
    problem.prepare(&y.scalars);
    let dims = problem.dimensions();
    let points = y.intervals() * y.m;
    let x: Vec<f64> = (0..points).map(|k| y.stage_x(gauss, k / y.m, k % y.m)).collect();
    let mut parts = out.map(|residual| {
        let border = dims.integrals + conditions;
        residual.reset([y.stages.len(), y.intervals() * y.components, dims.left, dims.right, border]);
        Part { residual, integrands: vec![0.0; points * dims.integrals], offsets: vec![0.0; dims.integrals] }
    });
    let values = parts.each_mut().map(|part| [&mut part.residual.stages[..], &mut part.integrands]);
    let of_points = along.map(|d| PointDirection { y: &d.stages, p: &d.scalars });
    at_points(problem, CollocationPoints { first: 0, x: &x, y: &y.stages }, &y.scalars, of_points, values);
    parts.iter_mut().for_each(|part| integrate(gauss, y, &part.integrands, part.residual));
    let values = parts.each_mut().map(|Part { residual, offsets, .. }| EndDerivatives {
        left: &mut residual.left,
        right: &mut residual.right,
        offsets,
    });
    let ends_along = along.map(|d| ends(&d.nodes, &d.scalars, y.components));
    at_ends(problem, ends(&y.nodes, &y.scalars, y.components), ends_along, values);
    for Part { residual, offsets, .. } in parts {
        residual.border.iter_mut().zip(offsets).for_each(|(row, h)| *row += h);
    }
}

/// The unknowns at both ends of a solution, or of a direction, of n components.
fn ends<'a>(nodes: &'a [f64], p: &'a [f64], n: usize) -> EndValues<'a> {
    EndValues { left: &nodes[..n], right: &nodes[nodes.len() - n..], p }
}

/// Turns derivatives of f in the stage rows of `out` into −h f, and adds Σ h b g to its integral rows.
fn integrate(gauss: &Gauss, y: &Solution, integrands: &[f64], out: &mut Residual) {
    let width = y.m * y.components;
    let integrals = integrands.len() / (y.intervals() * y.m);
    for i in 0..y.intervals() {
        let h = y.mesh[i + 1] - y.mesh[i];
        out.stages[i * width..(i + 1) * width].iter_mut().for_each(|row| *row *= -h);
        for j in 0..y.m {
            let g = &integrands[(i * y.m + j) * integrals..];
            for (row, g) in out.border[..integrals].iter_mut().zip(g) {
                *row += h * gauss.b[j] * g;
            }
        }
    }
}
