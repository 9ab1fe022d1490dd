//! The linearised collocation system.

mod antisymmetric;
mod operator;
mod place;
mod system;

pub use operator::SolutionOperator;
pub use place::Place;
pub use system::{FactorisationError, System};
