//! Second and third derivatives along given directions, for singular points and their normal forms.
//!
//! Only the right-hand side and the integrands are nonlinear here: boundary conditions must be linear.

use crate::dimensions::{Dimensions, MAX_UNKNOWNS};
use crate::direction::{Direction, Residual};
use crate::gauss::Gauss;
use crate::solution::Solution;

use super::statement::{BoundaryValueProblem, CollocationPoint};

/// A collocation point with the unknowns there.
#[derive(Clone, Copy, Debug)]
pub struct PointValues<'a> {
    /// The point.
    pub at: CollocationPoint,
    /// Components of y.
    pub y: &'a [f64],
    /// Scalar unknowns.
    pub p: &'a [f64],
}

/// A direction in the unknowns at one point: components of y and scalar unknowns.
#[derive(Clone, Copy, Debug)]
pub struct PointDirection<'a> {
    /// Along y.
    pub y: &'a [f64],
    /// Along the scalar unknowns.
    pub p: &'a [f64],
}

/// Problems whose right-hand side can be differentiated along directions. The scalar directions of a whole sweep are
/// known before its first point, so that what depends on them alone is computed once.
pub trait Directional: BoundaryValueProblem {
    /// What a sweep of second derivatives prepares.
    type Second;
    /// What a sweep of third derivatives prepares.
    type Third;

    /// Prepares D²f\[a, b\] for scalar unknowns p and their directions.
    fn prepare_second(&self, p: &[f64], a: &[f64], b: &[f64]) -> Self::Second;

    /// D²f\[a, b\] and D²g\[a, b\] into the two of `out`.
    fn second(&self, prepared: &Self::Second, point: PointValues, along: [PointDirection; 2], out: [&mut [f64]; 2]);

    /// The same of the part h(p) of an integral condition.
    fn second_offset(&self, _prepared: &Self::Second, _k: usize) -> f64 {
        0.0
    }

    /// Prepares the powers of one direction.
    fn prepare_third(&self, p: &[f64], a: &[f64]) -> Self::Third;

    /// D²f\[a, a\], D²g\[a, a\] and D³f\[a, a, a\] into the three of `out`.
    fn third(&self, prepared: &Self::Third, point: PointValues, along: PointDirection, out: [&mut [f64]; 3]);
}

/// Clears `out` in the shape of the problem and the mesh of `y`.
fn clear(dims: Dimensions, y: &Solution, border: usize, out: &mut Residual) {
    out.reset([y.stages.len(), y.intervals() * y.components, dims.left, dims.right, border]);
}

/// Runs `point` over all collocation points and collects −h f in the stage rows and Σ h b g in the integral rows.
fn sweep<P: BoundaryValueProblem>(
    gauss: &Gauss,
    problem: &mut P,
    y: &Solution,
    border: usize,
    out: &mut Residual,
    mut point: impl FnMut(&P, PointValues, [&mut [f64]; 2]),
) {
    let dims = problem.dimensions();
    let n = dims.components;
    clear(dims, y, border, out);
    let mut scratch = [0.0; 2 * MAX_UNKNOWNS];
    let (f, rest) = scratch.split_at_mut(n);
    let g = &mut rest[..dims.integrals];
    for i in 0..y.intervals() {
        let h = y.mesh[i + 1] - y.mesh[i];
        for j in 0..y.m {
            let index = i * y.m + j;
            f.fill(0.0);
            g.fill(0.0);
            let at = CollocationPoint { x: y.mesh[i] + h * gauss.c[j], index };
            point(problem, PointValues { at, y: y.stage(i, j), p: &y.scalars }, [f, g]);
            for (row, f) in out.stages[index * n..(index + 1) * n].iter_mut().zip(f.iter()) {
                *row = -h * f;
            }
            for (row, g) in out.border.iter_mut().zip(g.iter()) {
                *row += h * gauss.b[j] * g;
            }
        }
    }
}

/// D²F\[a, b\] of all collocation equations, with zeros in `conditions` linear conditions.
pub fn second_residual<P: Directional>(
    gauss: &Gauss,
    problem: &mut P,
    y: &Solution,
    [a, b]: [&Direction; 2],
    conditions: usize,
    out: &mut Residual,
) {
    problem.prepare(&y.scalars);
    let prepared = problem.prepare_second(&y.scalars, &a.scalars, &b.scalars);
    let (n, integrals) = (y.components, problem.dimensions().integrals);
    sweep(gauss, problem, y, integrals + conditions, out, |problem, point, out| {
        let range = point.at.index * n..(point.at.index + 1) * n;
        let along = [a, b].map(|d| PointDirection { y: &d.stages[range.clone()], p: &d.scalars });
        problem.second(&prepared, point, along, out);
    });
    for k in 0..integrals {
        out.border[k] += problem.second_offset(&prepared, k);
    }
}

/// D²F\[a, a\] of all collocation equations into `second`, and D³F\[a, a, a\] of the stage equations into `third`, for a
/// direction that leaves the scalar unknowns alone; zeros in `conditions` linear conditions.
pub fn power_residuals<P: Directional>(
    gauss: &Gauss,
    problem: &mut P,
    y: &Solution,
    a: &Direction,
    conditions: usize,
    [second, third]: [&mut Residual; 2],
) {
    problem.prepare(&y.scalars);
    let prepared = problem.prepare_third(&y.scalars, &a.scalars);
    let dims = problem.dimensions();
    let n = dims.components;
    clear(dims, y, dims.integrals + conditions, third);
    sweep(gauss, problem, y, dims.integrals + conditions, second, |problem, point, [f, g]| {
        let range = point.at.index * n..(point.at.index + 1) * n;
        let along = PointDirection { y: &a.stages[range.clone()], p: &a.scalars };
        let f3 = &mut third.stages[range];
        problem.third(&prepared, point, along, [f, g, f3]);
        let interval = point.at.index / y.m;
        let h = y.mesh[interval + 1] - y.mesh[interval];
        f3.iter_mut().for_each(|f| *f *= -h);
    });
}
