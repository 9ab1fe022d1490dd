//! Damped Newton iteration with Jacobian reuse.
//!
//! Every factorisation is used for one full step and then for chord steps while they contract. Damping follows the
//! natural monotonicity test: a step is accepted when the simplified correction J⁻¹F(x + λδ) is smaller than δ.
//!
//! # References
//! Deuflhard, *Newton Methods for Nonlinear Problems*, Springer 2004, ch. 3.

use crate::problem::BoundaryValueProblem;
use crate::solution::Solution;
use crate::{Direction, LinearCondition, System};

/// Settings of the iteration.
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
pub enum NewtonError {
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
    /// A residual or correction was not finite.
    #[error("the residual is not finite after {iterations} iterations")]
    NonFinite {
        /// Linear solves done.
        iterations: usize,
    },
    /// The accuracy asked for would need more intervals than allowed.
    #[error("the mesh limit of {limit} intervals is reached with a defect of {defect:.3e}")]
    MeshLimit {
        /// Most intervals allowed.
        limit: usize,
        /// Defect at the limit.
        defect: f64,
    },
}

/// Scratch of [`Newton::solve`], reused between calls.
#[derive(Clone, Debug, Default)]
pub struct NewtonScratch {
    step: Direction,
    trial_step: Direction,
    trial: Option<Solution>,
}

impl Newton {
    /// Solves `problem` with further linear `conditions`, starting from and ending in `y`. On an error `y` is left at
    /// the last accepted iterate.
    ///
    /// With `reuse` the factors already in `system` (from a nearby problem of the same mesh) are tried first.
    pub fn solve<P: BoundaryValueProblem>(
        &self,
        system: &mut System,
        scratch: &mut NewtonScratch,
        problem: &mut P,
        y: &mut Solution,
        conditions: &[LinearCondition],
        reuse: bool,
    ) -> Result<NewtonReport, NewtonError> {
        let mut report = NewtonReport::default();
        if reuse && self.chord(system, scratch, problem, y, conditions, &mut report)? {
            return Ok(report);
        }
        while report.factorisations < self.max_factorisations && report.iterations < self.max_iterations {
            system.evaluate(problem, y, conditions, true);
            report.factorisations += 1;
            system.condense().and_then(|()| system.factor_blocks(conditions)).map_err(|f| {
                if f.non_finite {
                    NewtonError::NonFinite { iterations: report.iterations }
                } else {
                    NewtonError::Singular { column: f.column, iterations: report.iterations }
                }
            })?;
            system.solve_own(&mut scratch.step);
            report.iterations += 1;
            let size = scratch.step.norm(y);
            if !size.is_finite() {
                return Err(NewtonError::NonFinite { iterations: report.iterations });
            }
            if size <= self.tolerance {
                scratch.step.apply(1.0, y);
                report.last_correction = size;
                return Ok(report);
            }
            if self.damped_step(system, scratch, problem, y, conditions, size, &mut report)?
                && self.chord_from(system, scratch, problem, y, conditions, size, &mut report)
            {
                return Ok(report);
            }
        }
        Err(NewtonError::Stalled { iterations: report.iterations, correction: report.last_correction })
    }

    /// Accepts y + λδ with the largest λ that passes the monotonicity test; the simplified correction at the accepted
    /// point is left in `trial_step`. Returns whether λ = 1.
    #[allow(clippy::too_many_arguments)]
    fn damped_step<P: BoundaryValueProblem>(
        &self,
        system: &mut System,
        scratch: &mut NewtonScratch,
        problem: &mut P,
        y: &mut Solution,
        conditions: &[LinearCondition],
        size: f64,
        report: &mut NewtonReport,
    ) -> Result<bool, NewtonError> {
        let mut lambda = 1.0;
        loop {
            let trial = scratch.trial.get_or_insert_with(|| y.clone());
            trial.clone_from(y);
            scratch.step.apply(lambda, trial);
            system.evaluate(problem, trial, conditions, false);
            system.solve_own(&mut scratch.trial_step);
            report.iterations += 1;
            let next = scratch.trial_step.norm(trial);
            if next <= (1.0 - 0.25 * lambda) * size {
                std::mem::swap(y, trial);
                report.last_correction = next;
                return Ok(lambda == 1.0);
            }
            lambda *= 0.5;
            if lambda < self.min_damping || report.iterations >= self.max_iterations {
                return Err(if next.is_finite() {
                    NewtonError::Stalled { iterations: report.iterations, correction: size }
                } else {
                    NewtonError::NonFinite { iterations: report.iterations }
                });
            }
        }
    }

    /// Chord steps from a pending correction in `trial_step`; `before` is the size of the step before it. True when
    /// converged. A pending correction that no longer contracts well is applied if it still helps, and false returned.
    #[allow(clippy::too_many_arguments)]
    fn chord_from<P: BoundaryValueProblem>(
        &self,
        system: &mut System,
        scratch: &mut NewtonScratch,
        problem: &mut P,
        y: &mut Solution,
        conditions: &[LinearCondition],
        before: f64,
        report: &mut NewtonReport,
    ) -> bool {
        let mut before = before;
        loop {
            let size = report.last_correction;
            let theta = size / before;
            if theta > 0.5 {
                return false;
            }
            scratch.trial_step.apply(1.0, y);
            // After the pending correction the error is about θ/(1 − θ) of it.
            if size * theta / (1.0 - theta) <= self.tolerance {
                return true;
            }
            if theta > self.chord_contraction || report.iterations >= self.max_iterations {
                return false;
            }
            system.evaluate(problem, y, conditions, false);
            system.solve_own(&mut scratch.trial_step);
            report.iterations += 1;
            let next = scratch.trial_step.norm(y);
            if next.is_nan() || next > 0.5 * size && next > self.tolerance {
                return false;
            }
            before = size;
            report.last_correction = next;
            if next <= self.tolerance {
                scratch.trial_step.apply(1.0, y);
                return true;
            }
        }
    }

    /// Tries to converge with the factors at hand. On failure `y` is restored.
    fn chord<P: BoundaryValueProblem>(
        &self,
        system: &mut System,
        scratch: &mut NewtonScratch,
        problem: &mut P,
        y: &mut Solution,
        conditions: &[LinearCondition],
        report: &mut NewtonReport,
    ) -> Result<bool, NewtonError> {
        system.evaluate(problem, y, conditions, false);
        system.solve_own(&mut scratch.step);
        report.iterations += 1;
        let size = scratch.step.norm(y);
        if !size.is_finite() {
            return Ok(false);
        }
        let saved = scratch.trial.get_or_insert_with(|| y.clone());
        saved.clone_from(y);
        scratch.step.apply(1.0, y);
        report.last_correction = size;
        if size <= self.tolerance {
            return Ok(true);
        }
        system.evaluate(problem, y, conditions, false);
        system.solve_own(&mut scratch.trial_step);
        report.iterations += 1;
        report.last_correction = scratch.trial_step.norm(y);
        if report.last_correction <= self.chord_contraction * size
            && self.chord_from(system, scratch, problem, y, conditions, size, report)
        {
            return Ok(true);
        }
        if let Some(saved) = &scratch.trial {
            y.clone_from(saved);
        }
        Ok(false)
    }
}
