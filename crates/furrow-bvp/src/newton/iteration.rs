//! Damped Newton iteration with Jacobian reuse.
//!
//! Every factorisation is used for one full step and then for chord steps (corrections with the factors of an earlier
//! iterate) while they contract. Damping follows the natural monotonicity test, N.5: a step is accepted when the simplified
//! correction J⁻¹F(x + λδ) is smaller than δ.
//!
//! Corrections are compared in one scaling, by the iterate from which both start: a step to huge values makes every
//! correction there small *relative to those values*, which says nothing about a root.
//!
//! # References
//! Deuflhard, *Newton Methods for Nonlinear Problems*, Springer 2004, ch. 3.

use crate::direction::{Direction, LinearCondition};
use crate::invalid::{self, InvalidInput};
use crate::linear::{FactorisationError, Place, System};
use crate::problem::BoundaryValueProblem;
use crate::solution::Solution;

use super::limits::{Stop, WorkLimit};

/// Settings of the iteration.
///
/// # Examples
/// u″ + λeᵘ = 0, u(0) = u(1) = 0 with λ held at 1 by a linear condition. `Oscillator` is in
/// `examples/problems/oscillator.rs`.
///
/// ```
/// # mod oscillator { include!(concat!(env!("CARGO_MANIFEST_DIR"), "/examples/problems/oscillator.rs")); }
/// # use oscillator::Oscillator;
/// use furrow_bvp::{BoundaryValueProblem, LinearCondition, Newton, System, metric};
/// let mut problem = Oscillator::bratu();
/// let mut y = problem.zero(1.0, 20, 4, 1.0);
/// let mut conditions = vec![LinearCondition::default()];
/// metric::scalar_condition(&y, 0, 1.0, &mut conditions[0]);
/// let mut system = System::new(problem.dimensions(), y.m);
/// let newton = Newton::default();
/// let report = newton.solve(&mut system, &mut Default::default(), &mut problem, &mut y, &conditions, false)?;
/// assert!(report.factorisations <= 2);
/// // u(½) = 2 ln cosh θ belongs to λ = 8(θ/cosh θ)².
/// let cosh = (0.5 * y.node(10)[0]).exp();
/// assert!((8.0 * (cosh.acosh() / cosh).powi(2) - 1.0).abs() < 1e-8);
/// # Ok::<(), furrow_bvp::NewtonError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Newton {
    /// Bound on the estimated remaining error, max |δ|/(1 + |value|).
    pub tolerance: f64,
    /// Most factorisations.
    pub max_factorisations: usize,
    /// Most linear solves.
    pub max_iterations: usize,
    /// Smallest damping factor.
    pub min_damping: f64,
    /// How many times larger than the monotonicity test asks for the next correction may be: 1 is the test itself. More of it
    /// lets full steps pass that the test would shorten though they lead to the root, as where a few entries are far
    /// larger than all others.
    pub leniency: f64,
    /// Chord steps continue while each is at most this fraction of the one before.
    pub chord_contraction: f64,
}

impl Default for Newton {
    fn default() -> Self {
        Newton {
            tolerance: 1e-9,
            max_factorisations: 30,
            max_iterations: 100,
            min_damping: 1e-3,
            leniency: 1.0,
            chord_contraction: 0.3,
        }
    }
}

/// Work and quality of a converged iteration.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct NewtonReport {
    /// Linear solves.
    pub iterations: usize,
    /// Factorisations.
    pub factorisations: usize,
    /// Norm of the last correction applied.
    pub last_correction: f64,
}

/// Why the iteration did not converge.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum NewtonError {
    /// The problem, the solution, the conditions or the settings are refused.
    #[error(transparent)]
    Invalid(#[from] InvalidInput),
    /// A pivot vanished.
    #[error("the Jacobian is singular (pivot {column}) after {iterations} iterations")]
    Singular {
        /// Column of the failing pivot in its block.
        column: usize,
        /// Linear solves done.
        iterations: usize,
    },
    /// Damping or iterations were exhausted.
    #[error("stalled after {iterations} iterations with a correction of {correction:.3e}")]
    Stalled {
        /// Linear solves done.
        iterations: usize,
        /// Norm of the last correction.
        correction: f64,
    },
    /// A correction was not finite, though all values of the equations were.
    #[error("the correction is not finite after {iterations} iterations")]
    NonFinite {
        /// Linear solves done.
        iterations: usize,
    },
    /// A value of the equations or of their derivatives is not finite.
    #[error("{place} is not finite after {iterations} iterations")]
    Undefined {
        /// Which value.
        place: Place,
        /// Linear solves done.
        iterations: usize,
    },
    /// It was ended from outside.
    #[error("{reason} after {iterations} iterations")]
    Stopped {
        /// Why.
        reason: Stop,
        /// Linear solves done.
        iterations: usize,
    },
}

