//! Lineages: founders, which cells divide, the tree that grows and its rounds per founder beside the observed ones.
//!
//! | file | what it says |
//! |---|---|
//! | [`definition`] | the lineage file: founders, cues and who carries them, names, limits, observed counts; a file may say what differs from a built-in one |
//! | [`observed`], [`physics`], [`units`] | what was observed of a founder, what it changes of the physics, µm and minutes |
//! | [`grow`] | growth: volumes are handed down, every cell's division is solved as soon as its mother's is |
//! | [`ends`] | which cells cannot divide, told ahead of their division |
//! | [`work`] | in which order divisions are solved |
//! | [`tree`] | the tree grown |
//! | [`rounds`] | rounds of division per founder |

mod base;
mod check;
mod clash;
pub mod definition;
pub mod ends;
pub mod grow;
pub mod observed;
pub mod physics;
pub mod rounds;
pub mod scenario;
pub mod tree;
pub mod units;
pub mod work;

pub use definition::{C_ELEGANS, CueRule, Daughter, Founder, Limits, Lineage, ListedDaughters, Place, TEMPLATE};
pub use ends::Ends;
pub use grow::{GrowError, Grower, grow_together};
pub use observed::ObservedRounds;
pub use physics::FounderPhysics;
pub use rounds::{FounderRounds, Rounds, founder_rounds};
pub use scenario::Scenario;
pub use tree::{CellId, EndReason, Fate, Side, Tree, TreeCell, TreeSettings};
pub use units::{Length, Units};
pub use work::expected_work;
