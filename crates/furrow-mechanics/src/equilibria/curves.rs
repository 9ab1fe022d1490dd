//! Curves of pitchforks and folds of cells in ξ_s and one further parameter.

use furrow_bvp::normal_form::pitchfork_normal_form;
use furrow_bvp::{
    AugmentedReport, Bracket, Codim2Curve, CurveError, CurveSettings, Direction, Fold, SingularError, Singularity,
    Solution, SymmetryBreaking,
};

use super::branch::{Branch, BranchOptions, Criticality, FoldPoint, Pitchfork, mesh_monitor, metric};
use super::budget::StepBudget;
use super::error::{CellName, PointKind, Result, ShapeError};
use super::locate::furrow_shift;
use super::passage::Passage;
use super::point::{ShapePoint, XI};
use super::{pitchfork, primary};
use crate::cortex::equations::LENGTH;
use crate::cortex::symmetry::unfold;
use crate::cortex::{Cortex, Domain};
use furrow_cell::{Cell, Numerics, Parameter};

/// Index of the second free parameter among the scalar unknowns of a curve.
pub const SECOND: usize = XI + 1;

/// A point of a curve.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct CurvePoint {
    /// Cell radius R0.
    pub r0: f64,
    /// Confinement ε.
    pub epsilon: f64,
    /// Value of the varied parameter.
    pub value: f64,
    /// Activity ξ_s at the singular point.
    pub xi_s: f64,
    /// Slope dξ_s/d(value) along the curve.
    pub slope: f64,
    /// Elongation H there.
    pub elongation: f64,
    /// For a pitchfork: c of ξ_s = ξ_s* + c (u_f − ½)².
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub coefficient: Option<f64>,
}

impl CurvePoint {
    /// Sub- or supercritical, for a pitchfork.
    pub fn criticality(&self) -> Option<Criticality> {
        self.coefficient.map(Criticality::of)
    }
}

/// The end of a curve.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub enum CurveEnd {
    /// At the given value.
    #[default]
    Reached,
    /// It turned back in its parameter, at a cusp where two folds meet, or where two pitchforks do.
    Cusp(CurvePoint),
    /// It could not be followed further.
    Stopped(ShapeError),
}

impl CurveEnd {
    /// Its name in files.
    pub fn name(&self) -> &'static str {
        match self {
            CurveEnd::Reached => "reached",
            CurveEnd::Cusp(_) => "cusp",
            CurveEnd::Stopped(_) => "stopped",
        }
    }
}

/// A curve over a range of its parameter.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Curve {
    /// Its points, in the order followed.
    pub points: Vec<CurvePoint>,
    /// Points where the criticality changes (pitchforks).
    pub degenerate: Vec<CurvePoint>,
    /// The point at the requested activity, if the curve passes it exactly once on its way to the end.
    pub at_activity: Option<CurvePoint>,
    /// How it ended.
    pub ended: CurveEnd,
    /// Newton iterations of the whole curve.
    pub iterations: usize,
}

impl Curve {
    /// Whether it passes through a fold at a value of its parameter, by the cubics through its points with their slopes.
    fn passes(&self, value: f64, fold: &ShapePoint) -> bool {
        self.points.windows(2).any(|ends| {
            let (a, b) = (&ends[0], &ends[1]);
            let width = b.value - a.value;
            let t = (value - a.value) / width;
            if !(0.0..=1.0).contains(&t) {
                return false;
            }
            let rise = b.xi_s - a.xi_s;
            let bend = a.slope * width * (1.0 - t) - b.slope * width * t + rise * (2.0 * t - 1.0);
            let xi_s = a.xi_s + t * rise + t * (1.0 - t) * bend;
            let elongation = a.elongation + t * (b.elongation - a.elongation);
            (xi_s / fold.xi_s - 1.0).abs() < PASSES && (elongation - fold.elongation).abs() < PASSES_BY
        })
    }

    /// The cusp at its end, if there is one.
    pub fn cusp(&self) -> Option<CurvePoint> {
        match self.ended {
            CurveEnd::Cusp(point) => Some(point),
            _ => None,
        }
    }

    /// The error that ended it before the given value; `None` if it reached this value or a cusp.
    pub fn error(&self) -> Option<&ShapeError> {
        match &self.ended {
            CurveEnd::Stopped(error) => Some(error),
            _ => None,
        }
    }
}

/// A curve of pitchforks of cells during its continuation.
pub(crate) type PitchforkCurve = Codim2Curve<Cortex, SymmetryBreaking>;
/// A curve of folds of cells during its continuation.
pub type FoldCurve = Codim2Curve<Cortex, Fold>;

