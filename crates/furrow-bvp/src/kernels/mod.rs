//! Inner loops: the stages of every interval are condensed, the blocks that are left eliminated.

mod block;
mod condense;
mod operator;
mod shape;
mod stage_values;
mod stages;
mod table;

pub use block::AntisymmetricEnd;
pub(crate) use block::{BlockFactor, EndJacobian};
pub(crate) use condense::Condensed;
pub(crate) use operator::{MAX_READINGS, Responses};
pub use table::Kernels;
pub(crate) use table::{forces_onto_nodes, read_responses};
