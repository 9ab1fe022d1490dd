//! Following a branch to a value of its parameter.

use crate::direction::Direction;
use crate::metric;
use crate::problem::BoundaryValueProblem;
use crate::solution::Solution;

use super::accuracy::Fixed;
use super::branch::{Continuation, with_more_iterations};
use super::passing::PassedBranchPoint;
use super::settings::ContinuationError;
use super::state::{Advance, Termination};

impl<P: BoundaryValueProblem> Continuation<P> {
    /// Follows the branch until λ leaves `range`, `limit` points are reached or `visit` returns false. `visit` sees
    /// every accepted point with the factors it left in `system`. A last point on the bound of the range is solved for.
    ///
    /// # Errors
    /// As [`advance`](Self::advance).
    pub fn follow(
        &mut self,
        range: [f64; 2],
        limit: usize,
        mut visit: impl FnMut(&mut Self, Advance) -> bool,
    ) -> Result<Termination, ContinuationError> {
        for _ in 0..limit {
            let mut advance = match self.advance() {
                Err(ContinuationError::Degenerate { .. }) => return Ok(Termination::Degenerate),
                advance => advance?,
            };
            let parameter = self.state.parameter();
            if parameter < range[0] || parameter > range[1] {
                let bound = if parameter < range[0] { range[0] } else { range[1] };
                self.land_on(bound)?;
                advance.defect = self.settings.tolerance.map(|_| self.defect());
                // What was passed may lie beyond the bound.
                advance.passed_branch_point &=
                    self.passed.as_ref().is_none_or(|PassedBranchPoint { solution: y, .. }| {
                        let passed = y.scalars[y.scalars.len() - 1];
                        (range[0]..=range[1]).contains(&passed)
                    });
                visit(self, advance);
                return Ok(Termination::ParameterBound(bound));
            }
            if !visit(self, advance) {
                return Ok(Termination::Stopped);
            }
        }
        Ok(Termination::PointLimit(limit))
    }

    /// Replaces the newest point by the one with λ = `value` between the last two.
    ///
    /// # Errors
    /// [`ContinuationError::Lost`] if the corrector fails there, [`ContinuationError::MeshLimit`] if the point is not accurate
    /// enough.
    pub fn land_on(&mut self, value: f64) -> Result<(), ContinuationError> {
        let y = self.at(value)?;
        if let Some((before, share)) = self.between_last_points(value) {
            self.state.arclength = before + share.clamp(0.0, 1.0) * (self.state.arclength - before);
        }
        self.state.solution = y;
        self.exact_tangent().map_err(|failure| self.lost(value, failure.into()))?;
        // The points before stay, so that what lies between them and the new one can still be located.
        self.state.history.replace_newest(self.state.arclength, &self.state.solution);
        self.problem.accepted(&self.state.solution);
        if let Some(tolerance) = self.settings.tolerance {
            self.update_test_values();
            self.refine(tolerance, Fixed::Parameter(value))?;
        }
        Ok(())
    }

    /// Arclength of the point before the newest, and the place of λ = `value` between the two by linear interpolation: 0 at
    /// that point, 1 at the newest. None if λ is the same at both.
    fn between_last_points(&self, value: f64) -> Option<(f64, f64)> {
        let (arclength, earlier) = self.state.history.back(1)?;
        let before = *earlier.scalars.last()?;
        let span = self.state.parameter() - before;
        (span != 0.0).then(|| (arclength, (value - before) / span))
    }

    /// Corrects `y` onto the branch in the plane through it across `direction`, and returns whether that succeeded; otherwise `y` is left
    /// as it is.
    pub fn correct_across(&mut self, y: &mut Solution, direction: &Direction) -> bool {
        self.exact = false;
        self.metric.plane_through(y, direction, &mut self.conditions[0]);
        self.trial.clone_from(y);
        let Continuation { problem, system, settings, scratch, conditions, trial, .. } = self;
        let solved = settings.newton.solve(system, scratch, problem, trial, conditions, false).is_ok();
        if solved {
            std::mem::swap(y, trial);
        }
        solved
    }

    /// The solution with λ = `value` near the last two points; the run itself is left alone.
    ///
    /// # Errors
    /// [`ContinuationError::Lost`] if the corrector fails there.
    pub fn at(&mut self, value: f64) -> Result<Solution, ContinuationError> {
        self.check()?;
        self.renew_budget();
        self.exact = false;
        let mut y = self.state.solution.clone();
        if let Some((before, share)) = self.between_last_points(value) {
            self.state.history.extrapolate(before + share * (self.state.arclength - before), &mut y);
        }
        let last = y.scalars.len() - 1;
        metric::scalar_condition(&y, last, value, &mut self.conditions[0]);
        with_more_iterations(self.settings.newton)
            .solve(&mut self.system, &mut self.scratch, &mut self.problem, &mut y, &self.conditions, false)
            .map_err(|error| self.lost(value, error.into()))?;
        Ok(y)
    }
}
