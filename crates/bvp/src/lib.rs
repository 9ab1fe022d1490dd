#![doc = include_str!("../README.md")]
//!
//! # Modules
//! Each imports only from those above it in this list:
//!
//! | module | role |
//! |---|---|
//! | [`problem`], [`gauss`], [`mesh`], [`solution`], [`direction`] | what is solved, and on what |
//! | `dense`, `stages`, `condense`, `block` (private), [`Kernels`] | the kernels: stages are condensed, blocks eliminated in O(N), borders included |
//! | [`system`], [`newton`] | the linearised system of one problem, and damped Newton with Jacobian reuse |
//! | [`solver`] | a problem solved to an accuracy, on meshes of its own choice |
//! | [`metric`], [`predictor`], [`continuation`], [`work`] | branches by pseudo-arclength, and what they cost |
//! | [`derivatives`], [`singularity`], [`fold`], [`symmetry_breaking`] | what vanishes at a fold, at a pitchfork |
//! | [`minimally_augmented`], [`locate`], [`normal_form`], [`two_parameter`] | singular points as roots, their normal forms, curves of them |

mod block;
mod condense;
pub mod continuation;
mod dense;
pub mod derivatives;
pub mod direction;
pub mod fold;
pub mod gauss;
mod kernels;
pub mod locate;
pub mod mesh;
pub mod metric;
pub mod minimally_augmented;
pub mod newton;
pub mod normal_form;
pub mod predictor;
pub mod problem;
pub mod singularity;
pub mod solution;
pub mod solver;
mod stages;
pub mod symmetry_breaking;
pub mod system;
pub mod two_parameter;
pub mod work;

#[cfg(test)]
mod tests;

pub use block::AntisymmetricEnd;
pub use continuation::{Continuation, ContinuationError, ContinuationSettings, Ended, StepFailure};
pub use dense::{Determinant, PivotFailure};
pub use derivatives::Directional;
pub use direction::{Direction, LinearCondition};
pub use fold::Fold;
pub use gauss::Gauss;
pub use kernels::Kernels;
pub use metric::Metric;
pub use minimally_augmented::{AugmentedReport, MinimallyAugmented};
pub use newton::{Newton, NewtonError, NewtonReport};
pub use problem::{
    BoundaryJacobian, BoundaryValueProblem, CollocationPoint, CollocationPoints, Dimensions, PointJacobian, TooLarge,
};
pub use singularity::{SingularError, Singularity};
pub use solution::{Solution, Transfer};
pub use solver::{Settings, SolveError, Solved, solve};
pub use symmetry_breaking::{MirrorSymmetric, SymmetryBreaking};
pub use system::{Residual, System};
pub use two_parameter::{CurveError, CurveSettings, TwoParameterCurve};
pub use work::Work;
