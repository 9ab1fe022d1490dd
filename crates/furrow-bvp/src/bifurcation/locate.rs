//! Locates a singular point inside a bracket on a branch.

use crate::continuation::Continuation;
use crate::direction::LinearCondition;
use crate::metric;
use crate::problem::Directional;
use crate::solution::Solution;

pub use super::branch_point::branch_point;
use super::fold::Fold;
use super::minimally_augmented::{AugmentedReport, MinimallyAugmented};
use super::singularity::{SingularError, Singularity};

/// A singular point found, with the factors at it.
#[derive(Clone, Debug)]
pub struct Located<P, S> {
    /// Factors and directions at the point.
    pub augmented: MinimallyAugmented<P, S>,
    /// The point.
    pub solution: Solution,
    /// Its arclength along the branch, interpolated.
    pub arclength: f64,
    /// Estimated error of the parameter, see [`MinimallyAugmented::error_estimate`].
    pub error: f64,
    /// How Newton converged.
    pub report: AugmentedReport,
}

/// The fold in the last scalar unknown that the last step of a branch has passed, as
/// [`passed_fold`](crate::continuation::Advance::passed_fold) says.
///
/// # Errors
/// As [`between_last_points`].
pub fn last_fold<P: Directional + Clone>(branch: &mut Continuation<P>) -> Result<Located<P, Fold>, SingularError> {
    let after = branch.state.parameter_slope().signum();
    let parameter = branch.state.solution.scalars.len().saturating_sub(1);
    between_last_points(branch, Fold::new(parameter), [-after, after])
}

/// Finds the zero of `singularity` between the last points of a branch, where its sign changes from `signs[0]` to
/// `signs[1]`. The bracket is the last pair of neighbouring points with these signs (a caller that judges by factors of a
/// prediction may be a point late); Newton starts from points of the branch inside it, and it is halved until Newton
/// stays inside.
///
/// # Errors
/// The last error of Newton, if it leaves the bracket from all starts.
pub fn between_last_points<P: Directional + Clone, S: Singularity<P> + Clone>(
    branch: &mut Continuation<P>,
    singularity: S,
    signs: [f64; 2],
) -> Result<Located<P, S>, SingularError> {
    const HALVINGS: usize = 24;
    let state = &branch.state;
    let tangent = state.tangent.clone();
    let mut augmented = MinimallyAugmented::new(
        branch.problem.clone(),
        singularity,
        state.solution.m,
        branch.metric.clone(),
        &tangent,
    )?;
    let mut last = SingularError::Stalled { iterations: 0, correction: f64::NAN };
    let Some((mut now, mut later)) = state.history.back(0) else { return Err(last) };
    let (mut before, mut earlier) = state.history.back(1).ok_or(last)?;
    for k in 2.. {
        augmented.set_reference(&tangent);
        if augmented.sign_at(earlier)? * signs[0] > 0.0 {
            break;
        }
        let Some((position, y)) = state.history.back(k) else { break };
        (now, later, before, earlier) = (before, earlier, position, y);
    }
    // Position across the bracket: 0 at the earlier point, 1 at the later.
    let mut across = LinearCondition::default();
    branch.metric.plane_through(earlier, &tangent, &mut across);
    let span = metric::evaluate(&across, later) - across.value;
    let position = |y: &Solution| (metric::evaluate(&across, y) - across.value) / span;
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        let mut y = branch.state.solution.clone();
        branch.state.history.extrapolate(before + middle * (now - before), &mut y);
        branch.correct_across(&mut y, &tangent);
        let start = y.clone();
        augmented.set_reference(&tangent);
        match augmented.solve(&mut y, None) {
            Ok(report) if (low - 0.05..=high + 0.05).contains(&position(&y)) => {
                let arclength = before + position(&y) * (now - before);
                let error = augmented.error_estimate(&y, None);
                return Ok(Located { augmented, solution: y, arclength, error, report });
            }
            Ok(_) => {
                let position = position(&y);
                last = SingularError::Elsewhere { distance: (position - high).max(low - position) };
            }
            Err(error) => last = error,
        }
        augmented.set_reference(&tangent);
        if augmented.sign_at(&start)? * signs[0] > 0.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    Err(last)
}
