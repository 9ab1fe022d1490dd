//! The branch that leaves the mirror-symmetric one at a pitchfork, on the full contour.

use super::continuation::{Advance, Continuation, ContinuationSettings, State};
use super::path::History;
use super::stability::Stability;
use super::symmetric::{
    Branch, BranchEnd, BranchEvent, BranchOptions, Pitchfork, ShapePoint, fold_near, mesh_monitor, metric, not_located,
};
use crate::cortex::equations::{COMPONENTS, M, R, T, Z};
use crate::cortex::{Control, Cortex, Cue, Domain, Physics, shape};
use crate::numerics::system::Update;
use crate::numerics::{Gauss, Solution};

/// An antisymmetric direction of the half contour on the full one: what is even about the equator (r, m, T) changes
/// sign, what is odd (z, q, v, and ψ − π/2) does not.
pub fn unfold_antisymmetric(half: &Update, scalars: usize) -> Update {
    let mirrored = |value: &[f64]| {
        let mut out = [0.0; COMPONENTS];
        out.copy_from_slice(value);
        for c in [R, M, T] {
            out[c] = -out[c];
        }
        out
    };
    let mut full = Update { nodes: half.nodes.clone(), stages: half.stages.clone(), scalars: vec![0.0; scalars] };
    let nodes = half.nodes.len() / COMPONENTS;
    for i in (0..nodes - 1).rev() {
        full.nodes.extend(mirrored(&half.nodes[i * COMPONENTS..(i + 1) * COMPONENTS]));
    }
    for stage in half.stages.rchunks_exact(COMPONENTS) {
        full.stages.extend(mirrored(stage));
    }
    full
}

/// Switches onto the asymmetric branch at a pitchfork, towards u_f < ½ (its mirror image is the other half of the
/// branch). The tangent there is the null vector, and the first step is the distance along it that moves the furrow by
/// `first_shift` in u.
pub fn switch(
    pitchfork: &Pitchfork,
    physics: &Physics,
    r0: f64,
    first_shift: f64,
    settings: &ContinuationSettings,
) -> Continuation<Cortex> {
    let gauss = Gauss::new(pitchfork.shape.m);
    let solution = shape::unfold(&gauss, &pitchfork.shape);
    let controls = [Control::Xi];
    let metric = metric(r0, &controls);
    let mut tangent = unfold_antisymmetric(&pitchfork.null, solution.scalars.len());
    let scale = metric.dot(&solution.mesh, &tangent, &tangent).sqrt();
    tangent.scale(-pitchfork.furrow_shift.signum() / scale);
    let step = first_shift / pitchfork.furrow_shift.abs() * scale;
    let state = State {
        solution,
        tangent,
        arclength: 0.0,
        step,
        points: 1,
        direction: 0.0,
        orientation: 0.0,
        history: History::default(),
    };
    let cortex = Cortex::new(physics, r0, &Cue::None, Domain::Full, &controls);
    let settings = ContinuationSettings { min_step: settings.min_step.min(1e-3 * step), ..settings.clone() };
    let mut branch = Continuation::resume(cortex, state, metric, settings);
    branch.monitor = Some(mesh_monitor);
    branch
}

/// Fit of |u_f − ½| = A |ξ_s − ξ_s*|^β near a pitchfork.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scaling {
    /// Exponent β; ½ at a pitchfork.
    pub exponent: f64,
    /// Prefactor A.
    pub prefactor: f64,
    /// (ξ_s − ξ_s*)/(u_f − ½)² extrapolated to the pitchfork: the coefficient of the normal form, from the branch itself.
    pub coefficient: f64,
    /// Points used.
    pub points: usize,
}

/// The asymmetric branch and how it opens.
#[derive(Clone, Debug, PartialEq)]
pub struct AsymmetricBranch {
    /// Points (with Δu) and folds.
    pub branch: Branch,
    /// Square-root scaling of Δu near the pitchfork.
    pub scaling: Option<Scaling>,
}

/// Furrow shifts Δu used for the scaling.
const SCALING_RANGE: [f64; 2] = [5e-4, 8e-3];

/// A branch is followed until its neck is this narrow, in R0: it goes on to pinch-off at finite ξ_s without end.
pub const NARROWEST: f64 = 0.03;

/// A branch whose asymmetry has shrunk to this fraction of its largest has come back to mirror-symmetric shapes: at a
/// pitchfork it can stop nowhere short of them.
const SHRUNK: f64 = 1e-3;

