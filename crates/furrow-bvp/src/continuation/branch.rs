//! Pseudo-arclength continuation of solutions of a boundary-value problem in its last scalar unknown λ.
//!
//! A point of the branch and its unit tangent t (in a [`Metric`]) give the next point as the solution of the problem
//! together with ⟨t, x − x_last⟩ = Δs (N.8); Newton starts from the polynomial through the last points. Folds are ordinary points
//! of the branch. The state of a run can be stored and resumed.
//!
//! # References
//! Keller, in *Applications of Bifurcation Theory*, Academic Press 1977, p. 359 (pseudo-arclength).

use crate::dense::Determinant;
use crate::direction::{Direction, LinearCondition};
use crate::invalid::InvalidInput;
use crate::linear::{FactorisationError, System};
use crate::mesh;
use crate::metric::{self, Metric};
use crate::newton::{Newton, NewtonError, NewtonReport, NewtonScratch, Work, WorkLimit};
use crate::problem::BoundaryValueProblem;
use crate::solution::Solution;

use super::accuracy::{Fixed, newton_tolerance};
use super::passing::{self, PassedBranchPoint, StepPair};
use super::predictor::History;
use super::settings::{ContinuationError, ContinuationSettings, StepFailure, check_problem};
use super::state::{Advance, State};
use super::unfolding::Unfolding;

/// Branches nearer to each other than a step of this length do meet, as far as rounding can tell: the branch goes
/// straight on.
const CLOSED_GAP: f64 = 1e-6;

/// Relative changes of λ that cannot be told from rounding.
const STILL: f64 = 1e-11;

/// A rejected step is repeated with this fraction of its length.
pub(crate) const SHORTER: f64 = 0.4;

/// After a step that converged with the factors of the last point, they are tried for steps longer by the first factor; after one that
/// did not, only for steps shorter by the second.
const CHORD_REACH_GROWTH: f64 = 1.2;
const CHORD_REACH_LOSS: f64 = 0.5;
/// Most corrections with them, and their largest contraction: together they cost half a factorisation.
const CHORD_STEPS: usize = 7;
const CHORD_CONTRACTION: f64 = 0.5;

/// After this many rejections the tangent may be wrong.
const REJECTIONS_BEFORE_EXACT_TANGENT: usize = 2;

/// The branch ends when a step has led to a degenerate solution this many times, although it was shortened each time.
const STEPS_TO_DEGENERATE: usize = 3;

/// A step that is not yet accepted: the point is in `trial`, its tangent in `tangent`.
struct Attempt {
    report: NewtonReport,
    /// Cosine of the angle turned.
    cosine: f64,
    /// The bordered determinant.
    orientation: Determinant,
    /// The factors belong to the point itself.
    exact: bool,
    passed_branch_point: bool,
}

/// Weights of a mesh monitor, one per interval.
pub type MeshMonitor<P> = fn(&P, &Solution, &mut Vec<f64>);

