#![doc = include_str!("../README.md")]
//!
//! # Modules
//! Each file imports only from files above it in this list:
//!
//! | module | contents |
//! |---|---|
//! | `dense`, `dimensions`, `invalid` (private) | small dense blocks; sizes and limits; why input is refused |
//! | [`Bracket`] | roots between two values |
//! | [`gauss`] | coefficients of Gauss collocation |
//! | [`solution`], [`direction`], [`metric`] | solutions and their changes |
//! | `kernels` (private) | `stages`, `condense`, `operator`, `block`, `table`: inner loops in O(N) |
//! | [`problem`], [`mesh`] | the statement of a problem; meshes and defects |
//! | [`auto`] | problems from equations, closures and vector fields, with automatic differentiation |
//! | [`linear`] | residuals, factors and solves of the linearised system |
//! | [`newton`] | damped Newton, and the adaptive driver [`solve`] |
//! | `two_point` (private) | [`solve_bvp`]: conditions at both ends, in one call |
//! | `deflation` (private) | [`Deflation`]: further solutions of a problem with several |
//! | [`continuation`] | branches by pseudo-arclength |
//! | [`bifurcation`] | folds, pitchforks and branch points as roots, normal forms, switching |
//! | `diagram` (private) | [`diagram()`]: branches, those that cross them, and so on |
//! | [`codim2`] | curves of folds and pitchforks in two parameters |

#[cfg(feature = "auto")]
pub mod auto;
pub mod bifurcation;
mod bracket;
pub mod codim2;
pub mod continuation;
mod deflation;
mod dense;
mod diagram;
mod dimensions;
pub mod direction;
pub mod gauss;
mod invalid;
mod kernels;
pub mod linear;
pub mod mesh;
pub mod metric;
pub mod newton;
pub mod problem;
pub mod solution;
mod two_point;
#[cfg(feature = "auto")]
#[doc = include_str!("tutorial.md")]
pub mod tutorial {}

// Test problems that examples share name the crate.
#[cfg(test)]
extern crate self as furrow_bvp;
#[cfg(test)]
mod tests;

#[cfg(feature = "auto")]
pub use auto::{Auto, DualNum, Equations, Jet, Number, PeriodicOrbit, SimpleProblem, VectorField};
pub use bifurcation::{
    AugmentedReport, BranchPoint, BranchPointKind, Fold, MinimallyAugmented, SingularError, Singularity,
    SymmetryBreaking, locate, normal_form,
};
pub use bracket::Bracket;
pub use codim2::{Codim2Curve, CurveError, CurveSettings};
pub use continuation::{Continuation, ContinuationError, ContinuationSettings, StepFailure, Termination, predictor};
pub use deflation::{Deflation, DeflationError};
pub use dense::{Determinant, PivotFailure};
pub use diagram::{
    BranchEnd, Diagram, DiagramBranch, DiagramPoint, DiagramSettings, SpecialKind, SpecialPoint, diagram,
};
pub use dimensions::{Dimensions, MAX_CONDITIONS, MAX_STAGE_UNKNOWNS, MAX_UNKNOWNS, TooLarge};
pub use direction::{Direction, LinearCondition, Residual};
pub use gauss::Gauss;
pub use invalid::InvalidInput;
pub use kernels::{AntisymmetricEnd, Kernels};
pub use linear::{FactorisationError, Place, SolutionOperator, System};
pub use metric::Metric;
pub use newton::{Interrupt, Newton, NewtonError, NewtonReport, Settings, SolveError, Solved, Stop, Work, solve};
pub use problem::{
    BoundaryJacobian, BoundaryValueProblem, CheckError, CollocationPoint, CollocationPoints, Directional,
    EndDerivatives, EndValues, MirrorSymmetric, Mismatch, PointDirection, PointJacobian, PointValues,
    check_derivatives, check_directional,
};
pub use solution::{Solution, Transfer};
#[cfg(feature = "auto")]
pub use two_point::solve_bvp;
pub use two_point::{TwoPoint, TwoPointJacobian, solve_two_point, solve_two_point_besides};
