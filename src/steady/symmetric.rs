//! The mirror-symmetric branch of stationary shapes from the passive shape on, its folds and its pitchforks.

use std::f64::consts::PI;

use super::continuation::{Continuation, ContinuationError, ContinuationSettings, Ended, Work};
use super::locate;
use super::normal_form::pitchfork_normal_form;
use super::path::Metric;
use super::singular::{Extended, ExtendedReport, Fold, MirrorSymmetric, SingularError, SymmetryBreaking};
use super::stability::Stability;
use crate::cortex::equations::{COMPONENTS, M, PSI, Q, R, T, V, Z};
use crate::cortex::shape::{self, PINCH_OFF};
use crate::cortex::{Control, Cortex, Cue, Domain, Numerics, Physics};
use crate::numerics::newton::NewtonError;
use crate::numerics::system::Update;
use crate::numerics::{BoundaryValueProblem, Gauss, Site, Solution};

impl MirrorSymmetric for Cortex {
    /// r, m and T are even about the equator, so antisymmetric changes of them vanish there.
    fn vanishing_at_mirror(&self) -> &[usize] {
        &[R, M, T]
    }

    fn free_at_mirror(&self) -> &[usize] {
        &[PSI, Q, V, Z]
    }
}

/// Index of the activity ξ_s among the scalar unknowns of every problem here.
pub const XI: usize = 2;

/// Why a stationary branch, or a point of it, could not be computed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SteadyError {
    /// No passive shape to start from.
    #[error("no passive shape for R0 = {r0}, epsilon = {epsilon} ({source}); try more mesh intervals")]
    Passive {
        /// Radius R0.
        r0: f64,
        /// Confinement ε.
        epsilon: f64,
        /// What the solver said.
        source: NewtonError,
    },
    /// With its cue, the passive cell has no shape.
    #[error("no passive shape with the cue for R0 = {r0}, epsilon = {epsilon} ({source}); try more mesh intervals")]
    Cue {
        /// Radius R0.
        r0: f64,
        /// Confinement ε.
        epsilon: f64,
        /// What the solver said.
        source: NewtonError,
    },
    /// The branch cannot be followed.
    #[error("R0 = {r0}, epsilon = {epsilon}: {source}; try more mesh intervals")]
    Branch {
        /// Radius R0.
        r0: f64,
        /// Confinement ε.
        epsilon: f64,
        /// What the continuation said.
        source: ContinuationError,
    },
    /// A singular point seen on the way cannot be located.
    #[error("R0 = {r0}, epsilon = {epsilon}: the {kind} near xi_s = {xi_s} cannot be located: {source}")]
    Point {
        /// Radius R0.
        r0: f64,
        /// Confinement ε.
        epsilon: f64,
        /// Pitchfork or fold.
        kind: &'static str,
        /// Where it was seen.
        xi_s: f64,
        /// What the solver said.
        source: SingularError,
    },
    /// There is none in the range searched.
    #[error("R0 = {r0}, epsilon = {epsilon}: no {kind} for xi_s up to {xi_max}; raise --xi-max")]
    None {
        /// Radius R0.
        r0: f64,
        /// Confinement ε.
        epsilon: f64,
        /// Pitchfork or fold.
        kind: &'static str,
        /// End of the range searched.
        xi_max: f64,
    },
    /// A curve of singular points does not reach the value asked for.
    #[error("the curve of {kind}s does not reach {what} = {value}: {reason}")]
    Curve {
        /// Pitchfork or fold.
        kind: &'static str,
        /// Name of the unknown.
        what: &'static str,
        /// Value asked for.
        value: f64,
        /// Why.
        reason: String,
    },
}

/// What is followed, and how far.
#[derive(Clone, Debug, PartialEq)]
pub struct BranchOptions {
    /// Range of ξ_s; the branch ends where it leaves it.
    pub xi: [f64; 2],
    /// Most points.
    pub points: usize,
    /// Continuation settings.
    pub settings: ContinuationSettings,
    /// Whether growth rates are computed at every point.
    pub growth_rates: bool,
}

impl Default for BranchOptions {
    fn default() -> Self {
        BranchOptions {
            xi: [0.0, 100.0],
            points: 400,
            settings: ContinuationSettings { first_step: 0.3, max_step: 3.0, ..Default::default() },
            growth_rates: false,
        }
    }
}

