//! The command line, with one file per command. Results go to stdout, messages to stderr.

mod boundary;
mod branch;
mod cache;
mod calibrate;
mod cell;
mod compare;
mod completions;
mod context;
mod divide;
mod embryos;
mod ensemble;
mod error;
mod explore;
mod export;
mod fit;
mod interrupt;
mod merge;
mod messages;
mod new_lineage;
mod output;
mod phase;
mod picture;
mod pitchfork;
mod polarity;
mod progress;
mod reproduce;
mod solve;
mod steady;
mod sweep;
mod test;
mod tree;
mod vary;
mod work;

use clap::error::ErrorKind;
use clap::{ArgMatches, Args, CommandFactory, FromArgMatches, Parser, Subcommand};
use context::{Context, Globals};
pub use error::CliError;
use messages::Level;
use std::borrow::Cow;
use std::cell::RefCell;
use std::ffi::OsString;
use std::fmt::Write;
use std::path::{Component, Path, PathBuf};
use std::process::ExitCode;
use std::time::Instant;

/// Predicts cell divisions of embryos from mechanics: how unequal they are, how many rounds there are, and when a lineage stops.
///
/// Lengths are in L_h, times in τ, activities in κ0/L_h. ξ_s is the activity as published.
#[derive(Debug, Parser)]
#[command(name = "furrow", version, arg_required_else_help = true, propagate_version = true)]
#[command(after_help = "\
Examples:
  furrow tree
  furrow divide --r0 2.5
  furrow pitchfork --r0 2")]
