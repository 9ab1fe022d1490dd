//! Curves of pitchforks and folds of cells in ξ_s and one further parameter, and the radii at which they bound division.

use super::cued;
use super::locus::{Locus, LocusError, LocusSettings};
use super::normal_form::pitchfork_normal_form;
use super::singular::{ExtendedReport, Fold, SingularError, Singularity, SymmetryBreaking};
use super::symmetric::{
    self, BranchEvent, BranchOptions, Criticality, FoldPoint, Pitchfork, ShapePoint, SteadyError, XI, furrow_shift,
    mesh_monitor, metric,
};
use crate::cortex::{Control, Cortex, Cue, Domain, Numerics, Physics};
use crate::numerics::Solution;
use crate::numerics::system::Update;

/// Index of the second free parameter among the scalar unknowns of a curve.
pub const SECOND: usize = 3;

/// A point of a curve.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct CurvePoint {
    /// Cell radius R0.
    pub r0: f64,
    /// Confinement ε.
    pub epsilon: f64,
    /// Value of the parameter varied.
    pub value: f64,
    /// Activity ξ_s at the singular point.
    pub xi_s: f64,
    /// Slope dξ_s/d(value) along the curve.
    pub slope: f64,
    /// Elongation H there.
    pub elongation: f64,
    /// Of a pitchfork: c of ξ_s = ξ_s* + c (u_f − ½)².
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub coefficient: Option<f64>,
}

impl CurvePoint {
    /// Sub- or supercritical, of a pitchfork.
    pub fn criticality(&self) -> Option<Criticality> {
        self.coefficient.map(|c| if c < 0.0 { Criticality::Subcritical } else { Criticality::Supercritical })
    }
}

/// A curve followed over a range of its parameter.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Curve {
    /// Its points, in the order followed.
    pub points: Vec<CurvePoint>,
    /// Points where criticality changes sign (pitchforks).
    pub degenerate: Vec<CurvePoint>,
    /// Where the curve turned back in its parameter: a cusp, at which two folds are born (folds).
    pub cusp: Option<CurvePoint>,
    /// Why it ends before the value it was followed to, if it does (folds).
    pub stopped_by: Option<SteadyError>,
    /// Newton iterations of the whole curve.
    pub iterations: usize,
}

/// A curve of pitchforks of cells.
pub type PitchforkLocus = Locus<Cortex, SymmetryBreaking>;
/// A curve of folds of cells.
pub type FoldLocus = Locus<Cortex, Fold>;

/// Largest number of steps of one curve.
const MOST_STEPS: usize = 2000;

/// Settings of curves of cells.
pub fn settings() -> LocusSettings {
    LocusSettings { first_step: 0.02, max_step: 1.0, ..LocusSettings::default() }
}

fn locus<S: Singularity<Cortex> + Clone>(
    cell: &Cell<'_>,
    control: Control,
    singularity: S,
    shape: &Solution,
    tangent: &Update,
    upwards: bool,
) -> Result<Locus<Cortex, S>, LocusError> {
    let controls = [Control::Xi, control];
    let cortex = Cortex::new(&cell.physics, cell.r0, cell.cue, cell.domain, &controls);
    let mut metric = metric(cell.r0, &controls);
    let value = cortex.get(control);
    // The parameter varied counts relative to its own size.
    metric.scalars[SECOND] = 1.0 / (value * value).max(1e-2);
    let mut y = shape.clone();
    y.scalars.truncate(SECOND);
    y.scalars.push(value);
    let mut locus = Locus::start(cortex, singularity, y, metric, tangent, settings(), upwards)?;
    locus.monitor = Some(mesh_monitor);
    Ok(locus)
}

struct Cell<'a> {
    physics: Physics,
    r0: f64,
    cue: &'a Cue,
    domain: Domain,
}

/// The tangent that normalises at a singular point: any direction the branch is not orthogonal to.
fn branch_direction(shape: &Solution) -> Update {
    let mut direction =
        Update { nodes: shape.nodes.clone(), stages: shape.stages.clone(), scalars: shape.scalars.clone() };
    direction.nodes.fill(0.0);
    direction.stages.fill(0.0);
    direction.scalars.fill(0.0);
    // The contour length grows along every branch near its singular points.
    direction.scalars[0] = 1.0;
    direction.scalars.truncate(SECOND);
    direction
}

