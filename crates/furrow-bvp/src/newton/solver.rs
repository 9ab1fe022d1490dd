//! Solves a boundary-value problem to an accuracy: Newton, then redistribution and refinement of the mesh, until the defect
//! is below a tolerance.
//!
//! # References
//! Ascher, Mattheij & Russell 1995, ch. 9 (mesh selection). Kierzenka & Shampine, ACM Trans. Math. Softw. 27, 299 (2001)
//! (control of the defect).

use crate::dimensions::TooLarge;
use crate::linear::System;
use crate::mesh;
use crate::problem::BoundaryValueProblem;
use crate::solution::Solution;

use super::homotopy;
use super::iteration::{Newton, NewtonError, NewtonScratch};
use super::work::Work;

/// Settings of [`solve`].
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// Bound on the largest defect |u′ − f(u)| · h / (1 + |u|) of any component, see [`mesh::defect`].
    pub tolerance: f64,
    /// Most intervals.
    pub max_intervals: usize,
    /// The iteration on every mesh. Its tolerance is tightened where that of the defect asks for it.
    pub newton: Newton,
}

impl Default for Settings {
    fn default() -> Self {
        Settings { tolerance: 1e-6, max_intervals: 2000, newton: Newton::default() }
    }
}

/// A solution, its defect and its cost.
#[derive(Clone, Debug, PartialEq)]
pub struct Solved {
    /// The solution, on a mesh of its own.
    pub solution: Solution,
    /// Its largest defect.
    pub defect: f64,
    /// Steps are meshes on which Newton converged, those rejected meshes on which it did not.
    pub work: Work,
}

/// Why a problem was not solved to the accuracy asked for.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SolveError {
    /// The problem does not fit the kernels.
    #[error(transparent)]
    TooLarge(#[from] TooLarge),
    /// The problem is short of conditions (see [`Continuation`](crate::Continuation) for problems that lack one).
    #[error("the problem has {missing} unknowns more than conditions")]
    NotSquare {
        /// Unknowns less conditions.
        missing: isize,
    },
    /// The guess has other sizes than the problem.
    #[error("the guess has {components} components and {scalars} scalars, the problem has others")]
    Guess {
        /// Components of the guess.
        components: usize,
        /// Scalars of the guess.
        scalars: usize,
    },
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
    /// The accuracy asked for would need more intervals than allowed.
    #[error("the limit of {limit} intervals is reached with a defect of {:.3e}", .best.defect)]
    MeshLimit {
        /// Most intervals allowed.
        limit: usize,
        /// The solution of smallest defect.
        best: Box<Solved>,
    },
}

/// Consecutive meshes on which Newton may fail.
const FAILURES: usize = 3;

/// A redistributed mesh is worth another try with as many intervals if the last one brought the defect down to this
/// fraction.
const PROGRESS: f64 = 0.5;

/// Most intervals from one mesh to the next, in those of the first: what a coarse mesh says of a finer one is a rough
/// guess.
const GROWTH: usize = 2;

/// A defect tolerance is worth this many of Newton's.
const NEWTON_SHARE: f64 = 1e-2;

/// Solves a square problem to a defect below a tolerance, from a guess on any mesh; its stages are those of the guess.
///
/// On every mesh Newton solves the collocation equations. Where the defect is too large, the mesh is redistributed so that
/// every interval has an equal share of it, with as many intervals as its order h^(m+1) asks for. Where Newton fails,
/// intervals are halved.
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
/// let gauss = Gauss::new(4);
/// let line = |x: f64, y: &mut [f64]| y.copy_from_slice(&[4.0 - 3.0 * x, -3.0]);
/// let guess = Solution::from_fn(&gauss, &furrow_bvp::mesh::uniform(0.0, 1.0, 4), 2, &[], line);
/// let solved = furrow_bvp::solve(&mut Example, &guess, &Settings { tolerance: 1e-9, ..Settings::default() })?;
/// let mut y = [0.0; 2];
/// solved.solution.eval(&gauss, 0.5, &mut y);
/// assert!((y[0] - 4.0 / 1.5f64.powi(2)).abs() < 1e-9);
/// # Ok::<(), furrow_bvp::SolveError>(())
/// ```
pub fn solve<P: BoundaryValueProblem>(
    problem: &mut P,
    guess: &Solution,
    settings: &Settings,
) -> Result<Solved, SolveError> {
    let dims = problem.dimensions();
    dims.check(guess.m)?;
    if dims.missing_conditions() != 0 {
        return Err(SolveError::NotSquare { missing: dims.missing_conditions() });
    }
    if guess.components != dims.components || guess.scalars.len() != dims.scalars {
        return Err(SolveError::Guess { components: guess.components, scalars: guess.scalars.len() });
    }
    let mut run = Run {
        problem,
        settings,
        system: System::new(dims, guess.m),
        scratch: NewtonScratch::default(),
        work: Work::default(),
        best: None,
        origin: guess.clone(),
        deformed: false,
    };
    run.solve(guess.clone())
}

