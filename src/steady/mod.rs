//! Stationary shapes: their branches, bifurcations and stability.

pub mod continuation;
pub mod directional;
pub mod locate;
pub mod normal_form;
pub mod path;
pub mod singular;
pub mod symmetric;
pub mod stability;

pub use stability::{Parity, Spectrum, Stability, StabilityError};
