//! Lineages: founders, which cells divide, the tree that grows and its rounds per founder beside the observed ones.
//!
//! | file | what it says |
//! |---|---|
//! | [`definition`] | the lineage file: founders, cues and who carries them, names, limits, observed counts |
//! | [`grow`] | growth: volumes are handed down, every cell's division is solved as soon as its mother's is |
//! | [`ends`] | which cells cannot divide, told ahead of their division |
//! | [`work`] | in which order divisions are solved |
//! | [`tree`] | the tree grown |
//! | [`rounds`] | rounds of division per founder |

mod check;
mod clash;
pub mod definition;
pub mod ends;
pub mod grow;
pub mod rounds;
pub mod tree;
pub mod work;

pub use definition::{C_ELEGANS, CueRule, Daughter, Founder, Limits, Lineage, ListedDaughters, ObservedRounds, Place};
pub use ends::Ends;
pub use grow::{GrowError, Grower};
pub use rounds::{FounderRounds, Rounds, founder_rounds};
pub use tree::{CellId, EndReason, Fate, Side, Tree, TreeCell, TreeSettings};
pub use work::expected_work;
