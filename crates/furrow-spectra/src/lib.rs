#![doc = include_str!("../README.md")]

pub mod arnoldi;
mod hessenberg;
pub mod svd;

pub use arnoldi::{Arnoldi, EigenError, Krylov, Looks, NoEigenvalues, RitzValue};
pub use svd::{NoSingularValues, Svd};
