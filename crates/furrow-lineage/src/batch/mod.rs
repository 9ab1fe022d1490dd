//! Many divisions, each solved once. Known divisions are looked up; the others are solved on all cores and stored for later
//! runs and other processes.
//!
//! [`scheduler::run`] requests every division from the [`Memo`] and solves unknown ones. The memo uses the [`Store`],
//! a file shared with other processes. [`mod@replicates`], [`mod@perturbations`] and [`phase`] solve many related
//! divisions; [`checks`] compares a division with others of the same cell.

pub mod checks;
pub mod key;
pub mod memo;
pub mod perturbations;
pub mod phase;
pub mod quantisation;
pub mod replicates;
pub mod scheduler;
pub mod solve;
pub mod store;

#[cfg(test)]
mod fake;

pub use key::{Key, SOLVER_VERSION};
pub use memo::{Failure, Memo, Noted, Observer};
pub use phase::{PhaseDiagram, PhasePlane};
pub use quantisation::Quantisation;
pub use replicates::{Replicates, replicates, replicates_by};
pub use scheduler::{Job, Progress, SchedulerError, SchedulerOptions, Summary, Unsolved};
#[cfg(not(target_family = "wasm"))]
pub use solve::Filming;
pub use solve::{critical_radii, method, solve};
#[cfg(feature = "store")]
pub use store::StoreError;
pub use store::{Store, StoreWarning};
