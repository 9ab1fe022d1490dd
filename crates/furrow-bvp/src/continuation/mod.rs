//! Branches of solutions in one parameter.

mod accuracy;
mod branch;
pub mod predictor;

pub(crate) use branch::SHORTER;
pub use branch::{
    Advance, Continuation, ContinuationError, ContinuationSettings, MeshMonitor, State, StepFailure, Termination,
};
