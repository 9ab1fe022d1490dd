//! Branches of solutions in one parameter.

mod accuracy;
mod branch;
mod passing;
pub mod predictor;
mod unfolded;
mod unfolding;

pub(crate) use branch::SHORTER;
pub use branch::{
    Advance, Continuation, ContinuationError, ContinuationSettings, MeshMonitor, State, StepFailure, Termination,
};
pub(crate) use passing::{belongs, distances};
pub(crate) use unfolding::Unfolding;
