//! Studies: many trees asked about together.

pub mod scenarios;