/// How far a full contour is from its mirror image, at places along it: r(u) − r(1 − u) and z(u) + z(1 − u).
fn asymmetry(gauss: &Gauss, y: &Solution) -> Vec<[f64; 2]> {
    const PLACES: usize = 32;
    let (mut here, mut there) = ([0.0; COMPONENTS], [0.0; COMPONENTS]);
    let at = |k: usize| {
        let u = k as f64 / (2 * PLACES) as f64;
        y.eval(gauss, u, &mut here);
        y.eval(gauss, 1.0 - u, &mut there);
        [here[R] - there[R], here[Z] + there[Z]]
    };
    (0..=PLACES).map(at).collect()
}

/// Whether the asymmetry has turned into its mirror image, as behind a pitchfork. Radii and places must both turn: a cell
/// in a wide shell can slide past the middle alone.
fn turned(before: &[[f64; 2]], now: &[[f64; 2]]) -> bool {
    let product = |c: usize| before.iter().zip(now).map(|(a, b)| a[c] * b[c]).sum::<f64>();
    product(0) < 0.0 && product(1) < 0.0
}

/// Follows the asymmetric branch from a pitchfork until ξ_s leaves its range, the neck is pinched or the shapes are
/// mirror-symmetric again. A fold that cannot be located ends it, as does the loss of the branch: both are kept in
/// [`Branch::stopped_by`].
pub fn follow(pitchfork: &Pitchfork, physics: &Physics, r0: f64, options: &BranchOptions) -> AsymmetricBranch {
    let mut branch = switch(pitchfork, physics, r0, SCALING_RANGE[0], &options.settings);
    let mut opening = true;
    let mut points = vec![pitchfork.point];
    let (mut events, mut failure, mut samples) = (Vec::new(), None, Vec::new());
    let (mut end, mut odd, mut largest) = (None, Vec::new(), 0.0);
    let gauss = branch.system.gauss.clone();
    let mut stability = options.growth_rates.then(|| Stability::new(gauss.m));
    let ended = branch.follow(options.xi, options.points, |branch: &mut Continuation<Cortex>, advance: Advance| {
        let before = std::mem::replace(&mut odd, asymmetry(&gauss, &branch.state.solution));
        let size = odd.iter().fold(0.0, |m: f64, v| m.max(v[0].abs()));
        largest = size.max(largest);
        if size < SHRUNK * largest || turned(&before, &odd) {
            end = Some(BranchEnd::Rejoined);
            return false;
        }
        if advance.passed_fold {
            match fold_near(branch) {
                Ok(fold) => events.push(BranchEvent::Fold(Box::new(fold))),
                Err(source) => failure = Some(not_located(branch, "fold", source)),
            }
        }
        let point = ShapePoint::newest(branch, events.len(), &mut stability);
        // Only on the way out: the furrow may come back later.
        opening &= point.delta_u.abs() < SCALING_RANGE[1];
        if opening && events.is_empty() && point.delta_u.abs() >= SCALING_RANGE[0] {
            samples.push([point.delta_u.abs(), point.xi_s - pitchfork.point.xi_s]);
        }
        points.push(point);
        let neck = shape::neck(&gauss, &branch.state.solution);
        if failure.is_none() && neck.is_some_and(|neck| neck.radius < NARROWEST * r0) {
            end = Some(BranchEnd::Pinched(NARROWEST));
        }
        failure.is_none() && end.is_none()
    });
    AsymmetricBranch {
        branch: Branch::complete(&branch, points, events, ended, end, failure),
        scaling: scaling(&samples),
    }
}

/// Least squares of ln Δu over ln |ξ_s − ξ_s*|, and the limit of (ξ_s − ξ_s*)/Δu² by a line in Δu².
fn scaling(samples: &[[f64; 2]]) -> Option<Scaling> {
    let (exponent, intercept) = line(samples.iter().map(|[du, dxi]| [dxi.abs().ln(), du.ln()]))?;
    let (_, coefficient) = line(samples.iter().map(|[du, dxi]| [du * du, dxi / (du * du)]))?;
    Some(Scaling { exponent, prefactor: intercept.exp(), coefficient, points: samples.len() })
}

/// Slope and intercept of the least-squares line through at least two points.
fn line(points: impl Iterator<Item = [f64; 2]> + Clone) -> Option<(f64, f64)> {
    let n = points.clone().count() as f64;
    let (sx, sy) = points.clone().fold((0.0, 0.0), |(sx, sy), [x, y]| (sx + x / n, sy + y / n));
    let (sxx, sxy) = points.fold((0.0, 0.0), |(a, b), [x, y]| (a + (x - sx) * (x - sx), b + (x - sx) * (y - sy)));
    (n >= 2.0 && sxx > 0.0).then(|| (sxy / sxx, sy - sxy / sxx * sx))
}
