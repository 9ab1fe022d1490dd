//! What commands share: parameters, memo, the way to schedule and to log.

use super::Globals;
use super::error::CliError;
use super::interrupt;
use super::output::Stderr;
use crate::batch::{Memo, Progress, Quantisation, SchedulerOptions, Store, StoreWarning};
use crate::input::InputError;
use crate::io::Settings;
use crate::lineage::Units;
use std::io::IsTerminal;
use std::path::{Path, PathBuf};

/// Parameters and services of a command.
pub struct Context {
    /// Checked parameters.
    pub settings: Settings,
    /// What one L_h and one τ are, as the lineage file of the command says.
    pub units: Units,
    /// How R0 is rounded.
    pub quantisation: Quantisation,
    /// Threads; 0 is one for each core.
    pub threads: usize,
    /// Whether the answer is JSON.
    pub json: bool,
    /// Whether progress may be shown.
    pub progress: bool,
    cache: Option<PathBuf>,
    no_cache: bool,
}

impl Context {
    /// Reads and checks the global options.
    pub fn new(globals: &Globals) -> Result<Context, CliError> {
        start_logs(globals);
        interrupt::listen();
        let settings = Settings::load(&globals.preset, globals.config.as_deref(), &globals.set)?;
        let quantisation = match globals.r0_step {
            None => Quantisation::DEFAULT,
            Some(step) => Quantisation::with_relative_step(step)
                .map_err(|step| InputError::not_allowed("--r0-step", "r0_step", step, "from 0 to 0.5"))?,
        };
        Ok(Context {
            settings,
            units: Units::default(),
            quantisation,
            threads: globals.threads.map_or(0, usize::from),
            json: globals.json,
            progress: !globals.quiet && std::io::stderr().is_terminal(),
            cache: globals.cache.clone(),
            no_cache: globals.no_cache,
        })
    }

    /// The memo, over the cache folder unless that is refused or, by default, not to be had.
    pub fn memo(&self) -> Result<Memo, CliError> {
        let memo = Memo::new(self.quantisation);
        if self.no_cache {
            return Ok(memo);
        }
        let store = match &self.cache {
            // A folder the user named must work.
            Some(folder) => Store::open(folder)?,
            None => {
                let opened = default_folder().and_then(|folder| Store::open(&folder).map_err(CliError::from));
                match opened {
                    Ok(store) => store,
                    Err(error) => {
                        tracing::warn!("solved divisions are not kept: {error}");
                        return Ok(memo);
                    }
                }
            }
        };
        Ok(memo.with_store(store))
    }

    /// How divisions are scheduled: on the threads asked for, until Ctrl-C.
    pub fn scheduling<'a>(&self, progress: &'a dyn Fn(Progress)) -> SchedulerOptions<'a> {
        SchedulerOptions {
            threads: self.threads,
            interrupt: Some(interrupt::flag()),
            progress: Some(progress),
            ..SchedulerOptions::default()
        }
    }
}

/// Logs what the user should know about the store.
pub fn warn_of_store(warnings: &[StoreWarning]) {
    warnings.iter().for_each(|warning| tracing::warn!("{warning}"));
}

/// The cache folder where none is named: `cache` in the working folder if there is one, else the user's.
fn default_folder() -> Result<PathBuf, CliError> {
    use etcetera::BaseStrategy;
    let here = Path::new("cache");
    if here.is_dir() {
        return Ok(here.to_owned());
    }
    etcetera::choose_base_strategy()
        .map(|strategy| strategy.cache_dir().join("furrow"))
        .map_err(|error| CliError::NoCacheFolder { reason: error.to_string() })
}

/// The cache folder in force.
pub fn cache_folder(globals: &Globals) -> Result<PathBuf, CliError> {
    match &globals.cache {
        Some(folder) => Ok(folder.clone()),
        None => default_folder(),
    }
}

/// Sends logs to stderr, warnings and worse unless told otherwise.
pub fn start_logs(globals: &Globals) {
    use tracing::level_filters::LevelFilter;
    let level = match (globals.quiet, globals.verbose) {
        (true, _) => LevelFilter::ERROR,
        (_, 0) => LevelFilter::WARN,
        (_, 1) => LevelFilter::INFO,
        _ => LevelFilter::DEBUG,
    };
    let subscriber = tracing_subscriber::fmt()
        .with_max_level(level)
        .with_writer(|| Stderr)
        .with_ansi(std::io::stderr().is_terminal())
        .without_time()
        .with_target(false);
    // Set before by whoever uses the library in-process: theirs stays.
    let _ = subscriber.try_init();
}
