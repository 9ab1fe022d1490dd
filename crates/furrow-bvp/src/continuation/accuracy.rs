//! Continuation to an accuracy: the mesh is refined where the defect of a point is above the tolerance, and coarsened again.

use crate::mesh;
use crate::metric;
use crate::newton::NEWTON_SHARE;
use crate::problem::BoundaryValueProblem;

use super::branch::{Continuation, SHORTER, patient};
use super::settings::ContinuationError;
use super::state::Advance;

/// The mesh is made coarser once this fraction of its intervals will do.
const TOO_MANY: f64 = 0.6;

/// Fewest intervals of a coarsened mesh.
const FEWEST: usize = 8;

/// What else is held while a point is moved to another mesh.
#[derive(Clone, Copy)]
pub(super) enum Held {
    /// The position along the branch.
    Arclength,
    /// The value of λ.
    Parameter(f64),
}

impl<P: BoundaryValueProblem> Continuation<P> {
    /// Largest defect of the newest point, see [`mesh::defect`].
    pub fn defect(&mut self) -> f64 {
        self.defects().into_iter().fold(0.0, f64::max)
    }

    fn defects(&mut self) -> Vec<f64> {
        mesh::defect(&self.system.gauss, &mut self.problem, &self.state.solution)
    }

    /// One step to a point whose defect is below `tolerance`. A point whose mesh cannot be refined, since Newton fails on the
    /// finer one, is tried again nearer by.
    pub(super) fn advance_to(&mut self, tolerance: f64) -> Result<Advance, ContinuationError> {
        self.settings.newton.tolerance = newton_tolerance(self.settings.newton.tolerance, tolerance);
        self.coarsen(tolerance);
        loop {
            let saved = self.state.clone();
            let advance = self.step()?;
            let error = match self.refine(tolerance, Held::Arclength) {
                Ok(defect) => return Ok(Advance { defect: Some(defect), ..advance }),
                Err(error) => error,
            };
            let shorter = SHORTER * (self.state.arclength - saved.arclength);
            self.state = saved;
            self.exact = false;
            if matches!(error, ContinuationError::MeshLimit { .. }) || shorter < self.settings.min_step {
                return Err(error);
            }
            self.state.step = shorter;
        }
    }

    /// Moves the newest point to finer meshes until its defect, which is returned, is below `tolerance`.
    pub(super) fn refine(&mut self, tolerance: f64, held: Held) -> Result<f64, ContinuationError> {
        let limit = self.settings.max_intervals;
        let mut refinement = mesh::Refinement::new(tolerance, limit);
        loop {
            let defects = self.defects();
            let defect = defects.iter().copied().fold(0.0, f64::max);
            if defect <= tolerance {
                return Ok(defect);
            }
            let y = &self.state.solution;
            let grid = refinement.next(&defects, y.m).map(|next| mesh::redistributed(&y.mesh, &defects, y.m, next));
            let Some(grid) = grid.filter(|grid| mesh::check(grid).is_ok()) else {
                let parameter = self.state.parameter();
                return Err(ContinuationError::MeshLimit { limit, parameter, defect, tolerance });
            };
            self.move_to(&grid);
            self.correct_newest(held)?;
        }
    }

    /// Moves to a mesh of fewer intervals where they do.
    fn coarsen(&mut self, tolerance: f64) {
        let defects = self.defects();
        let y = &self.state.solution;
        let intervals = y.intervals();
        let needed = mesh::intervals_for(&defects, y.m, tolerance).max(FEWEST);
        if (needed as f64) < TOO_MANY * intervals as f64 {
            let grid = mesh::redistributed(&y.mesh, &defects, y.m, needed);
            if mesh::check(&grid).is_ok() {
                self.move_to(&grid);
            }
        }
    }

    /// Solves for the newest point again, after a change of mesh.
    fn correct_newest(&mut self, held: Held) -> Result<(), ContinuationError> {
        let Continuation { problem, system, settings, metric, state, scratch, conditions, trial, .. } = self;
        match held {
            Held::Arclength => metric.plane_through(&state.solution, &state.tangent, &mut conditions[0]),
            Held::Parameter(value) => {
                let last = state.solution.scalars.len().saturating_sub(1);
                metric::scalar_condition(&state.solution, last, value, &mut conditions[0]);
            }
        }
        trial.clone_from(&state.solution);
        let solved = patient(settings.newton).solve(system, scratch, problem, trial, conditions, false);
        let parameter = self.state.parameter();
        solved.map_err(|error| self.lost(parameter, error.into()))?;
        std::mem::swap(&mut self.state.solution, &mut self.trial);
        self.exact = false;
        self.exact_tangent().map_err(|failure| self.lost(parameter, failure.into()))?;
        self.state.history.replace_newest(self.state.arclength, &self.state.solution);
        Ok(())
    }
}

/// The tolerance of a corrector whose points are to have a defect below `tolerance`.
pub(super) fn newton_tolerance(own: f64, tolerance: f64) -> f64 {
    own.min(NEWTON_SHARE * tolerance).max(f64::MIN_POSITIVE)
}
