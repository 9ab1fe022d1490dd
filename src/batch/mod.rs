//! Many things computed once each: what is known is looked up, what is not is solved on all cores and kept for the next
//! run and for other processes.

pub mod key;
pub mod memo;
pub mod scheduler;
pub mod store;

pub use key::{Key, Quantisation, SolverVersion};
pub use memo::{Failure, Memo};
pub use scheduler::{Job, Progress, SchedulerError, SchedulerOptions, Summary};
pub use store::Store;