/// A stationary shape on a branch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShapePoint {
    /// Activity ξ_s.
    pub xi_s: f64,
    /// Elongation H = (z(0) − z(1))/R0.
    pub elongation: f64,
    /// Contour length L.
    pub length: f64,
    /// Pressure p.
    pub pressure: f64,
    /// Radius at the equator u = ½.
    pub equator_radius: f64,
    /// Furrow position u_f − ½ of asymmetric shapes; 0 on the symmetric branch.
    pub delta_u: f64,
    /// Arclength along the branch.
    pub arclength: f64,
    /// Folds and pitchforks passed since the start of the branch.
    pub passed: usize,
    /// Largest growth rate of disturbances, in 1/τ, if asked for and found.
    pub growth_rate: Option<f64>,
}

impl ShapePoint {
    /// Observables of a solution.
    pub fn of(y: &Solution, cortex: &Cortex, gauss: &Gauss) -> ShapePoint {
        ShapePoint {
            xi_s: y.scalars.get(XI).copied().unwrap_or(cortex.physics.xi_s),
            elongation: shape::elongation(y, cortex.domain, cortex.r0),
            length: y.scalars[0],
            pressure: y.scalars[1],
            equator_radius: match cortex.domain {
                Domain::Half => y.node(y.intervals())[R],
                Domain::Full => shape::equator_radius(gauss, y),
            },
            delta_u: match cortex.domain {
                Domain::Half => 0.0,
                Domain::Full => shape::furrow_position(gauss, cortex, y).map_or(0.0, |u| u - 0.5),
            },
            arclength: 0.0,
            passed: 0,
            growth_rate: None,
        }
    }

    /// The newest point of a branch, after so many folds and pitchforks; with its growth rate if there is a workspace for it.
    pub(super) fn newest(
        branch: &Continuation<Cortex>,
        passed: usize,
        stability: &mut Option<Stability>,
    ) -> ShapePoint {
        let (y, cortex) = (&branch.state.solution, &branch.problem);
        ShapePoint {
            arclength: branch.state.arclength,
            passed,
            growth_rate: stability.as_mut().and_then(|stability| stability.growth_rate(cortex, y).ok()),
            ..ShapePoint::of(y, cortex, &branch.system.gauss)
        }
    }
}

/// Whether the asymmetric branch exists above or below the pitchfork.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Criticality {
    /// ξ_s > ξ_s* on the asymmetric branch.
    Supercritical,
    /// ξ_s < ξ_s* on the asymmetric branch.
    Subcritical,
}

/// A pitchfork of the mirror-symmetric branch.
#[derive(Clone, Debug, PartialEq)]
pub struct Pitchfork {
    /// Threshold ξ_s*, with the other observables.
    pub point: ShapePoint,
    /// c of ξ_s = ξ_s* + c (u_f − ½)² on the asymmetric branch, u_f the furrow (most negative meridional curvature).
    /// Positive: supercritical.
    pub coefficient: f64,
    /// How the location converged.
    pub report: ExtendedReport,
    /// The shape, on the half domain, with (L, p, ξ_s).
    pub shape: Solution,
    /// Antisymmetric null vector φ on the half domain.
    pub null: Update,
    /// Furrow displacement u_f − ½ per unit of φ.
    pub furrow_shift: f64,
}

impl Pitchfork {
    /// Sub- or supercritical.
    pub fn criticality(&self) -> Criticality {
        if self.coefficient < 0.0 { Criticality::Subcritical } else { Criticality::Supercritical }
    }
}

/// A turning point of ξ_s.
#[derive(Clone, Debug, PartialEq)]
pub struct FoldPoint {
    /// Its observables.
    pub point: ShapePoint,
    /// Whether ξ_s is largest (rather than smallest) here along the branch.
    pub maximum: bool,
    /// How the location converged.
    pub report: ExtendedReport,
    /// The shape with (L, p, ξ_s).
    pub shape: Solution,
}

/// Something on a branch.
#[derive(Clone, Debug, PartialEq)]
pub enum BranchEvent {
    /// A pitchfork.
    Pitchfork(Box<Pitchfork>),
    /// A fold.
    Fold(Box<FoldPoint>),
}

