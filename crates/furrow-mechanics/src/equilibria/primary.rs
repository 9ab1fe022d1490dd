//! The primary branch: the stationary shapes that start at the passive shape as activity rises.
//!
//! For a mirror-symmetric cell, without a cue or with an even one, they are mirror-symmetric and are computed on the
//! half domain, where pitchforks are simple zeros of one determinant. A cue that distinguishes the poles breaks the
//! symmetry, and the pitchfork becomes imperfect: the branch leans to one side and its stable part ends, where the cell
//! begins to divide, in a fold.

use furrow_bvp::newton::NewtonScratch;
use furrow_bvp::{Continuation, ContinuationSettings, Newton, SingularError, Solution, SymmetryBreaking, System, mesh};
use ordered_float::OrderedFloat;

use super::azimuthal_scan::AzimuthalScan;
use super::branch::{Branch, BranchEnd, BranchEvent, BranchOptions, FoldPoint, NARROWEST, begin, newest_contour};
use super::budget::StepBudget;
use super::error::{CellName, PointKind, Result, ShapeError, resolved, with_paper_law};
use super::locate::{course, deflated, end_at_width, folds_near, not_located, pitchfork_near};
use super::passive::{passive, passive_whole};
use super::point::ShapePoint;
use super::rates::{self, Shape, with_rates};
use crate::cortex::observables::{PINCH_OFF, with_components};
use crate::cortex::{Cortex, Domain};
use crate::law;
use crate::stability::Stability;
use furrow_cell::{Cell, Numerics};

/// Smallest fraction of a cue in which it is switched on.
const SMALLEST_PART: f64 = 1e-3;

/// The shape of a cell without activity, with its cue: half of the contour if the cell is mirror-symmetric. In a wide
/// shell a weak cue moves the passive cell far: the shape is reached from the shape without a cue, by fractions of the
/// cue if necessary.
///
/// # Errors
/// [`ShapeError::Passive`], [`ShapeError::Cue`].
pub(crate) fn passive_with_cue(cell: &Cell, numerics: &Numerics) -> Result<Solution> {
    let name = CellName::of(cell);
    let domain = Domain::of(cell);
    let found = if domain == Domain::Half { passive(cell, numerics) } else { passive_whole(cell, numerics) };
    let (mut y, _) = found.map_err(|source| match law::cannot_rest(cell) {
        Some(source) => ShapeError::Law { cell: name, source },
        None => ShapeError::Passive { cell: name, source },
    })?;
    if cell.cue.is_none() && cell.cue.regulator().is_none() {
        return Ok(y);
    }
    let mut cortex = Cortex::new(&Cell { xi_s: 0.0, ..cell.clone() }, domain, &[]);
    let mut system = System::new(Cortex::dimensions_for(cell, 0), numerics.stages);
    y = with_components(&y, cortex.components());
    let mut scratch = NewtonScratch::default();
    let (mut share, mut step) = (0.0, 1.0);
    while share < 1.0 {
        let next = f64::min(share + step, 1.0);
        cortex.cell.cue = cell.cue.scaled(next);
        cortex.refresh();
        let mut trial = y.clone();
        match Newton::default().solve(&mut system, &mut scratch, &mut cortex, &mut trial, &[], false) {
            Ok(_) => (share, y) = (next, trial),
            Err(source) => {
                step *= 0.5;
                if step < SMALLEST_PART {
                    // A regulator that acts through the law alone has no amplitude that could be smaller.
                    return Err(ShapeError::Cue { cell: name, source, painted: !cell.cue.is_none() });
                }
            }
        }
    }
    Ok(y)
}

/// The primary branch at ξ_s = 0, ready for continuation to larger ξ_s.
///
/// # Errors
/// [`ShapeError::Passive`], [`ShapeError::Cue`], [`ShapeError::Law`], [`ShapeError::Branch`].
pub fn start(cell: &Cell, numerics: &Numerics, settings: &ContinuationSettings) -> Result<Continuation<Cortex>> {
    let y = passive_with_cue(cell, numerics)?;
    let inactive = Cortex::new(&Cell { xi_s: 0.0, ..cell.clone() }, Domain::of(cell), &[]);
    match law::short_waves(&inactive, &y) {
        Some(source) => Err(ShapeError::Law { cell: CellName::of(cell), source }),
        None => begin(y, cell, settings),
    }
}

/// Detects folds and pitchforks along the branch.
struct EventDetector {
    breaking: SymmetryBreaking,
    /// Number of parts into which mesh intervals are divided before a point is located.
    refinement: usize,
    /// Number of pitchforks still to be found.
    pitchforks: usize,
    /// Last sign of the antisymmetric determinant. The first one seen is the reference, since passive shapes have no
    /// antisymmetric null vector.
    sign: Option<f64>,
    stop: Option<BranchEnd>,
}

