//! From a branch point onto the branch that crosses there.

use crate::continuation::predictor::History;
use crate::continuation::{Continuation, ContinuationError, SHORTER, State, StepFailure, distances};
use crate::direction::{Direction, LinearCondition};
use crate::linear::System;
use crate::newton::NewtonScratch;
use crate::problem::BoundaryValueProblem;
use crate::solution::Solution;

use super::branch_point::BranchPoint;

/// A first point may be this share of the first step off the tangent.
const OFF: f64 = 0.5;

impl BranchPoint {
    /// A point of the crossing branch next to this one, for [`Continuation::resume`]: along its tangent, or against it if not
    /// `forwards`. Its arclength is counted from the branch point. The branch that was followed stays as it is, but for its count
    /// of work.
    ///
    /// # Errors
    /// [`ContinuationError::Lost`] if there is no such point at any distance from
    /// [`first_step`](crate::ContinuationSettings::first_step) down to [`min_step`](crate::ContinuationSettings::min_step).
    pub fn switch<P: BoundaryValueProblem>(
        &self,
        branch: &mut Continuation<P>,
        forwards: bool,
    ) -> Result<State, ContinuationError> {
        let mut along = self.tangents[1].clone();
        along.scale(if forwards { 1.0 } else { -1.0 });
        let mut step = branch.settings.first_step;
        loop {
            let source = match self.first_point(branch, &along, step) {
                Ok((solution, tangent)) => return Ok(self.state(solution, tangent, step)),
                Err(source) => source,
            };
            step *= SHORTER;
            if step.is_nan() || step < branch.settings.min_step {
                return Err(ContinuationError::Lost { parameter: self.parameter(), arclength: 0.0, source });
            }
        }
    }

    /// The point of the crossing branch at a distance along its tangent, and the tangent there.
    fn first_point<P: BoundaryValueProblem>(
        &self,
        branch: &mut Continuation<P>,
        along: &Direction,
        step: f64,
    ) -> Result<(Solution, Direction), StepFailure> {
        let Continuation { problem, metric, settings, work, state, .. } = branch;
        let mut system = System::new(problem.dimensions(), self.solution.m);
        let mut conditions = vec![LinearCondition::default()];
        let mut y = self.solution.clone();
        metric.plane_through(&y, along, &mut conditions[0]);
        conditions[0].value += step;
        along.apply(step, &mut y);
        let mut scratch = NewtonScratch::default();
        let report = settings.newton.solve(&mut system, &mut scratch, problem, &mut y, &conditions, false);
        problem.prepare(&state.solution.scalars);
        *work += report?;
        let mut tangent = Direction::default();
        system.factorise(problem, &y, &conditions)?;
        work.factorisations += 1;
        system.null_direction(0, &mut tangent)?;
        problem.prepare(&state.solution.scalars);
        metric.normalise(&y.mesh, &mut tangent);
        let [cosine, other] = [along, &self.tangents[0]].map(|d| metric.dot(&y.mesh, &tangent, d));
        if cosine.is_nan() || cosine < settings.min_cosine {
            return Err(StepFailure::Turn { cosine });
        }
        let [_, across] = distances(metric, &self.solution, &y, along);
        if cosine <= other.abs() || across > OFF * step {
            return Err(StepFailure::OtherBranch);
        }
        Ok((y, tangent))
    }

    /// A run that has come from the branch point to its first point.
    fn state(&self, solution: Solution, tangent: Direction, step: f64) -> State {
        let mut history = History::default();
        history.push(0.0, &self.solution);
        history.push(step, &solution);
        let direction = tangent.scalars[tangent.scalars.len() - 1].signum();
        State { solution, tangent, arclength: step, step, points: 1, direction, orientation: 0.0, history }
    }
}
