//! The embryo of [furrow](https://docs.rs/furrow): many divisions solved once each and kept, the lineage that grows from
//! them, studies of many trees, and what is written of all that.
//!
//! `furrow` gives all of it under its own name (`furrow::batch`, `furrow::lineage`, …), and everybody takes it from there.
//!
//! | module | role |
//! |---|---|
//! | [`batch`] | many divisions solved once each, on all cores, and kept; phase diagrams |
//! | [`lineage`] | founders, the tree that grows from them, rounds beside the observed ones |
//! | [`settings`] | parameters as users give them, each field checked |
//! | [`study`] | many trees and divisions with one question: sweeps, scenarios side by side, ensembles of constants |
//! | [`io`], [`report`] | files, tables and pictures |

pub mod batch;
pub mod io;
pub mod lineage;
pub mod report;
pub mod settings;
pub mod study;

// The floors below, by the names they have in `furrow`.
use mechanics::{calibration, cell, cortex, division, input, perturbation, shapes};
