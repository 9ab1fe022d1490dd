//! Lineages: which cells divide, in which order they are solved, and what is remembered of them.

pub mod key;
pub mod memo;
pub mod scheduler;

pub use key::{Key, Quantisation, SolverVersion};
pub use memo::Memo;
pub use scheduler::{Job, Progress, SchedulerError, SchedulerOptions, Summary};
