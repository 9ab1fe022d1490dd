//! Location of folds and pitchforks between the last two points of a branch.

use furrow_bvp::locate::{self, Located};
use furrow_bvp::normal_form::pitchfork_normal_form;
use furrow_bvp::{
    BoundaryValueProblem, CollocationPoint, Continuation, Direction, Fold, Gauss, MinimallyAugmented, SingularError,
    Singularity, Solution, SymmetryBreaking, mesh,
};

use super::branch::{BranchEnd, FoldPoint, Pitchfork};
use super::curves::along_scalar;
use super::error::{CellName, PointKind, ShapeError};
use super::point::{ShapePoint, XI};
use crate::cortex::equations::{J, LENGTH, M, PHI, PSI, Q, R, REGULATED};
use crate::cortex::lanes::sin_cos;
use crate::cortex::{Cortex, Domain, observables};
use crate::law;

/// The folds between the last two points of a continuation. `passed` says whether ξ_s has turned an odd number of times
/// in the step; `before` is [arclength, ξ_s, dξ_s/ds] at its start.
///
/// # Errors
/// [`SingularError`].
pub(super) fn folds_near(
    branch: &mut Continuation<Cortex>,
    before: [f64; 3],
    passed: bool,
) -> Result<Vec<FoldPoint>, SingularError> {
    match passed {
        true => Ok(vec![fold_near(branch)?]),
        false => two_folds(branch, before),
    }
}

/// The fold between the last two points of a continuation.
///
/// # Errors
/// [`SingularError`].
pub fn fold_near(branch: &mut Continuation<Cortex>) -> Result<FoldPoint, SingularError> {
    // Beyond a maximum ξ_s decreases.
    fold_between(branch, branch.state.parameter_slope() < 0.0)
}

fn fold_between(branch: &mut Continuation<Cortex>, maximum: bool) -> Result<FoldPoint, SingularError> {
    let signs = if maximum { [1.0, -1.0] } else { [-1.0, 1.0] };
    let found = confirmed(locate::between_last_points(branch, Fold::new(XI), signs)?, Fold::new(XI))?;
    let of = ShapePoint::of(&found.solution, &found.augmented.problem, &found.augmented.system.gauss);
    let point = ShapePoint { arclength: found.arclength, ..of };
    Ok(FoldPoint { point, maximum, error: found.error, report: found.report, shape: found.solution })
}

/// Two folds in one step are looked for if the parabola of dξ_s/ds falls below the first share of its smaller end value
/// within the step, and the slope of the polynomial through the previous points below the second.
const DIP: [f64; 2] = [0.5, 0.75];
/// Half of the fraction of a step over which that polynomial's slope is taken.
const NEAR: f64 = 0.01;

/// The two folds that one step has passed, if any: the tangents at its ends do not show them.
fn two_folds(
    branch: &mut Continuation<Cortex>,
    [start, from, slope]: [f64; 3],
) -> Result<Vec<FoldPoint>, SingularError> {
    let state = &branch.state;
    let (length, now) = (state.arclength - start, state.parameter_slope());
    // dξ_s/ds as the parabola with its values at the ends and its mean.
    let mean = (state.parameter() - from) / length;
    let (linear, square) = (6.0 * mean - 4.0 * slope - 2.0 * now, 3.0 * slope + 3.0 * now - 6.0 * mean);
    let turn = -0.5 * linear / square;
    let least = slope + 0.5 * linear * turn;
    let falls = |least: f64, share: f64| least * now.signum() < share * slope.abs().min(now.abs());
    if !(turn > 0.0 && turn < 1.0 && falls(least, DIP[0]) && slope * now > 0.0) {
        return Ok(Vec::new());
    }
    let (at, newest) = (start + turn * length, state.solution.clone());
    let mut between = newest.clone();
    let [before, after] = [-NEAR, NEAR].map(|off| {
        state.history.extrapolate(at + off * length, &mut between);
        between.scalars[XI]
    });
    if !falls((after - before) / (2.0 * NEAR * length), DIP[1]) {
        return Ok(Vec::new());
    }
    let (end, tangent) = (state.arclength, state.tangent.clone());
    state.history.extrapolate(at, &mut between);
    branch.correct_across(&mut between, &tangent);
    let (cortex, metric) = (branch.problem.clone(), branch.metric.clone());
    let mut fold = MinimallyAugmented::new(cortex, Fold::new(XI), newest.m, metric, &tangent)?;
    if fold.sign_at(&between)? * now > 0.0 {
        return Ok(Vec::new());
    }
    branch.state.history.replace_newest(at, &between);
    let first = fold_between(branch, now > 0.0);
    branch.state.history.push(end, &newest);
    let second = fold_between(branch, now < 0.0);
    // Predicted tangents may suggest two folds where there is only one ahead, which the next step passes.
    Ok(first.ok().zip(second.ok()).map_or_else(Vec::new, |(first, second)| vec![first, second]))
}

