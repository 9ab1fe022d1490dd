//! Stationary shapes: their branches, bifurcations and stability.

pub mod asymmetric;
pub mod boundary;
pub mod calibrate;
pub mod continuation;
pub mod cued;
pub mod curves;
pub mod directional;
pub mod locate;
pub mod locus;
pub mod normal_form;
pub mod path;
pub mod phase;
pub mod singular;
pub mod stability;
pub mod stationary;
pub mod symmetric;

pub use boundary::Boundary;
pub use calibrate::{CalibrateError, Calibration, calibrate};
pub use stability::{Parity, Spectrum, Stability, StabilityError};
pub use stationary::{Stationary, StationaryError, stationary};
