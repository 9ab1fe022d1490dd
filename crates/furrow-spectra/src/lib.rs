#![doc = include_str!("../README.md")]

pub mod arnoldi;
pub mod cycles;
pub mod evolution;
pub mod floquet;
pub mod hopf;
mod root;
pub mod svd;

pub use arnoldi::{Arnoldi, EigenError, Krylov, NoEigenvalues, RitzValue};
pub use svd::{NoSingularValues, Svd};
