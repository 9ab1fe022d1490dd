//! Studies of many divisions or trees.
//!
//! | file | contents |
//! |---|---|
//! | [`sweep`], `parse` | a sweep: its kind, its axes and its cell; reading and checking its file |
//! | [`points`], [`sample`] | axes, the points that they span, and values that fill an interval evenly |
//! | [`shard`] | the part of the points that one machine solves |
//! | [`run`], [`journal`], [`table`] | solving the points, resuming after an interruption; rows as CSV and as JSON lines |
//! | `doubts` | warnings about a sweep and its results |
//! | [`scenarios`], [`growth`] | lineages and cues side by side, and their trees |
//! | [`mod@diagram`] | the stationary shapes of one cell over ξ_s |
//! | [`constraints`] | whether constants agree with the published statements |
//! | [`mod@front`] | how well constants can meet all of them at once |
//! | [`mod@ensemble`], [`constants`], [`mod@ranges`] | a sample of the constants that do; its table; a lineage over it |
//! | [`compare`] | the model beside measured embryos |
//! | [`reproduce`] | the paper's statements beside the computed results |
//! | [`mod@solve`] | the value of one parameter that gives a wanted division |
//! | [`mod@boundary`] | the boundary of division over a parameter |
//! | `bent` | bent states, without axial symmetry, in diagrams, boundaries and phase diagrams |
//! | [`tempering`] | samples of a posterior by sequential Monte Carlo |
//! | [`fit`] | constants, activities and a cue fitted to observations |
//! | [`hypotheses`] | several cues beside each other: which one the measured χ speak for |
//! | [`mod@polarity`] | PAR polarity along the germline, and its effect on divisions |

#[cfg(not(target_family = "wasm"))]
pub mod bent;
pub mod boundary;
pub mod compare;
pub mod constants;
pub mod constraints;
pub mod diagram;
mod doubts;
pub mod ensemble;
#[cfg(not(target_family = "wasm"))]
pub mod fit;
pub mod front;
pub mod growth;
#[cfg(not(target_family = "wasm"))]
pub mod hypotheses;
pub mod journal;
pub mod json;
pub mod observed;
mod parse;
pub mod points;
#[cfg(not(target_family = "wasm"))]
pub mod polarity;
pub mod ranges;
pub mod reproduce;
pub mod run;
pub mod sample;
pub mod scenarios;
pub mod scenarios_csv;
pub mod shard;
#[cfg(not(target_family = "wasm"))]
pub mod solve;
pub mod sweep;
pub mod sweep_files;
pub mod table;
pub mod tempering;

pub use boundary::{BoundaryOptions, BoundaryStudy, boundary, edges};
pub use constants::{Constant, ConstantKind, Constants, read_constants, read_constants_of, write_constants};
pub use constraints::{ConstraintCheck, Exclusion, Extent, check_constraints};
pub use diagram::{Diagram, Edges, diagram};
pub use ensemble::{ConstantsSearch, Ensemble, EnsembleError, Member, ensemble};
pub use front::{Front, FrontMember, front};
pub use growth::{Grown, grown, grown_replicates, scenario_of, scenarios_of, tree_settings};
pub use journal::Journal;
pub use parse::ListedSweep;
pub use points::{Axes, Axis, AxisValue, Point, Target};
pub use ranges::{FounderRange, LineageRanges, Range, ranges};
pub use run::{Run, SweepProgress, SweepResult};
pub use shard::Shard;
pub use sweep::{Kind, Sweep};
pub use table::Row;

pub use scenarios_csv::{scenarios_csv, spread_csv};