/// Largest number of steps of one curve.
pub(crate) const MOST_STEPS: usize = 2000;

/// A cell with one parameter at another value.
pub(crate) fn at_value(cell: &Cell, parameter: Parameter, value: f64) -> Cell {
    let mut moved = cell.clone();
    parameter.set(&mut moved, value);
    moved
}

/// The part of the contour needed for shapes along a curve: half of it if the cell is mirror-symmetric for every value
/// of the parameter.
pub(crate) fn domain_along(cell: &Cell, parameter: Parameter) -> Domain {
    let elsewhere = at_value(cell, parameter, parameter.get(cell) + 0.01);
    if cell.is_mirror_symmetric() { Domain::of(&elsewhere) } else { Domain::Full }
}

/// The curve through a singular point of a cell, ready for continuation.
fn through<S: Singularity<Cortex> + Clone>(
    cell: &Cell,
    domain: Domain,
    parameter: Parameter,
    singularity: S,
    shape: &Solution,
    upwards: bool,
) -> Result<Codim2Curve<Cortex, S>, CurveError> {
    let free = [Parameter::XiS, parameter];
    let cortex = Cortex::new(cell, domain, &free);
    let mut metric = metric(cell, &free);
    let value = cortex.get(parameter);
    // The varied parameter is weighted relative to its own size.
    metric.scalars[SECOND] = 1.0 / (value * value).max(1e-2);
    // A normalisation at the singular point: any direction that is not orthogonal to the branch. The length of the
    // contour increases along every branch near its singular points.
    let tangent = along_scalar(shape, SECOND, LENGTH);
    let mut y = shape.clone();
    y.scalars.truncate(SECOND);
    y.scalars.push(value);
    let settings = CurveSettings { first_step: 0.02, max_step: 1.0, ..CurveSettings::default() };
    let mut curve = Codim2Curve::start(cortex, singularity, y, metric, &tangent, settings, upwards)?;
    curve.monitor = Some(mesh_monitor);
    Ok(curve)
}

/// The direction that changes only scalar unknown `index` out of `count`, at a shape.
pub(crate) fn along_scalar(y: &Solution, count: usize, index: usize) -> Direction {
    let mut scalars = vec![0.0; count];
    scalars[index] = 1.0;
    Direction { nodes: vec![0.0; y.nodes.len()], stages: vec![0.0; y.stages.len()], scalars }
}

/// The curve of pitchforks through a given one, ready for continuation.
///
/// # Errors
/// [`CurveError::Start`].
pub fn through_pitchfork(
    cell: &Cell,
    pitchfork: &Pitchfork,
    parameter: Parameter,
    upwards: bool,
) -> Result<PitchforkCurve, CurveError> {
    through(cell, Domain::Half, parameter, SymmetryBreaking::default(), &pitchfork.shape, upwards)
}

/// The curve of folds through a given one, ready for continuation.
///
/// # Errors
/// [`CurveError::Start`].
pub fn through_fold(cell: &Cell, fold: &FoldPoint, parameter: Parameter, up: bool) -> Result<FoldCurve, CurveError> {
    let domain = domain_along(cell, parameter);
    let shape = match (Domain::of(cell), domain) {
        // A mirror-symmetric cell that is asymmetric at other values.
        (Domain::Half, Domain::Full) => &unfold(&fold.shape),
        _ => &fold.shape,
    };
    through(cell, domain, parameter, Fold::new(XI), shape, up)
}

/// The newest point of a curve.
pub fn curve_point<S: Singularity<Cortex> + Clone>(
    curve: &Codim2Curve<Cortex, S>,
    coefficient: Option<f64>,
) -> CurvePoint {
    let cortex = &curve.augmented.problem;
    let point = ShapePoint::of(&curve.solution, cortex, &curve.augmented.system.gauss);
    CurvePoint {
        r0: cortex.cell.r0,
        epsilon: cortex.cell.epsilon,
        value: curve.solution.scalars[SECOND],
        xi_s: point.xi_s,
        slope: curve.tangent.scalars[XI] / curve.tangent.scalars[SECOND],
        elongation: point.elongation,
        coefficient,
    }
}

