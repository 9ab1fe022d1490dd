//! Solves a boundary-value problem to an accuracy: Newton, then redistribution and refinement of the mesh, until the defect
//! is below a tolerance.
//!
//! # References
//! Ascher, Mattheij & Russell 1995, ch. 9 (mesh selection). Kierzenka & Shampine, ACM Trans. Math. Softw. 27, 299 (2001)
//! (control of the defect).

use crate::direction::Direction;
use crate::gauss::Gauss;
use crate::invalid::{self, InvalidInput};
use crate::linear::System;
use crate::mesh;
use crate::problem::BoundaryValueProblem;
use crate::solution::Solution;

use super::carried;
use super::condition;
use super::homotopy;
use super::iteration::{Newton, NewtonError, NewtonScratch};
use super::limits::{Interrupt, Stop, WorkLimit};
use super::solved::{SMOOTH, Solved, smooth_slopes};
use super::work::Work;

/// Settings of [`solve`].
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// Bound on the largest defect |u′ − f(u)| · h / (1 + |u|) of any component, see [`mesh::defect`].
    pub tolerance: f64,
    /// Bound on the estimated error |δ| / (1 + |u|) of any component as well, see [`Solved::error`].
    pub error: Option<f64>,
    /// Most intervals.
    pub max_intervals: usize,
    /// The iteration on every mesh. The tolerance of the defect may tighten its own.
    pub newton: Newton,
    /// Most work, in factorisations of a mesh of `max_intervals`.
    pub budget: f64,
    /// Most corrections of the homotopy, which is tried where Newton fails; 0 switches it off.
    pub homotopy: usize,
    /// Ends the solve from outside.
    pub interrupt: Interrupt,
}

impl Default for Settings {
    fn default() -> Self {
        Settings {
            tolerance: 1e-6,
            error: None,
            max_intervals: 2000,
            newton: Newton::default(),
            budget: BUDGET,
            homotopy: 1500,
            interrupt: Interrupt::default(),
        }
    }
}

/// The hardest case that is solved in the table of Cash and Mazzia takes a quarter of it.
pub(crate) const BUDGET: f64 = 1000.0;

impl Settings {
    /// Checks the settings.
    ///
    /// # Errors
    /// [`InvalidInput::Setting`].
    pub fn check(&self) -> Result<(), InvalidInput> {
        invalid::positive("the tolerance", self.tolerance)?;
        self.error.map_or(Ok(()), |error| invalid::positive("the bound on the error", error))?;
        invalid::setting("the budget", self.budget, self.budget > 0.0, "a number above 0")?;
        self.newton.check()
    }
}

/// Why a problem was not solved to the accuracy asked for.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SolveError {
    /// The problem, the guess or the settings are refused. (See [`Continuation`](crate::Continuation) for problems that lack a
    /// condition.)
    #[error(transparent)]
    Invalid(#[from] InvalidInput),
    /// Newton does not converge, on the last mesh tried and on some coarser ones.
    #[error("no convergence on {intervals} intervals: {source}")]
    Newton {
        /// Intervals of the last mesh tried.
        intervals: usize,
        /// Error of the iteration there.
        source: NewtonError,
        /// The solution of smallest defect on the meshes before, if there is any.
        best: Option<Box<Solved>>,
    },
    /// The equations have more than one solution nearby, or a solution that grows without bound as the mesh is refined: the condition
    /// grows with every halving of the intervals, or the Jacobian has no inverse.
    #[error("the problem is singular: its condition is {condition:.1e} on {intervals} intervals")]
    Singular {
        /// Condition on the last mesh, see [`Solved::condition`].
        condition: f64,
        /// Intervals of that mesh.
        intervals: usize,
    },
    /// More intervals make the defect no smaller: what remains is rounding.
    #[error("rounding limits the defect to {:.3e} on {} intervals", .best.defect, .best.solution.intervals())]
    Rounding {
        /// The solution of smallest defect.
        best: Box<Solved>,
    },
    /// It was ended from outside.
    #[error("{reason} on {intervals} intervals")]
    Stopped {
        /// Why.
        reason: Stop,
        /// Intervals of the last mesh.
        intervals: usize,
        /// The solution of smallest defect on the meshes before, if there is any.
        best: Option<Box<Solved>>,
    },
    /// The bound on the error would need more intervals than allowed.
    #[error(
        "the limit of {limit} intervals is reached before the bound on the error: its estimate takes {}",
        2 * .best.solution.intervals()
    )]
    ErrorLimit {
        /// Most intervals allowed.
        limit: usize,
        /// A solution within the tolerance of the defect.
        best: Box<Solved>,
    },
    /// The accuracy asked for would need more intervals than allowed.
    #[error("the limit of {limit} intervals is reached with a defect of {:.3e}", .best.defect)]
    MeshLimit {
        /// Most intervals allowed.
        limit: usize,
        /// The solution of smallest defect.
        best: Box<Solved>,
    },
}