/// One call of [`solve`].
struct Run<'a, P> {
    problem: &'a mut P,
    settings: &'a Settings,
    system: System,
    scratch: NewtonScratch,
    work: Work,
    /// The solution of smallest defect.
    best: Option<Box<Solved>>,
    /// The guess.
    origin: Solution,
    /// Homotopy was tried.
    deformed: bool,
}

impl<P: BoundaryValueProblem> Run<'_, P> {
    fn solve(&mut self, mut y: Solution) -> Result<Solved, SolveError> {
        let mut before = f64::INFINITY;
        let mut weight = Vec::new();
        loop {
            y = self.on_this_mesh_or_a_finer(y)?;
            let defects = mesh::defect(&self.system.gauss, self.problem, &y);
            let defect = defects.iter().copied().fold(0.0, f64::max);
            self.keep(&y, defect);
            if defect <= self.settings.tolerance {
                return Ok(Solved { solution: y, defect, work: self.work });
            }
            let (intervals, limit) = (y.intervals(), self.settings.max_intervals);
            let settled = defect > PROGRESS * before;
            if intervals >= limit && settled {
                return Err(self.mesh_limit(y, defect));
            }
            let needed = mesh::intervals_for(&defects, y.m, self.settings.tolerance);
            let next = if settled { GROWTH * intervals } else { needed.clamp(intervals, GROWTH * intervals) };
            let next = next.min(limit.max(intervals));
            // More intervals are a new beginning: there may be no progress yet where the first layers come into sight.
            before = if next > intervals { f64::INFINITY } else { defect };
            if defect.is_finite() {
                mesh::defect_monitor(&y.mesh, &defects, y.m, &mut weight);
            } else {
                // The right-hand side is not defined somewhere between the stages: that says nothing of a better mesh.
                weight.clear();
                weight.extend(y.mesh.windows(2).map(|x| 1.0 / (x[1] - x[0])));
            }
            y = self.moved(&y, next, &weight);
        }
    }

    /// Newton on the mesh of `y`; where it fails, on that of halved intervals.
    fn on_this_mesh_or_a_finer(&mut self, start: Solution) -> Result<Solution, SolveError> {
        let settings = self.settings;
        let tolerance = settings.newton.tolerance.min(NEWTON_SHARE * settings.tolerance);
        let newton = Newton { tolerance, ..settings.newton };
        let (mut start, mut failures) = (start, 0);
        loop {
            let mut y = start.clone();
            match newton.solve(&mut self.system, &mut self.scratch, self.problem, &mut y, &[], false) {
                Ok(report) => {
                    self.work.steps += 1;
                    self.work += report;
                    return Ok(y);
                }
                Err(source) => {
                    self.work.rejected += 1;
                    failures += 1;
                    let intervals = start.intervals();
                    if failures == FAILURES && !std::mem::replace(&mut self.deformed, true) {
                        let Run { problem, system, scratch, work, .. } = self;
                        let limit = settings.max_intervals;
                        if let Some(y) = homotopy::solve(*problem, &self.origin, limit, system, scratch, work) {
                            start = y;
                            continue;
                        }
                    }
                    if failures >= FAILURES || 2 * intervals > settings.max_intervals {
                        return Err(SolveError::Newton { intervals, source, best: self.best.take() });
                    }
                    start = start.on_mesh(&self.system.gauss, &mesh::halved(&start.mesh));
                    self.work.remeshings += 1;
                }
            }
        }
    }

    /// The solution on a mesh of `intervals` that share the monitor equally.
    fn moved(&mut self, y: &Solution, intervals: usize, weight: &[f64]) -> Solution {
        let mut grid = Vec::new();
        mesh::equidistribute(&y.mesh, weight, intervals, &mut grid);
        self.work.remeshings += 1;
        y.on_mesh(&self.system.gauss, &grid)
    }

    fn keep(&mut self, y: &Solution, defect: f64) {
        if self.best.as_ref().is_none_or(|best| defect < best.defect) {
            self.best = Some(Box::new(Solved { solution: y.clone(), defect, work: self.work }));
        }
    }

    /// The best solution, which is that of this mesh if there is no other.
    fn mesh_limit(&mut self, solution: Solution, defect: f64) -> SolveError {
        let work = self.work;
        let mut best = self.best.take().unwrap_or_else(|| Box::new(Solved { solution, defect, work }));
        best.work = work;
        SolveError::MeshLimit { limit: self.settings.max_intervals, best }
    }
}
