#![doc = include_str!("../README.md")]

pub mod arnoldi;
pub mod cycles;
pub mod floquet;
pub mod hopf;
pub mod svd;

pub use arnoldi::{Arnoldi, EigenError, Krylov, NoEigenvalues, RitzValue};
pub use svd::{NoSingularValues, Svd};
