//! Killed sweeps, ensembles of constants, fits, contours, the reproduction of the paper, and what other groups found.

#[path = "../common/mod.rs"]
mod common;

mod confinement;
mod contours;
mod ensemble;
mod fit;
mod fit_clock;
mod laws;
mod reproduction;
mod solve;
mod sweep;
mod vesicles;
