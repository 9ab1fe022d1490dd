//! Many trees and divisions with one question: sweeps, ensembles of constants, fits, measured embryos, the paper reproduced.

#[path = "../common/mod.rs"]
mod common;

mod compare;
mod contours;
mod ensemble;
mod fit;
mod reproduction;
mod sweep;
mod workflows;
