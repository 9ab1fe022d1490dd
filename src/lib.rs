//! furrow predicts, from mechanics alone, how an embryo's cells divide: how unequally, how many rounds, and when a
//! lineage stops.
//!
//! The cell cortex is an active viscous surface inside an ellipsoidal shell. Curvature-dependent active stress makes a
//! furrow; small size or tight confinement breaks its symmetry.
//!
//! ```
//! use furrow::cell::{Cell, Cue};
//! use furrow::division::{DivisionInput, divide};
//!
//! let zygote = Cell::new(5.4).with_cue(Cue::published());
//! let division = divide(&DivisionInput::new(zygote))?;
//! assert!((division.chi.unwrap() - 0.209).abs() < 1e-3);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! The floors of the crate, each importing only from those above it in this list. Those down to [`division`] are
//! what decides a division and those below it what is built on divisions, each a crate of its own that is reached from here;
//! the crate [`bvp`] underneath knows no cell:
//!
//! | module | role |
//! |---|---|
//! | [`input`] | what users write, and errors that name file, field, value and what is allowed |
//! | [`cell`] | what a cell is: size, confinement, activity, cue, material, shell |
//! | [`cortex`] | the equations of the surface, their derivatives, symmetry, observables |
//! | [`stability`] | growth rates of small disturbances of a stationary shape |
//! | [`shapes`] | branches of stationary shapes, folds and pitchforks, critical radii |
//! | [`calibration`] | constants from thresholds |
//! | [`division`] | one division in time |
//! | [`perturbation`] | a stationary shape that is disturbed, and watched |
//! | [`batch`] | many divisions solved once each, on all cores, and kept; phase diagrams |
//! | [`lineage`] | founders, the tree that grows from them, rounds beside the observed ones |
//! | [`settings`] | parameters as users give them, each field checked |
//! | [`study`] | many trees and divisions with one question: sweeps, scenarios side by side, ensembles of constants |
//! | [`io`], [`report`] | files, tables and the lineage's drawing |
//! | `drawing`, `plot`, `movie` | pictures of what is computed, and movies of divisions (feature `figures`, on by default) |
//! | `cli` | the command line (feature `cli`, on by default) |
//!
//! # Where to begin
//! Each has an example that runs; that of `divide` is above.
//!
//! | type or function | role |
//! |---|---|
//! | [`Cell`](cell::Cell), [`Cue`](cell::Cue), [`Parameter`](cell::Parameter) | a cell, what tells its poles apart, its numbers by name |
//! | [`divide`](division::divide), [`film`](division::film()), [`divide_with_sensitivities`](division::divide_with_sensitivities) | one division: its outcome, all its shapes, its derivatives by parameters |
//! | [`passive`](shapes::passive()), [`stationary`](shapes::stationary()) | the shape without activity, the first one at some activity |
//! | [`Stability`](stability::Stability) | growth rates of a stationary shape |
//! | [`primary::follow`](shapes::primary::follow), [`pitchfork::first`](shapes::pitchfork::first), [`critical_radius`](shapes::critical_radius) | a branch with its folds and pitchforks, a threshold, the radius below which cells rest |
//! | [`calibrate`](calibration::calibrate) | constants from thresholds |
//! | [`Cortex`](cortex::Cortex), [`forces::profile`](cortex::forces::profile) | the boundary-value problem itself, what acts along a contour |
//! | [`replicates`](batch::replicates()), [`PhasePlane`](batch::PhasePlane), [`Store`](batch::Store) | one cell several times, a plane of cells, what was solved before |
//! | [`Lineage`](lineage::Lineage), [`Grower`](lineage::Grower) | who founds and who carries which cue, the tree that grows |
//! | [`Settings`](settings::Settings) | parameters as users write them |
//! | [`Sweep`](study::Sweep), [`study::Run`], [`scenarios::combine`](study::scenarios::combine) | many points, their solving, trees side by side |
//! | [`io::exchange::export`] | a tree for other programs |
//!
//! # References
//! Gao, Guan, Tang & Ma, "Cell size and confinement drive asymmetric cell division through a cortical instability",
//! called *the paper* throughout.

#[cfg(feature = "cli")]
pub mod cli;

#[doc(inline)]
pub use embryo::{batch, io, lineage, report, settings, study};
#[cfg(feature = "figures")]
#[doc(inline)]
pub use figures::{drawing, movie, plot};
#[doc(inline)]
pub use mechanics::{calibration, cell, cortex, division, input, perturbation, shapes, stability};
