//! Branches of stationary shapes: points, folds, pitchforks and ends.

use furrow_bvp::{
    AugmentedReport, Continuation, ContinuationError, ContinuationSettings, Direction, Gauss, Metric, Solution,
    Termination, Work, mesh,
};

use super::azimuthal_scan::AzimuthalScan;
use super::error::{CellName, PointKind, Result, ShapeError};
use super::hopf::HopfPoint;
use super::point::ShapePoint;
use crate::cortex::equations::{COMPONENTS, J, M, Q, R, REGULATED, T, V, Z};
use crate::cortex::{Cortex, Domain, observables, resolution};
use furrow_cell::{Cell, Parameter};

/// Options of a continuation.
#[derive(Clone, Debug, PartialEq)]
pub struct BranchOptions {
    /// Range of ξ_s; the branch ends where it leaves this range.
    pub xi: [f64; 2],
    /// Most points.
    pub points: usize,
    /// Continuation settings.
    pub settings: ContinuationSettings,
    /// Most pitchforks that are looked for; all folds are located.
    pub pitchforks: usize,
    /// The reduced volume at which the branch ends, if it falls so far.
    pub reduced_volume: Option<f64>,
    /// Whether growth rates are computed at every point.
    pub growth_rates: bool,
    /// Whether the contour of every point is kept.
    pub contours: bool,
    /// Largest azimuthal number m for which growth rates are computed at every point; 0 computes no such rates.
    pub azimuthal: usize,
    /// Whether the branch is followed on a coarse mesh up to the first pitchfork. Singular points are located on the
    /// given mesh; other points of the branch are approximate.
    pub coarse: bool,
}

impl Default for BranchOptions {
    fn default() -> Self {
        BranchOptions {
            xi: [0.0, 100.0],
            points: 400,
            settings: ContinuationSettings { first_step: 0.3, max_step: 3.0, ..Default::default() },
            pitchforks: usize::MAX,
            reduced_volume: None,
            growth_rates: false,
            contours: false,
            azimuthal: 0,
            coarse: false,
        }
    }
}

impl BranchOptions {
    /// With steps of at most `max_step`, in arclength of the branch.
    pub fn with_max_step(mut self, max_step: f64) -> BranchOptions {
        self.settings.max_step = max_step;
        self.settings.first_step = self.settings.first_step.min(max_step);
        self
    }
}

/// A turning point of ξ_s.
#[derive(Clone, Debug, PartialEq)]
pub struct FoldPoint {
    /// Its observables.
    pub point: ShapePoint,
    /// Whether ξ_s is largest (rather than smallest) here along the branch.
    pub maximum: bool,
    /// Estimated error of ξ_s; infinite if the point does not exist on halved intervals.
    pub error: f64,
    /// How the location converged.
    pub report: AugmentedReport,
    /// The shape with (L, p, ξ_s).
    pub shape: Solution,
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

impl Criticality {
    /// The criticality for a coefficient c of ξ_s = ξ_s* + c a², M.23.
    pub fn of(coefficient: f64) -> Criticality {
        if coefficient < 0.0 { Criticality::Subcritical } else { Criticality::Supercritical }
    }
}

impl std::fmt::Display for Criticality {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(if *self == Criticality::Supercritical { "supercritical" } else { "subcritical" })
    }
}

/// A pitchfork of the mirror-symmetric branch.
#[derive(Clone, Debug, PartialEq)]
pub struct Pitchfork {
    /// Threshold ξ_s*, with the other observables.
    pub point: ShapePoint,
    /// c of ξ_s = ξ_s* + c (u_f − ½)² on the asymmetric branch, u_f the furrow (most negative meridional curvature).
    /// Positive: supercritical.
    pub coefficient: f64,
    /// Estimated error of ξ_s*; infinite if the point does not exist on halved intervals.
    pub error: f64,
    /// How the location converged.
    pub report: AugmentedReport,
    /// The shape, on the half domain, with (L, p, ξ_s).
    pub shape: Solution,
    /// Antisymmetric null vector φ on the half domain.
    pub null: Direction,
    /// Furrow displacement u_f − ½ per unit of φ.
    pub furrow_shift: f64,
    /// ξ_s of the first fold between the passive shape and this point, where stable shapes end before the pitchfork; `None` without such
    /// a fold, and where it was not looked for.
    pub beyond_fold: Option<f64>,
}

