//! Studies: many trees and divisions with one question.
//!
//! | file | what it says |
//! |---|---|
//! | [`sweep`] | the sweep file: of what kind, over which axes, from what cell |
//! | [`points`], [`sample`] | axes and their values, and the points that they span; values that fill an interval evenly |
//! | [`shard`] | which part of the points one machine takes |
//! | [`run`], [`table`] | solving the points; columns and rows, as CSV and as JSON lines |
//! | [`scenarios`] | lineages and cues side by side |
//! | [`growth`] | their trees, grown in one run |
//! | [`mod@diagram`] | the stationary shapes of one cell over ξ_s |
//! | [`mod@judge`] | whether constants agree with what is known |
//! | [`mod@ensemble`] | a sample of the constants that do |
//! | [`constants`] | sets of constants as a table |
//! | [`mod@ranges`] | a lineage over sets of constants |
//! | [`compare`] | the model beside measured embryos |
//! | [`reproduce`] | every statement of the paper that computation can reach, beside what is computed |
//! | [`fit`] | what would make it the embryo: constants, activities and a cue from what was observed |

mod check;
pub mod compare;
pub mod constants;
pub mod diagram;
pub mod ensemble;
#[cfg(not(target_family = "wasm"))]
pub mod fit;
pub mod growth;
pub mod judge;
pub mod points;
pub mod ranges;
pub mod reproduce;
pub mod run;
pub mod sample;
pub mod scenarios;
pub mod shard;
pub mod sweep;
pub mod table;

pub use constants::{Constants, read_constants, write_constants};
pub use diagram::{Diagram, diagram};
pub use ensemble::{Ensemble, EnsembleError, Member, ensemble, ensemble_until};
pub use growth::{Grown, grown, scenarios_of, tree_settings};
pub use judge::{Exclusion, Judgement, judge};
pub use points::{Axes, Axis, AxisValue, Point, Target};
pub use ranges::{LineageRanges, Range, ranges};
pub use run::{Done, Run, Standing};
pub use shard::Shard;
pub use sweep::{Kind, Sweep};
pub use table::Row;
