//! Whether a step has passed a branch point, or jumped to another branch.

use crate::direction::{Direction, LinearCondition, Residual};
use crate::linear::System;
use crate::mesh;
use crate::metric::{self, Metric};
use crate::newton::Work;
use crate::problem::BoundaryValueProblem;
use crate::solution::Solution;

use super::unfolded::Unfolded;
use super::unfolding::Unfolding;

/// Branches nearer to each other than this cross, as far as the rounding of β can tell.
const CLOSED: f64 = 1e-5;

/// A gap that shrinks by this factor on a mesh twice as fine is one of the mesh and not of the problem: the order of collocation
/// makes it far more, and an imperfection stays.
const SHRINKS: f64 = 0.5;

/// A branch point belongs to a step if it lies between the ends, or beyond them by this share of the step.
const BEYOND: f64 = 0.05;

/// The branch point that the step of length `step` from `ends[0]` to `ends[1]` has passed on a branch that goes straight on. The
/// bordered determinants at the ends have different signs. None if the step has changed to another branch, or if there is no
/// simple branch point.
pub(super) fn branch_point<P: BoundaryValueProblem>(
    problem: &mut P,
    metric: &Metric,
    ends: [&Solution; 2],
    tangent: &Direction,
    step: f64,
    work: &mut Work,
) -> Option<Solution> {
    let dims = problem.dimensions();
    let mut unfolding = Unfolding::new(dims, ends[0].m, metric.clone(), second_difference)?;
    let mut found = None;
    for share in [0.5, 0.1, 0.9] {
        let mut y = between(ends, share);
        let solved = unfolding.solve(problem, &mut y, tangent);
        if solved.is_some() && belongs(distances(metric, ends[0], &y, tangent), step) {
            found = Some(y);
            break;
        }
    }
    let crosses = found.as_ref().is_some_and(|y| {
        unfolding.crossing(&y.mesh, tangent).is_some() && is_closed(&mut unfolding, problem, y, tangent)
    });
    *work += unfolding.work;
    problem.prepare(&ends[1].scalars);
    found.filter(|_| crosses)
}

/// Whether the branches that cross at `y` in the unfolded problem do so in the problem itself.
fn is_closed<P: BoundaryValueProblem>(
    unfolding: &mut Unfolding<P>,
    problem: &mut P,
    y: &Solution,
    tangent: &Direction,
) -> bool {
    let gap = unfolding.gap();
    if gap < CLOSED {
        return true;
    }
    let finer = mesh::halved(&y.mesh);
    let gauss = unfolding.system.gauss.clone();
    let (mut refined, mut along) = (y.on_mesh(&gauss, &finer), tangent.clone());
    metric::transfer_direction(&gauss, &y.mesh, &finer, &mut along);
    unfolding.solve(problem, &mut refined, &along).is_some() && unfolding.gap() < SHRINKS * gap
}

/// The point at a share of the way.
fn between([from, to]: [&Solution; 2], share: f64) -> Solution {
    let mut y = from.clone();
    for (y, to) in [(&mut y.nodes, &to.nodes), (&mut y.stages, &to.stages), (&mut y.scalars, &to.scalars)] {
        for (y, to) in y.iter_mut().zip(to) {
            *y += share * (to - *y);
        }
    }
    y
}

/// Distances of `y` from a point: along its tangent and across it.
pub(crate) fn distances(metric: &Metric, from: &Solution, y: &Solution, tangent: &Direction) -> [f64; 2] {
    let minus = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a - b).collect();
    let way = Direction {
        nodes: minus(&y.nodes, &from.nodes),
        stages: Vec::new(),
        scalars: minus(&y.scalars, &from.scalars),
    };
    let along = metric.dot(&y.mesh, &way, tangent);
    [along, (metric.dot(&y.mesh, &way, &way) - along * along).max(0.0).sqrt()]
}

/// Whether a point at these distances belongs to a step.
pub(crate) fn belongs([along, across]: [f64; 2], step: f64) -> bool {
    (-BEYOND * step..=(1.0 + BEYOND) * step).contains(&along) && across <= step
}

/// Length of the differences, relative to the directions.
const DIFFERENCE: f64 = 1e-4;

/// D²F\[a, b\] by differences of the residual. Newton converges with it as with the exact one, to the same point.
fn second_difference<P: BoundaryValueProblem>(
    system: &mut System,
    problem: &mut P,
    y: &Solution,
    [a, b]: [&Direction; 2],
    conditions: usize,
    out: &mut Residual,
) {
    let largest = |d: &Direction| d.nodes.iter().chain(&d.scalars).fold(f64::MIN_POSITIVE, |m, v| m.max(v.abs()));
    let steps = [a, b].map(|d| DIFFERENCE / largest(d));
    let dims = problem.dimensions();
    let (weights, conditions) = (vec![0.0; dims.right + dims.integrals], vec![LinearCondition::default(); conditions]);
    let mut unfolded = Unfolded { inner: problem, beta: 0.0, weights: &weights };
    let kept = std::mem::take(&mut system.residual);
    for (count, signs) in [[1.0, 1.0], [1.0, -1.0], [-1.0, 1.0], [-1.0, -1.0]].into_iter().enumerate() {
        let mut moved = y.clone();
        a.apply(signs[0] * steps[0], &mut moved);
        b.apply(signs[1] * steps[1], &mut moved);
        system.evaluate(&mut unfolded, &moved, &conditions, false);
        if count == 0 {
            out.clone_from(&system.residual);
            out.add(-1.0, &system.residual);
        }
        out.add(signs[0] * signs[1] / (4.0 * steps[0] * steps[1]), &system.residual);
    }
    system.residual = kept;
}