/// The curve of pitchforks through one of them, ready to be followed.
///
/// # Errors
/// [`LocusError::Start`].
pub fn pitchfork_locus(
    physics: &Physics,
    r0: f64,
    pitchfork: &Pitchfork,
    control: Control,
    upwards: bool,
) -> Result<PitchforkLocus, LocusError> {
    let cell = Cell { physics: *physics, r0, cue: &Cue::None, domain: Domain::Half };
    let shape = &pitchfork.shape;
    locus(&cell, control, SymmetryBreaking::default(), shape, &branch_direction(shape), upwards)
}

/// The curve of folds through one of them, ready to be followed.
///
/// # Errors
/// [`LocusError::Start`].
pub fn fold_locus(
    physics: &Physics,
    r0: f64,
    cue: &Cue,
    fold: &FoldPoint,
    control: Control,
    upwards: bool,
) -> Result<FoldLocus, LocusError> {
    let domain = if *cue == Cue::None { Domain::Half } else { Domain::Full };
    let cell = Cell { physics: *physics, r0, cue, domain };
    locus(&cell, control, Fold::new(XI), &fold.shape, &branch_direction(&fold.shape), upwards)
}

/// The newest point of a curve.
pub fn curve_point<S: Singularity<Cortex> + Clone>(locus: &Locus<Cortex, S>, coefficient: Option<f64>) -> CurvePoint {
    let cortex = &locus.extended.problem;
    let point = ShapePoint::of(&locus.solution, cortex, &locus.extended.system.gauss);
    CurvePoint {
        r0: cortex.r0,
        epsilon: cortex.physics.epsilon,
        value: locus.solution.scalars[SECOND],
        xi_s: point.xi_s,
        slope: locus.tangent.scalars[XI] / locus.tangent.scalars[SECOND],
        elongation: point.elongation,
        coefficient,
    }
}

/// c of ξ_s = ξ_s* + c (u_f − ½)² at the point `y` on which the curve has just converged, as `report` says. Third derivatives
/// magnify what the factors are off by: they are those of the last iteration if its correction was next to nothing.
///
/// # Errors
/// [`SingularError`].
pub fn coefficient(locus: &mut PitchforkLocus, y: &Solution, report: &ExtendedReport) -> Result<f64, SingularError> {
    if report.correction > NEGLIGIBLE {
        locus.extended.refresh(y)?;
    }
    let form = pitchfork_normal_form(&mut locus.extended, y)?;
    let shift = furrow_shift(&locus.extended.problem, y, &locus.extended.singularity.null);
    Ok(form.parameters[0] / (shift * shift))
}

/// Corrections below this change a coefficient by less than 10⁻⁵ of itself.
const NEGLIGIBLE: f64 = 2e-9;

fn curve_error(kind: &'static str, what: &'static str, value: f64, error: impl std::fmt::Display) -> SteadyError {
    SteadyError::Curve { kind, what, value, reason: error.to_string() }
}

/// Follows the curve of the first pitchfork from control value `from` (where it is looked for first) to `to`.
///
/// # Errors
/// [`SteadyError`]; `Curve` if the curve ends before `to`.
pub fn pitchfork_curve(
    physics: &Physics,
    numerics: &Numerics,
    r0: f64,
    control: Control,
    [from, to]: [f64; 2],
) -> Result<Curve, SteadyError> {
    let (mut physics, mut r0) = (*physics, r0);
    control.set(from, &mut physics, &mut r0, &mut Cue::None);
    let first = symmetric::first_pitchfork(&physics, numerics, r0, &BranchOptions::default())?;
    let failed = |error: &dyn std::fmt::Display| curve_error("pitchfork", "the parameter", to, error);
    let mut locus = pitchfork_locus(&physics, r0, &first, control, to > from).map_err(|e| failed(&e))?;
    let mut curve = Curve { points: vec![curve_point(&locus, Some(first.coefficient))], ..Curve::default() };
    let mut before = [curve.points[0].value, first.coefficient];
    let mut failure = None;
    locus
        .follow_to(SECOND, to, MOST_STEPS, |locus, report| {
            let y = locus.solution.clone();
            match coefficient(locus, &y, report) {
                Ok(c) => {
                    let point = curve_point(locus, Some(c));
                    let now = [point.value, c];
                    if before[1] * c < 0.0
                        && let Some(point) = degenerate(locus, [before, now])
                    {
                        curve.degenerate.push(point);
                    }
                    curve.points.push(point);
                    before = now;
                }
                Err(error) => failure = Some(error),
            }
            failure.is_none()
        })
        .map_err(|e| failure.map_or_else(|| failed(&e), |f| failed(&f)))?;
    curve.iterations = locus.iterations;
    Ok(curve)
}

