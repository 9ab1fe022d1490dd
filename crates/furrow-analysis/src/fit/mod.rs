//! Constants, activities and a cue fitted to observations.
//!
//! | file | what it says |
//! |---|---|
//! | [`targets`] | what a fit is held against, and between which limits is searched |
//! | [`mod@constants`] | one set of constants for the embryo, and what it costs the published thresholds |
//! | [`activity`] | which activity each founder by itself would need for its observed rounds |
//! | [`germline`] | which cue gives the measured χ of the germline |
//! | [`search`] | the search, without derivatives |

pub mod activity;
pub mod constants;
pub mod germline;
pub mod search;
pub mod targets;

pub use activity::{FounderActivity, Reading, activities};
pub use constants::{Evaluated, FittedConstants, fit_constants};
pub use germline::{ChiResidual, FittedCue, fit_cue};
pub use search::SearchBudget;
pub use targets::Targets;

use std::sync::atomic::{AtomicBool, Ordering};

use furrow_lineage::batch::SchedulerError;

/// Why there is no fit.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FitError {
    /// No candidate gives numbers to compare.
    #[error("none of {tried} {what} tried gives anything to compare; {advice}")]
    Nothing {
        /// Number of candidates.
        tried: usize,
        /// The kind of candidate.
        what: &'static str,
        /// Advice.
        advice: &'static str,
    },
    /// It was stopped.
    #[error("interrupted after {tried} {what}")]
    Interrupted {
        /// Number of candidates.
        tried: usize,
        /// The kind of candidate.
        what: &'static str,
    },
    /// A tree could not be grown.
    #[error(transparent)]
    Grow(#[from] furrow_lineage::GrowError),
    /// The sensitivities of χ have no singular values.
    #[error("the sensitivities of the size asymmetries: {0}")]
    NotFinite(#[from] furrow_spectra::NoSingularValues),
    /// The workers could not be started.
    #[error(transparent)]
    Workers(#[from] SchedulerError),
}

/// Whether the flag, if there is one, is set: that a search should stop.
fn is_set(cancel: Option<&AtomicBool>) -> bool {
    cancel.is_some_and(|flag| flag.load(Ordering::Relaxed))
}

/// A place of the unit cube with one of its coordinates at another value.
fn moved(place: &[f64], index: usize, share: f64) -> Vec<f64> {
    let mut out = place.to_vec();
    out[index] = share;
    out
}