/// c of ξ_s = ξ_s* + c (u_f − ½)² at the point `y` on which the curve has just converged, with the given report. Third
/// derivatives magnify the error of the factors, which stem from the last iteration: they are recomputed unless its
/// correction was negligible.
///
/// # Errors
/// [`SingularError`].
pub fn coefficient(curve: &mut PitchforkCurve, y: &Solution, report: &AugmentedReport) -> Result<f64, SingularError> {
    if report.correction > NEGLIGIBLE {
        curve.augmented.refresh(y)?;
    }
    let form = pitchfork_normal_form(&mut curve.augmented, y)?;
    let shift = furrow_shift(&curve.augmented.problem, y, &curve.augmented.singularity.null);
    Ok(form.parameters[0] / (shift * shift))
}

/// The newest point of a curve of pitchforks, on which it has just converged, with its coefficient.
///
/// # Errors
/// [`SingularError`].
pub(crate) fn pitchfork_point(
    curve: &mut PitchforkCurve,
    report: &AugmentedReport,
) -> Result<(CurvePoint, f64), SingularError> {
    let y = curve.solution.clone();
    let c = coefficient(curve, &y, report)?;
    Ok((curve_point(curve, Some(c)), c))
}

/// Corrections below this change a coefficient by less than 10⁻⁵ of itself.
const NEGLIGIBLE: f64 = 2e-9;

pub(crate) fn lost(kind: PointKind, parameter: Parameter, value: f64) -> impl Fn(CurveError) -> ShapeError {
    move |source| ShapeError::Curve { kind, parameter, value, source }
}

/// Follows the curve of the first pitchfork of a mirror-symmetric cell from one value of a parameter, where it is
/// located first, to another.
///
/// # Errors
/// [`ShapeError`]; `Curve` if the curve ends on the way, `NoPitchfork` if the cell's cue breaks the symmetry.
pub fn pitchfork_curve(cell: &Cell, numerics: &Numerics, parameter: Parameter, [from, to]: [f64; 2]) -> Result<Curve> {
    let cell = at_value(cell, parameter, from);
    let first = pitchfork::first(&cell, numerics, &BranchOptions::default())?;
    let curve = follow_pitchfork(&cell, &first, parameter, to, None)?;
    match curve.ended {
        CurveEnd::Reached => Ok(curve),
        CurveEnd::Stopped(error) => Err(error),
        CurveEnd::Cusp(CurvePoint { value, .. }) => {
            let turned = CurveError::NotReached { steps: curve.points.len(), reached: value };
            Err(lost(PointKind::Pitchfork, parameter, to)(turned))
        }
    }
}

/// Follows the curve through a pitchfork of a cell until the parameter reaches `to`, the curve turns back, or continuation fails. The
/// passage through `activity` is recorded.
fn follow_pitchfork(
    cell: &Cell,
    first: &Pitchfork,
    parameter: Parameter,
    to: f64,
    activity: Option<f64>,
) -> Result<Curve> {
    let lost = lost(PointKind::Pitchfork, parameter, to);
    let mut curve = through_pitchfork(cell, first, parameter, to > parameter.get(cell)).map_err(&lost)?;
    let mut found = Curve { points: vec![curve_point(&curve, Some(first.coefficient))], ..Curve::default() };
    let direction = curve.tangent.scalars[SECOND].signum();
    let mut before = [found.points[0].value, first.coefficient];
    let (mut failure, mut turned) = (None, false);
    let mut passage = activity.map(|xi_s| Passage::of(xi_s, &curve));
    let followed = curve.follow_to(SECOND, to, MOST_STEPS, |curve, report| {
        passage.iter_mut().for_each(|passage| passage.take_in(curve));
        turned = curve.tangent.scalars[SECOND] * direction < 0.0;
        if turned {
            return false;
        }
        match pitchfork_point(curve, report) {
            Ok((point, c)) => {
                let now = [point.value, c];
                if before[1] * c < 0.0 {
                    found.degenerate.extend(degenerate(curve, [before, now]));
                }
                found.points.push(point);
                before = now;
            }
            Err(error) => failure = Some(error),
        }
        failure.is_none()
    });
    found.iterations = curve.work.iterations;
    found.ended = match followed {
        Ok(()) => CurveEnd::Reached,
        Err(_) if turned => turned_back(&mut curve),
        Err(error) => CurveEnd::Stopped(lost(failure.map_or(error, CurveError::Start))),
    };
    let passed = passage.filter(|_| found.ended == CurveEnd::Reached).and_then(Passage::solve);
    found.at_activity = passed.and_then(|(mut curve, report)| Some(pitchfork_point(&mut curve, &report).ok()?.0));
    Ok(found)
}

