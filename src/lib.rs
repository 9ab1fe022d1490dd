//! furrow predicts, from mechanics alone, how an embryo's cells divide: how unequally, how many rounds, and when a
//! lineage stops.
//!
//! The cell cortex is an active viscous surface inside an ellipsoidal shell. Curvature-dependent active stress makes a
//! furrow; small size or tight confinement breaks its symmetry. The floors of the crate, each importing only from below:
//!
//! 1. [`numerics`]: Gauss collocation, meshes, Newton, the bordered block solver. Knows no biology.
//! 2. [`cortex`]: parameters, shell, cue, the equations of the surface, observables.
//! 3. [`steady`]: branches of stationary shapes, their bifurcations and stability. [`division`]: one division in time.
//! 4. [`batch`]: many divisions solved once each, on all cores, and kept. Knows no lineages.
//! 5. [`lineage`]: founders, the tree that grows from them, comparison with observed lineages.
//! 6. [`io`] and [`report`]: files and pictures. `cli`: the command line.
//!
//! # References
//! Gao, Guan, Tang & Ma, "Cell size and confinement drive asymmetric cell division through a cortical instability",
//! called *the paper* throughout.

pub mod batch;
pub mod cli;
pub mod cortex;
pub mod division;
pub mod input;
pub mod io;
pub mod lineage;
pub mod numerics;
pub mod report;
pub mod steady;
