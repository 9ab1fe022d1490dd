//! The linearised collocation system.

mod operator;
mod system;

pub use operator::SolutionOperator;
pub use system::{Place, System};
