//! Whether a step has passed a branch point, or jumped to another branch.

use crate::direction::{Direction, Residual};
use crate::invalid::InvalidInput;
use crate::linear::System;
use crate::metric::Metric;
use crate::newton::Work;
use crate::problem::BoundaryValueProblem;
use crate::solution::Solution;

use super::unfolding::{CONVERGED, Differentiated, Unfolding, unfolding_weights};

/// Branches nearer to each other than this cross, as far as the rounding of β can tell.
const CLOSED: f64 = 1e-5;

/// A gap that shrinks by this factor on a mesh twice as fine is one of the mesh and not of the problem: the order of collocation
/// makes it far more, and an imperfection stays.
const SHRINKS: f64 = 0.5;

/// A branch point belongs to a step if it lies between the ends, or beyond them by this share of the step.
const BEYOND: f64 = 0.05;

/// A branch point that was passed, and the null directions there.
pub(crate) struct PassedBranchPoint {
    pub solution: Solution,
    pub basis: [Direction; 2],
    /// Whether the unfolded system belongs to the point and its mesh.
    pub unfolded: bool,
}

/// The direction that belongs to the smallest singular value, nearly, from factors near a branch point: a second null direction.
pub(super) fn approximate_null_vector(system: &mut System) -> Result<Direction, InvalidInput> {
    let (mut residual, mut direction, integrals) =
        (system.zero_residual(), Direction::default(), system.dimensions().integrals);
    let Residual { left, right, border, .. } = &mut residual;
    let conditions = right.iter_mut().chain(&mut border[..integrals]).chain(left);
    conditions.zip(unfolding_weights()).for_each(|(row, weight)| *row = weight);
    system.solve(&residual, &mut direction)?;
    Ok(direction)
}

/// The step from one point to the next, which may have passed a branch point.
pub(super) struct StepPair<'a> {
    pub ends: [&'a Solution; 2],
    /// Where between them the branch point is to be expected.
    pub share: f64,
    pub tangent: &'a Direction,
    /// Nearly the other null direction.
    pub null: &'a Direction,
    /// Arclength.
    pub step: f64,
}

/// The branch point that a step has passed on a branch that goes straight on. The bordered determinants at the ends have
/// different signs. None if the step has changed to another branch, or if there is no simple branch point.
pub(super) fn branch_point(
    problem: &mut dyn BoundaryValueProblem,
    metric: &Metric,
    pair: &StepPair<'_>,
    kept: &mut Option<Unfolding>,
    work: &mut Work,
) -> Option<PassedBranchPoint> {
    let [from, to] = pair.ends;
    // Newton converges with differences as with the problem's own derivatives, to the same point.
    let unfolding = Unfolding::reuse_or_new(kept, problem.dimensions(), from.m, metric)?;
    let problem = &mut Differentiated::ByDifferences(problem);
    let mut found = None;
    for share in [pair.share, 0.5] {
        let mut y = between(pair.ends, share);
        let basis = [pair.tangent, pair.null].map(Clone::clone);
        let solved = unfolding.solve_from(problem, &mut y, basis);
        if solved.is_some() && is_within_step(distances(metric, from, &y, pair.tangent), pair.step) {
            found = Some(y);
            break;
        }
    }
    let found = found.and_then(|solution| {
        // The form may belong to an iterate farther away.
        if unfolding.roots().is_none() {
            unfolding.derive(problem, &solution).ok()?;
            unfolding.roots()?;
        }
        let basis = unfolding.basis.clone();
        let unfolded = unfolding.gap() < CLOSED;
        (unfolded || is_closed(unfolding, problem, &solution)).then_some(PassedBranchPoint {
            solution,
            basis,
            unfolded,
        })
    });
    *work += std::mem::take(&mut unfolding.work);
    problem.problem().prepare(&to.scalars);
    found
}

/// Whether the branches that cross at `y` in the unfolded problem, with a gap in the problem itself, cross there on a finer mesh.
fn is_closed(unfolding: &mut Unfolding, problem: &mut Differentiated<'_>, y: &Solution) -> bool {
    let gap = unfolding.gap();
    unfolding.on_halved(problem, y, CONVERGED).is_some() && unfolding.gap() < SHRINKS * gap
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
pub(crate) fn is_within_step([along, across]: [f64; 2], step: f64) -> bool {
    (-BEYOND * step..=(1.0 + BEYOND) * step).contains(&along) && across <= step
}