/// [arclength, ξ_s, dξ_s/ds] at the newest point.
pub(super) fn course(branch: &Continuation<Cortex>) -> [f64; 3] {
    [branch.state.arclength, branch.state.parameter(), branch.state.parameter_slope()]
}

/// If the newest shape of a branch is narrower than `limit`, in R0, ends the branch at the shape of this width between
/// the last two points, if there is one: the newest shape depends on the length of the steps.
pub(super) fn end_at_width(branch: &mut Continuation<Cortex>, limit: f64) -> Option<BranchEnd> {
    if let Some(source) = law::short_waves(&branch.problem, &branch.state.solution) {
        return Some(BranchEnd::CannotHold(ShapeError::Law { cell: CellName::of(&branch.problem.cell), source }));
    }
    let (gauss, domain) = (branch.system.gauss.clone(), branch.problem.domain);
    let scale = limit * branch.problem.cell.r0;
    let excess = |y: &Solution| narrowest(&gauss, y, domain).map_or(f64::INFINITY, |width| (width / scale).ln());
    ended(branch, CLOSE, excess).then_some(BranchEnd::Pinched(limit))
}

/// If the reduced volume has fallen to that at which the branch is to end since the point before, ends it at the shape of that reduced
/// volume between the last two points.
pub(super) fn deflated(branch: &mut Continuation<Cortex>, until: Option<f64>) -> Option<BranchEnd> {
    let until = until?;
    let (gauss, cortex) = (branch.system.gauss.clone(), branch.problem.clone());
    let excess = |y: &Solution| {
        let [area, _] = observables::area_and_bending(&gauss, &cortex, y);
        (observables::reduced_volume(cortex.cell.r0, area) / until).ln()
    };
    // A branch that begins below may rise first.
    let above = branch.state.history.back(1).is_some_and(|(_, earlier)| excess(earlier) >= 0.0);
    (above && ended(branch, CLOSE, excess)).then_some(BranchEnd::Deflated(until))
}

/// If the branch passes ξ_s between its last but one point and a fold in its last step, moves its newest point there.
pub(super) fn reached_before(branch: &mut Continuation<Cortex>, fold: &FoldPoint, xi_s: f64) -> bool {
    let towards = if fold.maximum { 1.0 } else { -1.0 };
    let short = |y: &Solution| (xi_s - y.scalars[XI]) * towards;
    let begins_short = branch.state.history.back(1).is_some_and(|(_, earlier)| short(earlier) >= 0.0);
    if !(begins_short && short(&fold.shape) < 0.0) {
        return false;
    }
    (branch.state.solution, branch.state.arclength) = (fold.shape.clone(), fold.point.arclength);
    branch.state.history.replace_newest(fold.point.arclength, &fold.shape);
    ended(branch, 1e-12 * (1.0 + xi_s.abs()), short)
}

