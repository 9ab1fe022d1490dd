//! The branch that leaves the mirror-symmetric branch at a pitchfork, on the full contour.

use furrow_bvp::continuation::State;
use furrow_bvp::predictor::History;
use furrow_bvp::{Continuation, ContinuationSettings, SingularError};

use super::azimuthal_scan::AzimuthalScan;
use super::branch::{
    Branch, BranchEnd, BranchEvent, BranchOptions, NARROWEST, Pitchfork, contour, mesh_monitor, metric, newest_contour,
};
use super::error::PointKind;
use super::locate::{course, deflated, end_at_width, folds_near, not_located};
use super::point::ShapePoint;
use super::rates::{self, Shape, with_rates};
use super::rejoin::{asymmetry, mirrored, mirrored_monitor, rejoined, vanishes};
use crate::cortex::symmetry::{is_mirrored, unfold, unfold_antisymmetric};
use crate::cortex::{Cortex, Domain};
use furrow_cell::{Cell, Parameter};

/// Switches to the asymmetric branch at a pitchfork of a cell, towards u_f < ½ (its mirror image is the other half of
/// the branch). The tangent there is the null vector, and the first step is the distance along it that moves the furrow
/// by the first of [`SCALING_RANGE`] in u.
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

/// A step has returned to mirror-symmetric shapes if the asymmetry vanishes within this many of its lengths from its
/// start.
const REACHED: f64 = 1.02;
/// The same limit, and the fraction of the largest asymmetry below which it applies: steps can become short next to a
/// pitchfork.
const CLOSE: f64 = 3.0;
const SHRUNK: f64 = 1e-3;
/// On a mesh that is not quite mirror-symmetric the branch turns back shortly before the pitchfork, in a fold that
/// cannot always be located. Below this fraction of the largest asymmetry the pitchfork is looked for instead.
const TURNS: f64 = 2e-2;

/// Shapes with less than this fraction of the largest asymmetry may be returning to mirror symmetry.
const NEARLY: f64 = 0.3;

/// Data of a run along an asymmetric branch.
#[derive(Default)]
struct Run {
    points: Vec<ShapePoint>,
    events: Vec<BranchEvent>,
    /// (|Δu|, ξ_s − ξ_s*) while the branch opens.
    samples: Vec<[f64; 2]>,
    /// Whether Δu has only grown so far: the furrow may return later.
    opening: bool,
    asymmetry: Vec<f64>,
    largest: f64,
    /// Fraction of the newest step, at most [`CLOSE`], at which the asymmetry vanishes.
    vanishes: Option<f64>,
    /// The [course] of the branch at the previous point.
    before: [f64; 3],
    stop: Option<BranchEnd>,
}

impl Run {
    /// The pitchfork at which the newest step has returned to mirror-symmetric shapes, if it has; the error if such
    /// shapes were reached but the pitchfork cannot be located.
    fn rejoined(&mut self, branch: &Continuation<Cortex>) -> Option<Result<Pitchfork, SingularError>> {
        let before = std::mem::replace(&mut self.asymmetry, asymmetry(&branch.system.gauss, &branch.state.solution));
        self.largest = self.size().max(self.largest);
        let symmetric = self.size() < SHRUNK * self.largest;
        self.vanishes = vanishes(&before, &self.asymmetry, CLOSE);
        let share = self.vanishes.filter(|share| symmetric || *share <= REACHED)?;
        Some(rejoined(branch, share)).filter(|found| found.is_ok() || symmetric && share < REACHED)
    }

    /// The pitchfork near a fold that cannot be located, if there is one.
    fn turned(&self, branch: &Continuation<Cortex>) -> Option<Pitchfork> {
        let lost = matches!(self.stop, Some(BranchEnd::NotLocated(_))) && self.size() < TURNS * self.largest;
        self.vanishes.filter(|_| lost).and_then(|share| rejoined(branch, share).ok())
    }

    fn size(&self) -> f64 {
        self.asymmetry.iter().fold(0.0, |most: f64, v| most.max(v.abs()))
    }

