//! Folds and pitchforks, located between the last two points of a branch.

use furrow_bvp::normal_form::pitchfork_normal_form;
use furrow_bvp::{
    BoundaryValueProblem, CollocationPoint, Continuation, Direction, Fold, SingularError, Solution, SymmetryBreaking,
    locate,
};

use super::branch::{BranchEnd, FoldPoint, Pitchfork};
use super::error::{CellName, PointKind, ShapeError};
use super::point::{ShapePoint, XI};
use crate::cortex::Cortex;
use crate::cortex::equations::{J, LENGTH, M, PHI, PSI, Q, R, REGULATED};

/// The fold between the last two points of a continuation.
///
/// # Errors
/// [`SingularError`].
pub fn fold_near(branch: &mut Continuation<Cortex>) -> Result<FoldPoint, SingularError> {
    // Past a maximum ξ_s falls.
    let maximum = branch.state.parameter_slope() < 0.0;
    let signs = if maximum { [1.0, -1.0] } else { [-1.0, 1.0] };
    let found = locate::between_last_points(branch, Fold::new(XI), signs)?;
    let of = ShapePoint::of(&found.solution, &found.augmented.problem, &found.augmented.system.gauss);
    let point = ShapePoint { arclength: found.arclength, ..of };
    Ok(FoldPoint { point, maximum, report: found.report, shape: found.solution })
}

/// The pitchfork between the last two points of a continuation of symmetric shapes, where the antisymmetric determinant
/// changes sign as given.
///
/// # Errors
/// [`SingularError`].
pub fn pitchfork_near(branch: &mut Continuation<Cortex>, signs: [f64; 2]) -> Result<Pitchfork, SingularError> {
    let mut found = locate::between_last_points(branch, SymmetryBreaking::default(), signs)?;
    let (at, y) = (&mut found.augmented, found.solution);
    let form = pitchfork_normal_form(at, &y)?;
    let furrow_shift = furrow_shift(&at.problem, &y, &at.singularity.null);
    Ok(Pitchfork {
        point: ShapePoint { arclength: found.arclength, ..ShapePoint::of(&y, &at.problem, &at.system.gauss) },
        coefficient: form.parameters[0] / (furrow_shift * furrow_shift),
        report: found.report,
        null: at.singularity.null.clone(),
        furrow_shift,
        shape: y,
    })
}

/// Displacement of the furrow, the minimum of the meridional curvature c1 at the equator, per unit of the antisymmetric
/// direction φ: −∂_u δc1/∂_uu c1. With c1 = m/κ − c2, c2_s = (cosψ/r)(c1 − c2) and κ_s = 0, at the equator
///
/// * δc1_s = δq/κ + δψ (c1 − c2)/r, c1_ss = q_s/κ − m κ_ss/κ² + c1(c1 − c2)/r.
pub fn furrow_shift(cortex: &Cortex, y: &Solution, null: &Direction) -> f64 {
    let last = y.intervals();
    let state = y.node(last);
    let length = y.scalars[LENGTH];
    let here = cortex.constants().of_state(0.5, state, length);
    let kappa = here.kappa;
    let mut kappa_ss = cortex.constants().rigidity_curvature(0.5, length) / (length * length);
    let (mut f, mut g) = ([0.0; REGULATED], [0.0]);
    let f = &mut f[..y.components];
    cortex.rhs(CollocationPoint { x: 0.5, index: 0 }, state, &y.scalars, f, &mut g);
    let phi = &null.nodes[last * y.components..];
    // An antisymmetric change leaves φ at the equator, and turns its slope j.
    let mut kappa_turn = 0.0;
    if y.components == REGULATED {
        let (_, by_phi) = cortex.constants().regulated_by_phi(cortex.constants().at(0.5, length), state[PHI], 0.0);
        kappa_ss += by_phi.kappa * f[J] / length;
        kappa_turn = by_phi.kappa * phi[J];
    }
    let c2 = 1.0 / state[R];
    let c1 = state[M] / kappa - c2;
    debug_assert!((state[PSI] - std::f64::consts::FRAC_PI_2).abs() < 1e-6);
    let change = phi[Q] / kappa + phi[PSI] * (c1 - c2) / state[R] - state[M] * kappa_turn / (kappa * kappa);
    let bend = f[Q] / length / kappa - state[M] * kappa_ss / (kappa * kappa) + c1 * (c1 - c2) / state[R];
    -change / bend / length
}

/// A singular point near the newest point of a branch that cannot be located.
pub(super) fn not_located(branch: &Continuation<Cortex>, kind: PointKind, source: SingularError) -> BranchEnd {
    let cell = CellName::of(&branch.problem.cell);
    BranchEnd::NotLocated(ShapeError::Point { cell, kind, xi_s: branch.state.parameter(), source })
}