/// Relative accuracy of the width and of the reduced volume at which a branch ends.
const CLOSE: f64 = 1e-6;

/// Whether a quantity of the newest shape of a branch is below 0; the shape at 0 between the last two points, within `close`, then
/// replaces the newest, if there is one.
fn ended(branch: &mut Continuation<Cortex>, close: f64, excess: impl Fn(&Solution) -> f64) -> bool {
    const MOST: usize = 30;
    let beyond = excess(&branch.state.solution);
    if beyond >= 0.0 {
        return false;
    }
    let Some((before, earlier)) = branch.state.history.back(1) else { return true };
    let mut ends = [(before, excess(earlier)), (branch.state.arclength, beyond)];
    let (tangent, mut y) = (branch.state.tangent.clone(), branch.state.solution.clone());
    for count in 0..MOST {
        let [(low, above), (high, below)] = ends;
        let secant = (low * below - high * above) / (below - above);
        let at = if count % 3 < 2 && secant.is_finite() { secant } else { 0.5 * (low + high) };
        branch.state.history.extrapolate(at, &mut y);
        branch.correct_across(&mut y, &tangent);
        let found = excess(&y);
        if found.abs() < close {
            (branch.state.solution, branch.state.arclength) = (y, at);
            break;
        }
        ends[usize::from(found < 0.0)] = (at, found);
    }
    true
}

/// The pitchfork between the last two points of a continuation of symmetric shapes, where the antisymmetric determinant
/// changes sign as given.
///
/// # Errors
/// [`SingularError`].
pub(crate) fn pitchfork_near(branch: &mut Continuation<Cortex>, signs: [f64; 2]) -> Result<Pitchfork, SingularError> {
    let found = locate::between_last_points(branch, SymmetryBreaking::default(), signs)?;
    pitchfork_at(confirmed(found, SymmetryBreaking::default())?)
}

/// A shape narrower than this, in R0, may need a finer mesh than its branch.
const NARROW: f64 = 0.05;
/// Largest relative change of ξ_s on a finer mesh; a singular point that moves further is an artefact of the mesh.
const MOVES: f64 = 1e-2;

/// A singular point of a narrow shape, recomputed on halved intervals; other points are unchanged.
fn confirmed<S: Singularity<Cortex>>(
    found: Located<Cortex, S>,
    singularity: S,
) -> Result<Located<Cortex, S>, SingularError> {
    let Located { augmented: MinimallyAugmented { problem, system, metric, .. }, solution: coarse, arclength, .. } =
        &found;
    if narrowest(&system.gauss, coarse, problem.domain).is_none_or(|radius| radius > NARROW * problem.cell.r0) {
        return Ok(found);
    }
    let mut solution = coarse.on_mesh(&system.gauss, &mesh::halved(&coarse.mesh));
    // The contour length changes along every branch near its singular points.
    let along = along_scalar(&solution, solution.scalars.len(), LENGTH);
    let mut augmented = MinimallyAugmented::new(problem.clone(), singularity, solution.m, metric.clone(), &along)?;
    let report = augmented.solve(&mut solution, None)?;
    let [from, to] = [coarse, &solution].map(|y| y.scalars[XI]);
    let error = (to - from).abs();
    if error > MOVES * (1.0 + from.abs()) {
        return Err(SingularError::Stalled { iterations: report.iterations, correction: error });
    }
    Ok(Located { augmented, solution, arclength: *arclength, error, report })
}

/// Radius of the narrowest place of a contour away from its poles, if there is one.
pub(super) fn narrowest(gauss: &Gauss, y: &Solution, domain: Domain) -> Option<f64> {
    let neck = observables::neck(gauss, y).map(|neck| neck.radius);
    match domain {
        // The equator of a half contour, or a furrow beside it.
        Domain::Half => Some(neck.unwrap_or(f64::INFINITY).min(y.node(y.intervals())[R])),
        Domain::Full => neck,
    }
}

