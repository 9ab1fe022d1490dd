//! Second and third derivatives of all equations along given directions, for singular points and their normal forms.

use crate::dimensions::{Dimensions, MAX_UNKNOWNS};
use crate::direction::{Direction, Residual};
use crate::gauss::Gauss;
use crate::solution::Solution;

use super::differences;
use super::statement::{BoundaryValueProblem, CollocationPoints};

pub use super::directional::{Directional, EndDerivatives, EndValues, PointDirection, PointValues};

/// Clears `out` in the shape of the problem and the mesh of `y`.
fn clear(dims: Dimensions, y: &Solution, border: usize, out: &mut Residual) {
    out.reset([y.stages.len(), y.intervals() * y.components, dims.left, dims.right, border]);
}

/// The collocation points of a mesh.
fn places(gauss: &Gauss, y: &Solution) -> Vec<f64> {
    let intervals = y.mesh.windows(2).map(|x| (x[0], x[1] - x[0]));
    intervals.flat_map(|(left, h)| gauss.c.iter().map(move |c| left + h * c)).collect()
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

/// The unknowns at both ends of a solution, or of a direction, on n components.
fn ends<'a>(nodes: &'a [f64], p: &'a [f64], n: usize) -> EndValues<'a> {
    EndValues { left: &nodes[..n], right: &nodes[nodes.len() - n..], p }
}

/// Room for derivatives of the boundary conditions and of h(p).
fn conditions<'a>(out: &'a mut Residual, offsets: &'a mut [f64]) -> EndDerivatives<'a> {
    EndDerivatives { left: &mut out.left, right: &mut out.right, offsets }
}

/// Adds the derivatives of h(p) to the integral rows.
fn add_offsets(out: &mut Residual, offsets: &[f64]) {
    out.border.iter_mut().zip(offsets).for_each(|(row, h)| *row += h);
}

/// D²F\[a, b\] of all equations, with zeros in `conditions` linear conditions.
pub fn second_residual<P: Directional>(
    gauss: &Gauss,
    problem: &mut P,
    y: &Solution,
    along: [&Direction; 2],
    conditions: usize,
    out: &mut Residual,
) {
    let many =
        |problem: &mut P, points: CollocationPoints<'_>, p: &[f64], along: [PointDirection<'_>; 2], out: Pair<'_>| {
            problem.second_many(points, p, along, out);
        };
    residual_of(gauss, problem, y, along, conditions, out, (many, P::second_at_ends));
}

/// [`second_residual`] of any problem, by differences.
pub(crate) fn second_differences<P: BoundaryValueProblem>(
    gauss: &Gauss,
    problem: &mut P,
    y: &Solution,
    along: [&Direction; 2],
    conditions: usize,
    out: &mut Residual,
) {
    residual_of(gauss, problem, y, along, conditions, out, (differences::second, differences::second_at_ends));
}

/// Outputs in f and in g.
type Pair<'a> = [&'a mut [f64]; 2];

/// [`second_residual`] of a problem by functions for its equations and its conditions.
fn residual_of<P: BoundaryValueProblem>(
    gauss: &Gauss,
    problem: &mut P,
    y: &Solution,
    [a, b]: [&Direction; 2],
    conditions: usize,
    out: &mut Residual,
    (many, at_ends): (
        impl FnOnce(&mut P, CollocationPoints<'_>, &[f64], [PointDirection<'_>; 2], Pair<'_>),
        impl FnOnce(&mut P, EndValues<'_>, [EndValues<'_>; 2], EndDerivatives<'_>),
    ),
) {
    problem.prepare(&y.scalars);
    let dims = problem.dimensions();
    clear(dims, y, dims.integrals + conditions, out);
    let x = places(gauss, y);
    let mut integrands = vec![0.0; x.len() * dims.integrals];
    let points = CollocationPoints { first: 0, x: &x, y: &y.stages };
    let along = [a, b].map(|d| PointDirection { y: &d.stages, p: &d.scalars });
    many(problem, points, &y.scalars, along, [&mut out.stages, &mut integrands]);
    integrate(gauss, y, &integrands, out);
    let mut offsets = [0.0; MAX_UNKNOWNS];
    let offsets = &mut offsets[..dims.integrals];
    let n = y.components;
    let along = [a, b].map(|d| ends(&d.nodes, &d.scalars, n));
    at_ends(problem, ends(&y.nodes, &y.scalars, n), along, self::conditions(out, offsets));
    add_offsets(out, offsets);
}

/// D²F\[a, a\] of all equations into `second` and D³F\[a, a, a\] into `third`, with zeros in `conditions` linear conditions.
pub fn power_residuals<P: Directional>(
    gauss: &Gauss,
    problem: &mut P,
    y: &Solution,
    a: &Direction,
    conditions: usize,
    [second, third]: [&mut Residual; 2],
) {
    problem.prepare(&y.scalars);
    let dims = problem.dimensions();
    let x = places(gauss, y);
    let mut integrands = [(); 2].map(|()| vec![0.0; x.len() * dims.integrals]);
    for out in [&mut *second, &mut *third] {
        clear(dims, y, dims.integrals + conditions, out);
    }
    let points = CollocationPoints { first: 0, x: &x, y: &y.stages };
    let along = PointDirection { y: &a.stages, p: &a.scalars };
    let [g2, g3] = &mut integrands;
    let out = [[&mut second.stages[..], &mut g2[..]], [&mut third.stages[..], &mut g3[..]]];
    problem.third_many(points, &y.scalars, along, out);
    for (out, integrands) in [(&mut *second, &integrands[0]), (&mut *third, &integrands[1])] {
        integrate(gauss, y, integrands, out);
    }
    let (at, along) = (ends(&y.nodes, &y.scalars, y.components), ends(&a.nodes, &a.scalars, y.components));
    let mut offsets = [[0.0; MAX_UNKNOWNS]; 2];
    let [h2, h3] = offsets.each_mut().map(|h| &mut h[..dims.integrals]);
    problem.second_at_ends(at, [along, along], self::conditions(second, h2));
    problem.third_at_ends(at, along, self::conditions(third, h3));
    add_offsets(second, h2);
    add_offsets(third, h3);
}
