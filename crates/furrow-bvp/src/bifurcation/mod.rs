//! Singular points of a branch: folds and pitchforks.

mod fold;
pub mod locate;
mod minimally_augmented;
pub mod normal_form;
mod singularity;
mod symmetry_breaking;

pub use fold::Fold;
pub use minimally_augmented::{AugmentedReport, MinimallyAugmented};
pub use singularity::{SingularError, Singularity};
pub use symmetry_breaking::SymmetryBreaking;