impl BranchEvent {
    /// Observables of the point.
    pub fn point(&self) -> &ShapePoint {
        match self {
            BranchEvent::Pitchfork(pitchfork) => &pitchfork.point,
            BranchEvent::Fold(fold) => &fold.point,
        }
    }

    fn arclength(&self) -> f64 {
        self.point().arclength
    }
}

/// Where a branch ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum BranchEnd {
    /// ξ_s left its range; the last point lies on the bound.
    Bound(f64),
    /// The largest number of points is reached.
    PointLimit(usize),
    /// The neck is narrower than this, relative to R0: the shapes beyond are two cells on a thread.
    Pinched(f64),
    /// An asymmetric branch has come back to mirror-symmetric shapes, at a pitchfork of theirs.
    Rejoined,
    /// The caller had seen enough, or [`Branch::stopped_by`] says why.
    Stopped,
}

/// A branch followed.
#[derive(Clone, Debug, PartialEq)]
pub struct Branch {
    /// Its points in order of arclength.
    pub points: Vec<ShapePoint>,
    /// Folds and pitchforks in order.
    pub events: Vec<BranchEvent>,
    /// Where it ended.
    pub ended: BranchEnd,
    /// The singular point that could not be located, or how the branch was lost, if that ended it; the events before are
    /// complete.
    pub stopped_by: Option<SteadyError>,
    /// Work of the continuation.
    pub work: Work,
}

impl Branch {
    /// What a run along `branch` has found, with how the continuation `ended` and, if it was stopped, why.
    pub(super) fn complete(
        branch: &Continuation<Cortex>,
        points: Vec<ShapePoint>,
        events: Vec<BranchEvent>,
        ended: Result<Ended, ContinuationError>,
        stopped: Option<BranchEnd>,
        stopped_by: Option<SteadyError>,
    ) -> Branch {
        let (r0, epsilon) = (branch.problem.r0, branch.problem.physics.epsilon);
        let (ended, stopped_by) = match ended {
            Ok(Ended::ParameterBound(bound)) => (BranchEnd::Bound(bound), stopped_by),
            Ok(Ended::PointLimit(points)) => (BranchEnd::PointLimit(points), stopped_by),
            Ok(Ended::Stopped) => (stopped.unwrap_or(BranchEnd::Stopped), stopped_by),
            Err(source) => (BranchEnd::Stopped, Some(SteadyError::Branch { r0, epsilon, source })),
        };
        Branch { points, events, ended, stopped_by, work: branch.work }
    }
}

/// Norm of branches of cells of radius R0: lengths in R0, stresses in κ/R0², and ξ_s with weight 1 on its own scale.
pub fn metric(r0: f64, controls: &[Control]) -> Metric {
    let mut components = vec![1.0; COMPONENTS];
    for c in [R, Z] {
        components[c] = 1.0 / (r0 * r0);
    }
    components[M] = r0 * r0;
    for c in [Q, T] {
        components[c] = 0.01 * r0.powi(4);
    }
    components[V] = 0.1;
    let mut scalars = vec![1.0 / (r0 * r0), 0.01 * r0.powi(6)];
    scalars.extend(controls.iter().map(|c| if *c == Control::Xi { 0.04 * r0 * r0 } else { 1.0 }));
    Metric { components, scalars }
}

/// The mesh monitor of branches.
pub fn mesh_monitor(cortex: &Cortex, y: &Solution, weight: &mut Vec<f64>) {
    shape::monitor(cortex, y, false, weight);
}

/// The symmetric branch at ξ_s = 0, ready to be followed upwards.
///
/// # Errors
/// [`SteadyError::Passive`], [`SteadyError::Branch`].
pub fn start(
    physics: &Physics,
    numerics: &Numerics,
    r0: f64,
    settings: &ContinuationSettings,
) -> Result<Continuation<Cortex>, SteadyError> {
    let epsilon = physics.epsilon;
    let (y, _) =
        shape::passive(physics, numerics, r0).map_err(|source| SteadyError::Passive { r0, epsilon, source })?;
    begin(y, physics, r0, &Cue::None, Domain::Half, settings)
}

