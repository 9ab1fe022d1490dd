//! Continuation to an accuracy: the mesh is refined where the defect of a point is above the tolerance, and coarsened again.
//!
//! Where folds and branch points are depends on the tangent and on a second, nearly null direction, which may need more
//! intervals than the point itself: along a branch of zeros that has no defect at all. Their defects count as well. An
//! eigenvalue has an error of order h^(2m), the defect of its vectors is of order h^(m+1), and the bound on it follows from that.
//!
//! The second direction is the response to a smooth disturbance of the right-hand side. It keeps the conditions, as a null direction
//! does: one that breaks u′ = 0 at a singular centre is itself singular there, and no mesh resolves it.

use crate::direction::Direction;
use crate::mesh;
use crate::metric;
use crate::newton::NEWTON_SHARE;
use crate::problem::BoundaryValueProblem;

use super::branch::{Continuation, SHORTER, with_more_iterations};
use super::settings::ContinuationError;
use super::state::Advance;

/// The mesh is made coarser once this fraction of its intervals will do.
const TOO_MANY: f64 = 0.6;

/// Fewest intervals of a coarsened mesh.
const FEWEST: usize = 8;

/// The quantity that stays fixed while a point is moved to another mesh.
#[derive(Clone, Copy)]
pub(super) enum Fixed {
    /// The plane across the tangent.
    Arclength,
    /// The value of λ.
    Parameter(f64),
}

impl<P: BoundaryValueProblem> Continuation<P> {
    /// Largest defect of the newest point, see [`mesh::defect`].
    pub fn defect(&mut self) -> f64 {
        largest(&mesh::defect(&self.system.gauss, &mut self.problem, &self.state.solution))
    }

    /// The largest defect of the newest point, and the defect of every interval. Unless the point is taken `alone`, the latter is the
    /// largest defect of point, tangent and response, the last two scaled to the tolerance of the point.
    fn defects(&mut self, tolerance: f64, alone: bool) -> (f64, Vec<f64>) {
        let Continuation { problem, system, state, response, .. } = self;
        let (gauss, y) = (&system.gauss, &state.solution);
        let mut defects = mesh::defect(gauss, problem, y);
        let own = largest(&defects);
        let m = y.m as f64;
        let scale = tolerance / tolerance.min(1.0).powf((m + 1.0) / (2.0 * m));
        for (direction, disturbed) in [(&state.tangent, 0.0), (&*response, 1.0)] {
            let size = direction.norm(y);
            if !alone && direction.check(y).is_ok() && size > 0.0 && size.is_finite() {
                let of_direction = mesh::direction_defect(gauss, problem, y, (direction, disturbed));
                defects.iter_mut().zip(of_direction).for_each(|(all, one)| *all = all.max(scale * one));
            }
        }
        (own, defects)
    }

    /// Computes the response to a disturbance if the newest point has factors.
    fn respond(&mut self) {
        let Continuation { system, state, response, .. } = self;
        let mut residual = system.zero_residual();
        residual.stages = mesh::disturbance(&system.gauss.c, &state.solution, -1.0);
        if system.solve(&residual, response).is_err() {
            *response = Direction::default();
        }
    }

    /// Stores the determinant and the response of the factors at the newest point.
    pub(super) fn update_test_values(&mut self) {
        let determinant = self.system.determinant();
        (self.state.orientation, self.log_determinant) = (determinant.sign, determinant.log_abs);
        if self.settings.tolerance.is_some() {
            self.respond();
        }
    }