impl EventDetector {
    /// The pitchfork between the last two points, if the antisymmetric determinant has changed sign.
    ///
    /// The sign is taken at the point itself: on constricted shapes the corrector's prediction, whose error is
    /// comparable to the neck's radius, can lie on the other side of a pitchfork for several points. A failed pivot has
    /// no sign; the next point is used instead.
    fn pitchfork(&mut self, branch: &mut Continuation<Cortex>) -> Option<BranchEvent> {
        if branch.problem.domain == Domain::Full || self.pitchforks == 0 || branch.factorise_newest().is_err() {
            return None;
        }
        let (now, _) = self.breaking.test(&branch.system, &branch.problem).ok()?;
        if now == 0.0 {
            return None;
        }
        let before = self.sign.replace(now)?;
        if before == now {
            return None;
        }
        self.refine(branch);
        self.pitchforks -= 1;
        let found = pitchfork_near(branch, [before, now]).map(|found| BranchEvent::Pitchfork(Box::new(found)));
        self.located(branch, PointKind::Pitchfork, found)
    }

    /// Leaves the coarse mesh, once.
    fn refine(&mut self, branch: &mut Continuation<Cortex>) {
        let parts = std::mem::replace(&mut self.refinement, 1);
        if parts > 1 {
            branch.move_to(&mesh::subdivided(&branch.state.solution.mesh, parts));
        }
    }

    /// The folds between the last two points.
    fn folds(&mut self, branch: &mut Continuation<Cortex>, before: [f64; 3], passed: bool) -> Vec<BranchEvent> {
        let found = folds_near(branch, before, passed);
        let found = self.located(branch, PointKind::Fold, found).unwrap_or_default();
        found.into_iter().map(|fold| BranchEvent::Fold(Box::new(fold))).collect()
    }

    fn located<T>(&mut self, at: &Continuation<Cortex>, kind: PointKind, found: Result<T, SingularError>) -> Option<T> {
        found.map_err(|source| self.stop = Some(not_located(at, kind, source))).ok()
    }
}

/// Follows the primary branch until ξ_s leaves its range or the neck is pinched off, and locates every fold and
/// pitchfork on the way. `wanted` receives every event and may end the branch early. The branch also ends, with the
/// events found so far, at a singular point that cannot be located or where continuation fails: see [`Branch::ended`].
///
/// # Examples
/// At R0 = 2 the symmetric shapes lose their stability at a pitchfork, and end in a fold at a larger activity:
///
/// ```
/// use furrow_cell::{Cell, Numerics};
/// use furrow_mechanics::equilibria::{BranchOptions, PointKind, primary};
/// let branch = primary::follow(&Cell::new(2.0), &Numerics::default(), &BranchOptions::default(), |_| true)?;
/// let xi = |kind| branch.events.iter().find(|event| event.kind() == kind).map(|event| event.point().xi_s);
/// let (pitchfork, fold) = (xi(PointKind::Pitchfork).unwrap(), xi(PointKind::Fold).unwrap());
/// assert!((pitchfork - 22.065).abs() < 1e-3 && (fold - 27.38).abs() < 0.01);
/// # Ok::<(), furrow_mechanics::equilibria::ShapeError>(())
/// ```
///
/// # Errors
/// [`ShapeError::Passive`], [`ShapeError::Cue`], [`ShapeError::Branch`] at ξ_s = 0.
pub fn follow(
    cell: &Cell,
    numerics: &Numerics,
    options: &BranchOptions,
    mut wanted: impl FnMut(&BranchEvent) -> bool,
) -> Result<Branch> {
    follow_within(cell, numerics, options, &StepBudget::unlimited(), &mut wanted)
}

