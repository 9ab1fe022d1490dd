//! Boundary-value problems for ordinary differential equations by Gauss collocation: a solver of its own that knows
//! nothing of cells.
//!
//! A [`problem::BoundaryValueProblem`] states y′ = f(x, y, p) on [x₀, x_N] with scalar unknowns p, conditions at both
//! ends and integral conditions. A [`solution::Solution`] holds node and stage values on a non-uniform mesh.
//! [`system::System`] condenses the stages of every interval and eliminates the resulting almost block diagonal system
//! in O(N), borders included. [`newton`] drives both; [`mesh`] moves and judges meshes;
//! [`arnoldi`] finds extreme eigenvalues.

pub mod arnoldi;
pub mod block;
pub mod condense;
pub mod dense;
pub mod gauss;
pub mod mesh;
pub mod newton;
pub mod problem;
pub mod solution;
pub mod system;
#[cfg(test)]
mod tests;

pub use gauss::Gauss;
pub use newton::{Newton, NewtonError, NewtonReport};
pub use problem::{BoundaryJacobian, BoundaryValueProblem, Dimensions, PointJacobian, Site};
pub use solution::Solution;
pub use system::{LinearCondition, System};