/// Continuation of one branch.
///
/// # Examples
/// The branch of u″ + λeᵘ = 0, u(0) = u(1) = 0 from u = 0 at λ = 0 up to λ = 2. `Oscillator` is in
/// `examples/problems/oscillator.rs`.
///
/// ```
/// # mod oscillator { include!(concat!(env!("CARGO_MANIFEST_DIR"), "/examples/problems/oscillator.rs")); }
/// # use oscillator::Oscillator;
/// use furrow_bvp::{Continuation, ContinuationSettings, Termination, Metric};
/// let problem = Oscillator::bratu();
/// let guess = problem.zero(1.0, 20, 4, 0.0);
/// let settings = ContinuationSettings::default();
/// let mut branch = Continuation::start(problem, guess, Metric::unit(2, 1), settings, true)?;
/// let ended = branch.follow([0.0, 2.0], 100, |_, advance| !advance.passed_fold)?;
/// assert_eq!(ended, Termination::ParameterBound(2.0));
/// let mut y = [0.0; 2];
/// branch.state.solution.eval(&branch.system.gauss, 0.5, &mut y);
/// let cosh = (0.5 * y[0]).exp();
/// assert!((8.0 * (cosh.acosh() / cosh).powi(2) - 2.0).abs() < 1e-7);
/// # Ok::<(), furrow_bvp::ContinuationError>(())
/// ```
pub struct Continuation<P> {
    /// The problem; its last scalar unknown is the parameter λ. One condition short of square.
    pub problem: P,
    /// Factors of a point near the newest, with a plane condition: see [`factorise_newest`](Continuation::factorise_newest).
    pub system: System,
    /// Settings.
    pub settings: ContinuationSettings,
    /// Norm of the branch.
    pub metric: Metric,
    /// Monitor that the mesh equidistributes; by default the defect.
    pub monitor: Option<MeshMonitor<P>>,
    /// State of the run.
    pub state: State,
    /// Work so far.
    pub work: Work,
    pub(super) scratch: NewtonScratch,
    pub(super) conditions: Vec<LinearCondition>,
    pub(super) trial: Solution,
    tangent: Direction,
    /// The response of the newest point to a disturbance, if a tolerance is set.
    pub(super) response: Direction,
    weight: Vec<f64>,
    /// The branch point that the last step has passed, from its detection.
    pub(crate) passed: Option<PassedBranchPoint>,
    /// Workspace for branch points.
    pub(crate) unfolding: Option<Unfolding>,
    /// The current step changes the orientation because it leads to another branch, however much it is shortened.
    on_other_branch: bool,
    /// ln |bordered determinant| at the newest point, or at a prediction of it; NaN if not known.
    pub(super) log_determinant: f64,
    /// The factors in `system` belong to the newest point.
    pub(super) exact: bool,
    /// Steps up to this length are corrected with the factors of their first point.
    chord_reach: f64,
}

impl<P: BoundaryValueProblem> Continuation<P> {
    /// Starts at the solution near `guess` with the λ of `guess`, towards larger λ if `upwards`.
    ///
    /// # Errors
    /// [`ContinuationError::Start`] if there is no such solution, [`ContinuationError::MeshLimit`] if it is not accurate enough,
    /// [`ContinuationError::Degenerate`] for an equilibrium in place of a cycle, [`ContinuationError::Invalid`] for input that is refused.
    pub fn start(
        mut problem: P,
        guess: Solution,
        metric: Metric,
        mut settings: ContinuationSettings,
        upwards: bool,
    ) -> Result<Self, ContinuationError> {
        let dims = problem.dimensions();
        settings.check()?;
        check_problem(dims, &guess, &metric)?;
        let tolerance = settings.tolerance;
        if let Some(tolerance) = tolerance {
            settings.newton.tolerance = newton_tolerance(settings.newton.tolerance, tolerance);
        }
        let mut system = System::new(dims, guess.m);
        let limit = WorkLimit::new(settings.budget, settings.max_intervals, &settings.interrupt);
        let mut scratch = NewtonScratch::limited(limit);
        let mut conditions = vec![LinearCondition::default()];
        let mut solution = guess;
        let last = dims.scalars - 1;
        let parameter = solution.scalars[last];
        metric::scalar_condition(&solution, last, parameter, &mut conditions[0]);
        with_more_iterations(settings.newton)
            .solve(&mut system, &mut scratch, &mut problem, &mut solution, &conditions, false)
            .map_err(|source| ContinuationError::Start { parameter, source })?;
        let mut tangent = Direction::default();
        system.null_direction(0, &mut tangent)?;
        metric.normalise(&solution.mesh, &mut tangent);
        if !upwards {
            tangent.scale(-1.0);
        }
        let mut history = History::default();
        history.push(0.0, &solution);
        let step = settings.first_step;
        let direction = if upwards { 1.0 } else { -1.0 };
        let state = State { solution, tangent, arclength: 0.0, step, points: 1, direction, orientation: 0.0, history };
        let mut branch = Continuation::resume(problem, state, metric, settings);
        // The first point is its own reference.
        if branch.problem.is_degenerate(&branch.state.solution) {
            return Err(branch.lost(parameter, StepFailure::Degenerate));
        }
        if let Some(tolerance) = tolerance {
            branch.refine(tolerance, Fixed::Parameter(parameter))?;
        }
        Ok(branch)
    }

