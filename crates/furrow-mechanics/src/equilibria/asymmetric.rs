//! The branch that leaves the mirror-symmetric one at a pitchfork, on the full contour.

use furrow_bvp::continuation::State;
use furrow_bvp::predictor::History;
use furrow_bvp::{Continuation, ContinuationSettings, Gauss, Solution};

use super::azimuthal_scan::AzimuthalScan;
use super::branch::{
    Branch, BranchEnd, BranchEvent, BranchOptions, NARROWEST, Pitchfork, mesh_monitor, metric, newest_contour,
};
use super::error::PointKind;
use super::locate::{fold_near, not_located};
use super::point::ShapePoint;
use super::rates::{self, with_rates};
use crate::cortex::equations::{R, REGULATED, Z};
use crate::cortex::symmetry::{unfold, unfold_antisymmetric};
use crate::cortex::{Cortex, Domain, observables};
use furrow_cell::{Cell, Parameter};

/// Switches onto the asymmetric branch at a pitchfork of a cell, towards u_f < ½ (its mirror image is the other half of
/// the branch). The tangent there is the null vector, and the first step is the distance along it that moves the furrow by
/// the first of [`SCALING_RANGE`] in u.
fn switch(pitchfork: &Pitchfork, cell: &Cell, settings: &ContinuationSettings) -> Continuation<Cortex> {
    let solution = unfold(&pitchfork.shape);
    let free = [Parameter::XiS];
    let metric = metric(cell, &free);
    let mut tangent = unfold_antisymmetric(&pitchfork.null, solution.components, solution.scalars.len());
    let scale = metric.dot(&solution.mesh, &tangent, &tangent).sqrt();
    tangent.scale(-pitchfork.furrow_shift.signum() / scale);
    let step = SCALING_RANGE[0] / pitchfork.furrow_shift.abs() * scale;
    let history = History::default();
    let state = State { solution, tangent, arclength: 0.0, step, points: 1, direction: 0.0, orientation: 0.0, history };
    let cortex = Cortex::new(cell, Domain::Full, &free);
    let settings = ContinuationSettings { min_step: settings.min_step.min(1e-3 * step), ..settings.clone() };
    let mut branch = Continuation::resume(cortex, state, metric, settings);
    branch.monitor = Some(mesh_monitor);
    branch
}

/// Fit of |u_f − ½| = A |ξ_s − ξ_s*|^β near a pitchfork.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
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

/// A branch whose asymmetry has shrunk to this fraction of its largest has come back to mirror-symmetric shapes: at a
/// pitchfork it can stop nowhere short of them.
const SHRUNK: f64 = 1e-3;

/// How far a full contour is from its mirror image, at places along it: r(u) − r(1 − u) and z(u) + z(1 − u).
fn asymmetry(gauss: &Gauss, y: &Solution) -> Vec<[f64; 2]> {
    const PLACES: usize = 32;
    let (mut here, mut there) = ([0.0; REGULATED], [0.0; REGULATED]);
    let (here, there) = (&mut here[..y.components], &mut there[..y.components]);
    let at = |k: usize| {
        let u = k as f64 / (2 * PLACES) as f64;
        y.eval(gauss, u, here);
        y.eval(gauss, 1.0 - u, there);
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

/// What a run along an asymmetric branch keeps.
#[derive(Default)]
struct Run {
    points: Vec<ShapePoint>,
    events: Vec<BranchEvent>,
    /// (|Δu|, ξ_s − ξ_s*) on the way out.
    samples: Vec<[f64; 2]>,
    /// Whether Δu has only grown so far: the furrow may come back later.
    opening: bool,
    asymmetry: Vec<[f64; 2]>,
    largest: f64,
    stop: Option<BranchEnd>,
}

impl Run {
    /// Whether the newest shape is mirror-symmetric again.
    fn rejoined(&mut self, gauss: &Gauss, y: &Solution) -> bool {
        let before = std::mem::replace(&mut self.asymmetry, asymmetry(gauss, y));
        let size = self.asymmetry.iter().fold(0.0, |m: f64, v| m.max(v[0].abs()));
        self.largest = size.max(self.largest);
        size < SHRUNK * self.largest || turned(&before, &self.asymmetry)
    }

    /// Takes a point in; whether to go on.
    fn take_in(&mut self, branch: &Continuation<Cortex>, point: ShapePoint, threshold: f64) -> bool {
        self.opening &= point.delta_u.abs() < SCALING_RANGE[1];
        if self.opening && self.events.is_empty() && point.delta_u.abs() >= SCALING_RANGE[0] {
            self.samples.push([point.delta_u.abs(), point.xi_s - threshold]);
        }
        self.points.push(point);
        let neck = observables::neck(&branch.system.gauss, &branch.state.solution);
        if self.stop.is_none() && neck.is_some_and(|neck| neck.radius < NARROWEST * branch.problem.cell.r0) {
            self.stop = Some(BranchEnd::Pinched(NARROWEST));
        }
        self.stop.is_none()
    }
}

/// Follows the asymmetric branch from a pitchfork of a cell until ξ_s leaves its range, the neck is pinched or the shapes
/// are mirror-symmetric again. A fold that cannot be located ends it, as does the loss of the branch: [`Branch::ended`]
/// says so.
pub fn follow(pitchfork: &Pitchfork, cell: &Cell, options: &BranchOptions) -> AsymmetricBranch {
    let mut branch = switch(pitchfork, cell, &options.settings);
    let mut run = Run { points: vec![pitchfork.point], opening: true, ..Run::default() };
    let gauss = branch.system.gauss.clone();
    let mut contours = Vec::from_iter(options.contours.then(|| newest_contour(&branch)));
    let mut azimuthal = AzimuthalScan::new(options.azimuthal);
    azimuthal.take_in(&branch);
    let (ended, rates) = with_rates(&mut branch, options.growth_rates, |branch, rate| {
        branch.follow(options.xi, options.points, |branch, advance| {
            if run.rejoined(&gauss, &branch.state.solution) {
                run.stop = Some(BranchEnd::Rejoined);
                return false;
            }
            match advance.passed_fold.then(|| fold_near(branch)) {
                Some(Ok(fold)) => run.events.push(BranchEvent::Fold(Box::new(fold))),
                Some(Err(source)) => run.stop = Some(not_located(branch, PointKind::Fold, source)),
                None => {}
            }
            rate(&branch.state.solution, run.events.len());
            let point = ShapePoint::newest(branch, run.events.len());
            contours.extend(options.contours.then(|| newest_contour(branch)));
            azimuthal.take_in(branch);
            run.take_in(branch, point, pitchfork.point.xi_s)
        })
    });
    rates::put(&rates, &mut run.points);
    let Run { points, events, samples, stop, .. } = run;
    let branch = Branch::complete(&branch, (points, contours, azimuthal), events, ended, stop);
    AsymmetricBranch { branch, scaling: scaling(&samples) }
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
