//! Inner loops: the stages of every interval are condensed, the blocks that are left eliminated.

mod block;
mod condense;
mod shape;
mod stage_values;
mod stages;
mod table;

pub use block::AntisymmetricEnd;
pub(crate) use block::{BlockFactor, EndJacobian};
pub(crate) use condense::Condensed;
pub(crate) use stages::Interval;
pub use table::Kernels;