/// The point between two values of the control where the coefficient vanishes, by the Illinois method.
fn degenerate(locus: &mut PitchforkLocus, [mut low, mut high]: [[f64; 2]; 2]) -> Option<CurvePoint> {
    let mut last_side = 0.0;
    for _ in 0..40 {
        let value = (low[0] * high[1] - high[0] * low[1]) / (high[1] - low[1]);
        let (y, report) = locus.at(SECOND, value).ok()?;
        let c = coefficient(locus, &y, &report).ok()?;
        if c.abs() < 1e-8 || (high[0] - low[0]).abs() < 1e-10 * value.abs() {
            let mut found = locus.clone();
            found.tangent = found.extended.curve_direction(&y);
            found.solution = y;
            return Some(curve_point(&found, Some(c)));
        }
        if c * low[1] > 0.0 {
            low = [value, c];
            if last_side < 0.0 {
                high[1] *= 0.5;
            }
            last_side = -1.0;
        } else {
            high = [value, c];
            if last_side > 0.0 {
                low[1] *= 0.5;
            }
            last_side = 1.0;
        }
    }
    None
}

/// Follows one fold until the control reaches `to`, the curve turns back at a cusp or leaves ξ_s > 0, or it cannot be
/// followed further.
pub fn fold_curve(locus: &mut FoldLocus, to: f64) -> Curve {
    let mut curve = Curve { points: vec![curve_point(locus, None)], ..Curve::default() };
    let direction = locus.tangent.scalars[SECOND].signum();
    let (mut cusp, mut passive) = (false, false);
    let followed = locus.follow_to(SECOND, to, MOST_STEPS, |locus, _| {
        cusp = locus.tangent.scalars[SECOND] * direction < 0.0;
        passive = locus.solution.scalars[XI] <= 0.0;
        if !cusp && !passive {
            curve.points.push(curve_point(locus, None));
        }
        !cusp && !passive
    });
    curve.iterations = locus.iterations;
    match followed {
        Err(LocusError::NotReached { .. }) if cusp => {
            if let Some(y) = locus.turning_point(SECOND) {
                locus.solution = y;
            }
            curve.cusp = Some(curve_point(locus, None));
        }
        Err(LocusError::NotReached { .. }) if passive => {
            curve.stopped_by = Some(curve_error("fold", "the parameter", to, "xi_s falls to 0 on the way"));
        }
        Err(error) => curve.stopped_by = Some(curve_error("fold", "the parameter", to, error)),
        Ok(()) => {}
    }
    curve
}

/// All folds of the symmetric branch at control value `from`, each followed towards `to`, and those at `to` that no curve
/// has led to, followed towards `from`. A curve that cannot be followed to its end keeps what there is of it, and why in
/// [`Curve::stopped_by`].
///
/// # Errors
/// [`SteadyError`] of the symmetric branches at both ends.
pub fn fold_curves(
    physics: &Physics,
    numerics: &Numerics,
    r0: f64,
    control: Control,
    [from, to]: [f64; 2],
) -> Result<Vec<Curve>, SteadyError> {
    let mut curves: Vec<Curve> = Vec::new();
    for [start, end] in [[from, to], [to, from]] {
        let (mut physics, mut r0) = (*physics, r0);
        control.set(start, &mut physics, &mut r0, &mut Cue::None);
        let branch = symmetric::follow(&physics, numerics, r0, &BranchOptions::default(), |_| true)?;
        for event in branch.events {
            let BranchEvent::Fold(fold) = event else { continue };
            let same = |a: f64, b: f64| (a - b).abs() <= 1e-6 * (1.0 + b.abs());
            let known = curves.iter().filter_map(|curve| curve.points.last()).any(|p| {
                same(p.value, start) && same(p.xi_s, fold.point.xi_s) && same(p.elongation, fold.point.elongation)
            });
            if known {
                continue;
            }
            let failed = |error: LocusError| curve_error("fold", "the parameter", end, error);
            let mut locus = fold_locus(&physics, r0, &Cue::None, &fold, control, end > start).map_err(failed)?;
            curves.push(fold_curve(&mut locus, end));
        }
    }
    Ok(curves)
}

