//! The statement of a boundary-value problem, its higher derivatives and its mirror symmetry.

pub mod derivatives;
mod differences;
mod directional;
mod statement;
mod symmetry;

pub use directional::{Directional, EndDerivatives, EndValues, PointDirection, PointValues};
pub use statement::{BoundaryJacobian, BoundaryValueProblem, CollocationPoint, CollocationPoints, PointJacobian};
pub use symmetry::MirrorSymmetric;
