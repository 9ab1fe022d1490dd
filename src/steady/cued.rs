//! The branch of stationary shapes of a cell with a polarity cue, on the full contour.
//!
//! A cue breaks the mirror symmetry, and the pitchfork with it: the branch that grows out of the passive shape leans to one
//! side and, where the cell begins to divide, ends its stable part in a fold.

use super::asymmetric::{NARROWEST, furrow};
use super::continuation::{Advance, Continuation, ContinuationSettings};
use super::stability::Stability;
use super::symmetric::{
    Branch, BranchEnd, BranchEvent, BranchOptions, FoldPoint, ShapePoint, SteadyError, fold_near, mesh_monitor, metric,
};
use crate::cortex::{Control, Cortex, Cue, Domain, Numerics, Physics, shape};
use crate::numerics::Gauss;

/// The branch at ξ_s = 0, ready to be followed upwards.
///
/// # Errors
/// [`SteadyError::Passive`], [`SteadyError::Branch`].
pub fn start(
    physics: &Physics,
    numerics: &Numerics,
    r0: f64,
    cue: &Cue,
    settings: &ContinuationSettings,
) -> Result<Continuation<Cortex>, SteadyError> {
    let epsilon = physics.epsilon;
    let (half, _) =
        shape::passive(physics, numerics, r0).map_err(|source| SteadyError::Passive { r0, epsilon, source })?;
    let mut y = shape::unfold(&Gauss::new(half.m), &half);
    y.scalars.push(0.0);
    let controls = [Control::Xi];
    let cortex = Cortex::new(physics, r0, cue, Domain::Full, &controls);
    let metric = metric(r0, Domain::Full, &controls);
    let mut branch = Continuation::start(cortex, y, metric, settings.clone(), true)
        .map_err(|source| SteadyError::Branch { r0, epsilon, source })?;
    branch.monitor = Some(mesh_monitor);
    Ok(branch)
}

/// Follows the branch from ξ_s = 0 until ξ_s leaves its range or the neck is pinched, and locates its folds; `wanted` may
/// end it early, being shown every fold. A fold that cannot be located, or a branch that is lost, ends it with what came
/// before, and is kept in [`Branch::stopped_by`].
///
/// # Errors
/// [`SteadyError::Passive`], [`SteadyError::Branch`] at ξ_s = 0.
pub fn follow(
    physics: &Physics,
    numerics: &Numerics,
    r0: f64,
    cue: &Cue,
    options: &BranchOptions,
    mut wanted: impl FnMut(&FoldPoint) -> bool,
) -> Result<Branch, SteadyError> {
    let epsilon = physics.epsilon;
    let mut branch = start(physics, numerics, r0, cue, &options.settings)?;
    let gauss = branch.system.gauss.clone();
    let mut stability = options.growth_rates.then(|| Stability::new(gauss.m));
    let mut describe = |branch: &Continuation<Cortex>, passed: usize| {
        let (y, cortex) = (&branch.state.solution, &branch.problem);
        ShapePoint {
            delta_u: furrow(&gauss, cortex, y),
            arclength: branch.state.arclength,
            passed,
            growth_rate: stability.as_mut().and_then(|stability| stability.growth_rate(cortex, y).ok()),
            ..ShapePoint::of(y, cortex, &gauss)
        }
    };
    let (mut points, mut events, mut failure) = (vec![describe(&branch, 0)], Vec::new(), None);
    let mut pinched = None;
    let ended = branch.follow(options.xi, options.points, |branch: &mut Continuation<Cortex>, advance: Advance| {
        let mut enough = false;
        if advance.passed_fold {
            match fold_near(branch) {
                Ok(mut fold) => {
                    fold.point.delta_u = furrow(&branch.system.gauss, &branch.problem, &fold.shape);
                    enough = !wanted(&fold);
                    events.push(BranchEvent::Fold(Box::new(fold)));
                }
                Err(source) => {
                    let xi_s = branch.state.parameter();
                    failure = Some(SteadyError::Point { r0, epsilon, kind: "fold", xi_s, source });
                }
            }
        }
        points.push(describe(branch, events.len()));
        let neck = shape::neck(&branch.system.gauss, &branch.state.solution);
        if neck.is_some_and(|neck| neck.radius < NARROWEST * r0) {
            pinched = Some(BranchEnd::Pinched(NARROWEST));
        }
        failure.is_none() && !enough && pinched.is_none()
    });
    let ended = ended.map(|ended| BranchEnd::of(ended, pinched)).unwrap_or_else(|source| {
        failure = Some(SteadyError::Branch { r0, epsilon, source });
        BranchEnd::Stopped
    });
    Ok(Branch { points, events, ended, stopped_by: failure, work: branch.work })
}

/// The first fold of the branch: where the weakly furrowed shape that grows out of the passive one ends.
///
/// # Errors
/// [`SteadyError`]; `None` if ξ_s does not turn back in the range.
pub fn first_fold(
    physics: &Physics,
    numerics: &Numerics,
    r0: f64,
    cue: &Cue,
    options: &BranchOptions,
) -> Result<FoldPoint, SteadyError> {
    let Branch { mut events, stopped_by, .. } = follow(physics, numerics, r0, cue, options, |_| false)?;
    match (events.pop(), stopped_by) {
        (Some(BranchEvent::Fold(fold)), _) => Ok(*fold),
        (_, Some(error)) => Err(error),
        _ => Err(SteadyError::None { r0, epsilon: physics.epsilon, kind: "fold", xi_max: options.xi[1] }),
    }
}
