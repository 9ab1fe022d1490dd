//! Studies: many points of one definition, solved once each and put into one table.
//!
//! | file | what it says |
//! |---|---|
//! | [`sweep`] | the sweep file: of what kind, over which axes, from what cell |
//! | [`points`] | axes and their values, and the points that they span |
//! | [`sample`] | values that fill an interval evenly at every count |
//! | [`shard`] | which part of the points one machine takes |
//! | [`run`] | solving the points |
//! | [`table`] | columns and rows, as CSV and as JSON lines |

mod check;
pub mod points;
pub mod run;
pub mod sample;
pub mod shard;
pub mod sweep;
pub mod table;

pub use points::{Axes, Axis, AxisValue, Point, Target};
pub use run::{Done, Run, Standing};
pub use shard::Shard;
pub use sweep::{Kind, Sweep};
pub use table::Row;
