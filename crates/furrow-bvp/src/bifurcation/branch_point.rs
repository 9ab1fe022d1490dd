//! Simple branch points: where they are, which directions the branches have there, and how they cross.
//!
//! A direction α₁b₁ + α₂b₂ of a branch fulfils the algebraic bifurcation equation Σ ψD²F\[b_j, b_k\] α_jα_k = 0 (N.20) with
//! the left null vector ψ. Along the branch with tangent τ, x = x* + aτ + a²η + O(a³):
//!
//! * O(a²): Jη = −½ D²F\[τ, τ\], up to multiples of the tangents; η = η₀ + sσ with the tangent σ of the other branch
//! * O(a³): ψ(D²F\[τ, η\] + ⅙ D³F\[τ, τ, τ\]) = 0, which gives s (as N.11)
//!
//! The parameter's component of η tells to which side a pitchfork opens.

use crate::continuation::{Continuation, Differentiated, PassedBranchPoint, Unfolding, distances, is_within_step};
use crate::direction::{Direction, Residual};
use crate::invalid::InvalidInput;
use crate::mesh::error_of_change;
use crate::problem::Directional;
use crate::problem::derivatives::{power_residuals, second_residual};
use crate::solution::Solution;

use super::singularity::SingularError;

/// How the branches cross at a branch point, as seen in the parameter λ.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BranchPointKind {
    /// λ changes along both branches.
    Transcritical,
    /// λ has an extremum along one of the branches, which exists for larger λ.
    SupercriticalPitchfork,
    /// λ has an extremum along one of the branches, which exists for smaller λ.
    SubcriticalPitchfork,
}

/// A simple branch point: two branches cross.
///
/// # Examples
/// A rod u″ + λ sin u = 0, u(0) = u(1) = 0 buckles at λ = π². `Oscillator` is in `examples/problems/oscillator.rs`.
///
/// ```
/// # mod oscillator { include!(concat!(env!("CARGO_MANIFEST_DIR"), "/examples/problems/oscillator.rs")); }
/// # use oscillator::Oscillator;
/// use furrow_bvp::{BranchPointKind, Continuation, ContinuationSettings, Metric, locate};
/// let problem = Oscillator::elastica(0);
/// let (guess, metric) = (problem.zero(1.0, 20, 4, 5.0), Metric::unit(2, 1));
/// let settings = ContinuationSettings::default();
/// let mut straight = Continuation::start(problem.clone(), guess, metric.clone(), settings.clone(), true)?;
/// straight.follow([0.0, 20.0], 100, |_, advance| !advance.passed_branch_point)?;
/// let point = locate::branch_point(&mut straight)?;
/// assert!((point.parameter() - std::f64::consts::PI.powi(2)).abs() < 1e-8);
/// assert_eq!(point.kind(), BranchPointKind::SupercriticalPitchfork);
///
/// // The buckled rod, to one side.
/// let state = point.switch(&mut straight, true)?;
/// let mut buckled = Continuation::resume(problem, state, metric, settings);
/// buckled.follow([0.0, 20.0], 100, |_, _| true)?;
/// assert!(buckled.state.solution.nodes[1].abs() > 5.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct BranchPoint {
    /// The point.
    pub solution: Solution,
    /// Its arclength along the branch, by projection on the tangent.
    pub arclength: f64,
    /// Unit tangents of the branch that was followed and of the one that crosses it.
    pub tangents: [Direction; 2],
    /// ½ d²λ/ds² along both branches.
    pub curvatures: [f64; 2],
    /// Estimated error of λ, by the change where the intervals are halved; infinite if the point is not found there.
    pub error: f64,
    /// Distance between the two branches next to the point: what rounding and the mesh leave of 0.
    pub gap: f64,
}

/// An estimate of the error needs no further iteration after a correction below this: the next is about its square.
const ROUGH: f64 = 1e-3;

/// Ratio of the slopes of λ at which one of the branches is taken to have an extremum there.
const EXTREMUM: f64 = 1e-6;

impl BranchPoint {
    /// λ at the point.
    pub fn parameter(&self) -> f64 {
        self.solution.scalars[self.solution.scalars.len() - 1]
    }

    /// dλ/ds along both branches.
    pub fn slopes(&self) -> [f64; 2] {
        [0, 1].map(|k| self.tangents[k].scalars[self.solution.scalars.len() - 1])
    }