/// The end of a curve that has just turned back in its parameter, located if possible.
fn turned_back<S: Singularity<Cortex> + Clone>(curve: &mut Codim2Curve<Cortex, S>) -> CurveEnd {
    if let Some(y) = curve.turning_point(SECOND) {
        curve.solution = y;
    }
    CurveEnd::Cusp(curve_point(curve, None))
}

/// The curves through the first pitchforks at some values of a parameter, over a range of it. The first pitchfork may lie on several
/// curves: where two pitchforks meet, both end, and a later one is the first.
fn pitchfork_curves<'p>(
    cell: &Cell,
    parameter: Parameter,
    [from, to]: [f64; 2],
    activity: Option<f64>,
    firsts: impl IntoIterator<Item = (f64, &'p Pitchfork)>,
) -> Vec<Curve> {
    let mut curves: Vec<Curve> = Vec::new();
    for (value, first) in firsts {
        if curves.iter().any(|curve| curve.passes(value, &first.point)) {
            continue;
        }
        let cell = at_value(cell, parameter, value);
        let follow = |end: f64, activity: Option<f64>| {
            (value != end).then(|| follow_pitchfork(&cell, first, parameter, end, activity).ok()).flatten()
        };
        let activity = activity.filter(|_| value == from);
        curves.extend(joined(follow(from, None), follow(to, activity)));
    }
    curves
}

/// One curve of two that begin at the same point: the first one backwards, then the second.
fn joined(backwards: Option<Curve>, forwards: Option<Curve>) -> Option<Curve> {
    let Some(mut curve) = backwards else { return forwards };
    let forwards = forwards.unwrap_or_else(|| Curve { points: vec![curve.points[0]], ..Curve::default() });
    curve.points.reverse();
    curve.points.extend(forwards.points.into_iter().skip(1));
    curve.degenerate.extend(forwards.degenerate);
    curve.iterations += forwards.iterations;
    // A curve has one end in its data: the second one, if both are within the range.
    if forwards.ended != CurveEnd::Reached {
        curve.ended = forwards.ended;
    }
    Some(curve)
}

/// The point between two values of the parameter where the coefficient vanishes, by the Illinois method.
fn degenerate(curve: &mut PitchforkCurve, ends: [[f64; 2]; 2]) -> Option<CurvePoint> {
    let mut bracket = Bracket::new(ends);
    for _ in 0..40 {
        let [low, high] = bracket.ends;
        let value = (low[0] * high[1] - high[0] * low[1]) / (high[1] - low[1]);
        let (y, report) = curve.at(SECOND, value).ok()?;
        let c = coefficient(curve, &y, &report).ok()?;
        if c.abs() < 1e-8 || (high[0] - low[0]).abs() < 1e-10 * value.abs() {
            let mut found = curve.clone();
            found.tangent = found.augmented.curve_direction(&y);
            found.solution = y;
            return Some(curve_point(&found, Some(c)));
        }
        bracket.keep([value, c]);
    }
    None
}

/// Follows one fold until the parameter reaches `to`, the curve turns back at a cusp or leaves ξ_s > 0, or continuation
/// fails. The passage through `activity` is recorded.
pub(crate) fn follow_fold(curve: &mut FoldCurve, parameter: Parameter, to: f64, activity: Option<f64>) -> Curve {
    let mut found = Curve { points: vec![curve_point(curve, None)], ..Curve::default() };
    let direction = curve.tangent.scalars[SECOND].signum();
    let (mut cusp, mut passive) = (false, false);
    let mut passage = activity.map(|xi_s| Passage::of(xi_s, curve));
    let followed = curve.follow_to(SECOND, to, MOST_STEPS, |curve, _| {
        passage.iter_mut().for_each(|passage| passage.take_in(curve));
        cusp = curve.tangent.scalars[SECOND] * direction < 0.0;
        passive = curve.solution.scalars[XI] <= 0.0;
        if !cusp && !passive {
            found.points.push(curve_point(curve, None));
        }
        !cusp && !passive
    });
    found.iterations = curve.work.iterations;
    found.ended = match followed {
        Err(CurveError::NotReached { .. }) if cusp => turned_back(curve),
        Err(CurveError::NotReached { .. }) if passive => {
            CurveEnd::Stopped(ShapeError::Inactive { kind: PointKind::Fold, parameter, value: to })
        }
        Err(error) => CurveEnd::Stopped(lost(PointKind::Fold, parameter, to)(error)),
        Ok(()) => {
            found.at_activity = passage.and_then(Passage::solve).map(|(curve, _)| curve_point(&curve, None));
            CurveEnd::Reached
        }
    };
    found
}

