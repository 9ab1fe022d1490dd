//! Lineages grown from mechanics.
//!
//! | file | contents |
//! |---|---|
//! | [`definition`], [`founder`], `read`, `check`, `clash`, `fits` | the lineage file: founders, cues, names, limits; checks |
//! | [`clock`] | lifetimes of cells; births and divisions in minutes |
//! | [`scenario`] | one of several lineages that are compared |
//! | [`batch`] | the cache of divisions, the scheduler, phase diagrams |
//! | [`rules`], `idle` | parameters of cells by generation, size and mother; rules that can never apply |
//! | [`observed`], [`physics`], [`units`] | observed counts and parameters of a founder, µm and minutes |
//! | [`grow`] | growth: daughters inherit volumes; a division starts as soon as the mother's is known |
//! | [`thresholds`] | cells that are too small to divide |
//! | [`priority`] | the order in which divisions are solved |
//! | [`tree`] | the grown tree |
//! | [`rounds`] | rounds of division per founder |
//! | `doubts` | warnings about the first cell and a grown tree |

pub mod batch;
mod check;
mod clash;
pub mod clock;
pub mod definition;
mod doubts;
mod fits;
pub mod founder;
mod given_sizes;
pub mod grow;
mod idle;
pub mod observed;
pub mod physics;
pub mod priority;
mod read;
pub mod rounds;
pub mod rules;
pub mod scenario;
pub mod thresholds;
pub mod tree;
pub mod units;

pub use clock::{CellTimes, Clock, FounderClock, Origin};
pub use definition::{C_ELEGANS, CueRule, Limits, Lineage, TEMPLATE};
pub use founder::{Daughter, Founder};
pub use grow::{GrowError, Grower, grow_replicates, grow_together};
pub use observed::ObservedRounds;
pub use physics::FounderPhysics;
pub use priority::expected_work;
pub use rounds::{Rounds, founder_rounds};
pub use rules::{Mother, Per, PhysicsRule, Place};
pub use scenario::{Scenario, named_cue};
pub use thresholds::{EndRule, Scope, Thresholds};
pub use tree::{CellId, Fate, Side, TerminalReason, Tree, TreeCell, TreeSettings};
pub use units::{Length, Units};

/// Reads a cue from an option: `none`, names of the lineage file, or terms, joined by `+`.
///
/// # Errors
/// Names the part of the cue, its value and the allowed values.
pub fn parse_cue(text: &str, lineage: &Lineage) -> Result<furrow_cell::Cue, furrow_input::InputError> {
    lineage
        .parse_cue(text)
        .map_err(|error| furrow_input::InputError::not_allowed("--cue", error.field, error.value, error.allowed))
}