    /// Resumes a run, or starts one from a point with a known tangent (e.g. after switching branches).
    /// A state may have been read from a file: one that does not fit the problem is refused by the first
    /// [`advance`](Self::advance).
    pub fn resume(mut problem: P, mut state: State, metric: Metric, settings: ContinuationSettings) -> Self {
        if state.history.is_empty() {
            state.history.push(state.arclength, &state.solution);
        }
        problem.accepted(&state.solution);
        let system = System::new(problem.dimensions(), state.solution.m);
        Continuation {
            trial: state.solution.clone(),
            tangent: Direction::default(),
            response: Direction::default(),
            problem,
            system,
            settings,
            metric,
            monitor: None,
            state,
            work: Work::default(),
            scratch: NewtonScratch::default(),
            conditions: vec![LinearCondition::default()],
            weight: Vec::new(),
            passed: None,
            unfolding: None,
            on_other_branch: false,
            log_determinant: f64::NAN,
            exact: false,
            chord_reach: f64::INFINITY,
        }
    }

    /// Checks the public fields, which may have changed since the last step.
    pub(super) fn check(&self) -> Result<(), InvalidInput> {
        self.settings.check()?;
        self.system.check(&self.problem, &self.state.solution)?;
        check_problem(self.system.dimensions(), &self.state.solution, &self.metric)?;
        self.state.check()
    }

    pub(super) fn renew_budget(&mut self) {
        let ContinuationSettings { budget, max_intervals, interrupt, .. } = &self.settings;
        self.scratch.limit = WorkLimit::new(*budget, *max_intervals, interrupt);
    }

    /// Whether λ is the same at the last two points but for rounding: along a vertical branch its sign of change tells of no folds.
    pub fn is_still(&self) -> bool {
        let (now, before) = (self.state.parameter(), self.state.history.back(1).and_then(|(_, y)| y.scalars.last()));
        before.is_some_and(|before| (now - before).abs() < STILL * (1.0 + now.abs()))
    }

    /// Reverses the direction.
    pub fn reverse(&mut self) {
        self.exact = false;
        self.state.tangent.scale(-1.0);
        self.state.direction = -self.state.direction;
        self.state.orientation = -self.state.orientation;
        self.state.history.clear();
        self.state.history.push(self.state.arclength, &self.state.solution);
    }

    /// Takes one step.
    ///
    /// # Errors
    /// [`ContinuationError::Lost`], [`ContinuationError::Degenerate`] or [`ContinuationError::MeshLimit`]; the state is left at the last
    /// point.
    /// [`ContinuationError::Invalid`] if public fields were changed to invalid values.
    pub fn advance(&mut self) -> Result<Advance, ContinuationError> {
        self.check()?;
        self.renew_budget();
        self.remesh();
        match self.settings.tolerance {
            Some(tolerance) => self.advance_to(tolerance),
            None => self.step(),
        }
    }