impl NewtonError {
    /// A failed factorisation after the given number of linear solves.
    pub fn of_factorisation(error: FactorisationError, iterations: usize) -> NewtonError {
        match error {
            FactorisationError::Invalid(input) => NewtonError::Invalid(input),
            FactorisationError::Pivot(failure) if failure.non_finite => NewtonError::NonFinite { iterations },
            FactorisationError::Pivot(failure) => NewtonError::Singular { column: failure.column, iterations },
        }
    }
}

/// Scratch of [`Newton::solve`], reused between calls.
#[derive(Clone, Debug, Default)]
pub struct NewtonScratch {
    step: Direction,
    trial_step: Direction,
    trial: Option<Solution>,
    /// Ends the iteration once its work is spent.
    pub(crate) limit: WorkLimit,
    /// A full step that leaves next to no residual is the last, without a solve that confirms it: linear problems take one.
    trusts_residuals: bool,
    /// The shortest step is taken even if it does not pass the monotonicity test.
    pub(super) insists: bool,
}

impl NewtonScratch {
    /// For iterations that end once the work of the limit is spent.
    pub(crate) fn limited(limit: WorkLimit) -> NewtonScratch {
        NewtonScratch { limit, ..NewtonScratch::default() }
    }

    /// For iterations without a solve that confirms a root.
    pub(super) fn trusting_residuals(self) -> NewtonScratch {
        NewtonScratch { trusts_residuals: true, ..self }
    }
}

impl Newton {
    /// Checks the settings.
    ///
    /// # Errors
    /// [`InvalidInput::Setting`].
    pub fn check(&self) -> Result<(), InvalidInput> {
        let Newton { tolerance, min_damping, leniency, chord_contraction, .. } = *self;
        invalid::positive("the tolerance of Newton's method", tolerance)?;
        let fraction = |value: f64| value > 0.0 && value <= 1.0;
        invalid::setting("min_damping", min_damping, fraction(min_damping), "a number above 0, at most 1")?;
        invalid::positive("leniency", leniency)?;
        let contracts = (0.0..=1.0).contains(&chord_contraction);
        invalid::setting("chord_contraction", chord_contraction, contracts, "a number from 0 to 1")
    }

    /// Solves `problem` with further linear `conditions`, starting from and ending in `y`. On an error `y` is left at
    /// the last accepted iterate.
    ///
    /// With `reuse` the factors already in `system` (from a nearby problem of the same mesh) are tried first.
    ///
    /// # Errors
    /// [`NewtonError`] if the iteration does not converge from there.
    pub fn solve(
        &self,
        system: &mut System,
        scratch: &mut NewtonScratch,
        problem: &mut dyn BoundaryValueProblem,
        y: &mut Solution,
        conditions: &[LinearCondition],
        reuse: bool,
    ) -> Result<NewtonReport, NewtonError> {
        let mut iteration = self.iteration(system, scratch, problem, y, conditions)?;
        if reuse && iteration.chord() {
            return Ok(iteration.report);
        }
        iteration.run()
    }

    /// Chord steps alone, with the factors already in `system`. None if they do not converge, with `y` as it was.
    pub(crate) fn solve_with_factors(
        &self,
        system: &mut System,
        scratch: &mut NewtonScratch,
        problem: &mut dyn BoundaryValueProblem,
        y: &mut Solution,
        conditions: &[LinearCondition],
    ) -> Option<NewtonReport> {
        let mut iteration = self.iteration(system, scratch, problem, y, conditions).ok()?;
        iteration.chord().then_some(iteration.report)
    }