/// As [`follow`], within a budget.
///
/// # Errors
/// The errors of [`follow`]; [`ShapeError::OutOfBudget`] and [`ShapeError::Interrupted`] if the search is stopped
/// before the end of the branch.
pub fn follow_within(
    cell: &Cell,
    numerics: &Numerics,
    options: &BranchOptions,
    budget: &StepBudget<'_>,
    wanted: &mut dyn FnMut(&BranchEvent) -> bool,
) -> Result<Branch> {
    budget.check(cell)?;
    let cell = &*resolved(cell)?;
    if options.azimuthal > 0 {
        with_paper_law(cell)?;
    }
    let (numerics, refinement) = if options.coarse { coarse(numerics) } else { (*numerics, 1) };
    let mut branch = start(cell, &numerics, &options.settings)?;
    let (breaking, pitchforks) = (SymmetryBreaking::default(), options.pitchforks);
    let mut detector = EventDetector { breaking, refinement, pitchforks, sign: None, stop: None };
    let mut contours = Vec::from_iter(options.contours.then(|| newest_contour(&branch)));
    let mut azimuthal = AzimuthalScan::new(options.azimuthal);
    azimuthal.take_in(&branch);
    let (mut points, mut events) = (vec![ShapePoint::newest(&branch, 0)], Vec::new());
    let mut before = course(&branch);
    let narrowest = if branch.problem.domain == Domain::Half { PINCH_OFF } else { NARROWEST };
    let (ended, (rates, hopf)) = with_rates(&mut branch, options.growth_rates, |branch, rate| {
        rate(&branch.state.solution, 0, Shape::Point);
        branch.follow(options.xi, options.points, |branch, advance| {
            let mut new: Vec<BranchEvent> = detector.pitchfork(branch).into_iter().collect();
            new.extend(detector.folds(branch, before, advance.passed_fold));
            new.sort_by_cached_key(|item| OrderedFloat(item.point().arclength));
            // A point that cannot be located may lie beyond the end.
            if let Some(end) = end_at_width(branch, narrowest).or_else(|| deflated(branch, options.reduced_volume)) {
                detector.stop = Some(end);
                new.retain(|event| event.point().arclength <= branch.state.arclength);
            }
            before = course(branch);
            azimuthal.take_in(branch);
            contours.extend(options.contours.then(|| newest_contour(branch)));
            new.iter().enumerate().for_each(|(k, event)| rate(event.shape(), events.len() + k, Shape::Event));
            let passed = events.len() + new.len();
            rate(&branch.state.solution, passed, Shape::Point);
            points.push(ShapePoint::newest(branch, passed));
            let enough = new.iter().any(|event| !wanted(event));
            events.extend(new);
            budget.spend(1 + advance.rejected) && detector.stop.is_none() && !enough
        })
    });
    budget.check(cell)?;
    rates::put(&rates, &mut points);
    let found = Branch::complete(&branch, (points, contours, azimuthal), events, ended, detector.stop);
    Ok(Branch { hopf, ..found })
}

/// Factor by which a coarse mesh of half a contour has fewer intervals, and its least number of intervals.
const COARSER: usize = 3;
const FEWEST: usize = 8;

/// A discretisation accurate enough to follow a branch, and the number of parts into which its intervals must be
/// divided to give the original one. The original is returned, with one part, if it is coarse already.
pub(super) fn coarse(numerics: &Numerics) -> (Numerics, usize) {
    let wanted = numerics.intervals / 2;
    let parts = if wanted.is_multiple_of(COARSER) && wanted >= FEWEST * COARSER { COARSER } else { 1 };
    (Numerics { intervals: 2 * (wanted / parts), ..*numerics }, parts)
}

/// Bound of the growth rate at a fold that ends stable shapes, in 1/τ: the mode of the fold itself neither grows nor
/// decays.
const MARGINAL: f64 = 1e-3;

/// The fold at which the last stable shape of the branch ends; above its ξ_s a cell with a cue divides. In a wide shell
/// this is not the first fold, but the fold at the end of the second rise of an S.
///
/// # Errors
/// The errors of [`follow_within`]; `NotFound` if no stable shape ends in a fold in the range.
pub fn failure_fold(cell: &Cell, numerics: &Numerics, budget: &StepBudget<'_>) -> Result<FoldPoint> {
    let cell = &*resolved(cell)?;
    let options = BranchOptions { pitchforks: 0, ..BranchOptions::default() };
    let Branch { events, ended, .. } = follow_within(cell, numerics, &options, budget, &mut |_| true)?;
    let cortex = Cortex::new(cell, Domain::of(cell), &[furrow_cell::Parameter::XiS]);
    let mut stability = Stability::new(numerics.stages);
    let mut ends_stable = |fold: &FoldPoint| {
        fold.maximum && stability.growth_rate(&cortex, &fold.shape).is_ok_and(|rate| rate < MARGINAL)
    };
    let folds = events.iter().filter_map(BranchEvent::fold).filter(|fold| ends_stable(fold));
    folds.max_by(|a, b| a.point.xi_s.total_cmp(&b.point.xi_s)).cloned().ok_or_else(|| {
        let none = ShapeError::NotFound { cell: CellName::of(cell), kind: PointKind::Fold, xi_max: options.xi[1] };
        ended.error().cloned().unwrap_or(none)
    })
}
