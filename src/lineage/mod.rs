//! Lineages: founders, which cells divide, in which order they are solved, what is remembered of them, the tree that grows
//! and its rounds per founder beside the observed ones.

pub mod definition;
pub mod grow;
pub mod key;
pub mod memo;
pub mod rounds;
pub mod scheduler;
pub mod store;
pub mod tree;

pub use definition::{C_ELEGANS, Daughter, Founder, Limits, Lineage, ListedDaughters, ObservedRounds, check_cue};
pub use grow::{GrowError, Grower};
pub use key::{Key, Quantisation, SolverVersion};
pub use memo::Memo;
pub use rounds::{FounderRounds, Rounds, founder_rounds};
pub use scheduler::{Job, Progress, SchedulerError, SchedulerOptions, Summary};
pub use store::Store;
pub use tree::{Cell, EndReason, Fate, Side, Tree, TreeSettings};
