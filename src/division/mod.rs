//! One division in time: implicit stepping of the cortex from the passive shape to pinch-off or rest.

pub mod noise;
pub mod outcome;
pub mod run;
pub mod stepper;

pub use outcome::{Division, DivisionError, Outcome};
pub use run::{Frame, divide, divide_observed};

use crate::cortex::{Cue, Numerics, Physics};

/// What one division depends on, and all it depends on: equal inputs give bit-identical outcomes.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct DivisionInput {
    /// Physical parameters; `physics.epsilon` is used, `physics.r0` (the first cell's radius) is not.
    pub physics: Physics,
    /// Discretisation.
    pub numerics: Numerics,
    /// Radius R0 of the sphere with the cell's volume, in L_h.
    pub r0: f64,
    /// Polarity cue.
    pub cue: Cue,
    /// Seed of the noise in the first step.
    pub seed: u64,
}
