//! Errors that end a command, and its exit code.

use std::error::Error;
use std::fmt;

use furrow_analysis::fit::FitError;
use furrow_input::InputError;
use furrow_lineage::GrowError;
use furrow_lineage::batch::StoreError;
use furrow_mechanics::division::DivisionError;
use furrow_mechanics::equilibria::{PointKind, ShapeError, StationaryError};
use furrow_mechanics::perturbation::PerturbationError;
use furrow_surface::bent::BentError;
use furrow_surface::steady::NoRest;

/// The reason for the end of a command: one of its own errors, or an error of the library.
#[derive(Debug)]
pub enum CliError {
    /// Invalid usage that has already been reported.
    Usage,
    /// The run was interrupted.
    Interrupted,
    /// No user cache folder is known, for this reason, and there is no `cache` in the working folder.
    NoCacheFolder(String),
    /// The cache holds this many damaged entries.
    CorruptCache(usize),
    /// A result could not be written to stdout.
    Stdout(std::io::Error),
    /// An error of the library.
    Library(Box<dyn Error>),
}

impl<E: Error + 'static> From<E> for CliError {
    fn from(error: E) -> CliError {
        let error: Box<dyn Error> = Box::new(error);
        error.downcast().map_or_else(CliError::Library, |error| CliError::Stdout(*error))
    }
}

impl fmt::Display for CliError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            CliError::Usage => write!(f, "bad usage"),
            CliError::Interrupted => {
                write!(f, "interrupted; solved divisions are kept in the cache (unless --no-cache)")
            }
            CliError::NoCacheFolder(why) => {
                write!(f, "no cache folder is known for this user: {why}; name one with --cache, or use --no-cache")
            }
            CliError::CorruptCache(count) => {
                let then = "they are not used, and their divisions are solved again when needed";
                write!(f, "damaged entries: {count}; {then}")
            }
            CliError::Stdout(error) => write!(f, "stdout: {error}"),
            CliError::Library(error) => write!(f, "{error}"),
        }
    }
}

/// Advice added to an error of the library.
fn hint(error: &(dyn Error + 'static)) -> &'static str {
    const RESUMES: &str = "; solved divisions are kept in the cache (unless --no-cache), and the same command resumes";
    if error.is::<NoRest>() {
        return "; lower --xi";
    }
    let (grow, fit, shape) = (error.downcast_ref(), error.downcast_ref(), error.downcast_ref());
    match (grow, fit, shape, error.downcast_ref()) {
        (Some(GrowError::Interrupted { .. }), ..) => RESUMES,
        (_, Some(FitError::Grow(GrowError::Interrupted { .. }) | FitError::Interrupted { .. }), ..) => RESUMES,
        (_, _, Some(ShapeError::NotFound { kind: PointKind::Pitchfork, .. }), _) => "; raise --xi-max",
        (_, _, Some(ShapeError::TurnsBack { .. }), _) => ", see furrow branch",
        (_, _, Some(ShapeError::NoPitchfork { .. }), _) => ": see furrow boundary",
        (.., Some(PerturbationError::Stationary(StationaryError::OutOfReach { .. }))) => {
            "; lower --xi, or leave out --from-steady"
        }
        _ => "",
    }
}

impl CliError {
    /// Advice on the error, if the command has the options that the advice names.
    pub fn hint(&self, options: &[String]) -> &'static str {
        let CliError::Library(error) = self else { return "" };
        let hint = hint(error.as_ref());
        let named =
            hint.split(|c: char| !c.is_ascii_alphanumeric() && c != '-').filter_map(|word| word.strip_prefix("--"));
        let has = |name: &str| options.iter().any(|option| option == name);
        if named.into_iter().all(has) { hint } else { "" }
    }

    /// 2 for invalid input, otherwise 1.
    pub fn exit_code(&self) -> u8 {
        let CliError::Library(error) = self else { return if matches!(self, CliError::Usage) { 2 } else { 1 } };
        let division = match error.downcast_ref() {
            Some(PerturbationError::Division(error)) => Some(error),
            _ => error.downcast_ref(),
        };
        let bad_input = error.is::<InputError>()
            || matches!(division, Some(DivisionError::BadInput { .. }))
            || matches!(error.downcast_ref(), Some(BentError::NoMirror { .. } | BentError::OwnLaw { .. }))
            || matches!(error.downcast_ref(), Some(StoreError::NotAFolder { .. }));
        if bad_input { 2 } else { 1 }
    }
}