impl Pitchfork {
    /// Sub- or supercritical.
    pub fn criticality(&self) -> Criticality {
        Criticality::of(self.coefficient)
    }
}

/// A singular point of a branch.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum BranchEvent {
    /// A pitchfork.
    Pitchfork(Box<Pitchfork>),
    /// A fold.
    Fold(Box<FoldPoint>),
}

impl BranchEvent {
    /// The shape, with (L, p, ξ_s).
    pub fn shape(&self) -> &Solution {
        match self {
            BranchEvent::Pitchfork(pitchfork) => &pitchfork.shape,
            BranchEvent::Fold(fold) => &fold.shape,
        }
    }

    /// Observables of the point.
    pub fn point(&self) -> &ShapePoint {
        match self {
            BranchEvent::Pitchfork(pitchfork) => &pitchfork.point,
            BranchEvent::Fold(fold) => &fold.point,
        }
    }

    /// Estimated error of its ξ_s; infinite if the point does not exist on halved intervals.
    pub fn error(&self) -> f64 {
        match self {
            BranchEvent::Pitchfork(pitchfork) => pitchfork.error,
            BranchEvent::Fold(fold) => fold.error,
        }
    }

    /// Its kind.
    pub fn kind(&self) -> PointKind {
        match self {
            BranchEvent::Pitchfork(_) => PointKind::Pitchfork,
            BranchEvent::Fold(_) => PointKind::Fold,
        }
    }

    /// The pitchfork, if it is one.
    pub fn pitchfork(&self) -> Option<&Pitchfork> {
        if let BranchEvent::Pitchfork(pitchfork) = self { Some(pitchfork) } else { None }
    }

    /// The fold, if it is one.
    pub fn fold(&self) -> Option<&FoldPoint> {
        if let BranchEvent::Fold(fold) = self { Some(fold) } else { None }
    }
}

/// The reason for the end of a branch.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum BranchEnd {
    /// ξ_s left its range; the last point lies on the bound.
    Bound(f64),
    /// The largest number of points is reached.
    PointLimit(usize),
    /// The neck is narrower than this, relative to R0: the shapes beyond are two cells connected by a thread.
    Pinched(f64),
    /// The reduced volume has fallen to this, at the last point.
    Deflated(f64),
    /// An asymmetric branch has returned to mirror-symmetric shapes, at one of their pitchforks.
    Rejoined,
    /// A branch of bent states was followed beyond its fold.
    PassedFold,
    /// The caller stopped.
    Enough,
    /// The branch could not be followed further.
    Lost(ShapeError),
    /// A singular point could not be located; the events before it are complete.
    NotLocated(ShapeError),
    /// The cell's own law of active stress cannot hold at the last point.
    CannotHold(ShapeError),
}

impl BranchEnd {
    /// Its name in files, and its description.
    fn words(&self) -> (&'static str, String) {
        match self {
            BranchEnd::Bound(_) => ("bound", "the bound of ξ_s".into()),
            BranchEnd::PointLimit(_) => ("point_limit", "the largest number of points".into()),
            BranchEnd::Pinched(neck) => ("pinched", format!("its neck is narrower than {neck} R0")),
            BranchEnd::Deflated(volume) => ("reduced_volume", format!("its reduced volume is {volume}")),
            BranchEnd::Rejoined => ("rejoined", "its shapes are mirror-symmetric again".into()),
            BranchEnd::PassedFold => ("passed_fold", "it is well beyond its fold".into()),
            BranchEnd::Enough => ("enough", "stopped by the caller".into()),
            BranchEnd::Lost(_) => ("lost", "lost".into()),
            BranchEnd::CannotHold(_) => ("cannot_hold", "the law cannot hold there".into()),
            BranchEnd::NotLocated(_) => ("not_located", "a singular point that cannot be located".into()),
        }
    }

