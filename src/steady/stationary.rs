//! One stationary shape: the first one at a given activity on the branch that starts at the passive shape.

use super::continuation::{ContinuationError, ContinuationSettings, Ended};
use super::cued;
use super::stability::{Spectrum, Stability, StabilityError};
use super::symmetric::{self, SteadyError};
use crate::cortex::equations::{COMPONENTS, R};
use crate::cortex::{Cortex, Cue, Domain, Numerics, Physics, shape};
use crate::numerics::newton::{Newton, NewtonScratch};
use crate::numerics::{Gauss, Solution, System};

/// A stationary shape of one cell.
#[derive(Clone, Debug)]
pub struct Stationary {
    /// The cell; its domain says which part of the contour `solution` is.
    pub cortex: Cortex,
    /// The shape with (L, p): the mirror-symmetric half without a cue, the whole contour with one.
    pub solution: Solution,
    /// ξ_s where the branch turned back on the way here.
    pub folds: Vec<f64>,
}

/// Why there is no such shape.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum StationaryError {
    /// The branch could not be followed.
    #[error(transparent)]
    Branch(#[from] SteadyError),
    /// The branch never reaches the activity asked for.
    #[error(
        "R0 = {r0}, epsilon = {epsilon}: no stationary shape at xi_s = {xi_s} on the branch of the passive shape, which turns back at xi_s = {turn}"
    )]
    OutOfReach {
        /// Radius R0.
        r0: f64,
        /// Confinement ε.
        epsilon: f64,
        /// ξ_s asked for.
        xi_s: f64,
        /// ξ_s furthest reached.
        turn: f64,
    },
    /// The branch ends before it reaches the activity asked for.
    #[error(
        "R0 = {r0}, epsilon = {epsilon}: the branch of the passive shape could not be followed to xi_s = {xi_s}: {reason}"
    )]
    Unfinished {
        /// Radius R0.
        r0: f64,
        /// Confinement ε.
        epsilon: f64,
        /// ξ_s asked for.
        xi_s: f64,
        /// What ended it.
        reason: String,
    },
}

/// Most points of a branch followed for one shape.
const MOST_POINTS: usize = 400;
/// Beyond a fold, a branch whose waist falls below this fraction of R0 leads to pinched shapes and is left there.
const PINCHING: f64 = 0.25;

/// The narrowest waist, or the largest radius of a contour without one.
fn waist(gauss: &Gauss, y: &Solution, domain: Domain) -> f64 {
    let widest = || y.stages.chunks_exact(COMPONENTS).map(|s| s[R]).fold(0.0, f64::max);
    match domain {
        Domain::Half => y.node(y.intervals())[R],
        Domain::Full => shape::neck(gauss, y).map_or_else(widest, |neck| neck.radius),
    }
}

/// The first stationary shape at ξ_s = `physics.xi_s` along the branch of the passive shape. Without a cue that is the
/// mirror-symmetric branch.
///
/// # Errors
/// [`StationaryError`]; `OutOfReach` when the cell has no such shape, as one that must divide.
pub fn stationary(physics: &Physics, numerics: &Numerics, r0: f64, cue: &Cue) -> Result<Stationary, StationaryError> {
    let mut last = None;
    // Landing on ξ_s extrapolates over a step of the branch: shorter steps where that fails.
    for max_step in [3.0, 0.6, 0.1] {
        match along_branch(physics, numerics, r0, cue, max_step) {
            Err(error @ StationaryError::Unfinished { .. }) => last = Some(error),
            other => return other,
        }
    }
    let (epsilon, xi_s) = (physics.epsilon, physics.xi_s);
    let reason = "no step is short enough".to_owned();
    Err(last.unwrap_or(StationaryError::Unfinished { r0, epsilon, xi_s, reason }))
}

fn along_branch(
    physics: &Physics,
    numerics: &Numerics,
    r0: f64,
    cue: &Cue,
    max_step: f64,
) -> Result<Stationary, StationaryError> {
    let (epsilon, xi_s) = (physics.epsilon, physics.xi_s);
    let settings = ContinuationSettings { first_step: 0.3f64.min(max_step), max_step, ..Default::default() };
    let mut branch = match cue {
        Cue::None => symmetric::start(physics, numerics, r0, &settings)?,
        Cue::Kappa { .. } => cued::start(physics, numerics, r0, cue, &settings)?,
    };
    let domain = branch.problem.domain;
    let mut folds = Vec::new();
    if xi_s != 0.0 {
        if xi_s < 0.0 {
            branch.reverse();
        }
        let range = if xi_s > 0.0 { [f64::MIN_POSITIVE, xi_s] } else { [xi_s, -f64::MIN_POSITIVE] };
        let (mut furthest, mut before) = (0.0f64, 0.0);
        let ended = branch.follow(range, MOST_POINTS, |branch, advance| {
            let here = branch.state.parameter();
            if here.abs() > furthest.abs() {
                furthest = here;
            }
            if advance.passed_fold {
                // The exact fold, or else the nearest point to it.
                folds.push(symmetric::fold_near(branch).map_or(before, |fold| fold.point.xi_s));
            }
            before = here;
            folds.is_empty() || waist(&branch.system.gauss, &branch.state.solution, domain) > PINCHING * r0
        });
        let turn = folds.iter().copied().fold(furthest, |a, b| if b.abs() > a.abs() { b } else { a });
        match ended {
            Ok(Ended::ParameterBound(bound)) if bound == xi_s => {}
            _ if !folds.is_empty() => return Err(StationaryError::OutOfReach { r0, epsilon, xi_s, turn }),
            Err(ContinuationError::Lost { reason, parameter, .. }) => {
                let reason = format!("lost at xi_s = {parameter}: {reason}");
                return Err(StationaryError::Unfinished { r0, epsilon, xi_s, reason });
            }
            other => {
                let reason = format!("{other:?}");
                return Err(StationaryError::Unfinished { r0, epsilon, xi_s, reason });
            }
        }
    }
    let mut cortex = Cortex::new(physics, r0, cue, branch.problem.domain, &[]);
    let mut solution = branch.state.solution;
    solution.scalars.truncate(2);
    let mut system = System::new(Cortex::dimensions_for(0), numerics.stages);
    // To rounding; at a fold itself the branch's own accuracy has to do.
    let newton = Newton { tolerance: 1e-12, max_factorisations: 4, ..Newton::default() };
    let mut polished = solution.clone();
    if newton.solve(&mut system, &mut NewtonScratch::default(), &mut cortex, &mut polished, &[], false).is_ok() {
        solution = polished;
    }
    Ok(Stationary { cortex, solution, folds })
}

impl Stationary {
    /// Contour length L.
    pub fn length(&self) -> f64 {
        self.solution.scalars[0]
    }

    /// Pressure p.
    pub fn pressure(&self) -> f64 {
        self.solution.scalars[1]
    }

    /// Elongation H = (z(0) − z(1))/R0.
    pub fn elongation(&self) -> f64 {
        shape::elongation(&self.solution, self.cortex.domain, self.cortex.r0)
    }

    /// Radius at u = ½, in L_h.
    pub fn equator_radius(&self) -> f64 {
        shape::equator_radius(&Gauss::new(self.solution.m), &self.solution)
    }

    /// The rightmost growth rates.
    ///
    /// # Errors
    /// As [`Stability::leading`].
    pub fn spectrum(&self) -> Result<Spectrum, StabilityError> {
        Stability::new(self.solution.m).leading(&self.cortex, &self.solution)
    }
}