struct Cli {
    #[command(flatten)]
    globals: Globals,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Grows a lineage from one cell, division by division, until no cell can divide
    ///
    /// Prints the rounds of division of each founder next to the observed ones. Writes tree.nwk, tree.json, tree.svg, report.html and
    /// run.json.
    ///
    /// With several lineages or several --cue, every combination is a scenario. One run grows and compares all scenarios, writes
    /// scenarios.csv, report.html and run.json, and writes each tree into a folder named after the scenario.
    Tree(IfNamed<tree::TreeArgs>),
    /// Computes one division, from the passive shape to pinch-off or rest
    ///
    /// With --from-steady the division starts from a stationary shape of the active cell, disturbed by the noise of the first step.
    Divide(IfNamed<divide::DivideArgs>),
    /// Computes the stationary shape at one activity, on the branch of the passive shape, and its growth rates
    Steady(IfNamed<steady::SteadyArgs>),
    /// Continues symmetric and asymmetric stationary shapes over ξ_s, with their folds and pitchforks
    ///
    /// If the cue breaks the mirror symmetry, the command continues the branch of the passive shape.
    Branch(IfNamed<branch::BranchArgs>),
    /// Locates the first pitchfork of the mirror-symmetric shapes and its criticality
    Pitchfork(IfNamed<pitchfork::PitchforkArgs>),
    /// Continues the boundary of division over a parameter: the pitchfork and the folds of mirror-symmetric shapes
    ///
    /// If the cue breaks the mirror symmetry, the boundary is the fold at which the stable shapes end.
    Boundary(IfNamed<boundary::BoundaryArgs>),
    /// Computes PAR polarity at the sizes of the germline: the position of its boundary, the resulting χ, and the smallest polarised cell
    ///
    /// The model has two antagonists with cytosolic pools (Goehring et al. 2011) on the passive shape of the cell. If a polarised state
    /// exists, κ follows P as a step, and the cell divides with this cue. For each cell of the germline the command prints the boundary,
    /// and χ next to the measured χ. It also prints the smallest polarised cell and the smallest cell that divides.
    Polarity(IfNamed<polarity::PolarityArgs>),
    /// Maps outcomes over a parameter and ξ_s: the exact edges of stable shapes, and χ from divisions
    Phase(IfNamed<phase::PhaseArgs>),
    /// Computes divisions, trees, pitchforks or critical radii over axes of parameters
    ///
    /// Writes results.csv (one row per point, the first axis varies slowest), the same rows in results.jsonl, and all inputs in
    /// sweep.json. Interrupted sweeps resume.
    Sweep(IfNamed<sweep::SweepArgs>),
    /// Merges the parts of a sweep, or of a sample of furrow test
    ///
    /// A merged sweep has the same files as the whole sweep, byte for byte. The command fails if parts are missing or come from different
    /// sweeps or versions of furrow.
    Merge(IfNamed<merge::MergeArgs>),
    /// Solves for one parameter: the values at which a cell divides with a required χ, furrow position or time
    ///
    /// Lists all roots in a range, jumps of the outcome across the required value, and values without a division.
    Solve(IfNamed<solve::SolveArgs>),
    /// Writes a grown tree, or an observed embryo, in the formats of other programs
    ///
    /// newick, nhx and nexus are trees with named inner nodes; nhx and nexus add the data of each cell. csv has one row per cell.
    /// lineagetree is the numeric CSV of the Python package LineageTree. graphml is a graph. itol is a folder with a tree and its
    /// annotations for itol.embl.de. geff is a folder in the graph exchange format of cell tracking, ctc the table of tracks of the Cell
    /// Tracking Challenge.
    Export(IfNamed<export::ExportArgs>),
    /// Fits material and shell constants to measured thresholds and shows which combinations stay undetermined
    Calibrate(IfNamed<calibrate::CalibrateArgs>),
    /// Fits constants, activities, a cue or a clock to observations
    ///
    /// constants: one set of constants for the observed rounds and terminal cells of founders and the measured χ of the germline, with
    /// the Pareto front between this fit and the published thresholds.
    /// activity: for each founder separately, the activity that gives its observed rounds.
    /// cue: the cue that gives the measured χ of the germline, and which combinations of its numbers remain undetermined.
    /// clock: the lifetimes of cells as powers of their volumes, for a lineage file.
    Fit(IfNamed<fit::FitArgs>),
    /// Tests hypotheses against each other: which cue fits measured χ best, and whether the difference is more than chance
    ///
    /// For each hypothesis the command prints the log likelihood, AICc, the score of left-out embryos, the fitted numbers with their
    /// errors, and the cells that do not divide. For each pair of hypotheses it prints whether they are distinguishable, or how many
    /// embryos would be needed.
    Test(IfNamed<test::TestArgs>),
    /// Compares the model with measured embryos
    Compare(IfNamed<compare::CompareArgs>),
    /// Recomputes the paper figure by figure and lists what agrees and what differs
    ///
    /// FIGURE is a figure, panel, table or movie of the paper, such as 2A, S5, `Table S3` or `Movie 1`, or a group, such as 2 or movies.
    /// All figures take a minute or two. Sizes, confinement, activity and cues of single cells are the paper's; the constants, and
    /// all settings of lineages, come from --preset, --config and --set.
    Reproduce(IfNamed<reproduce::ReproduceArgs>),
    /// Writes a web page that computes divisions in the browser: any cell you choose, and the founders' tree under another cue
    ///
    /// The page is one file and works offline. `furrow tree` writes the same page with its tree, as report.html.
    Explore(IfNamed<explore::ExploreArgs>),
    /// Writes a commented lineage file as a starting point
    NewLineage(IfNamed<new_lineage::NewLineageArgs>),
    /// Inspects, verifies or clears the cache
    Cache(IfNamed<cache::CacheArgs>),
    /// Prints a completion script for a shell
    Completions(IfNamed<completions::CompletionsArgs>),
}

thread_local! {
    /// The command that is run: to save time, only its arguments are defined. `None` defines the arguments of all commands.
    static NAMED: RefCell<Option<OsString>> = const { RefCell::new(None) };
}

/// The arguments of a command, defined unless [`NAMED`] is another one. clap's deferral would put them behind the global options in the
/// help.
#[derive(Debug)]
struct IfNamed<T>(T);

impl<T> std::ops::Deref for IfNamed<T> {
    type Target = T;

    fn deref(&self) -> &T {
        &self.0
    }
}

impl<T: Args> Args for IfNamed<T> {
    fn augment_args(command: clap::Command) -> clap::Command {
        let is_other = |named: &Option<OsString>| named.as_ref().is_some_and(|named| named != command.get_name());
        if NAMED.with_borrow(is_other) { command } else { T::augment_args(command) }
    }

    fn augment_args_for_update(command: clap::Command) -> clap::Command {
        Self::augment_args(command)
    }
}

