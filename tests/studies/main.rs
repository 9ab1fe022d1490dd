//! Killed sweeps, ensembles of constants, fits, contours, and the reproduction of the paper.

#[path = "../common/mod.rs"]
mod common;

mod contours;
mod ensemble;
mod fit;
mod fit_clock;
mod reproduction;
mod solve;
mod sweep;
