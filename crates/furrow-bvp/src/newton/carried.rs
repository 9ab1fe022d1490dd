//! Newton's iterates carried from mesh to mesh, where damped Newton and the homotopy fail.
//!
//! A few steps are taken on each of several meshes, which are refined although the iterates have not converged. Steps that no damping makes
//! acceptable are taken nevertheless, so that an iterate can leave the neighbourhood of the guess.

use crate::linear::System;
use crate::mesh;
use crate::problem::BoundaryValueProblem;
use crate::solution::Solution;

use super::iteration::{Newton, NewtonError, NewtonScratch};
use super::work::Work;

/// The iteration on each mesh.
const FEW: Newton = Newton {
    tolerance: 1e-6,
    max_factorisations: 8,
    max_iterations: 40,
    min_damping: 0.06,
    leniency: 1.0,
    chord_contraction: 0.3,
};

/// Number of meshes.
const MESHES: usize = 12;

/// Intervals with a larger defect are cut into two, and those with a hundred times as large a defect into three.
const DEFECT: f64 = 1e-3;

/// A solution on some mesh of at most `max_intervals`; `None` if no iterate converges.
pub(super) fn solve(
    problem: &mut dyn BoundaryValueProblem,
    guess: &Solution,
    max_intervals: usize,
    system: &mut System,
    scratch: &mut NewtonScratch,
    work: &mut Work,
) -> Option<Solution> {
    scratch.insists = true;
    let (mut y, mut meshes) = (guess.clone(), 0..MESHES);
    let found = loop {
        if meshes.next().is_none() {
            break None;
        }
        match FEW.solve(system, scratch, problem, &mut y, &[], false) {
            Ok(report) => {
                *work += report;
                break Some(y);
            }
            Err(NewtonError::Stalled { .. }) => work.rejected += 1,
            Err(_) => break None,
        }
        let defects = mesh::defect(&system.gauss, problem, &y);
        let grid = mesh::cut(&y.mesh, |i| match defects[i] {
            defect if defect > 100.0 * DEFECT => 3,
            defect if defect > DEFECT => 2,
            _ => 1,
        });
        if grid.len() == y.mesh.len() || grid.len() > max_intervals + 1 {
            break None;
        }
        work.remeshings += 1;
        y = y.on_mesh(&system.gauss, &grid);
    };
    scratch.insists = false;
    found
}