impl<T: FromArgMatches> FromArgMatches for IfNamed<T> {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self, clap::Error> {
        T::from_arg_matches(matches).map(IfNamed)
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), clap::Error> {
        self.0.update_from_arg_matches(matches)
    }
}

/// The commands and their arguments.
pub fn command() -> clap::Command {
    Command::augment_subcommands(Cli::command()).subcommand_required(true)
}

/// Runs the command line of this process. Exit codes: 0, done; 1, the computation failed; 2, invalid input.
pub fn main() -> ExitCode {
    survive_full_disks();
    let (mut options, mut name) = (Vec::new(), String::new());
    let done = match parse(&mut options, &mut name) {
        Ok((globals, command)) => run(&globals, command, &name),
        Err(error) => output::print_usage(&error),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        // The reader of a pipe has closed it.
        Err(CliError::Stdout(e)) if e.kind() == std::io::ErrorKind::BrokenPipe => ExitCode::SUCCESS,
        Err(error) => {
            if !matches!(error, CliError::Usage) {
                output::eprint(&format!("error: {error}{}", error.hint(&options)));
            }
            ExitCode::from(error.exit_code())
        }
    }
}

/// Treats a negative number as the value of the preceding option, so that an error names both.
fn with_negative_numbers(command: clap::Command) -> clap::Command {
    command
        .mut_args(|arg| if arg.get_action().takes_values() { arg.allow_negative_numbers(true) } else { arg })
        .mut_subcommands(with_negative_numbers)
}

/// Parses the arguments. clap copies the global options into each registered command; if the first argument is a command, only this
/// command is registered, to save time. The names of the command's options are added to `options`, its own name to `called`.
fn parse(options: &mut Vec<String>, called: &mut String) -> Result<(Globals, Command), clap::Error> {
    let first = std::env::args_os().nth(1);
    let known = match first.filter(|name| name.to_str().is_some_and(Command::has_subcommand)) {
        Some(name) => {
            NAMED.set(Some(name.clone()));
            let commands = Command::augment_subcommands(clap::Command::default());
            NAMED.set(None);
            Cli::command().subcommands(commands.find_subcommand(name).cloned())
        }
        None => command(),
    };
    let mut known = with_negative_numbers(known);
    let mut matches = known.try_get_matches_from_mut(std::env::args_os())?;
    let (mut command, mut below) = (&known, &matches);
    while let Some((name, matches)) = below.subcommand() {
        let _ = write!(called, " {name}");
        (command, below) = (command.find_subcommand(name).unwrap_or(command), matches);
    }
    options.extend(command.get_arguments().filter_map(clap::Arg::get_long).map(str::to_owned));
    if let Some(clash) = one_file_twice(below, options) {
        return Err(known.error(ErrorKind::ArgumentConflict, clash));
    }
    Cli::from_arg_matches_mut(&mut matches)
        .and_then(|cli| Ok((cli.globals, Command::from_arg_matches_mut(&mut matches)?)))
        .map_err(|error| error.format(&mut known))
}

/// Options that write a file.
const WRITTEN: [&str; 9] = ["out", "plot", "movie", "frames", "csv", "write", "posterior", "table", "front"];

/// The error if two options of a command name the same file, in which case one output would replace the other.
fn one_file_twice(matches: &clap::ArgMatches, options: &[String]) -> Option<String> {
    let written = WRITTEN.into_iter().filter(|name| options.iter().any(|option| option == name));
    let mut named: Vec<(&str, PathBuf)> = Vec::new();
    for name in written {
        let Ok(Some(mut values)) = matches.try_get_raw(name) else { continue };
        let Some(file) = values.next() else { continue };
        if let Some(clash) = file_that_is_read(matches, name, Path::new(file)) {
            return Some(clash);
        }
        let file: PathBuf = Path::new(file).components().filter(|part| *part != Component::CurDir).collect();
        if let Some((other, _)) = named.iter().find(|(_, known)| *known == file) {
            return Some(format!("--{other} and --{name} both write {}: give each a file of its own", file.display()));
        }
        named.push((name, file));
    }
    None
}

