//! Constants, activities and a cue fitted to observations.
//!
//! | file | content |
//! |---|---|
//! | [`targets`] | the observations, and the limits of the search |
//! | [`mod@constants`] | one set of constants for the embryo, and its cost in published thresholds |
//! | [`activity`] | the activity that each founder would need for its observed rounds |
//! | [`clock`] | how lifetimes depend on volume, by founder |
//! | `chain` | divisions of named cells, each from its mother's, and their derivatives |
//! | [`germline`] | the cue that gives the measured χ of the germline |
//! | `unknowns` | the numbers of a cue, and between which values they are searched |
//! | [`jumps`] | fitted divisions that jump next to the best cue |
//! | [`goodness`] | χ², degrees of freedom, p and the factor on errors |
//! | [`document`] | results as JSON and as configuration files |
//! | [`search`] | derivative-free search |
//! | [`error`] | why a fit fails |

pub mod activity;
pub(crate) mod chain;
pub mod clock;
pub mod constants;
pub mod document;
pub mod error;
pub mod germline;
pub mod goodness;
pub mod jumps;
pub mod search;
pub mod targets;
pub(crate) mod unknowns;

pub use crate::ranges::Reading;
pub use activity::{FittedActivities, FounderActivity, activities};
pub use clock::{FewCells, FittedCell, FittedClock, FittedLaw, Unused, fit_clock};
pub use constants::{Evaluated, FittedConstants, fit_constants};
pub use error::FitError;
pub use germline::{ChiResidual, FittedCue, fit_cue};
pub use goodness::{CalibrationStudy, Goodness};
pub use jumps::Jump;
pub use search::{FitProgress, FitRun, Limit, NumberAtLimit, SearchBudget};
pub use targets::Targets;