    /// One step on the mesh as it is.
    pub(super) fn step(&mut self) -> Result<Advance, ContinuationError> {
        let mut step = self.state.step.min(self.settings.max_step);
        let (mut rejected, mut degenerate) = (0, 0);
        (self.passed, self.on_other_branch) = (None, false);
        if self.state.orientation == 0.0 && self.state.points > 1 && self.factorise_newest().is_ok() {
            // After a change of the number of intervals. A branch point in this step would not show.
            self.update_test_values();
        }
        loop {
            let source = match self.attempt(step) {
                Ok(attempt) => return Ok(self.accept(step, attempt, rejected)),
                Err(failure) => failure,
            };
            if matches!(source, StepFailure::Newton(NewtonError::Stopped { .. })) {
                return Err(self.lost(self.state.parameter(), source));
            }
            rejected += 1;
            degenerate += usize::from(source == StepFailure::Degenerate);
            step *= SHORTER;
            if rejected == REJECTIONS_BEFORE_EXACT_TANGENT {
                // The tangent was computed with the corrector's factors at a prediction. If it is too inaccurate, no step is short
                // enough. Without an exact tangent the step is shortened further.
                let _ = self.exact_tangent();
            }
            let ended = step < self.settings.min_step.max(f64::MIN_POSITIVE);
            if degenerate == STEPS_TO_DEGENERATE || (ended && degenerate > 0) {
                return Err(self.lost(self.state.parameter(), StepFailure::Degenerate));
            }
            if ended {
                return Err(self.lost(self.state.parameter(), source));
            }
        }
    }

    pub(super) fn lost(&self, parameter: f64, source: StepFailure) -> ContinuationError {
        let arclength = self.state.arclength;
        match source {
            StepFailure::Newton(NewtonError::Stopped { reason, .. }) => {
                ContinuationError::Stopped { reason, parameter, arclength }
            }
            StepFailure::Degenerate => ContinuationError::Degenerate { parameter, arclength },
            source => ContinuationError::Lost { parameter, arclength, source },
        }
    }

    /// Makes the point of an attempt the newest.
    fn accept(&mut self, step: f64, attempt: Attempt, rejected: usize) -> Advance {
        let Attempt { report, cosine, orientation, exact, passed_branch_point } = attempt;
        self.exact = exact;
        let parameter = self.state.parameter();
        (self.state.orientation, self.log_determinant) = (orientation.sign, orientation.log_abs);
        std::mem::swap(&mut self.state.tangent, &mut self.tangent);
        std::mem::swap(&mut self.state.solution, &mut self.trial);
        self.state.arclength += step;
        self.state.points += 1;
        self.state.history.push(self.state.arclength, &self.state.solution);
        self.problem.accepted(&self.state.solution);
        self.state.step = step * growth(report, cosine, self.settings.min_cosine);
        self.work += Work { steps: 1, rejected, ..Work::default() };
        self.work += report;
        let passed_fold = self.confirm_direction(self.state.parameter() - parameter);
        Advance { passed_fold, passed_branch_point, report, rejected, defect: None }
    }

    /// Computes the tangent at the newest point with factors at the point itself, in its own plane.
    pub(super) fn exact_tangent(&mut self) -> Result<(), FactorisationError> {
        self.factorise_newest()?;
        let Continuation { system, metric, state, tangent, .. } = self;
        system.null_direction(0, tangent)?;
        metric.normalise(&state.solution.mesh, tangent);
        std::mem::swap(&mut state.tangent, tangent);
        Ok(())
    }

    /// Factorises the system at the newest point itself, unless the last step has. A corrector that factorises leaves the factors at
    /// its prediction, which suffice for its convergence but not for test functions where the solution changes much in a step.
    ///
    /// # Errors
    /// If a pivot vanishes.
    pub fn factorise_newest(&mut self) -> Result<(), FactorisationError> {
        if self.exact {
            return Ok(());
        }
        let Continuation { problem, system, metric, state, conditions, .. } = self;
        metric.plane_through(&state.solution, &state.tangent, &mut conditions[0]);
        system.factorise(problem, &state.solution, conditions)?;
        self.exact = true;
        Ok(())
    }