/// The control value between `from` and `to` at which the small-H fold and the large-H fold (both maxima of ξ_s) change
/// their order, i.e. lie at the same ξ_s, by Newton with the slopes of both curves. `None` if the branch at `from` has no
/// two maxima.
///
/// # Errors
/// [`SteadyError`].
pub fn fold_order_swap(
    physics: &Physics,
    numerics: &Numerics,
    r0: f64,
    control: Control,
    [from, to]: [f64; 2],
) -> Result<Option<[CurvePoint; 2]>, SteadyError> {
    let (mut physics, mut r0) = (*physics, r0);
    control.set(from, &mut physics, &mut r0, &mut Cue::None);
    let branch = symmetric::follow(&physics, numerics, r0, &BranchOptions::default(), |_| true)?;
    let maxima: Vec<_> = branch
        .events
        .iter()
        .filter_map(|event| match event {
            BranchEvent::Fold(fold) if fold.maximum => Some(fold),
            _ => None,
        })
        .collect();
    let [small, .., large] = maxima[..] else { return Ok(None) };
    let failed = |error: LocusError| curve_error("fold", "the parameter", to, error);
    let start = |fold| fold_locus(&physics, r0, &Cue::None, fold, control, to > from).map_err(failed);
    let (mut small, mut large) = (start(small)?, start(large)?);
    let (low, high) = (from.min(to), from.max(to));
    for _ in 0..50 {
        let points = [curve_point(&small, None), curve_point(&large, None)];
        let step = -(points[0].xi_s - points[1].xi_s) / (points[0].slope - points[1].slope);
        let value = points[0].value;
        if step.abs() < 1e-11 * value.abs() {
            return Ok(Some(points));
        }
        let next = (value + step).clamp(low, high);
        if next == value {
            return Ok(None);
        }
        for locus in [&mut small, &mut large] {
            locus.head_for(SECOND, next);
            locus.follow_to(SECOND, next, MOST_STEPS, |_, _| true).map_err(failed)?;
        }
    }
    Ok(None)
}

/// Radii at which a curve is looked for first, in order.
pub const STARTS: [f64; 7] = [2.0, 2.5, 3.0, 1.6, 4.0, 6.0, 1.0];

/// Values of a control that curves may run through.
fn domain_of(control: Control) -> std::ops::Range<f64> {
    match control {
        Control::R0 => 0.05..50.0,
        Control::Epsilon => 0.05..0.99,
        _ => f64::NEG_INFINITY..f64::INFINITY,
    }
}

/// Follows a curve to the point with ξ_s = `xi_s`, in whichever direction leads there; how that converged. Where a curve of
/// folds turns back in the control there is a cusp, beyond which it is another fold; a curve that leads well away from ξ_s
/// again is given up.
fn to_activity<S: Singularity<Cortex> + Clone>(
    locus: &mut Locus<Cortex, S>,
    xi_s: f64,
    control: Control,
    through_cusps: bool,
) -> Result<ExtendedReport, LocusError> {
    locus.head_for(XI, xi_s);
    let mut last = ExtendedReport::default();
    let direction = locus.tangent.scalars[SECOND];
    let mut nearest = f64::INFINITY;
    locus.follow_to(XI, xi_s, MOST_STEPS, |locus, report| {
        last = *report;
        let distance = (locus.solution.scalars[XI] - xi_s).abs();
        nearest = nearest.min(distance);
        let goes_on = through_cusps || locus.tangent.scalars[SECOND] * direction > 0.0;
        goes_on && distance < 2.0 * nearest + 1.0 && domain_of(control).contains(&locus.solution.scalars[SECOND])
    })?;
    Ok(last)
}

