//! Singular points of a branch: folds, pitchforks and branch points.

mod branch_point;
mod fold;
pub mod locate;
mod minimally_augmented;
pub mod normal_form;
mod singularity;
mod switching;
mod symmetry_breaking;

pub use branch_point::{BranchPoint, BranchPointKind};
pub use fold::Fold;
pub use minimally_augmented::{AugmentedReport, MinimallyAugmented};
pub use singularity::{SingularError, Singularity};
pub use symmetry_breaking::SymmetryBreaking;