    /// One step to a point with a defect below `tolerance`. If Newton fails on the refined mesh, a shorter step is tried.
    pub(super) fn advance_to(&mut self, tolerance: f64) -> Result<Advance, ContinuationError> {
        self.settings.newton.tolerance = newton_tolerance(self.settings.newton.tolerance, tolerance);
        self.coarsen(tolerance);
        loop {
            let saved = self.state.clone();
            let advance = self.step()?;
            self.respond();
            let error = match self.refine(tolerance, Fixed::Arclength) {
                Ok(defect) => return Ok(Advance { defect: Some(defect), ..advance }),
                Err(error) => error,
            };
            let shorter = SHORTER * (self.state.arclength - saved.arclength);
            self.state = saved;
            self.exact = false;
            let ended = matches!(error, ContinuationError::MeshLimit { .. } | ContinuationError::Stopped { .. });
            if ended || shorter < self.settings.min_step {
                return Err(error);
            }
            self.state.step = shorter;
        }
    }

    /// Moves the newest point to finer meshes until its defect, which is returned, is below `tolerance`.
    pub(super) fn refine(&mut self, tolerance: f64, fixed: Fixed) -> Result<f64, ContinuationError> {
        let limit = self.settings.max_intervals;
        let mut refinement = mesh::Refinement::new(tolerance, limit);
        let mut alone = false;
        loop {
            let (defect, defects) = self.defects(tolerance, alone);
            if largest(&defects) <= tolerance {
                return Ok(defect);
            }
            let grid = refinement.next(&self.state.solution, &defects);
            let Some(grid) = grid.filter(|grid| mesh::is_distinct(grid)) else {
                if defect <= tolerance {
                    // As well as the mesh allows for its directions.
                    return Ok(defect);
                }
                if !alone {
                    // The intervals may still do for the point.
                    (alone, refinement) = (true, mesh::Refinement::new(tolerance, limit));
                    continue;
                }
                let parameter = self.state.parameter();
                return Err(ContinuationError::MeshLimit { limit, parameter, defect, tolerance });
            };
            self.move_to(&grid);
            self.correct_newest(fixed)?;
        }
    }

    /// Moves to a mesh of fewer intervals where they do.
    fn coarsen(&mut self, tolerance: f64) {
        if self.response.check(&self.state.solution).is_err() && self.factorise_newest().is_ok() {
            self.update_test_values();
        }
        let (_, defects) = self.defects(tolerance, false);
        let y = &self.state.solution;
        let intervals = y.intervals();
        let needed = mesh::intervals_for(&y.mesh, &defects, y.m, tolerance).max(FEWEST);
        if (needed as f64) < TOO_MANY * intervals as f64 {
            let grid = mesh::redistributed(&y.mesh, &defects, y.m, needed, intervals);
            if mesh::is_distinct(&grid) {
                self.move_to(&grid);
            }
        }
    }

    /// Solves for the newest point again, after a change of mesh.
    fn correct_newest(&mut self, fixed: Fixed) -> Result<(), ContinuationError> {
        let Continuation { problem, system, settings, metric, state, scratch, conditions, trial, .. } = self;
        match fixed {
            Fixed::Arclength => metric.plane_through(&state.solution, &state.tangent, &mut conditions[0]),
            Fixed::Parameter(value) => {
                let last = state.solution.scalars.len().saturating_sub(1);
                metric::scalar_condition(&state.solution, last, value, &mut conditions[0]);
            }
        }
        trial.clone_from(&state.solution);
        let solved = with_more_iterations(settings.newton).solve(system, scratch, problem, trial, conditions, false);
        let parameter = self.state.parameter();
        solved.map_err(|error| self.lost(parameter, error.into()))?;
        std::mem::swap(&mut self.state.solution, &mut self.trial);
        self.exact = false;
        self.exact_tangent().map_err(|failure| self.lost(parameter, failure.into()))?;
        self.update_test_values();
        self.state.history.replace_newest(self.state.arclength, &self.state.solution);
        Ok(())
    }
}

fn largest(defects: &[f64]) -> f64 {
    defects.iter().copied().fold(0.0, f64::max)
}

/// The tolerance of a corrector for points with a defect below `tolerance`.
pub(super) fn newton_tolerance(own: f64, tolerance: f64) -> f64 {
    own.min(NEWTON_SHARE * tolerance).max(f64::MIN_POSITIVE)
}