    /// Transcritical, or a pitchfork to either side.
    pub fn kind(&self) -> BranchPointKind {
        let [first, second] = self.slopes().map(f64::abs);
        if first.min(second) > EXTREMUM * first.max(second) {
            return BranchPointKind::Transcritical;
        }
        if self.curvatures[usize::from(second < first)] > 0.0 {
            BranchPointKind::SupercriticalPitchfork
        } else {
            BranchPointKind::SubcriticalPitchfork
        }
    }
}

/// The branch point that the last step of a branch has passed ([`Advance::passed_branch_point`]), by Newton on an extended
/// system that is regular there.
///
/// [`Advance::passed_branch_point`]: crate::continuation::Advance::passed_branch_point
///
/// # Errors
/// [`SingularError::Stalled`] if Newton does not converge, [`SingularError::Elsewhere`] if it leads to a point outside the last
/// step, [`SingularError::Singular`] if the two branches touch there, or more than two meet.
pub fn branch_point<P: Directional>(branch: &mut Continuation<P>) -> Result<BranchPoint, SingularError> {
    let singular = SingularError::Singular { iterations: 0 };
    let Continuation { problem, metric, state, work, passed, unfolding, .. } = branch;
    let (before, from) = state.history.back(1).ok_or(singular)?;
    let dims = problem.dimensions();
    let unfolding = Unfolding::reuse_or_new(unfolding, dims, from.m, metric).ok_or(singular)?;
    let mut y = passed.as_ref().map_or(&state.solution, |passed| &passed.solution).clone();
    let solved = match passed {
        Some(PassedBranchPoint { unfolded: true, .. }) => Some(()),
        Some(passed) => unfolding.solve_from(&mut Differentiated::Exactly(problem), &mut y, passed.basis.clone()),
        None => unfolding.solve(&mut Differentiated::Exactly(problem), &mut y, &state.tangent),
    };
    let spent = std::mem::take(&mut unfolding.work);
    *work += spent;
    if solved.is_none() {
        return Err(SingularError::Stalled { iterations: spent.iterations, correction: f64::NAN });
    }
    unfolding.derive(&mut Differentiated::Exactly(problem), &y)?;
    let (step, place) = (state.arclength - before, distances(metric, from, &y, &state.tangent));
    if !is_within_step(place, step) {
        return Err(SingularError::Elsewhere { distance: (place[0] / step - 1.0).abs().max(place[1] / step) });
    }
    let (tangents, mixed) = unfolding.crossing(&y.mesh, &state.tangent).ok_or(singular)?;
    let [first, second] = &tangents;
    let curvatures = [
        curvature(unfolding, problem, &y, [first, second], mixed)?,
        curvature(unfolding, problem, &y, [second, first], mixed)?,
    ];
    if curvatures.iter().any(|c| !c.is_finite()) {
        problem.prepare(&state.solution.scalars);
        return Err(singular);
    }
    let gap = unfolding.gap();
    let last = y.scalars.len() - 1;
    let refined = unfolding.on_halved(&mut Differentiated::Exactly(problem), &y, ROUGH);
    let error = refined.map_or(f64::INFINITY, |refined| error_of_change(refined.scalars[last] - y.scalars[last], y.m));
    *work += std::mem::take(&mut unfolding.work);
    problem.prepare(&state.solution.scalars);
    if let Some(passed) = passed {
        // The unfolded system now belongs to the finer mesh.
        passed.unfolded = false;
    }
    Ok(BranchPoint { arclength: before + place[0], tangents, curvatures, error, gap, solution: y })
}

/// ½ d²λ/ds² along the first of the tangents, the parameter's component of η; `mixed` is the product of both.
fn curvature(
    unfolding: &mut Unfolding,
    problem: &mut dyn Directional,
    y: &Solution,
    [along, other]: [&Direction; 2],
    mixed: f64,
) -> Result<f64, InvalidInput> {
    let [mut square, mut cube, mut rest] = [(); 3].map(|()| Residual::default());
    let (mut response, gauss) = (Direction::default(), unfolding.system.gauss.clone());
    power_residuals(&gauss, problem, y, along, CONDITIONS, [&mut square, &mut cube]);
    unfolding.respond(&square, &mut response)?;
    response.scale(0.5);
    second_residual(&gauss, problem, y, [along, &response], CONDITIONS, &mut rest);
    rest.add(1.0 / 6.0, &cube);
    response.add(-unfolding.project(&rest)? / mixed, other);
    // An arclength has its curvature across the tangent.
    let rest = unfolding.metric.dot(&y.mesh, along, &response);
    response.add(-rest, along);
    Ok(response.scalars[y.scalars.len() - 1])
}

/// Linear conditions that border the unfolded problem.
const CONDITIONS: usize = 2;
