//! Many things computed once each: what is known is looked up, what is not is solved on all cores and kept for the next
//! run and for other processes.
//!
//! What is computed is a [`Task`], what comes of it a [`Record`]; [`division`] says what these are for cells that divide,
//! [`mod@replicates`], [`mod@perturbations`] and [`phase`] solve many of them,
//! and these alone know of cells. [`scheduler::run`] asks the [`Memo`] for the record of every task; the
//! memo asks the [`Store`], which shares a folder with other processes.

pub mod division;
pub mod key;
pub mod memo;
pub mod perturbations;
pub mod phase;
pub mod quantisation;
pub mod replicates;
pub mod scheduler;
pub mod store;
pub mod task;

#[cfg(test)]
mod stick;

pub use key::{Key, SolverVersion};
pub use memo::{Failure, Memo};
pub use phase::{PhaseDiagram, PhasePlane};
pub use quantisation::Quantisation;
pub use replicates::{Replicates, replicates};
pub use scheduler::{Job, Progress, SchedulerError, SchedulerOptions, Summary, Unsolved};
pub use store::{Store, StoreError, StoreWarning};
pub use task::{Record, Task};