/// Consecutive meshes on which Newton may fail before a homotopy is tried.
const FAILURES: usize = 3;

/// Where the condition times the defect is larger, the problem may be singular.
const SUSPECT: f64 = 1e-2;

/// A larger condition is estimated again, on halved intervals: Newton's last factors may belong to a point before the solution.
const LARGE: f64 = 1e8;

/// The condition of a singular problem grows at least by this factor where the intervals are halved.
const GROWN: f64 = 4.0;

/// A problem of larger condition is singular to rounding.
const SINGULAR: f64 = 1e12;

/// Where Newton stalls with a correction as small as this, rounding stops it.
const STALLED_BY_ROUNDING: f64 = 1e-9;

/// The same relative to the tolerance.
const STALLED_SHARE: f64 = 0.1;

/// A larger correction than this is not accepted, whatever the condition.
const LARGEST_ROUNDING: f64 = 1e-5;

/// A defect below this that twice as many intervals do not make smaller is one of rounding.
const ROUNDING: f64 = 1e-8;

/// Rounding of a right-hand side, relative to 1 + |value|.
const ROUNDED: f64 = 8.0 * f64::EPSILON;

/// Least width of an interval, in the spacing of numbers there.
const LEAST_WIDTH: f64 = 16.0;

/// Newton is asked for no smaller corrections.
const LEAST_TOLERANCE: f64 = 1e-14;

/// A solution on this many times the intervals it needs is tried again on those it needs.
const WASTEFUL: usize = 2;

/// More intervals are worth it if they bring the defect down to this fraction.
const PROGRESS: f64 = 0.5;

/// Where the error is too large, the tolerance of the defect is multiplied by this part of their quotient.
const TIGHTENING: f64 = 0.3;
/// The tolerance is multiplied by no less.
const LEAST_TIGHTENING: f64 = 1e-4;

/// Where Newton's method fails on halved intervals, the tolerance is multiplied by the same, but not below this.
const LEAST_TIGHTENED: f64 = 1e-9;

/// A defect tolerance is worth this many of Newton's.
pub(crate) const NEWTON_SHARE: f64 = 1e-2;

