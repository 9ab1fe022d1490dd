//! Why a fit fails.

use furrow_lineage::batch::SchedulerError;
use std::sync::atomic::{AtomicBool, Ordering};

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
    /// No cell of the lineage has a cue.
    #[error("no cell of the lineage has a cue: name one for a founder, as in `cue: \"germline\"`")]
    NoCue,
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

/// An error if the search was cancelled.
pub(crate) fn check_cancelled(cancel: &AtomicBool, tried: usize, what: &'static str) -> Result<(), FitError> {
    if cancel.load(Ordering::Relaxed) { Err(FitError::Interrupted { tried, what }) } else { Ok(()) }
}
