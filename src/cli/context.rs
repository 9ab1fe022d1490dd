//! Services that commands share: parameters, memo, scheduling and logging.

use super::error::CliError;
use super::interrupt;
use super::messages;
use super::output::number;
use super::progress::ProgressLine;
use super::work;
use clap::Args;
use clap::builder::{PossibleValue, StringValueParser, TypedValueParser};
use furrow_analysis::{Constants, read_constants_of};
use furrow_cell::Parameter;
use furrow_cell::settings::canonical_name;
use furrow_cell::settings::{self, Overrides, Settings};
use furrow_input::{InputError, read_text};
use furrow_lineage::batch::{Memo, Progress, Quantisation, SchedulerOptions, Store, scheduler};
use furrow_lineage::{Length, Lineage, Units};
use std::cell::OnceCell;
use std::path::{Path, PathBuf};

// Options of all commands.
#[derive(Clone, Debug, Args)]
pub struct Globals {
    /// Preset of constants: gao2026, fitted to all statements of the paper, gao2026-thresholds, fitted only to its four
    /// printed thresholds, or sulston1983, fitted to the rounds of the C. elegans founders
    #[arg(help_heading = "Parameters", long, global = true, value_name = "NAME", default_value = "gao2026",
        value_parser = PresetNames, hide_possible_values = true)]
    pub preset: String,
    /// Parameters in RON, as in `Config(physics: (epsilon: 0.8), numerics: (stages: 4))`; keys that are not set
    /// keep the preset's values
    #[arg(help_heading = "Parameters", long, global = true, value_name = "FILE.ron")]
    pub config: Option<PathBuf>,
    /// Law of active stress: a file of expressions, as in examples/laws/, or paper, the built-in one; its constants are set as law.NAME
    #[arg(help_heading = "Parameters", long, global = true, value_name = "FILE.ron")]
    pub law: Option<PathBuf>,
    /// Sets one parameter and overrides --config; repeatable
    #[arg(help_heading = "Parameters", long, global = true, value_name = "KEY=VALUE")]
    pub set: Vec<String>,
    /// Azimuthal modes unless --config or --set give them
    #[arg(skip)]
    pub base_modes: usize,
    /// Number of solver threads; default one per core
    #[arg(help_heading = "Run", long, global = true, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub threads: Option<u16>,
    /// Cache folder for solved divisions; default `cache` in the working folder if it exists, otherwise the user's cache folder
    #[arg(help_heading = "Run", long, global = true, value_name = "DIR", conflicts_with = "no_cache")]
    pub cache: Option<PathBuf>,
    /// Disables the cache
    #[arg(help_heading = "Run", long, global = true)]
    pub no_cache: bool,
    /// Relative step to which R0 is rounded before a division is looked up or solved; 0 disables rounding
    #[arg(help_heading = "Numerics", long, global = true, value_name = "STEP", value_parser = number)]
    pub r0_step: Option<f64>,
    /// Prints the result as one JSON document
    #[arg(help_heading = "Output", long, global = true)]
    pub json: bool,
    /// Hides progress and warnings
    #[arg(help_heading = "Output", short, long, global = true, conflicts_with = "verbose")]
    pub quiet: bool,
    /// Prints the settings and the work done on stderr; -vv also prints every division
    #[arg(help_heading = "Output", short, long, global = true, action = clap::ArgAction::Count)]
    pub verbose: u8,
}

/// An option, the name of its parameter, and its value.
type Given = (&'static str, &'static str, String);

impl Globals {
    /// The settings of the preset, with a configuration file and overrides.
    ///
    /// # Errors
    /// As [`Settings::load`], and for 0 modes with --three-dimensional.
    pub fn load(&self, config: Option<&Path>, overrides: &[String]) -> Result<Settings, InputError> {
        let mut base = Settings::preset(&self.preset)?;
        base.numerics.modes = self.base_modes;
        let settings = base.with(config, self.law.as_deref(), overrides)?;
        let fine = self.base_modes == 0 || settings.numerics.modes > 0;
        InputError::require(fine, "settings", "modes", 0, "1 to 12 with --three-dimensional")?;
        Ok(settings)
    }

    /// Rejects a parameter that both an option and `--set` give.
    ///
    /// # Errors
    /// Names the parameter and its value in `--set`.
    pub fn check_once(&self, option: &str, name: &str) -> Result<(), InputError> {
        match self.overrides()?.into_iter().find(|(_, set, _)| *set == name) {
            Some((source, _, twice)) => {
                Err(InputError::not_allowed(source, name, twice, format!("left out: {option} gives it")))
            }
            None => Ok(()),
        }
    }

    /// The settings of `--set`.
    ///
    /// # Errors
    /// Names an entry that cannot be read.
    pub fn overrides(&self) -> Result<Vec<Given>, InputError> {
        let Overrides { source_name, pairs } = Overrides::read(&self.set)?;
        Ok(pairs.into_iter().map(|(name, value)| (source_name, name, value.to_string())).collect())
    }
}