/// Solves a square problem to a defect below a tolerance, from a guess on any mesh, with the guess's number of stages.
///
/// On every mesh Newton solves the collocation equations; a full step that leaves next to no residual ends it, so that a linear problem
/// takes one solve unless rounding leaves a larger one. Where the defect is too large, the mesh is redistributed so that
/// every interval has an equal share of it, with as many intervals as its order h^(m+1) asks for, and graded towards layers.
/// A bound on the error is checked with a further solution on halved intervals, which is returned, with one more correction, and beside
/// nodes, where both may miss the same jump of f; where the error is larger, the defect is made smaller. As long as a layer is too thin to be seen, intervals are added where the solution changes most. Where Newton fails,
/// intervals are halved. Where it fails three times, a homotopy leads from the guess to a solution: the residual of the guess
/// is taken away step by step, and the mesh follows the layers. Where that fails too, a few steps are taken on each of several meshes, which
/// are refined although the iterates have not converged. A mesh twice as fine as needed is coarsened at the end. All of it
/// has a budget of work, and ends before the next factorisation once the interrupt of the settings is set.
///
/// # Errors
/// [`SolveError`], with the best solution found on the way.
///
/// # Examples
/// y″ = 3/2 y² with y(0) = 4, y(1) = 1 is solved by 4/(1 + x)²:
///
/// ```
/// use furrow_bvp::{BoundaryJacobian, BoundaryValueProblem, CollocationPoint, Dimensions, Gauss, PointJacobian, Settings, Solution};
///
/// struct Example;
///
/// impl BoundaryValueProblem for Example {
///     fn dimensions(&self) -> Dimensions {
///         Dimensions { components: 2, quadratures: 1, scalars: 0, left: 1, right: 1, ..Dimensions::default() }
///     }
///     fn rhs(&self, _: CollocationPoint, y: &[f64], _: &[f64], f: &mut [f64], _: &mut [f64]) {
///         f.copy_from_slice(&[y[1], 1.5 * y[0] * y[0]]);
///     }
///     fn rhs_jacobian(&self, at: CollocationPoint, y: &[f64], p: &[f64], out: &mut PointJacobian<'_>) {
///         self.rhs(at, y, p, out.f, out.g);
///         out.fy.copy_from_slice(&[0.0, 1.0, 3.0 * y[0], 0.0]);
///     }
///     fn left(&self, y: &[f64], _: &[f64], out: &mut BoundaryJacobian<'_>) {
///         (out.r[0], out.ry[0]) = (y[0] - 4.0, 1.0);
///     }
///     fn right(&self, y: &[f64], _: &[f64], out: &mut BoundaryJacobian<'_>) {
///         (out.r[0], out.ry[0]) = (y[0] - 1.0, 1.0);
///     }
/// }
///
/// let gauss = Gauss::new(4)?;
/// let line = |x: f64, y: &mut [f64]| y.copy_from_slice(&[4.0 - 3.0 * x, -3.0]);
/// let guess = Solution::from_fn(&gauss, &furrow_bvp::mesh::uniform(0.0, 1.0, 4), 2, &[], line)?;
/// let solved = furrow_bvp::solve(&mut Example, &guess, &Settings { tolerance: 1e-9, ..Settings::default() })?;
/// let mut y = [0.0; 2];
/// solved.eval(&gauss, 0.5, &mut y);
/// assert!((y[0] - 4.0 / 1.5f64.powi(2)).abs() < 1e-9);
/// # Ok::<(), furrow_bvp::SolveError>(())
/// ```
pub fn solve(
    problem: &mut dyn BoundaryValueProblem,
    guess: &Solution,
    settings: &Settings,
) -> Result<Solved, SolveError> {
    let dims = problem.dimensions();
    settings.check()?;
    guess.fits(dims)?;
    if dims.missing_conditions() != 0 {
        return Err(InvalidInput::NotSquare { missing: dims.missing_conditions(), allowed: "0" }.into());
    }
    let limit = WorkLimit::new(settings.budget, settings.max_intervals, &settings.interrupt);
    let mut run = Run {
        problem,
        settings,
        tolerance: settings.tolerance,
        system: System::new(dims, guess.m),
        scratch: NewtonScratch::limited(limit).trusting_residuals(),
        work: Work::default(),
        best: None,
        guess,
        homotopy_tried: false,
    };
    run.solve(guess.clone())
}

/// What follows from a defect below the tolerance.
enum Accepted {
    Solved(Box<Solved>),
    /// To be solved with a smaller defect.
    Again(Solution),
}