/// The value of `control` at which the pitchfork (no cue) lies at the activity ξ_s of `physics`. The curve is looked for
/// at each of `starts` in turn. Along R0 that is the critical radius R0_c; smaller cells do not divide.
///
/// # Errors
/// [`SteadyError`] if the curve of pitchforks does not pass that activity.
pub fn critical_pitchfork(
    physics: &Physics,
    numerics: &Numerics,
    r0: f64,
    control: Control,
    starts: &[f64],
) -> Result<CurvePoint, SteadyError> {
    let xi_s = physics.xi_s;
    let failed = |e: &dyn std::fmt::Display| curve_error("pitchfork", "xi_s", xi_s, e);
    first_success("pitchfork", xi_s, starts, |start| {
        let (mut physics, mut r0) = (*physics, r0);
        control.set(start, &mut physics, &mut r0, &mut Cue::None);
        let first = symmetric::first_pitchfork(&physics, numerics, r0, &BranchOptions::default())?;
        let mut locus = pitchfork_locus(&physics, r0, &first, control, true).map_err(|e| failed(&e))?;
        let report = to_activity(&mut locus, xi_s, control, true).map_err(|e| failed(&e))?;
        let y = locus.solution.clone();
        let c = coefficient(&mut locus, &y, &report).map_err(|e| failed(&e))?;
        Ok(curve_point(&locus, Some(c)))
    })
}

/// The value of `control` at which the stable branch of a cell with this cue ends, in a fold, at the activity ξ_s of
/// `physics`. Along R0: smaller cells do not divide.
///
/// # Errors
/// [`SteadyError`] if the curve of folds does not pass that activity.
pub fn critical_cued_fold(
    physics: &Physics,
    numerics: &Numerics,
    r0: f64,
    cue: &Cue,
    control: Control,
    starts: &[f64],
) -> Result<CurvePoint, SteadyError> {
    let xi_s = physics.xi_s;
    let failed = |e: LocusError| curve_error("fold", "xi_s", xi_s, e);
    first_success("fold", xi_s, starts, |start| {
        let (mut physics, mut r0, mut cue) = (*physics, r0, *cue);
        control.set(start, &mut physics, &mut r0, &mut cue);
        let fold = cued::failure_fold(&physics, numerics, r0, &cue, &BranchOptions::default())?;
        let mut locus = fold_locus(&physics, r0, &cue, &fold, control, true).map_err(failed)?;
        to_activity(&mut locus, xi_s, control, false).map_err(failed)?;
        Ok(curve_point(&locus, None))
    })
}

fn first_success(
    kind: &'static str,
    xi_s: f64,
    starts: &[f64],
    mut attempt: impl FnMut(f64) -> Result<CurvePoint, SteadyError>,
) -> Result<CurvePoint, SteadyError> {
    let mut last = curve_error(kind, "xi_s", xi_s, "no start given");
    for start in starts {
        match attempt(*start) {
            Ok(point) => return Ok(point),
            Err(error) => last = error,
        }
    }
    Err(last)
}

/// The curve of the fold that ends the stable branch of a cell with a cue, over a range of a control.
///
/// # Errors
/// [`SteadyError`].
pub fn cued_fold_curve(
    physics: &Physics,
    numerics: &Numerics,
    r0: f64,
    cue: &Cue,
    control: Control,
    [from, to]: [f64; 2],
) -> Result<Curve, SteadyError> {
    let (mut physics, mut r0, mut cue) = (*physics, r0, *cue);
    control.set(from, &mut physics, &mut r0, &mut cue);
    let fold = cued::failure_fold(&physics, numerics, r0, &cue, &BranchOptions::default())?;
    let failed = |e: LocusError| curve_error("fold", "the parameter", to, e);
    let mut locus = fold_locus(&physics, r0, &cue, &fold, control, to > from).map_err(failed)?;
    let curve = fold_curve(&mut locus, to);
    match curve.stopped_by {
        Some(error) => Err(error),
        None => Ok(curve),
    }
}
