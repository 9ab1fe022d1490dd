//! Stationary shapes: their branches in ξ_s, with folds and pitchforks.
//!
//! | file | contents |
//! |---|---|
//! | [`mod@passive`] | the shape of a cell without activity, in its shell |
//! | [`branch`] | points, events and ends of branches |
//! | [`point`] | observables of a point |
//! | `rates` | growth rates along a branch, computed concurrently |
//! | `hopf` | points at which oscillations begin |
//! | [`primary`] | the branch that starts at the passive shape, with or without a cue |
//! | [`locate`] | folds and pitchforks between two points of a branch |
//! | [`pitchfork`] | the first pitchfork |
//! | [`asymmetric`] | the branch that leaves at a pitchfork |
//! | `rejoin` | its return to mirror-symmetric shapes |
//! | [`mod@stationary`] | one shape at one activity |
//! | [`at_rest`] | the intervals of ξ_s in which a cell rests undivided |
//! | [`curves`] | pitchforks and folds over R0, ε or any other parameter |
//! | `passage` | passage of a curve through an activity |
//! | [`azimuthal_scan`] | growth rates of non-axisymmetric perturbations along a branch |
//! | [`azimuthal_threshold`] | the threshold of such perturbations over a parameter |
//! | [`budget`] | the step budget of a search |

pub mod asymmetric;
pub mod at_rest;
pub mod azimuthal_scan;
pub mod azimuthal_threshold;
pub mod branch;
pub mod budget;
pub mod curves;
pub mod error;
mod hopf;
pub mod locate;
mod passage;
pub mod passive;
pub mod pitchfork;
pub mod point;
pub mod primary;
mod rates;
mod rejoin;
pub mod stationary;

pub use at_rest::{RestShapes, rest_shapes};
pub use branch::{Branch, BranchEnd, BranchEvent, BranchOptions, Criticality, FoldPoint, Pitchfork};
pub use budget::StepBudget;
pub use error::{PointKind, Result, ShapeError};
pub use hopf::HopfPoint;
pub use passive::{passive, passive_whole};
pub use point::ShapePoint;
pub use stationary::{StationaryError, StationaryShape, stationary};
