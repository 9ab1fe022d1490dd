//! What readers of tracked cells use of tables.

pub(crate) use furrow_input::table::{Table, malformed, number};
