//! Branches of solutions in one parameter.

mod accuracy;
mod branch;
mod following;
mod passing;
pub mod predictor;
mod settings;
mod state;
mod unfolded;
mod unfolding;

pub(crate) use branch::SHORTER;
pub use branch::{Continuation, MeshMonitor};
pub(crate) use passing::{PassedBranchPoint, distances, is_within_step};
pub use settings::{ContinuationError, ContinuationSettings, StepFailure};
pub use state::{Advance, State, Termination};
pub(crate) use unfolding::{Differentiated, Unfolding};
