//! Stationary shapes: their branches, bifurcations and stability.

pub mod stability;

pub use stability::{Parity, Spectrum, Stability, StabilityError};
