//! Lineages: founders, which cells divide, the tree that grows and its rounds per founder beside the observed ones.

pub mod definition;
pub mod grow;
pub mod rounds;
pub mod tree;
pub mod work;

pub use definition::{C_ELEGANS, Daughter, Founder, Limits, Lineage, ListedDaughters, ObservedRounds, check_cue};
pub use grow::{GrowError, Grower};
pub use rounds::{FounderRounds, Rounds, founder_rounds};
pub use tree::{Cell, EndReason, Fate, Side, Tree, TreeSettings};
pub use work::expected_work;