/// The observables and the normal form of a located pitchfork.
pub(super) fn pitchfork_at(found: Located<Cortex, SymmetryBreaking>) -> Result<Pitchfork, SingularError> {
    let Located { augmented: mut at, solution: y, arclength, error, report } = found;
    let form = pitchfork_normal_form(&mut at, &y)?;
    let furrow_shift = furrow_shift(&at.problem, &y, &at.singularity.null);
    Ok(Pitchfork {
        point: ShapePoint { arclength, ..ShapePoint::of(&y, &at.problem, &at.system.gauss) },
        coefficient: form.parameters[0] / (furrow_shift * furrow_shift),
        error,
        report,
        null: at.singularity.null.clone(),
        furrow_shift,
        beyond_fold: None,
        shape: y,
    })
}

/// Displacement of the furrow, the minimum of the meridional curvature c1 at the equator, per unit of the antisymmetric
/// direction φ: −∂_u δc1/∂_uu c1. With c1 = m/κ + C0 − c2, c2_s = (cosψ/r)(c1 − c2) and κ_s = 0, at the equator
///
/// * δc1_s = δq/κ + δψ (c1 − c2)/r, c1_ss = q_s/κ − m κ_ss/κ² + c1(c1 − c2)/r.
pub(crate) fn furrow_shift(cortex: &Cortex, y: &Solution, null: &Direction) -> f64 {
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
    if cortex.constants().law.as_ref().is_some_and(|law| law.bends) {
        return shift_by_differences(cortex, state, [f, &phi[..y.components]], length);
    }
    // An antisymmetric change leaves φ at the equator unchanged, but changes its slope j.
    let mut kappa_turn = 0.0;
    if y.components == REGULATED {
        let (_, by_phi) = cortex.constants().regulated_by_phi(cortex.constants().at(0.5, length), state[PHI], 0.0);
        kappa_ss += by_phi.kappa * f[J] / length;
        kappa_turn = by_phi.kappa * phi[J];
    }
    let c2 = 1.0 / state[R];
    let c1 = here.mean(state[M]) - c2;
    debug_assert!((state[PSI] - std::f64::consts::FRAC_PI_2).abs() < 1e-6);
    let change = phi[Q] / kappa + phi[PSI] * (c1 - c2) / state[R] - state[M] * kappa_turn / (kappa * kappa);
    let bend = f[Q] / length / kappa - state[M] * kappa_ss / (kappa * kappa) + c1 * (c1 - c2) / state[R];
    -change / bend / length
}

/// [`furrow_shift`] by differences of c1_s, for a law with a moment: along the contour, where the state changes by `f` per u,
/// and along the antisymmetric direction.
fn shift_by_differences(cortex: &Cortex, state: &[f64], [f, phi]: [&[f64]; 2], length: f64) -> f64 {
    const STEP: f64 = 1e-5;
    let mut reader = cortex.constants().reader();
    let mut slope = |u: f64, by: &[f64], step: f64| {
        let moved: Vec<f64> = state.iter().zip(by).map(|(y, by)| y + step * by).collect();
        let here = cortex.constants().of_state(u, &moved, length);
        let [mean, mean_s] = reader.mean_curvature(u, &here, &moved, length);
        let (sin, cos) = sin_cos(moved[PSI]);
        mean_s - cos / moved[R] * (mean - 2.0 * sin / moved[R])
    };
    let change = slope(0.5, phi, STEP) - slope(0.5, phi, -STEP);
    let bend = slope(0.5 + STEP, f, STEP) - slope(0.5 - STEP, f, -STEP);
    -change / bend
}

/// A singular point near the newest point of a branch that cannot be located.
pub(super) fn not_located(branch: &Continuation<Cortex>, kind: PointKind, source: SingularError) -> BranchEnd {
    let cell = CellName::of(&branch.problem.cell);
    BranchEnd::NotLocated(ShapeError::Point { cell, kind, xi_s: branch.state.parameter(), source })
}
