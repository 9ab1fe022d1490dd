//! The active viscous cortex inside its shell: parameters, cue, equations, observables.

pub mod control;
pub mod cue;
pub mod equations;
pub mod parameters;
pub mod shape;

pub use control::Control;
pub use cue::Cue;
pub use equations::{Cortex, Domain};
pub use parameters::{Numerics, Physics, RigidityGradient};