/// The branch upwards in ξ_s from the passive shape `y` at ξ_s = 0.
///
/// # Errors
/// [`SteadyError::Branch`].
pub(super) fn begin(
    mut y: Solution,
    physics: &Physics,
    r0: f64,
    cue: &Cue,
    domain: Domain,
    settings: &ContinuationSettings,
) -> Result<Continuation<Cortex>, SteadyError> {
    y.scalars.push(0.0);
    let controls = [Control::Xi];
    let cortex = Cortex::new(physics, r0, cue, domain, &controls);
    let mut branch = Continuation::start(cortex, y, metric(r0, &controls), settings.clone(), true)
        .map_err(|source| SteadyError::Branch { r0, epsilon: physics.epsilon, source })?;
    branch.monitor = Some(mesh_monitor);
    Ok(branch)
}

/// Follows the symmetric branch from the passive shape until ξ_s leaves its range or the neck is pinched off, and locates
/// every fold and pitchfork on the way. `wanted` may end it early, being shown every event. A singular point that cannot
/// be located, or a branch that is lost, ends it with what came before, and is kept in [`Branch::stopped_by`].
///
/// # Errors
/// [`SteadyError::Passive`], [`SteadyError::Branch`] at ξ_s = 0.
pub fn follow(
    physics: &Physics,
    numerics: &Numerics,
    r0: f64,
    options: &BranchOptions,
    mut wanted: impl FnMut(&BranchEvent) -> bool,
) -> Result<Branch, SteadyError> {
    let mut branch = start(physics, numerics, r0, &options.settings)?;
    let mut watch = SymmetryBreaking::default();
    let mut stability = options.growth_rates.then(|| Stability::new(branch.state.solution.m));
    let (mut points, mut events) = (vec![ShapePoint::newest(&branch, 0, &mut stability)], Vec::new());
    let (mut failure, mut pinched) = (None, None);
    // Passive shapes have no antisymmetric null vector; their sign is the first one seen.
    let mut sign_before: Option<f64> = None;
    let mut passed = 0;
    let ended = branch.follow(options.xi, options.points, |branch, advance| {
        let mut new = Vec::new();
        // Judged at the point itself: on constricted shapes the corrector's prediction, off by a good part of the
        // neck's radius, can lie on the other side of a pitchfork for several points. A failed pivot has no sign;
        // the next point has.
        if branch.factorise_newest().is_ok()
            && let Ok((sign, _)) = watch.test(&branch.system, &branch.problem)
            && sign != 0.0
        {
            if let Some(before) = sign_before
                && before != sign
            {
                match pitchfork_near(branch, [before, sign]) {
                    Ok(pitchfork) => new.push(BranchEvent::Pitchfork(Box::new(pitchfork))),
                    Err(source) => failure = Some(not_located(branch, "pitchfork", source)),
                }
            }
            sign_before = Some(sign);
        }
        if advance.passed_fold {
            match fold_near(branch) {
                Ok(fold) => new.push(BranchEvent::Fold(Box::new(fold))),
                Err(source) => failure = Some(not_located(branch, "fold", source)),
            }
        }
        new.sort_by(|a, b| a.arclength().total_cmp(&b.arclength()));
        passed += new.len();
        points.push(ShapePoint::newest(branch, passed, &mut stability));
        let enough = new.iter().any(|event| !wanted(event));
        events.extend(new);
        if failure.is_none() && narrowest(&branch.system.gauss, &branch.state.solution) < PINCH_OFF * r0 {
            pinched = Some(BranchEnd::Pinched(PINCH_OFF));
        }
        failure.is_none() && pinched.is_none() && !enough
    });
    Ok(Branch::complete(&branch, points, events, ended, pinched, failure))
}

/// The first pitchfork of the symmetric branch.
///
/// # Errors
/// [`SteadyError`]; `None` if there is no pitchfork up to the end of the range.
pub fn first_pitchfork(
    physics: &Physics,
    numerics: &Numerics,
    r0: f64,
    options: &BranchOptions,
) -> Result<Pitchfork, SteadyError> {
    let branch = follow(physics, numerics, r0, options, |event| matches!(event, BranchEvent::Fold(_)))?;
    let Branch { events, stopped_by, .. } = branch;
    let none = SteadyError::None { r0, epsilon: physics.epsilon, kind: "pitchfork", xi_max: options.xi[1] };
    events
        .into_iter()
        .find_map(|event| match event {
            BranchEvent::Pitchfork(pitchfork) => Some(*pitchfork),
            BranchEvent::Fold(_) => None,
        })
        .ok_or(stopped_by.unwrap_or(none))
}

