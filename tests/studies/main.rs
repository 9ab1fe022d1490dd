//! Killed sweeps, ensembles of constants, fits, contours, the reproduction of the paper, and what other groups found.

#[path = "../common/mod.rs"]
mod common;

mod bands;
mod confinement;
mod contours;
mod ensemble;
mod fit;
mod fit_clock;
mod laws;
mod polarity_line;
mod reproduction;
mod solve;
mod sweep;
mod vesicles;