    /// Its name in files.
    pub fn name(&self) -> &'static str {
        self.words().0
    }

    /// The error, if there was one.
    pub fn error(&self) -> Option<&ShapeError> {
        match self {
            BranchEnd::Lost(error) | BranchEnd::NotLocated(error) | BranchEnd::CannotHold(error) => Some(error),
            _ => None,
        }
    }
}

impl std::fmt::Display for BranchEnd {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.words().1)
    }
}

/// Narrowest neck of a branch, in R0: the branch would continue to pinch-off at finite ξ_s without end.
pub const NARROWEST: f64 = 0.03;

/// Intervals between the places of a stored contour, evenly spaced in u.
const CONTOUR: usize = 240;

/// The contour of the newest point of a branch.
pub(super) fn newest_contour(branch: &Continuation<Cortex>) -> Vec<[f64; 2]> {
    contour(&branch.system.gauss, &branch.state.solution, branch.problem.domain)
}

/// The contour of a shape.
pub(super) fn contour(gauss: &Gauss, y: &Solution, domain: Domain) -> Vec<[f64; 2]> {
    observables::contour(gauss, y, domain, CONTOUR)
}

/// A computed branch.
#[derive(Clone, Debug, PartialEq)]
pub struct Branch {
    /// Its points in order of arclength.
    pub points: Vec<ShapePoint>,
    /// Their contours (r, z) from pole to pole, if requested; otherwise empty.
    pub contours: Vec<Vec<[f64; 2]>>,
    /// Growth rates of non-axisymmetric perturbations, if requested.
    pub azimuthal: AzimuthalScan,
    /// Folds and pitchforks in order.
    pub events: Vec<BranchEvent>,
    /// Points at which stability is lost or regained by an oscillation, if growth rates are requested.
    pub hopf: Vec<HopfPoint>,
    /// How it ended.
    pub ended: BranchEnd,
    /// Work of the continuation.
    pub work: Work,
}

impl Branch {
    /// The results of a run along `branch`, with the end of the continuation and, if it was stopped on the way, the
    /// reason.
    pub(super) fn complete(
        branch: &Continuation<Cortex>,
        (points, contours, azimuthal): (Vec<ShapePoint>, Vec<Vec<[f64; 2]>>, AzimuthalScan),
        events: Vec<BranchEvent>,
        ended: Result<Termination, ContinuationError>,
        stopped: Option<BranchEnd>,
    ) -> Branch {
        let ended = match (ended, stopped) {
            (Err(source), _) => {
                BranchEnd::Lost(ShapeError::Branch { cell: CellName::of(&branch.problem.cell), source })
            }
            (_, Some(end @ (BranchEnd::NotLocated(_) | BranchEnd::Rejoined))) => end,
            (Ok(Termination::ParameterBound(bound)), _) => BranchEnd::Bound(bound),
            (Ok(Termination::PointLimit(points)), _) => BranchEnd::PointLimit(points),
            (Ok(_), stopped) => stopped.unwrap_or(BranchEnd::Enough),
        };
        Branch { points, contours, azimuthal, events, hopf: Vec::new(), ended, work: branch.work }
    }

    /// Its pitchforks in order.
    pub fn pitchforks(&self) -> impl Iterator<Item = &Pitchfork> {
        self.events.iter().filter_map(BranchEvent::pitchfork)
    }

    /// Its folds in order.
    pub fn folds(&self) -> impl Iterator<Item = &FoldPoint> {
        self.events.iter().filter_map(BranchEvent::fold)
    }
}