    /// Checks the settings, the sizes and that there are as many conditions as unknowns.
    fn iteration<'a>(
        &'a self,
        system: &'a mut System,
        scratch: &'a mut NewtonScratch,
        problem: &'a mut dyn BoundaryValueProblem,
        y: &'a mut Solution,
        conditions: &'a [LinearCondition],
    ) -> Result<Iteration<'a>, InvalidInput> {
        self.check()?;
        system.check(problem, y)?;
        invalid::length("linear conditions", conditions.len(), system.dimensions().linear_conditions())?;
        conditions.iter().try_for_each(|condition| condition.check(y.nodes.len(), y.scalars.len()))?;
        let report = NewtonReport::default();
        Ok(Iteration { settings: self, system, scratch, problem, y, conditions, report })
    }
}

/// Solves for the correction of the residual at `y` with the factors of an earlier iterate.
fn chord_correction(
    system: &mut System,
    problem: &mut dyn BoundaryValueProblem,
    y: &Solution,
    conditions: &[LinearCondition],
    correction: &mut Direction,
) -> Result<(), InvalidInput> {
    system.evaluate(problem, y, conditions, false)?;
    system.solve_own(correction)
}

/// Chord steps go on from a correction at most this fraction of the one before.
const LEAST_CONTRACTION: f64 = 0.5;

/// A correction is the last if its square is at most this part of the tolerance and its contraction is small enough: the remaining
/// error is of second order in it.
const SQUARED: f64 = 0.1;

/// A step is not confirmed if the fraction of the residual that it leaves, times its size, is below this part of the tolerance.
const SETTLED: f64 = 1e-2;

/// A correction below this changes no scaling by more than a hundredth.
const SMALL: f64 = 1e-2;

/// State of one call of [`Newton::solve`].
struct Iteration<'a> {
    settings: &'a Newton,
    system: &'a mut System,
    scratch: &'a mut NewtonScratch,
    problem: &'a mut dyn BoundaryValueProblem,
    y: &'a mut Solution,
    conditions: &'a [LinearCondition],
    report: NewtonReport,
}

