//! The statement of a boundary-value problem, its higher derivatives, a check of both, and its mirror symmetry.

mod check;
pub(crate) mod derivatives;
mod differences;
mod directional;
mod statement;
mod symmetry;

pub use check::{CheckError, Mismatch, check_derivatives, check_directional};
pub use directional::{Directional, EndDerivatives, EndValues, PointDirection, PointValues};
pub use statement::{BoundaryJacobian, BoundaryValueProblem, CollocationPoint, CollocationPoints, PointJacobian};
pub(crate) use statement::{End, conditions_at};
pub use symmetry::MirrorSymmetric;
