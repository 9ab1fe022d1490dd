//! What ends a command, and its exit code.

use crate::batch::{Failure, SchedulerError, StoreError};
use crate::calibration::CalibrateError;
use crate::division::DivisionError;
use crate::drawing::FigureError;
use crate::input::InputError;
use crate::io::files::WriteError;
use crate::io::frames::FramesError;
use crate::io::sweep_files::SweepFilesError;
use crate::lineage::GrowError;
use crate::perturbation::PerturbationError;
use crate::shapes::{PointKind, ShapeError, StationaryError};
use crate::stability::StabilityError;
use crate::study::EnsembleError;
use crate::study::fit::FitError;
use crate::study::reproduce::LabError;
use crate::study::table::TableError;

/// What ends a command.
#[derive(Debug, thiserror::Error)]
pub enum CliError {
    /// Bad input.
    #[error(transparent)]
    Input(#[from] InputError),
    /// The arguments are none of this command's; said already.
    #[error("bad usage")]
    Usage,
    /// A tree could not be grown.
    #[error("{}", grow_text(.0))]
    Grow(#[from] GrowError),
    /// A division could not be computed.
    #[error(transparent)]
    Division(#[from] DivisionError),
    /// A replicate could not be computed.
    #[error("{0}")]
    Replicate(Failure),
    /// Divisions could not be scheduled.
    #[error(transparent)]
    Scheduler(#[from] SchedulerError),
    /// What becomes of a disturbed stationary shape could not be computed.
    #[error("{}", perturbation_text(.0))]
    Perturbation(#[from] PerturbationError),
    /// A stationary shape could not be computed.
    #[error(transparent)]
    Stationary(#[from] StationaryError),
    /// Its growth rates could not be computed.
    #[error(transparent)]
    Stability(#[from] StabilityError),
    /// A branch of stationary shapes could not be computed.
    #[error("{}", shape_text(.0))]
    Shape(#[from] ShapeError),
    /// No constants agree with what is known.
    #[error(transparent)]
    Ensemble(#[from] EnsembleError),
    /// Nothing was found that fits.
    #[error("{}", fit_text(.0))]
    Fit(#[from] FitError),
    /// No parameters were found.
    #[error(transparent)]
    Calibrate(#[from] CalibrateError),
    /// The run was interrupted.
    #[error("interrupted; divisions solved so far are kept in the cache (unless --no-cache)")]
    Interrupted,
    /// The cache folder cannot be used.
    #[error(transparent)]
    Store(#[from] StoreError),
    /// The user has no cache folder, and there is no `cache` here.
    #[error("no cache folder is known for this user: {reason}; name one with --cache, or use --no-cache")]
    NoCacheFolder {
        /// What the system said.
        reason: String,
    },
    /// The cache holds damaged entries.
    #[error("damaged entries: {corrupt}; they are never used, and what they held is solved again when needed")]
    CorruptCache {
        /// How many.
        corrupt: usize,
    },
    /// A file could not be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// The answer could not be written to stdout.
    #[error("stdout: {0}")]
    Answer(#[from] std::io::Error),
    /// The files of a sweep could not be written.
    #[error(transparent)]
    SweepFiles(#[from] SweepFilesError),
    /// A picture could not be made.
    #[error(transparent)]
    Figure(#[from] FigureError),
    /// A table could not be written.
    #[error(transparent)]
    Table(#[from] TableError),
    /// Frames could not be written.
    #[error(transparent)]
    Frames(#[from] FramesError),
    /// The answer could not be put into JSON.
    #[error("the answer has no JSON form: {0}")]
    Json(#[from] serde_json::Error),
}

fn grow_text(error: &GrowError) -> String {
    match error {
        GrowError::Interrupted { .. } => format!("{error}; {GOES_ON}"),
        _ => error.to_string(),
    }
}

/// What is left of a growth that was interrupted.
const GOES_ON: &str =
    "what was solved is kept in the cache (unless --no-cache), and the same command goes on from there";

fn fit_text(error: &FitError) -> String {
    match error {
        FitError::Grow(error) => grow_text(error),
        FitError::Interrupted { .. } => format!("{error}; {GOES_ON}"),
        _ => error.to_string(),
    }
}

/// Why a stationary shape could not be disturbed, with what helps.
fn perturbation_text(error: &PerturbationError) -> String {
    match error {
        PerturbationError::Stationary(StationaryError::OutOfReach { .. }) => {
            format!("{error}; lower --xi, or leave out --from-steady")
        }
        _ => error.to_string(),
    }
}

/// A computation's error, with the option that helps.
fn shape_text(error: &ShapeError) -> String {
    match error {
        ShapeError::NotFound { kind: PointKind::Pitchfork, .. } => format!("{error}; raise --xi-max"),
        ShapeError::NoPitchfork { .. } => format!("{error}: see furrow boundary"),
        _ => error.to_string(),
    }
}

impl From<LabError> for CliError {
    fn from(error: LabError) -> CliError {
        match error {
            LabError::Input(error) => CliError::Input(error),
            LabError::Workers(error) => CliError::Scheduler(error),
            _ => CliError::Interrupted,
        }
    }
}

impl CliError {
    /// 2 for bad input, else 1.
    pub fn exit_code(&self) -> u8 {
        let bad_division = |e: &DivisionError| matches!(e, DivisionError::BadInput { .. });
        let bad = match self {
            CliError::Input(_) | CliError::Usage | CliError::Store(StoreError::NotAFolder { .. }) => true,
            CliError::Division(e) | CliError::Perturbation(PerturbationError::Division(e)) => bad_division(e),
            _ => false,
        };
        if bad { 2 } else { 1 }
    }
}