/// Suggests the names of presets to shells. Unknown names are rejected when settings are read; that error suggests the nearest name.
#[derive(Clone)]
struct PresetNames;

impl TypedValueParser for PresetNames {
    type Value = String;

    fn parse_ref(
        &self,
        command: &clap::Command,
        arg: Option<&clap::Arg>,
        value: &std::ffi::OsStr,
    ) -> Result<String, clap::Error> {
        StringValueParser::new().parse_ref(command, arg, value)
    }

    fn possible_values(&self) -> Option<Box<dyn Iterator<Item = PossibleValue> + '_>> {
        Some(Box::new(settings::presets().map(PossibleValue::new)))
    }
}

/// Parameters and services of a command.
pub struct Context {
    /// Checked parameters.
    pub settings: Settings,
    /// Units of L_h and τ, from the lineage file.
    pub units: Units,
    /// How R0 is rounded.
    pub quantisation: Quantisation,
    /// Threads; 0 is one for each core.
    pub threads: usize,
    /// Whether the result is printed as JSON.
    pub json: bool,
    /// Whether progress may be shown.
    pub progress: bool,
    /// The options as given.
    pub globals: Globals,
}

impl Context {
    /// Reads and checks the global options.
    pub fn new(globals: &Globals) -> Result<Context, CliError> {
        if let Some(threads) = globals.threads {
            scheduler::bound_threads(usize::from(threads));
        }
        let settings = settings_in(globals, &Units::default())?;
        let quantisation = match globals.r0_step {
            None => Quantisation::DEFAULT,
            Some(step) => Quantisation::with_relative_step(step)
                .map_err(|step| InputError::not_allowed("--r0-step", "r0_step", step, "from 0 to 0.5"))?,
        };
        let context = Context {
            settings,
            units: Units::default(),
            quantisation,
            threads: globals.threads.map_or(0, usize::from),
            json: globals.json,
            progress: !globals.quiet,
            globals: globals.clone(),
        };
        work::settings(&context);
        Ok(context)
    }

    /// The same for a command that assumes axial symmetry.
    ///
    /// # Errors
    /// As [`Context::new`], and for settings with azimuthal modes.
    pub fn axisymmetric(globals: &Globals) -> Result<Context, CliError> {
        let context = Context::new(globals)?;
        context.settings.check_axisymmetric("settings")?;
        Ok(context)
    }

    /// The same for a command that supports only the paper's law; `what` is the purpose named in the error.
    ///
    /// # Errors
    /// As [`Context::axisymmetric`], and for any other law.
    pub fn of_paper_law(globals: &Globals, what: &str) -> Result<Context, CliError> {
        let context = Context::axisymmetric(globals)?;
        context.settings.check_paper_model(what)?;
        Ok(context)
    }

    /// Rejects a law if an option requests non-axisymmetric disturbances.
    ///
    /// # Errors
    /// Names the law.
    pub fn check_azimuthal(&self, given: Option<u8>) -> Result<(), InputError> {
        match given {
            Some(_) => {
                self.settings.check_paper_law("--azimuthal: disturbances around the axis have its equations alone")
            }
            None => Ok(()),
        }
    }

    /// The parameters, with a radius in µm by these units.
    ///
    /// # Errors
    /// As [`Settings::load`].
    pub fn settings_in(&self, units: &Units) -> Result<Settings, InputError> {
        let changes = self.globals.set.iter().any(|entry| radius_in_micrometres(entry).is_some());
        if changes { settings_in(&self.globals, units) } else { Ok(self.settings.clone()) }
    }

    /// Rejects settings that affect no cell of these lineages because every founder sets its own value: `--set` and the `given`
    /// options, with names and values. A configuration file may be meant for other lineages too, so it causes only a warning.
    ///
    /// # Errors
    /// Names the option, its value and the lineage.
    pub fn check_taken(
        &self,
        lineages: &[&Lineage],
        given: impl IntoIterator<Item = (&'static str, &'static str, String)>,
    ) -> Result<(), InputError> {
        Lineage::check_taken(lineages, given.into_iter().chain(self.overrides()?))?;
        let unused = |name: &'static str| Lineage::allowed_of_run(lineages.iter().copied(), name);
        let Some(file) = &self.globals.config else { return Ok(()) };
        let [with, without] = [Some(file.as_path()), None].map(|config| self.globals.load(config, &[]));
        let (with, without) = (with?.cell, without?.cell);
        // A table of the run's shell sets the aspect ratio too.
        let by_table = |parameter: &Parameter| *parameter == Parameter::Aspect && with.shell_profile.is_some();
        let differs = |parameter: &&Parameter| parameter.get(&with) != parameter.get(&without) && !by_table(parameter);
        let has_r0 = lineages.iter().all(|lineage| lineage.founders[lineage.first()].r0.is_some());
        for parameter in Parameter::ALL.iter().filter(differs) {
            let whose = match parameter {
                Parameter::R0 if has_r0 => "the first cell of the lineage has its own",
                _ if unused(parameter.name()).is_some() => "every founder of the lineage has its own",
                _ => continue,
            };
            let (file, value) = (file.display(), parameter.get(&with));
            messages::warning!("{file}: {parameter} = {value} reaches no cell: {whose}");
        }
        Ok(())
    }