    /// Whether dλ/ds has changed sign, by the tangent or by the distance λ has `moved` in the last step. The corrector's factors
    /// belong to a prediction, so a change is confirmed with factors at the point itself.
    fn confirm_direction(&mut self, moved: f64) -> bool {
        let direction = self.state.direction;
        let goes_on = direction * self.state.parameter_slope() > 0.0 && direction * moved > 0.0;
        if goes_on || self.exact_tangent().is_err() {
            return false;
        }
        let (before, now) = (self.state.direction, self.state.parameter_slope().signum());
        self.state.direction = now;
        before * now < 0.0
    }

    /// A corrected point at distance `step` in `trial`, and its tangent in `tangent`.
    ///
    /// A short step is corrected with the factors of its first point. One factorisation at the new point then gives its exact tangent and
    /// determinants. A longer step factorises at the prediction, and computes the tangent with these factors.
    fn attempt(&mut self, step: f64) -> Result<Attempt, StepFailure> {
        self.predict(step);
        let reuse = std::mem::take(&mut self.exact) && step <= self.chord_reach;
        let Continuation { problem, system, settings, metric, state, scratch, conditions, trial, .. } = self;
        // The plane is set by the point and not by the prediction, or steps would drift with the extrapolation.
        metric.plane_through(&state.solution, &state.tangent, &mut conditions[0]);
        conditions[0].value += step;
        let chord = Newton { max_iterations: CHORD_STEPS, chord_contraction: CHORD_CONTRACTION, ..settings.newton };
        let reused = if reuse { chord.solve_with_factors(system, scratch, problem, trial, conditions) } else { None };
        let report = match reused {
            Some(report) => {
                system.factorise(problem, trial, conditions)?;
                NewtonReport { factorisations: 1, ..report }
            }
            None => settings.newton.solve(system, scratch, problem, trial, conditions, false)?,
        };
        if problem.is_degenerate(trial) {
            return Err(StepFailure::Degenerate);
        }
        let exact = reused.is_some();
        self.chord_reach = match (reuse, exact) {
            (true, true) => self.chord_reach.max(CHORD_REACH_GROWTH * step),
            (true, false) => CHORD_REACH_LOSS * step,
            // Where the branch has become straighter they may serve again.
            (false, _) => self.chord_reach * CHORD_REACH_GROWTH,
        };
        let Continuation { system, settings, metric, state, trial, tangent, .. } = self;
        system.null_direction(0, tangent)?;
        metric.normalise(&trial.mesh, tangent);
        let cosine = metric.dot(&trial.mesh, tangent, &state.tangent);
        if cosine < settings.min_cosine {
            return Err(StepFailure::Turn { cosine });
        }
        let orientation = self.orientation();
        let flipped = orientation.sign * self.state.orientation < 0.0;
        if flipped && step > CLOSED_GAP && !self.passes_branch_point(step) {
            return Err(StepFailure::OtherBranch);
        }
        Ok(Attempt { report, cosine, orientation, exact, passed_branch_point: flipped })
    }

    /// Whether the step to the trial point, which turns the orientation, has passed a branch point on the same branch.
    fn passes_branch_point(&mut self, step: f64) -> bool {
        if self.on_other_branch {
            return false;
        }
        let Continuation { problem, system, metric, state, work, trial, tangent, log_determinant, unfolding, .. } =
            self;
        let null = passing::approximate_null_vector(system).unwrap_or_default();
        // By the determinants at both ends. Not known at the first of them, they are NaN, and the point may be anywhere.
        let ratio = (system.determinant().log_abs - *log_determinant).exp();
        let share = if ratio.is_finite() { 1.0 / (1.0 + ratio) } else { 0.5 };
        let (ends, along) = ([&state.solution, &*trial], &state.tangent);
        let pair = StepPair { ends, share, tangent: along, null: &null, step };
        self.passed = passing::branch_point(problem, metric, &pair, unfolding, work);
        // Next to the point, the factors of a prediction do not give the tangent; those that `orientation` left do.
        self.on_other_branch = self.passed.is_none() || system.null_direction(0, tangent).is_err();
        if !self.on_other_branch {
            metric.normalise(&trial.mesh, tangent);
        }
        !self.on_other_branch
    }

