//! furrow predicts from mechanics how the cells of an embryo divide: into equal or unequal daughters, for how many rounds,
//! and when a lineage stops.
//!
//! The cell cortex is modelled as an active viscous surface inside an ellipsoidal shell. Active stress that depends on
//! curvature forms a furrow; small size or tight confinement breaks its symmetry.
//!
//! ```
//! use furrow::{Cell, Cue, DivisionInput, divide};
//!
//! let zygote = Cell::new(5.4).with_cue(Cue::published());
//! let division = divide(&DivisionInput::new(zygote))?;
//! assert!((division.chi().unwrap() - 0.185).abs() < 1e-3);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! This crate re-exports the names that most programs need from the following crates. Each of them depends only on crates
//! above it in this table:
//!
//! | crate | contents |
//! |---|---|
//! | `furrow-input` | reading user input, with errors that name file, field, value and the allowed values |
//! | `furrow-bvp` | boundary-value problems, continuation, bifurcations |
//! | `furrow-spectra` | eigenvalues of linear maps, singular values |
//! | `furrow-cell` | a cell, its cue, its parameters |
//! | `furrow-mechanics` | cortex, equilibria, stability, division, calibration |
//! | `furrow-lineage` | memo, scheduler, growth, rounds |
//! | `furrow-formats` | files of trees, read and written |
//! | `furrow-measured` | tables and statistics of measured embryos |
//! | `furrow-analysis` | sweeps, ensembles, fits, comparisons, the paper reproduced |
//! | `furrow-figures` | plots, drawings, movies |
//! | `furrow-report` | text tables, the drawing of a lineage, the interactive page |
//!
//! # Where to begin
//!
//! | name | role |
//! |---|---|
//! | [`Cell`], [`Cue`], [`Parameter`], [`Numerics`], [`Settings`] | a cell, its cue, its parameters by name, the discretisation, presets and files |
//! | [`divide`], [`Trajectory`] | one division: its outcome, or all its shapes |
//! | [`stationary()`], [`Stability`] | an equilibrium at a given activity, its growth rates |
//! | [`follow`], [`first_pitchfork`], [`critical_radius`] | a branch with its folds and pitchforks, a threshold, the radius below which cells rest |
//! | [`calibrate`] | constants from thresholds |
//! | [`Lineage`], [`Grower`], [`Tree`], [`founder_rounds`] | founders and their cues, the tree that grows, its rounds |
//! | [`Memo`], [`Quantisation`], [`SchedulerOptions`] | solved divisions, rounding of sizes, threads and progress |
//! | [`newick`], [`tree_to_json`], [`tree_from_json`] | a tree as a file |
//! | [`Sweep`] | many divisions over axes of parameters |
//!
//! # References
//! Gao, Guan, Tang & Ma, "Cell size and confinement drive asymmetric cell division through a cortical instability",
//! called *the paper* throughout.

#[cfg(feature = "cli")]
pub mod cli;

#[doc(no_inline)]
pub use furrow_analysis::Sweep;
#[doc(no_inline)]
pub use furrow_cell::{Cell, Cue, Law, Numerics, Parameter, Settings};
#[doc(no_inline)]
pub use furrow_formats::{founder_rows, newick, tree_from_json, tree_to_json};
#[doc(no_inline)]
pub use furrow_lineage::batch::{Memo, Quantisation, SchedulerOptions};
#[doc(no_inline)]
pub use furrow_lineage::{EndRule, Grower, Lineage, Thresholds, Tree, TreeSettings, founder_rounds};
#[doc(no_inline)]
pub use furrow_mechanics::calibration::calibrate;
#[doc(no_inline)]
pub use furrow_mechanics::critical::{CriticalRadii, critical_radius};
#[doc(no_inline)]
pub use furrow_mechanics::division::{Division, DivisionInput, Outcome, Trajectory, divide};
#[doc(no_inline)]
pub use furrow_mechanics::equilibria::{
    BranchOptions, pitchfork::first as first_pitchfork, primary::follow, stationary,
};
#[doc(no_inline)]
pub use furrow_mechanics::stability::Stability;
#[doc(no_inline)]
pub use furrow_report::founders_table;