/// Refuses cues that differ for every cell.
pub(crate) fn refuse_par(cell: &Cell, kind: PointKind) -> Result<()> {
    match cell.cue.follows_par() {
        true => Err(ShapeError::FollowsPar { cell: CellName::of(cell), kind }),
        false => Ok(()),
    }
}

/// The curve of one fold from a cell to another value of the parameter, as far as continuation leads.
fn fold_curve(cell: &Cell, fold: &FoldPoint, parameter: Parameter, to: f64, activity: Option<f64>) -> Result<Curve> {
    let curve = through_fold(cell, fold, parameter, to > parameter.get(cell));
    Ok(follow_fold(&mut curve.map_err(lost(PointKind::Fold, parameter, to))?, parameter, to, activity))
}

/// The folds of the primary branches of a mirror-symmetric cell at both ends of a range of a parameter, followed over
/// the range: folds at the first end are followed to the second, and folds at the second end that no curve has reached
/// are followed to the first. A curve that ends early keeps its points, and the reason in [`Curve::ended`].
fn fold_curves(cell: &Cell, branches: [&Branch; 2], parameter: Parameter, range: [f64; 2]) -> Result<Vec<Curve>> {
    let mut curves: Vec<Curve> = Vec::new();
    for (branch, [start, end]) in branches.into_iter().zip([range, [range[1], range[0]]]) {
        let cell = at_value(cell, parameter, start);
        for fold in branch.folds() {
            let same = |a: f64, b: f64| (a - b).abs() <= 1e-6 * (1.0 + b.abs());
            let known = curves.iter().filter_map(|curve| curve.points.last()).any(|p| {
                same(p.value, start) && same(p.xi_s, fold.point.xi_s) && same(p.elongation, fold.point.elongation)
            });
            if !known {
                curves.push(fold_curve(&cell, fold, parameter, end, None)?);
            }
        }
    }
    Ok(curves)
}

/// Number of values within a range where folds and first pitchforks are looked for, beside both ends.
const INNER: usize = 7;
/// Largest relative distance of ξ_s at which a curve counts as passing through a fold.
const PASSES: f64 = 1e-3;
/// The same for the elongation.
const PASSES_BY: f64 = 0.02;

/// Values within a range, from its beginning on.
fn inner([from, to]: [f64; 2]) -> impl Iterator<Item = f64> {
    (1..=INNER).map(move |k| from + (to - from) * k as f64 / (INNER + 1) as f64)
}

/// Adds the curves through folds within the range, where no curve from its ends passes: between two cusps there are folds that
/// neither end has. Each is followed in both directions. `folds` has the folds of cells at some values.
fn add_inner(
    curves: &mut Vec<Curve>,
    cell: &Cell,
    parameter: Parameter,
    range: [f64; 2],
    folds: impl Iterator<Item = (f64, Vec<FoldPoint>)>,
) {
    for (value, folds) in folds {
        let cell = at_value(cell, parameter, value);
        for fold in folds {
            if !curves.iter().any(|curve| curve.passes(value, &fold.point)) {
                curves.extend(range.iter().filter_map(|end| fold_curve(&cell, &fold, parameter, *end, None).ok()));
            }
        }
    }
}

/// The curves that bound outcomes over a range of a parameter.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BoundaryCurves {
    /// The curves through the first pitchforks of a cell that is mirror-symmetric for every value of the parameter.
    pub pitchforks: Vec<Curve>,
    /// All folds of the primary branches of such a cell; for other cells, the fold that ends the stable shapes.
    pub folds: Vec<Curve>,
}

