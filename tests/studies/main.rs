//! Sweeps, ensembles of constants, fits, comparisons with measured embryos, and the reproduction of the paper.

#[path = "../common/mod.rs"]
mod common;

mod compare;
mod contours;
mod ensemble;
mod fit;
mod reproduction;
mod sweep;
mod workflows;