    /// Reads sets of constants for a lineage. Their parameters must not also be set by `--set` or by the `given` options, with
    /// names and values.
    ///
    /// # Errors
    /// As [`read_constants_of`] and [`Constants::check_given`].
    pub fn constants(
        &self,
        file: &Path,
        lineage: &Lineage,
        given: impl IntoIterator<Item = (&'static str, &'static str, String)>,
    ) -> Result<Vec<Constants>, InputError> {
        let name = file.display().to_string();
        let sets = read_constants_of(&read_text(file)?, &name, lineage)?;
        let given = given.into_iter().chain(self.overrides()?);
        sets.first().map_or(Ok(()), |first| first.check_given(&name, given))?;
        Ok(sets)
    }

    /// Whether `--set` sets a parameter, by its [canonical name](furrow_cell::settings::canonical_name).
    ///
    /// # Errors
    /// Names an entry that cannot be read.
    pub fn sets(&self, name: &str) -> Result<bool, InputError> {
        Ok(self.overrides()?.iter().any(|(_, set, _)| *set == name))
    }

    fn overrides(&self) -> Result<Vec<Given>, InputError> {
        self.globals.overrides()
    }

    /// The memo, backed by the cache folder unless the cache is disabled or the default folder cannot be used.
    pub fn memo(&self) -> Result<Memo, CliError> {
        let memo = Memo::new(self.quantisation);
        if self.globals.no_cache {
            return Ok(work::watched(memo, None));
        }
        match cache_folder(&self.globals).and_then(|folder| Ok((Store::open(&folder)?, folder))) {
            Ok((store, folder)) => {
                interrupt::cached();
                Ok(work::watched(memo.with_store(store), Some(&folder)))
            }
            // A folder given by the user must be usable.
            Err(error) if self.globals.cache.is_some() => Err(error),
            Err(error) => {
                messages::warning!("the cache is disabled, solved divisions are not kept: {error}");
                Ok(work::watched(memo, None))
            }
        }
    }

    /// Runs work with a progress line, which is removed when the work ends.
    pub fn shown<T>(&self, work: impl FnOnce(&ProgressLine) -> T) -> T {
        work(&ProgressLine::new(self.progress))
    }

    /// The same for divisions: the line counts finished divisions. It appears with the first one, because the work may show another
    /// line until then.
    pub fn scheduled<T>(&self, work: impl FnOnce(&SchedulerOptions<'_>) -> T) -> T {
        let line = OnceCell::new();
        let show = |progress| line.get_or_init(|| ProgressLine::new(self.progress)).show_all(progress);
        work(&self.scheduling(&show))
    }

    /// Options of the scheduler: the requested number of threads, and a stop at Ctrl-C.
    pub fn scheduling<'a>(&self, progress: &'a dyn Fn(Progress)) -> SchedulerOptions<'a> {
        SchedulerOptions {
            threads: self.threads,
            interrupt: Some(interrupt::flag()),
            progress: Some(progress),
            ..SchedulerOptions::default()
        }
    }
}

/// The parameters that the options give.
fn settings_in(globals: &Globals, units: &Units) -> Result<Settings, InputError> {
    let natural = |entry: &String| match radius_in_micrometres(entry) {
        Some(length) => format!("r0={}", length.in_units(units)),
        None => entry.clone(),
    };
    let set: Vec<String> = globals.set.iter().map(natural).collect();
    globals.load(globals.config.as_deref(), &set)
}

/// The radius in µm given by an entry of `--set`.
pub fn radius_in_micrometres(entry: &str) -> Option<Length> {
    let (key, value) = entry.split_once('=')?;
    let length = value.parse().ok().filter(|length: &Length| matches!(length, Length::Micrometres(_)));
    length.filter(|_| canonical_name(key.trim()) == Ok("r0"))
}

/// The cache folder: the given one, otherwise `cache` in the working folder if it exists, otherwise the user's.
pub fn cache_folder(globals: &Globals) -> Result<PathBuf, CliError> {
    use etcetera::BaseStrategy;
    let here = Path::new("cache");
    match &globals.cache {
        Some(folder) => {
            let (fine, allowed) = (folder.is_dir() || !folder.exists(), "a folder, which is made if it is not there");
            InputError::require(fine, "--cache", "cache", folder.display(), allowed)?;
            Ok(folder.clone())
        }
        None if here.is_dir() => Ok(here.to_owned()),
        None => match etcetera::choose_base_strategy() {
            Ok(strategy) => Ok(strategy.cache_dir().join("furrow")),
            Err(error) => Err(CliError::NoCacheFolder(error.to_string())),
        },
    }
}
