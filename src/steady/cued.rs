//! The branch of stationary shapes of a cell with a polarity cue, on the full contour.
//!
//! A cue breaks the mirror symmetry, and the pitchfork with it: the branch that grows out of the passive shape leans to one
//! side and, where the cell begins to divide, ends its stable part in a fold.

use super::asymmetric::NARROWEST;
use super::continuation::{Advance, Continuation, ContinuationSettings};
use super::stability::Stability;
use super::symmetric::{
    self, Branch, BranchEnd, BranchEvent, BranchOptions, FoldPoint, ShapePoint, SteadyError, fold_near, not_located,
};
use crate::cortex::{Control, Cortex, Cue, Domain, Numerics, Physics, shape};
use crate::numerics::System;
use crate::numerics::newton::{Newton, NewtonScratch};

/// The branch at ξ_s = 0, ready to be followed upwards. In a wide shell a weak cue moves the passive cell far: it is reached
/// from the passive shape without a cue, by parts of the cue where need be.
///
/// # Errors
/// [`SteadyError::Passive`], [`SteadyError::Cue`], [`SteadyError::Branch`].
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
    let passive = Physics { xi_s: 0.0, ..*physics };
    let mut cortex = Cortex::new(&passive, r0, cue, Domain::Full, &[]);
    let target = cortex.get(Control::CueAmplitude);
    let mut system = System::new(Cortex::dimensions_for(0), numerics.stages);
    let mut scratch = NewtonScratch::default();
    let mut y = shape::unfold(&system.gauss, &half);
    let (mut share, mut step) = (0.0, 1.0);
    while share < 1.0 {
        let next = f64::min(share + step, 1.0);
        cortex.set(Control::CueAmplitude, next * target);
        let mut trial = y.clone();
        match Newton::default().solve(&mut system, &mut scratch, &mut cortex, &mut trial, &[], false) {
            Ok(_) => (share, y) = (next, trial),
            Err(source) => {
                step *= 0.5;
                if step < 1e-3 {
                    return Err(SteadyError::Cue { r0, epsilon, source });
                }
            }
        }
    }
    symmetric::begin(y, &passive, r0, cue, Domain::Full, settings)
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
    let mut branch = start(physics, numerics, r0, cue, &options.settings)?;
    let mut stability = options.growth_rates.then(|| Stability::new(branch.state.solution.m));
    let (mut points, mut events) = (vec![ShapePoint::newest(&branch, 0, &mut stability)], Vec::new());
    let (mut failure, mut pinched) = (None, None);
    let ended = branch.follow(options.xi, options.points, |branch: &mut Continuation<Cortex>, advance: Advance| {
        let mut enough = false;
        if advance.passed_fold {
            match fold_near(branch) {
                Ok(fold) => {
                    enough = !wanted(&fold);
                    events.push(BranchEvent::Fold(Box::new(fold)));
                }
                Err(source) => failure = Some(not_located(branch, "fold", source)),
            }
        }
        points.push(ShapePoint::newest(branch, events.len(), &mut stability));
        let neck = shape::neck(&branch.system.gauss, &branch.state.solution);
        if neck.is_some_and(|neck| neck.radius < NARROWEST * r0) {
            pinched = Some(BranchEnd::Pinched(NARROWEST));
        }
        failure.is_none() && !enough && pinched.is_none()
    });
    Ok(Branch::complete(&branch, points, events, ended, pinched, failure))
}

/// Growth rates at a fold that ends a stable shape are none above this, in 1/τ: the mode of the fold itself neither grows
/// nor decays.
const MARGINAL: f64 = 1e-3;

/// The fold at which the last stable shape of the branch ends; above its ξ_s the cell divides. In a wide shell that is not
/// the first one, but that of the second rise of an S.
///
/// # Errors
/// [`SteadyError`]; `None` if no stable shape ends in a fold in the range.
pub fn failure_fold(
    physics: &Physics,
    numerics: &Numerics,
    r0: f64,
    cue: &Cue,
    options: &BranchOptions,
) -> Result<FoldPoint, SteadyError> {
    let Branch { events, stopped_by, .. } = follow(physics, numerics, r0, cue, options, |_| true)?;
    let cortex = Cortex::new(physics, r0, cue, Domain::Full, &[Control::Xi]);
    let mut stability = Stability::new(numerics.stages);
    let mut ends_stable = |fold: &FoldPoint| {
        fold.maximum && stability.growth_rate(&cortex, &fold.shape).is_ok_and(|rate| rate < MARGINAL)
    };
    let none = SteadyError::None { r0, epsilon: physics.epsilon, kind: "fold", xi_max: options.xi[1] };
    events
        .into_iter()
        .filter_map(|event| match event {
            BranchEvent::Fold(fold) => Some(*fold),
            BranchEvent::Pitchfork(_) => None,
        })
        .filter(|fold| ends_stable(fold))
        .max_by(|a, b| a.point.xi_s.total_cmp(&b.point.xi_s))
        .ok_or(stopped_by.unwrap_or(none))
}