impl Iteration<'_> {
    /// Factorises and steps until converged or at a limit.
    fn run(&mut self) -> Result<NewtonReport, NewtonError> {
        let settings = self.settings;
        while self.report.factorisations < settings.max_factorisations
            && self.report.iterations < settings.max_iterations
        {
            self.factorise()?;
            self.system.solve_own(&mut self.scratch.step)?;
            self.report.iterations += 1;
            let size = self.scratch.step.norm(self.y);
            if !size.is_finite() {
                return Err(self.non_finite());
            }
            if size <= settings.tolerance {
                self.scratch.step.apply(1.0, self.y);
                self.report.last_correction = size;
                return Ok(self.report);
            }
            if let Some(contraction) = self.damped_step(size)?
                && (contraction == 0.0 && self.scratch.trusts_residuals || self.chord_from(contraction))
            {
                return Ok(self.report);
            }
        }
        Err(NewtonError::Stalled { iterations: self.report.iterations, correction: self.report.last_correction })
    }

    /// Residual, derivatives and factors at `y`.
    fn factorise(&mut self) -> Result<(), NewtonError> {
        let Iteration { system, scratch, problem, y, conditions, report, .. } = self;
        let iterations = report.iterations;
        scratch.limit.spend(y.intervals()).map_err(|reason| NewtonError::Stopped { reason, iterations })?;
        report.factorisations += 1;
        match system.factorise(*problem, y, conditions) {
            Err(FactorisationError::Pivot(failure)) if failure.non_finite => Err(self.non_finite()),
            factored => factored.map_err(|error| NewtonError::of_factorisation(error, iterations)),
        }
    }

    /// The error where a correction or a pivot is not finite.
    fn non_finite(&self) -> NewtonError {
        let iterations = self.report.iterations;
        match self.system.undefined() {
            Some(place) => NewtonError::Undefined { place, iterations },
            None => NewtonError::NonFinite { iterations },
        }
    }

    /// Accepts y + λδ with the largest λ that passes the monotonicity test, δ being the correction `step` of norm `size`;
    /// the simplified correction at the accepted point is left in `trial_step`. Returns by how much it is smaller than δ
    /// if λ = 1.
    fn damped_step(&mut self, size: f64) -> Result<Option<f64>, NewtonError> {
        let Iteration { settings, system, scratch, problem, y, conditions, report } = self;
        let NewtonScratch { step, trial_step, trial, trusts_residuals, insists, .. } = &mut **scratch;
        let trial = trial.get_or_insert_with(|| y.clone());
        let before = if *trusts_residuals { system.residual.largest() } else { 0.0 };
        let mut lambda = 1.0;
        loop {
            trial.clone_from(y);
            step.apply(lambda, trial);
            system.evaluate(*problem, trial, conditions, false)?;
            if *trusts_residuals && lambda == 1.0 {
                let left = size * system.residual.largest();
                if left <= SETTLED * settings.tolerance * before {
                    std::mem::swap(*y, trial);
                    report.last_correction = 0.0;
                    return Ok(Some(0.0));
                }
            }
            system.solve_own(trial_step)?;
            report.iterations += 1;
            // Scaled by y, as `size` is, however large the trial has become.
            let next = trial_step.norm(y);
            if next <= settings.leniency * (1.0 - 0.25 * lambda) * size {
                std::mem::swap(*y, trial);
                report.last_correction = trial_step.norm(y);
                return Ok((lambda == 1.0).then_some(next / size));
            }
            lambda *= 0.5;
            if lambda < settings.min_damping || report.iterations >= settings.max_iterations {
                let iterations = report.iterations;
                if *insists && next.is_finite() {
                    std::mem::swap(*y, trial);
                    return Ok(None);
                }
                return Err(if next.is_finite() {
                    NewtonError::Stalled { iterations, correction: size }
                } else {
                    self.non_finite()
                });
            }
        }
    }

    /// Chord steps from a pending correction in `trial_step`, which is `contraction` times the one before. True when
    /// converged. A pending correction that no longer contracts well is applied if it still helps, and false returned.
    fn chord_from(&mut self, mut contraction: f64) -> bool {
        let Iteration { settings, system, scratch, problem, y, conditions, report } = self;
        let correction = &mut scratch.trial_step;
        loop {
            if contraction > LEAST_CONTRACTION {
                return false;
            }
            let size = report.last_correction;
            correction.apply(1.0, y);
            // After the pending correction the error is about θ/(1 − θ) of it. That is so where the contraction is that
            // of small corrections: the quotient of one by a step that was larger than the solution is no rate.
            if size * size <= SQUARED * settings.tolerance
                && size * contraction / (1.0 - contraction) <= settings.tolerance
            {
                return true;
            }
            if contraction > settings.chord_contraction || report.iterations >= settings.max_iterations {
                return false;
            }
            // Small corrections leave the scaling as it is.
            let before = if size < SMALL { size } else { correction.norm(y) };
            report.iterations += 1;
            if chord_correction(system, *problem, y, conditions, correction).is_err() {
                return false;
            }
            let next = correction.norm(y);
            contraction = next / before;
            if next.is_nan() || contraction > LEAST_CONTRACTION && next > settings.tolerance {
                return false;
            }
            report.last_correction = next;
            if next <= settings.tolerance {
                correction.apply(1.0, y);
                return true;
            }
        }
    }

    /// Tries to converge with the existing factors. On failure `y` is restored.
    fn chord(&mut self) -> bool {
        let Iteration { settings, system, scratch, problem, y, conditions, report } = self;
        report.iterations += 1;
        let solved = chord_correction(system, *problem, y, conditions, &mut scratch.step);
        let size = scratch.step.norm(y);
        if solved.is_err() || !size.is_finite() {
            return false;
        }
        let saved = scratch.trial.get_or_insert_with(|| y.clone());
        saved.clone_from(y);
        scratch.step.apply(1.0, y);
        report.last_correction = size;
        if size <= settings.tolerance {
            return true;
        }
        report.iterations += 1;
        let solved = chord_correction(system, *problem, y, conditions, &mut scratch.trial_step);
        report.last_correction = scratch.trial_step.norm(y);
        let in_the_same = if size < SMALL { report.last_correction } else { scratch.trial_step.norm(saved) };
        let contraction = in_the_same / size;
        if solved.is_ok() && contraction <= settings.chord_contraction && self.chord_from(contraction) {
            return true;
        }
        if let Some(saved) = &self.scratch.trial {
            self.y.clone_from(saved);
        }
        false
    }
}