/// Norm for branches of cells of radius R0: lengths in R0, stresses in κ/R0², and ξ_s with weight 1 on its own scale.
/// Other free parameters have weight 1 until the caller changes it.
pub fn metric(cell: &Cell, free: &[Parameter]) -> Metric {
    let (r0, regulated) = (cell.r0, cell.cue.regulator().is_some());
    let mut components = vec![1.0; if regulated { REGULATED } else { COMPONENTS }];
    for c in [R, Z] {
        components[c] = 1.0 / (r0 * r0);
    }
    components[M] = r0 * r0;
    for c in [Q, T] {
        components[c] = 0.01 * r0.powi(4);
    }
    components[V] = 0.1;
    if let Some(gradient) = components.get_mut(J) {
        *gradient = 0.1 * r0 * r0;
    }
    let mut scalars = vec![1.0 / (r0 * r0), 0.01 * r0.powi(6)];
    scalars.extend(free.iter().map(|p| if *p == Parameter::XiS { 0.04 * r0 * r0 } else { 1.0 }));
    Metric { components, scalars }
}

/// The mesh monitor of branches. Their meshes seldom move, so that located points depend smoothly on the parameters of
/// a cell, to the last digits: calibrations and sensitivities rely on this.
pub fn mesh_monitor(cortex: &Cortex, y: &Solution, weight: &mut Vec<f64>) {
    resolution::monitor(cortex, y, false, &mut resolution::Places::default(), weight);
}

/// Share of [`mesh_monitor`] in [`error_monitor`]: the defect on a coarse mesh misses features between its points.
const SEEN: f64 = 0.3;

/// A mesh monitor for branches that distributes the estimated error, the defect, evenly. With
/// [`remesh_above`](ContinuationSettings::remesh_above) at 1.3, folds are a few times more accurate on the same number
/// of intervals, but no longer depend smoothly on the parameters of a cell below that error, since meshes move in
/// jumps.
///
/// # Examples
/// ```
/// use furrow_cell::{Cell, Numerics};
/// use furrow_mechanics::equilibria::{BranchOptions, branch::error_monitor, primary};
/// let (cell, mut settings) = (Cell::new(2.0), BranchOptions::default().settings);
/// settings.remesh_above = 1.3;
/// let mut branch = primary::start(&cell, &Numerics::default(), &settings)?;
/// branch.monitor = Some(error_monitor);
/// # Ok::<(), furrow_mechanics::equilibria::ShapeError>(())
/// ```
pub fn error_monitor(cortex: &Cortex, y: &Solution, weight: &mut Vec<f64>) {
    mesh_monitor(cortex, y, weight);
    let defects = mesh::defect(&y.gauss(), &mut cortex.clone(), y);
    let mut by_defect = Vec::with_capacity(defects.len());
    mesh::defect_monitor(&y.mesh, &defects, y.m, &mut by_defect);
    let end = y.mesh[y.intervals()] - y.mesh[0];
    let mean = |of: &[f64]| y.mesh.windows(2).zip(of).map(|(x, w)| (x[1] - x[0]) * w).sum::<f64>() / end;
    let (seen, estimated) = (mean(weight), mean(&by_defect));
    for (weight, by_defect) in weight.iter_mut().zip(&by_defect) {
        *weight = SEEN * *weight / seen + by_defect / estimated;
    }
}

/// The branch towards larger ξ_s from the shape `y` of a cell at ξ_s = 0.
///
/// # Errors
/// [`ShapeError::Branch`].
pub(super) fn begin(mut y: Solution, cell: &Cell, settings: &ContinuationSettings) -> Result<Continuation<Cortex>> {
    y.scalars.push(0.0);
    let free = [Parameter::XiS];
    let cortex = Cortex::new(cell, Domain::of(cell), &free);
    let mut branch = Continuation::start(cortex, y, metric(cell, &free), settings.clone(), true)
        .map_err(|source| ShapeError::Branch { cell: CellName::of(cell), source })?;
    branch.monitor = Some(mesh_monitor);
    Ok(branch)
}