/// One call of [`solve`].
struct Run<'a> {
    problem: &'a mut dyn BoundaryValueProblem,
    settings: &'a Settings,
    /// Bound on the defect, which a bound on the error tightens.
    tolerance: f64,
    system: System,
    scratch: NewtonScratch,
    work: Work,
    /// The solution of smallest defect.
    best: Option<Box<Solved>>,
    /// The guess.
    guess: &'a Solution,
    /// Homotopy was tried.
    homotopy_tried: bool,
}

impl Run<'_> {
    fn solve(&mut self, mut y: Solution) -> Result<Solved, SolveError> {
        let limit = self.settings.max_intervals;
        let mut refinement = mesh::Refinement::new(self.tolerance, limit);
        loop {
            y = self.solve_with_refinement(y)?;
            let (defects, slopes) = self.defects(&y);
            let defect = largest(&defects);
            let halved = self.best.as_ref().is_some_and(|best| WASTEFUL * best.solution.intervals() <= y.intervals());
            if halved && defect <= ROUNDING && self.best.as_ref().is_some_and(|best| defect >= PROGRESS * best.defect) {
                return Err(SolveError::Rounding { best: self.take_best_or(y, defect) });
            }
            if defect <= self.tolerance {
                let solved = match self.accepted(y, defects, slopes)? {
                    Accepted::Solved(solved) => *solved,
                    Accepted::Again(again) => {
                        (refinement, y) = (mesh::Refinement::new(self.tolerance, limit), again);
                        continue;
                    }
                };
                let Some(allowed) = self.settings.error else { return Ok(solved) };
                let solved = self.with_error(solved)?;
                let error = solved.error.unwrap_or_default();
                if error <= allowed {
                    return Ok(solved);
                }
                self.tolerance *= (TIGHTENING * allowed / error).clamp(LEAST_TIGHTENING, TIGHTENING);
                refinement = mesh::Refinement::new(self.tolerance, limit);
                y = solved.solution;
                continue;
            }
            self.keep_best(&y, defect);
            let Some(grid) = refinement.next(&y, &defects) else {
                return Err(SolveError::MeshLimit { limit, best: self.take_best_or(y, defect) });
            };
            if is_degenerate(&grid) {
                return Err(SolveError::Rounding { best: self.take_best_or(y, defect) });
            }
            y = self.moved(&y, &grid);
        }
    }

    /// The solution, on a coarser mesh if that is fine enough; an error if the problem is singular.
    fn accepted(&mut self, y: Solution, defects: Vec<f64>, slopes: Vec<f64>) -> Result<Accepted, SolveError> {
        let (condition, defect) = (condition::estimate(&mut self.system, &y), largest(&defects));
        let needed = mesh::intervals_for(&y.mesh, &defects, y.m, self.tolerance).max(2);
        let solved = Solved { solution: y, defect, condition, work: self.work, slopes, error: None };
        if condition * defect > SUSPECT || condition > LARGE {
            return self.settled(solved);
        }
        if WASTEFUL * needed <= solved.solution.intervals()
            && let Some(coarser) = self.on_coarser(&solved, &defects, needed)
        {
            return if coarser.condition > LARGE {
                self.settled(coarser)
            } else {
                Ok(Accepted::Solved(Box::new(coarser)))
            };
        }
        Ok(Accepted::Solved(Box::new(Solved { work: self.work, ..solved })))
    }

    /// The solution on intervals that are halved until its condition no longer grows; an error if it grows without bound, as the condition of
    /// a singular problem does.
    fn settled(&mut self, mut solved: Solved) -> Result<Accepted, SolveError> {
        loop {
            let Solved { solution: y, condition, .. } = &solved;
            let (condition, intervals) = (*condition, y.intervals());
            let mut finer = self.moved(y, &mesh::halved(&y.mesh));
            match self.newton(&mut finer) {
                Ok(()) => {}
                Err(NewtonError::Stopped { reason, .. }) => return Err(self.stopped(reason, finer.intervals())),
                Err(_) if self.tolerance > LEAST_TIGHTENED => {
                    // The defect moves the solution farther than Newton's method converges from.
                    self.tolerance *= LEAST_TIGHTENING;
                    return Ok(Accepted::Again(solved.solution));
                }
                Err(_) => return Err(SolveError::Singular { condition, intervals }),
            }
            let on_finer = condition::estimate(&mut self.system, &finer);
            let grows = on_finer > GROWN * condition || solved.defect > self.tolerance;
            if on_finer > singular(&finer) || grows && 4 * intervals > self.settings.max_intervals {
                return Err(SolveError::Singular { condition: on_finer, intervals: finer.intervals() });
            }
            let (defects, slopes) = self.defects(&finer);
            let defect = largest(&defects);
            let work = self.work;
            let finer = Solved { solution: finer, defect, condition: on_finer, work, slopes, error: None };
            match grows {
                true => solved = finer,
                false => return Ok(Accepted::Solved(Box::new(Solved { work, ..solved }))),
            }
        }
    }

    /// The solution on the number of intervals that it needs, if it is the same there.
    fn on_coarser(&mut self, solved: &Solved, defects: &[f64], needed: usize) -> Option<Solved> {
        let (y, tolerance) = (&solved.solution, self.tolerance);
        let mut coarser = self.moved(y, &mesh::redistributed(&y.mesh, defects, y.m, needed, y.intervals()));
        self.newton(&mut coarser).ok()?;
        let (defects, slopes) = self.defects(&coarser);
        let defect = largest(&defects);
        if defect > tolerance {
            return None;
        }
        let condition = condition::estimate(&mut self.system, &coarser);
        let coarser = Solved { solution: coarser, defect, condition, work: self.work, slopes, error: None };
        let agrees = apart(&self.system.gauss, &coarser, y) <= SMOOTH * tolerance * condition.max(1.0);
        agrees.then_some(coarser)
    }

    /// The solution on halved intervals, with its error.
    fn with_error(&mut self, solved: Solved) -> Result<Solved, SolveError> {
        let y = &solved.solution;
        let intervals = 2 * y.intervals();
        if intervals > self.settings.max_intervals {
            return Err(SolveError::ErrorLimit { limit: self.settings.max_intervals, best: Box::new(solved) });
        }
        let mut finer = self.moved(y, &mesh::halved(&y.mesh));
        match self.newton(&mut finer) {
            Ok(()) => {}
            Err(NewtonError::Stopped { reason, .. }) => return Err(self.stopped(reason, intervals)),
            Err(source) => return Err(SolveError::Newton { intervals, source, best: Some(Box::new(solved)) }),
        }
        let apart = apart(&self.system.gauss, &solved, &finer).max(relative(&y.scalars, &finer.scalars));
        let (defects, slopes) = self.defects(&finer);
        // Newton's last factors may belong to an iterate before a nearly singular solution.
        self.work.factorisations += 1;
        let factorised = self.system.factorise(self.problem, &finer, &[]).is_ok();
        let condition = if factorised { condition::estimate(&mut self.system, &finer) } else { f64::INFINITY };
        // A solution may approach one that leaves a scalar free, such as rest where a period is sought.
        if condition > singular(&finer) {
            return Err(SolveError::Singular { condition, intervals });
        }
        let missed = condition.max(1.0) * self.missed(&finer, &defects);
        let rounding = self.unsettled(&finer).max(condition * f64::EPSILON);
        let error = (apart / (2f64.powi(y.m as i32) - 1.0)).max(missed).max(rounding);
        let (defect, work) = (largest(&defects), self.work);
        Ok(Solved { solution: finer, defect, condition, work, slopes, error: Some(error) })
    }

    /// One more correction, with the factors of Newton's last iterate: what rounding leaves of the error.
    fn unsettled(&mut self, y: &Solution) -> f64 {
        let mut correction = Direction::default();
        let solved =
            self.system.evaluate(self.problem, y, &[], false).and_then(|()| self.system.solve_own(&mut correction));
        solved.map_or(f64::INFINITY, |()| correction.norm(y))
    }

    /// Integral of |u′ − f(u)| beside nodes where f jumps or is not smooth: halved intervals may miss the same jump.
    fn missed(&mut self, y: &Solution, defects: &[f64]) -> f64 {
        let gauss = &self.system.gauss;
        let Some([_, beside]) = mesh::beside_nodes(gauss, self.problem, y) else { return f64::INFINITY };
        let is_jump = |(size, defect): (&f64, &f64)| *size > SMOOTH * defect.max(ROUNDED);
        if !beside.iter().zip(defects).any(is_jump) {
            return 0.0;
        }
        let missed = mesh::missed(gauss, self.problem, y);
        let jumps = missed.iter().zip(beside.iter().zip(defects)).filter(|(_, sizes)| is_jump(*sizes));
        jumps.map(|([integral, _], _)| integral).sum()
    }

    fn stopped(&mut self, reason: Stop, intervals: usize) -> SolveError {
        SolveError::Stopped { reason, intervals, best: self.best.take() }
    }

    /// Defects of the intervals. If a tolerance allows them, intervals with a jump of f beside a node have the size of the jump, and the slopes
    /// at the nodes are the second result.
    fn defects(&mut self, y: &Solution) -> (Vec<f64>, Vec<f64>) {
        let (gauss, tolerance) = (&self.system.gauss, self.tolerance);
        let mut defects = mesh::defect(gauss, self.problem, y);
        if largest(&defects) > tolerance {
            return (defects, Vec::new());
        }
        let Some([slopes, beside]) = mesh::beside_nodes(gauss, self.problem, y) else { return (defects, Vec::new()) };
        let slopes = smooth_slopes(y, slopes, &defects);
        if beside.iter().any(|size| *size > SMOOTH * tolerance) {
            for (defect, [integral, size]) in defects.iter_mut().zip(mesh::missed(gauss, self.problem, y)) {
                *defect = if 2.0 * integral > tolerance { size.max(*defect) } else { *defect };
            }
        }
        (defects, slopes)
    }

    /// Newton on the mesh of `y`.
    fn newton(&mut self, y: &mut Solution) -> Result<(), NewtonError> {
        let settings = self.settings;
        let allowed = self.tolerance.min(settings.error.unwrap_or(f64::INFINITY));
        let tolerance = settings.newton.tolerance.min(NEWTON_SHARE * allowed).max(LEAST_TOLERANCE);
        let newton = Newton { tolerance, ..settings.newton };
        match newton.solve(&mut self.system, &mut self.scratch, self.problem, y, &[], false) {
            Ok(report) => self.work += report,
            Err(NewtonError::Stalled { correction, .. }) if self.is_small(correction, y) => {}
            Err(error) => {
                self.work.rejected += 1;
                return Err(error);
            }
        }
        self.work.steps += 1;
        Ok(())
    }

    /// Whether a correction at which Newton's method stalls is small enough: next to the tolerance, as where the derivative of f is
    /// infinite, or the effect of rounding, which the condition amplifies.
    fn is_small(&mut self, correction: f64, y: &Solution) -> bool {
        correction <= STALLED_BY_ROUNDING.max(STALLED_SHARE * self.tolerance)
            || correction <= LARGEST_ROUNDING && correction <= ROUNDED * condition::estimate(&mut self.system, y)
    }

    /// Newton on the mesh of `y`; if it fails, on the mesh with halved intervals, and by a homotopy from the guess.
    fn solve_with_refinement(&mut self, mut start: Solution) -> Result<Solution, SolveError> {
        let limit = self.settings.max_intervals;
        let mut failures = 0;
        loop {
            let mut y = start.clone();
            let Err(source) = self.newton(&mut y) else { return Ok(y) };
            failures += 1;
            let intervals = start.intervals();
            if let NewtonError::Stopped { reason, .. } = source {
                return Err(self.stopped(reason, intervals));
            }
            let last = 2 * intervals > limit;
            if (failures == FAILURES || last) && !std::mem::replace(&mut self.homotopy_tried, true) {
                let Run { problem, settings, system, scratch, work, guess, .. } = self;
                let limits = [limit, settings.homotopy];
                let found = homotopy::solve(*problem, guess, limits, system, scratch, work);
                if let Some(y) = found.or_else(|| carried::solve(*problem, guess, limit, system, scratch, work)) {
                    start = y;
                    continue;
                }
            }
            if last {
                // Stalled with the factors of the last iterate, which has the mesh of `start`.
                let stalled = matches!(source, NewtonError::Stalled { .. });
                let condition = if stalled { condition::estimate(&mut self.system, &start) } else { 0.0 };
                if condition > singular(&start) {
                    return Err(SolveError::Singular { condition, intervals });
                }
                return Err(SolveError::Newton { intervals, source, best: self.take_best() });
            }
            start = self.moved(&start, &mesh::halved(&start.mesh));
        }
    }

    /// The solution on another mesh.
    fn moved(&mut self, y: &Solution, mesh: &[f64]) -> Solution {
        self.work.remeshings += 1;
        y.on_mesh(&self.system.gauss, mesh)
    }

    /// Keeps a solution that has the smallest defect so far. Its condition is estimated if it is asked for.
    fn keep_best(&mut self, y: &Solution, defect: f64) {
        if self.best.as_ref().is_none_or(|best| defect < best.defect) {
            self.best = Some(Box::new(Solved::unchecked(y.clone(), defect, self.work)));
        }
    }

    /// The best solution and the condition there.
    fn take_best(&mut self) -> Option<Box<Solved>> {
        let mut best = self.best.take()?;
        self.work.factorisations += 1;
        if self.system.factorise(self.problem, &best.solution, &[]).is_ok() {
            best.condition = condition::estimate(&mut self.system, &best.solution);
        }
        Some(best)
    }

    /// The best solution; without another, the one on this mesh.
    fn take_best_or(&mut self, solution: Solution, defect: f64) -> Box<Solved> {
        let mut best =
            self.take_best().unwrap_or_else(|| Box::new(Solved::unchecked(solution, defect, Work::default())));
        best.work = self.work;
        best
    }
}

