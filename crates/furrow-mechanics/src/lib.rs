//! The mechanics of [furrow](https://docs.rs/furrow): the model of a cell, the equations of its cortex, its stationary
//! shapes and its division.
//!
//! This crate decides a division: it has no trees, store, command line, files or clock. Growth rates along a branch are
//! computed on a second thread, with the same bits on any number of threads. The crate is separate for speed: it is
//! compiled as one unit with full optimisation.
//!
//! | module | role |
//! |---|---|
//! | [`cortex`] | the equations of the surface, their derivatives, symmetry, observables |
//! | [`stability`] | growth rates of small perturbations of a stationary shape |
//! | [`azimuthal`] | growth rates of non-axisymmetric perturbations |
//! | [`equilibria`] | branches of stationary shapes, folds and pitchforks |
//! | [`calibration`] | constants from thresholds |
//! | [`division`] | one division in time |
//! | [`critical`] | the radius below which a cell does not divide |
//! | [`law`] | cells with a law of active stress of their own |
//! | [`perturbation`] | the evolution of a perturbed stationary shape |
//! | [`polarity`] | PAR polarity on the passive shape: two antagonists with cytosolic pools |
//!
//! # References
//! Gao, Guan, Tang & Ma, "Cell size and confinement drive asymmetric cell division through a cortical instability",
//! called *the paper* throughout.

pub mod azimuthal;
pub mod calibration;
pub mod cortex;
pub mod critical;
pub mod division;
pub mod equilibria;
pub mod law;
pub mod perturbation;
pub mod polarity;
pub mod stability;