/// The error if the file that an option writes exists and is also the value of an option or argument that is read.
fn file_that_is_read(matches: &ArgMatches, option: &str, file: &Path) -> Option<String> {
    let written = file.canonicalize().ok().filter(|file| file.is_file())?;
    let read = matches.ids().filter(|id| !WRITTEN.contains(&id.as_str()));
    let mut values = read.filter_map(|id| matches.try_get_raw(id.as_str()).ok().flatten()).flatten();
    values
        .any(|value| Path::new(value).canonicalize().is_ok_and(|value| value == written))
        .then(|| format!("--{option} would replace {}, which this command reads: give it another name", file.display()))
}

/// Makes a write beyond the limit on file sizes fail like a write to a full disk. Without a handler the signal would kill the process
/// and leave its temporary files behind.
fn survive_full_disks() {
    #[cfg(unix)]
    let _ = signal_hook::flag::register(signal_hook::consts::SIGXFSZ, std::sync::Arc::default());
}

/// The global options, with the settings of --three-dimensional and --modes.
fn with_axis<'a>(globals: &'a Globals, command: &Command) -> Result<Cow<'a, Globals>, CliError> {
    let axis = match command {
        Command::Tree(args) => &args.axis,
        Command::Divide(args) => &args.axis,
        Command::Steady(args) => &args.axis,
        Command::Branch(args) => &args.axis,
        Command::Reproduce(args) => &args.axis,
        Command::Boundary(args) => &args.axis,
        Command::Phase(args) => &args.axis,
        Command::Sweep(args) => &args.axis,
        Command::Solve(args) => &args.axis,
        _ => return Ok(Cow::Borrowed(globals)),
    };
    Ok(Cow::Owned(axis.applied(globals)?))
}

fn run(globals: &Globals, command: Command, name: &str) -> Result<(), CliError> {
    messages::set_level(globals);
    let start = Instant::now();
    messages::write(Level::Info, format_args!("furrow {}{name}", env!("CARGO_PKG_VERSION")));
    let done = perform(globals, command);
    work::report(start);
    done
}

fn perform(globals: &Globals, command: Command) -> Result<(), CliError> {
    // A cached division takes less time than installing the Ctrl-C handler, so `divide` installs it itself when needed.
    if !matches!(command, Command::Divide(_)) {
        interrupt::listen();
    }
    let globals = &*with_axis(globals, &command)?;
    match command {
        Command::Tree(args) => tree::run(&args, &Context::new(globals)?),
        Command::Divide(args) => divide::run(&args, Context::new(globals)?),
        Command::Steady(args) => steady::run(&args, Context::new(globals)?),
        Command::Branch(args) => branch::run(&args, Context::new(globals)?),
        Command::Pitchfork(args) => pitchfork::run(&args, Context::axisymmetric(globals)?),
        Command::Boundary(args) => boundary::run(&args, Context::new(globals)?),
        Command::Polarity(args) => polarity::run(&args, Context::axisymmetric(globals)?),
        Command::Calibrate(args) => {
            calibrate::run(&args, &Context::of_paper_law(globals, "constants calibrated with it")?)
        }
        Command::Fit(args) => fit::run(&args, &Context::axisymmetric(globals)?),
        Command::Test(args) => test::run(&args, &Context::axisymmetric(globals)?),
        Command::Compare(args) => compare::run(&args, &Context::new(globals)?),
        Command::Phase(args) => phase::run(&args, Context::new(globals)?),
        Command::Solve(args) => solve::run(&args, Context::new(globals)?),
        Command::Sweep(args) => sweep::run(&args, &Context::new(globals)?),
        Command::Merge(args) => merge::run(&args, globals),
        Command::Export(args) => export::run(&args, globals),
        Command::Reproduce(args) => {
            let context = Context::new(globals)?;
            context.settings.check_paper_model("the statements of the paper")?;
            reproduce::run(&args, &context)
        }
        Command::Explore(args) => {
            explore::run(&args, &Context::of_paper_law(globals, "a page whose controls are its constants")?)
        }
        Command::NewLineage(args) => new_lineage::run(&args, globals),
        Command::Cache(args) => cache::run(&args, globals),
        Command::Completions(args) => completions::run(&args, &mut self::command()),
    }
}