    /// Adds the folds of the newest step, up to the narrowest allowed neck or the reduced volume that ends the branch.
    fn folds(&mut self, branch: &mut Continuation<Cortex>, passed: bool, until: Option<f64>) {
        match folds_near(branch, self.before, passed) {
            Ok(folds) => self.events.extend(folds.into_iter().map(|fold| BranchEvent::Fold(Box::new(fold)))),
            Err(source) => self.stop = Some(not_located(branch, PointKind::Fold, source)),
        }
        if self.stop.is_none() {
            self.stop = end_at_width(branch, NARROWEST).or_else(|| deflated(branch, until));
            self.events.retain(|event| event.point().arclength <= branch.state.arclength);
        }
        self.before = course(branch);
    }

    /// Keeps the mesh mirror-symmetric near mirror-symmetric shapes: on other meshes the pitchfork is imperfect, and
    /// the branch turns back before it in a spurious fold.
    fn mirror_mesh(&self, branch: &mut Continuation<Cortex>) {
        let near = self.size() < NEARLY * self.largest;
        branch.monitor = Some(if near { mirrored_monitor } else { mesh_monitor });
        if near && !is_mirrored(&branch.state.solution.mesh) && self.stop.is_none() {
            branch.move_to(&mirrored(&branch.state.solution.mesh));
        }
    }

    /// Adds a point; returns whether to continue.
    fn take_in(&mut self, point: ShapePoint, threshold: f64) -> bool {
        let shift = point.delta_u.unwrap_or_default().abs();
        self.opening &= shift < SCALING_RANGE[1];
        if self.opening && self.events.is_empty() && shift >= SCALING_RANGE[0] {
            self.samples.push([shift, point.xi_s - threshold]);
        }
        self.points.push(point);
        self.stop.is_none()
    }
}

/// Follows the asymmetric branch from a pitchfork of a cell until ξ_s leaves its range, the neck is pinched or the
/// shapes are mirror-symmetric again. The branch also ends at a fold that cannot be located, or where continuation
/// fails: see [`Branch::ended`].
pub fn follow(pitchfork: &Pitchfork, cell: &Cell, options: &BranchOptions) -> AsymmetricBranch {
    let mut branch = switch(pitchfork, cell, &options.settings);
    let mut run = Run { points: vec![pitchfork.point], opening: true, before: course(&branch), ..Run::default() };
    let mut contours = Vec::from_iter(options.contours.then(|| newest_contour(&branch)));
    let mut azimuthal = AzimuthalScan::new(options.azimuthal);
    azimuthal.take_in(&branch);
    let mut end = None;
    let (ended, (rates, hopf)) = with_rates(&mut branch, options.growth_rates, |branch, rate| {
        branch.follow(options.xi, options.points, |branch, advance| {
            if let Some(found) = run.rejoined(branch) {
                let failed = |source| not_located(branch, PointKind::Pitchfork, source);
                run.stop = Some(found.as_ref().map_or_else(|source| failed(*source), |_| BranchEnd::Rejoined));
                end = found.ok();
                return false;
            }
            run.folds(branch, advance.passed_fold, options.reduced_volume);
            if let Some(pitchfork) = run.turned(branch) {
                (run.stop, end) = (Some(BranchEnd::Rejoined), Some(pitchfork));
                return false;
            }
            run.mirror_mesh(branch);
            rate(&branch.state.solution, run.events.len(), Shape::Point);
            let point = ShapePoint::newest(branch, run.events.len());
            contours.extend(options.contours.then(|| newest_contour(branch)));
            azimuthal.take_in(branch);
            run.take_in(point, pitchfork.point.xi_s)
        })
    });
    rates::put(&rates, &mut run.points);
    if let Some(Pitchfork { point, shape, .. }) = end {
        run.points.push(ShapePoint { passed: run.events.len(), ..point });
        contours.extend(options.contours.then(|| contour(&branch.system.gauss, &shape, Domain::Half)));
    }
    let Run { points, events, samples, stop, .. } = run;
    let branch = Branch::complete(&branch, (points, contours, azimuthal), events, ended, stop);
    AsymmetricBranch { branch: Branch { hopf, ..branch }, scaling: scaling(&samples) }
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