    /// The point at distance `step` by extrapolation, in `trial`.
    fn predict(&mut self, step: f64) {
        let Continuation { state, trial, .. } = self;
        if state.history.len() > 1 {
            state.history.extrapolate(state.arclength + step, trial);
        } else {
            trial.clone_from(&state.solution);
            state.tangent.apply(step, trial);
        }
    }

    /// The bordered determinant at the trial point. Its sign is the orientation.
    ///
    /// Where two branches nearly meet, as next to an imperfect pitchfork, a step across the gap turns by no angle at all.
    /// But it turns the sign of the bordered determinant, as passing a branch point does, and nothing else does.
    fn orientation(&mut self) -> Determinant {
        let Continuation { problem, system, state, conditions, trial, .. } = self;
        let determinant = system.determinant();
        if determinant.sign * state.orientation >= 0.0 {
            return determinant;
        }
        // The corrector's factors belong to a prediction: what counts is the point itself.
        system.factorise(problem, trial, conditions).map_or(determinant, |()| system.determinant())
    }

    /// Moves the mesh if it no longer fits.
    fn remesh(&mut self) {
        if !self.state.points.is_multiple_of(self.settings.remesh_every) {
            return;
        }
        let y = &self.state.solution;
        match self.monitor {
            Some(monitor) => monitor(&self.problem, y, &mut self.weight),
            None => {
                let defect = mesh::defect(&self.system.gauss, &mut self.problem, y);
                mesh::defect_monitor(&y.mesh, &defect, y.m, &mut self.weight);
            }
        }
        if let Some(grid) = mesh::rebalanced(&y.mesh, &self.weight, self.settings.remesh_above) {
            self.move_to(&grid);
        }
    }

    /// Carries the run over to another mesh.
    pub fn move_to(&mut self, grid: &[f64]) {
        self.exact = false;
        let (gauss, from) = (&self.system.gauss, &self.state.solution.mesh);
        metric::transfer_direction(gauss, from, grid, &mut self.state.tangent);
        self.metric.normalise(grid, &mut self.state.tangent);
        if self.response.check(&self.state.solution).is_ok() {
            metric::transfer_direction(gauss, from, grid, &mut self.response);
        }
        if let Some(PassedBranchPoint { solution, basis, unfolded }) = &mut self.passed {
            basis.iter_mut().for_each(|direction| metric::transfer_direction(gauss, from, grid, direction));
            (*solution, *unfolded) = (solution.on_mesh(gauss, grid), false);
        }
        if grid.len() != self.state.solution.mesh.len() {
            // The sign of the determinant depends on the number of intervals.
            self.state.orientation = 0.0;
        }
        self.state.solution.transfer_into(gauss, grid, &mut self.trial);
        std::mem::swap(&mut self.state.solution, &mut self.trial);
        self.state.history.transfer(gauss, grid);
        self.work.remeshings += 1;
    }
}

/// The corrector for points that no shorter step can replace.
pub(super) fn with_more_iterations(newton: Newton) -> Newton {
    Newton { max_factorisations: 20, max_iterations: 60, ..newton }
}

/// Factor on the next step from the corrector's work and from the angle turned.
fn growth(report: NewtonReport, cosine: f64, min_cosine: f64) -> f64 {
    let by_work: f64 = match (report.factorisations, report.iterations) {
        (1, ..=3) => 1.5,
        (1, _) => 1.15,
        (2, _) => 0.8,
        _ => 0.6,
    };
    // Turning angles grow in proportion to the step: aim at half the angle allowed.
    let angle = (1.0 - cosine).max(0.0).sqrt();
    let allowed = 0.6 * (1.0 - min_cosine).sqrt();
    by_work.min((allowed / angle.max(1e-300)).max(0.3))
}