/// The curves that bound division of a cell over a range of a parameter, as [`boundary_curves`], with all folds of
/// mirror-symmetric shapes.
///
/// # Errors
/// [`ShapeError`] of the first end.
pub fn boundary_and_folds(
    cell: &Cell,
    numerics: &Numerics,
    parameter: Parameter,
    range: [f64; 2],
    activity: Option<f64>,
) -> Result<BoundaryCurves> {
    refuse_par(cell, PointKind::Fold)?;
    if domain_along(cell, parameter) == Domain::Full {
        let at_ends = boundary_curves(cell, numerics, parameter, range, activity);
        let mut folds = at_ends.as_ref().map_or(Vec::new(), |found| found.folds.clone());
        // Only the fold that ends the stable shapes bounds division.
        let failure = |value: f64| {
            let fold = primary::failure_fold(&at_value(cell, parameter, value), numerics, &StepBudget::unlimited());
            (value, fold.into_iter().collect())
        };
        add_inner(&mut folds, cell, parameter, range, inner(range).map(failure));
        return if folds.is_empty() { at_ends } else { Ok(BoundaryCurves { folds, ..BoundaryCurves::default() }) };
    }
    let [at_from, at_to] = range.map(|value| at_value(cell, parameter, value));
    let options = BranchOptions { pitchforks: 1, ..BranchOptions::default() };
    let branch = |cell: &Cell| primary::follow(cell, numerics, &options, |_| true);
    let ends = [pitchfork::branch_beyond(&at_from, numerics)?, branch(&at_to)?];
    let within = |value: f64| Some((value, branch(&at_value(cell, parameter, value)).ok()?));
    let within: Vec<(f64, Branch)> = inner(range).filter_map(within).collect();
    let all = range.into_iter().zip(&ends).chain(within.iter().map(|(value, branch)| (*value, branch)));
    let firsts = all.filter_map(|(value, branch)| Some((value, branch.pitchforks().next()?)));
    let pitchforks = pitchfork_curves(cell, parameter, range, activity, firsts);
    let mut folds = fold_curves(cell, ends.each_ref(), parameter, range)?;
    let folds_within = within.iter().map(|(value, branch)| (*value, branch.folds().cloned().collect()));
    add_inner(&mut folds, cell, parameter, range, folds_within);
    match pitchforks.is_empty() && folds.is_empty() {
        // The reason why there is no pitchfork.
        true => boundary_curves(cell, numerics, parameter, range, activity),
        false => Ok(BoundaryCurves { pitchforks, folds }),
    }
}

/// The error if no curve can be followed from either end of a range; `error` belongs to the first end.
fn no_end(error: ShapeError, parameter: Parameter, to: f64) -> ShapeError {
    match error {
        ShapeError::NotFound { .. } | ShapeError::TurnsBack { .. } => {
            ShapeError::NoEnd { source: Box::new(error), parameter, to }
        }
        error => error,
    }
}

/// The curves that bound division of a cell over a range of a parameter: the curves of its first pitchfork if it is
/// mirror-symmetric for every value of the parameter, looked for at both ends and in the middle, else the curve of the
/// fold that ends its stable shapes. If this point is not found at one end of the range, the curve is followed from the
/// other end; if the curve of folds ends on the way, for example in a cusp, a second curve is followed from there. If `activity` is given,
/// [`Curve::at_activity`] of a curve from the first end is its passage through it; a curve from the other end has none
/// recorded.
///
/// # Errors
/// [`ShapeError`] of the first end.
pub fn boundary_curves(
    cell: &Cell,
    numerics: &Numerics,
    parameter: Parameter,
    [from, to]: [f64; 2],
    activity: Option<f64>,
) -> Result<BoundaryCurves> {
    refuse_par(cell, PointKind::Fold)?;
    if domain_along(cell, parameter) == Domain::Half {
        let first =
            |value: f64| pitchfork::first(&at_value(cell, parameter, value), numerics, &BranchOptions::default());
        let values = [from, to, 0.5 * (from + to)];
        let found = values.map(first);
        let firsts = values.into_iter().zip(&found).filter_map(|(value, first)| Some((value, first.as_ref().ok()?)));
        let pitchforks = pitchfork_curves(cell, parameter, [from, to], activity, firsts);
        return match (pitchforks.is_empty(), found) {
            (true, [Err(error), ..]) => Err(no_end(error, parameter, to)),
            _ => Ok(BoundaryCurves { pitchforks, folds: Vec::new() }),
        };
    }
    let curve = |from: f64, to: f64, activity: Option<f64>| {
        let cell = at_value(cell, parameter, from);
        let fold = primary::failure_fold(&cell, numerics, &StepBudget::unlimited())?;
        fold_curve(&cell, &fold, parameter, to, activity)
    };
    let forwards = curve(from, to, activity);
    if let Ok(Curve { ended: CurveEnd::Reached, .. }) = forwards {
        return Ok(BoundaryCurves { folds: vec![forwards?], ..BoundaryCurves::default() });
    }
    match (forwards, curve(to, from, None)) {
        (Err(error), Err(_)) => Err(no_end(error, parameter, to)),
        (forwards, backwards) => {
            let folds = forwards.into_iter().chain(backwards).collect();
            Ok(BoundaryCurves { folds, ..BoundaryCurves::default() })
        }
    }
}
