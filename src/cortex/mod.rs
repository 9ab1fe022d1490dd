//! The active viscous cortex inside its shell: parameters, cue, equations, observables.

pub mod cue;
pub mod parameters;

pub use cue::Cue;
pub use parameters::{Numerics, Physics, RigidityGradient};
