//! Studies: many trees and divisions with one question.
//!
//! | file | what it says |
//! |---|---|
//! | [`mod@judge`] | whether constants agree with what is known |
//! | [`mod@ensemble`] | a sample of the constants that do |
//! | [`constants`] | sets of constants as a table |
//! | [`mod@ranges`] | a lineage over sets of constants |
//! | [`scenarios`] | lineages and cues side by side |

pub mod constants;
pub mod ensemble;
pub mod judge;
pub mod ranges;
pub mod scenarios;

pub use constants::{Constants, read_constants, write_constants};
pub use ensemble::{Ensemble, EnsembleError, Member, ensemble};
pub use judge::{Exclusion, Judgement, judge};
pub use ranges::{LineageRanges, Range, ranges};