/// The condition from which on a problem is singular to rounding. On a long interval small changes of f add up.
fn singular(y: &Solution) -> f64 {
    let [from, to] = [y.mesh.first(), y.mesh.last()].map(|end| end.copied().unwrap_or_default());
    SINGULAR * (to - from).max(1.0)
}

/// Largest |a − b| / (1 + |b|), infinite where it is not a number.
fn relative(a: &[f64], b: &[f64]) -> f64 {
    let sizes = a.iter().zip(b).map(|(a, b)| (a - b).abs() / (1.0 + b.abs()));
    sizes.fold(0.0, |largest, size| if size.is_nan() { f64::INFINITY } else { largest.max(size) })
}

/// The same of a solution from another one, at all nodes of the other.
fn apart(gauss: &Gauss, solved: &Solved, other: &Solution) -> f64 {
    let mut value = vec![0.0; other.components];
    let at = |(x, node): (&f64, &[f64])| {
        solved.eval(gauss, *x, &mut value);
        relative(&value, node)
    };
    other.mesh.iter().zip(other.nodes.chunks_exact(other.components)).map(at).fold(0.0, f64::max)
}

fn largest(defects: &[f64]) -> f64 {
    defects.iter().copied().fold(0.0, f64::max)
}

/// Some interval is as narrow as the spacing of numbers there.
fn is_degenerate(mesh: &[f64]) -> bool {
    mesh.windows(2).any(|x| x[1] - x[0] <= LEAST_WIDTH * f64::EPSILON * x[0].abs().max(x[1].abs()))
}