/// The narrowest place of a half contour, its equator or a furrow beside it.
fn narrowest(gauss: &Gauss, y: &Solution) -> f64 {
    let equator = y.node(y.intervals())[R];
    shape::neck(gauss, y).map_or(equator, |neck| neck.radius.min(equator))
}

/// A singular point near the newest point of a branch that cannot be located.
pub(super) fn not_located(branch: &Continuation<Cortex>, kind: &'static str, source: SingularError) -> SteadyError {
    let (r0, epsilon, xi_s) = (branch.problem.r0, branch.problem.physics.epsilon, branch.state.parameter());
    SteadyError::Point { r0, epsilon, kind, xi_s, source }
}

/// The fold between the last two points of a continuation.
///
/// # Errors
/// [`SingularError`].
pub fn fold_near(branch: &mut Continuation<Cortex>) -> Result<FoldPoint, SingularError> {
    // Past a maximum ξ_s falls.
    let maximum = branch.state.parameter_slope() < 0.0;
    let signs = if maximum { [1.0, -1.0] } else { [-1.0, 1.0] };
    let found = locate::between_last_points(branch, Fold::new(XI), signs)?;
    let mut point = ShapePoint::of(&found.solution, &found.extended.problem, &found.extended.system.gauss);
    point.arclength = found.arclength;
    Ok(FoldPoint { point, maximum, report: found.report, shape: found.solution })
}

/// The pitchfork between the last two points of a continuation of the symmetric branch, where the antisymmetric
/// determinant changes sign as given.
///
/// # Errors
/// [`SingularError`].
pub fn pitchfork_near(branch: &mut Continuation<Cortex>, signs: [f64; 2]) -> Result<Pitchfork, SingularError> {
    let mut found = locate::between_last_points(branch, SymmetryBreaking::default(), signs)?;
    let mut pitchfork = describe(&mut found.extended, found.solution, found.report)?;
    pitchfork.point.arclength = found.arclength;
    Ok(pitchfork)
}

/// Observables and normal form of a pitchfork just converged.
///
/// # Errors
/// [`SingularError`] if the normal form does not exist.
pub fn describe(
    point: &mut Extended<Cortex, SymmetryBreaking>,
    y: Solution,
    report: ExtendedReport,
) -> Result<Pitchfork, SingularError> {
    let form = pitchfork_normal_form(point, &y)?;
    let furrow_shift = furrow_shift(&point.problem, &y, &point.singularity.null);
    Ok(Pitchfork {
        point: ShapePoint::of(&y, &point.problem, &point.system.gauss),
        coefficient: form.parameters[0] / (furrow_shift * furrow_shift),
        report,
        null: point.singularity.null.clone(),
        furrow_shift,
        shape: y,
    })
}

/// Displacement of the furrow, the minimum of the meridional curvature c1 at the equator, per unit of the antisymmetric
/// direction φ: −∂_u δc1/∂_uu c1. With c2_s = (cosψ/r)(c1 − c2), at the equator
///
/// * δc1_s = δq/κ + δψ (c1 − c2)/r, c1_ss = q_s/κ + c1(c1 − c2)/r.
pub fn furrow_shift(cortex: &Cortex, y: &Solution, null: &Update) -> f64 {
    let last = y.intervals();
    let state = y.node(last);
    let kappa = cortex.constants().rigidity(0.5).0;
    let length = y.scalars[0];
    let (mut f, mut g) = ([0.0; COMPONENTS], [0.0]);
    cortex.rhs(Site { x: 0.5, index: 0 }, state, &y.scalars, &mut f, &mut g);
    let phi = &null.nodes[last * COMPONENTS..];
    let c2 = 1.0 / state[R];
    let c1 = state[M] / kappa - c2;
    debug_assert!((state[PSI] - 0.5 * PI).abs() < 1e-6);
    let change = phi[Q] / kappa + phi[PSI] * (c1 - c2) / state[R];
    let bend = f[Q] / length / kappa + c1 * (c1 - c2) / state[R];
    -change / bend / length
}
