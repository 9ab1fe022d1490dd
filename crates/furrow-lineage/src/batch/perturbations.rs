//! Disturbances of one stationary shape by noise of several seeds.

use super::scheduler::{self, Result};
use furrow_mechanics::division::{DivisionInput, DivisionOptions};
use furrow_mechanics::equilibria::stationary;
use furrow_mechanics::perturbation::{Perturbation, PerturbationError, perturb};

/// A disturbed shape.
#[derive(Clone, Debug, PartialEq)]
pub struct Disturbed {
    /// The seed of the noise.
    pub seed: u64,
    /// Its evolution, or the reason why this could not be computed.
    pub found: Result<Perturbation, PerturbationError>,
}

/// Disturbances with consecutive seeds from `input.seed`, on `threads` threads; 0 is one thread per core. They are not stored,
/// because each result is a curve.
///
/// # Errors
/// No workers can be started. The absence of a stationary shape is not an error here but the result of every seed.
pub fn perturbations(input: &DivisionInput, count: usize, until: f64, threads: usize) -> Result<Vec<Disturbed>> {
    let start = stationary(&input.cell, &input.numerics);
    let one = |k: usize| {
        let seed = input.seed.wrapping_add(k as u64);
        let start = start.as_ref().map_err(|error| PerturbationError::from(error.clone()));
        let found = start.and_then(|start| {
            perturb(&DivisionInput { seed, ..input.clone() }, start, until, DivisionOptions::default())
        });
        Disturbed { seed, found }
    };
    Ok(scheduler::pool(threads)?.install(|| scheduler::in_parallel(count, one)))
}
