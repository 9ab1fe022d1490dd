//! The command line: arguments in, answers to stdout, all else to stderr. One file a command.

mod boundary;
mod branch;
mod cache;
mod calibrate;
mod cell;
mod compare;
mod completions;
mod context;
mod divide;
mod ensemble;
mod error;
mod explore;
mod export;
mod fit;
mod from_steady;
mod interrupt;
mod merge;
mod movie;
mod new_lineage;
mod output;
mod phase;
mod pitchfork;
mod plot;
mod progress;
mod reproduce;
mod scenarios;
mod steady;
mod sweep;
mod tree;
mod vary;

use clap::{Args, CommandFactory, Parser, Subcommand};
use context::Context;
pub use error::CliError;
use std::path::PathBuf;
use std::process::ExitCode;

/// Predicts from mechanics how an embryo's cells divide: how unequally, how many rounds, and when a lineage stops.
///
/// Lengths are in L_h, times in τ, activities in κ0/L_h; ξ_s is the published one.
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
    #[command(subcommand)]
    command: Command,
}

/// Options of all commands.
#[derive(Clone, Debug, Args)]
struct Globals {
    /// Constants to begin with: gao2026, from the thresholds that the paper prints, or sulston1983, from the rounds of the
    /// C. elegans founders
    #[arg(help_heading = "Parameters", long, global = true, value_name = "NAME", default_value = "gao2026")]
    preset: String,
    /// Parameters in RON, as in `Config(physics: (epsilon: 0.8), numerics: (stages: 4))`; what it does not name keeps
    /// the value of the preset
    #[arg(help_heading = "Parameters", long, global = true, value_name = "FILE.ron")]
    config: Option<PathBuf>,
    /// Sets one parameter, after the file; repeatable
    #[arg(help_heading = "Parameters", long, global = true, value_name = "KEY=VALUE")]
    set: Vec<String>,
    /// Threads that solve; default one for each core
    #[arg(help_heading = "Run", long, global = true, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
    /// Folder that keeps solved divisions; default `cache` here if there is one, else the user's cache folder
    #[arg(help_heading = "Run", long, global = true, value_name = "DIR", conflicts_with = "no_cache")]
    cache: Option<PathBuf>,
    /// Neither reads nor keeps solved divisions
    #[arg(help_heading = "Run", long, global = true)]
    no_cache: bool,
    /// Relative step to which R0 is rounded before a division is looked up or solved; 0 for none
    #[arg(help_heading = "Numerics", long, global = true, value_name = "STEP", allow_negative_numbers = true, value_parser = cell::number)]
    r0_step: Option<f64>,
    /// Prints one JSON document
    #[arg(help_heading = "Output", long, global = true)]
    json: bool,
    /// No progress and no warnings
    #[arg(help_heading = "Output", long, global = true, conflicts_with = "verbose")]
    quiet: bool,
    /// Says more on stderr; twice says most
    #[arg(help_heading = "Output", short, long, global = true, action = clap::ArgAction::Count)]
    verbose: u8,
}

#[derive(Debug, Subcommand)]
enum Command {
    Tree(tree::TreeArgs),
    Divide(divide::DivideArgs),
    Steady(steady::SteadyArgs),
    Branch(branch::BranchArgs),
    Pitchfork(pitchfork::PitchforkArgs),
    Boundary(boundary::BoundaryArgs),
    Phase(phase::PhaseArgs),
    Sweep(sweep::SweepArgs),
    Merge(merge::MergeArgs),
    Export(export::ExportArgs),
    Calibrate(calibrate::CalibrateArgs),
    Fit(fit::FitArgs),
    Compare(compare::CompareArgs),
    Reproduce(reproduce::ReproduceArgs),
    Explore(explore::ExploreArgs),
    NewLineage(new_lineage::NewLineageArgs),
    Cache(cache::CacheArgs),
    Completions(completions::CompletionsArgs),
}

/// Runs the command line of this process. Exit code 0: done; 1: the computation failed; 2: bad input.
pub fn main() -> ExitCode {
    survive_full_disks();
    let done = match Cli::try_parse() {
        Ok(cli) => run(cli),
        Err(said) => output::explain(&said),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        // Whoever reads the answer has enough of it.
        Err(CliError::Answer(e)) if e.kind() == std::io::ErrorKind::BrokenPipe => ExitCode::SUCCESS,
        Err(error) => {
            if !matches!(error, CliError::Usage) {
                output::say(&format!("error: {error}"));
            }
            ExitCode::from(error.exit_code())
        }
    }
}

/// A write beyond the largest size a file may have fails like one to a full disk. By default the signal that comes with it
/// would end the process, temporary files left where they are; with a handler, whatever it does, it does not.
fn survive_full_disks() {
    #[cfg(unix)]
    let _ = signal_hook::flag::register(signal_hook::consts::SIGXFSZ, std::sync::Arc::default());
}

fn run(cli: Cli) -> Result<(), CliError> {
    match cli.command {
        Command::Tree(args) => tree::run(&args, &Context::new(&cli.globals)?),
        Command::Divide(args) => divide::run(&args, Context::new(&cli.globals)?),
        Command::Steady(args) => steady::run(&args, Context::new(&cli.globals)?),
        Command::Branch(args) => branch::run(&args, Context::new(&cli.globals)?),
        Command::Pitchfork(args) => pitchfork::run(&args, Context::new(&cli.globals)?),
        Command::Boundary(args) => boundary::run(&args, Context::new(&cli.globals)?),
        Command::Calibrate(args) => calibrate::run(&args, &Context::new(&cli.globals)?),
        Command::Fit(args) => fit::run(&args, &Context::new(&cli.globals)?),
        Command::Compare(args) => compare::run(&args, &Context::new(&cli.globals)?),
        Command::Phase(args) => phase::run(&args, Context::new(&cli.globals)?),
        Command::Sweep(args) => sweep::run(&args, &Context::new(&cli.globals)?, &cli.globals),
        Command::Merge(args) => merge::run(&args, &cli.globals),
        Command::Export(args) => export::run(&args, &cli.globals),
        Command::Reproduce(args) => reproduce::run(&args, &Context::new(&cli.globals)?, &cli.globals),
        Command::Explore(args) => explore::run(&args, &Context::new(&cli.globals)?),
        Command::NewLineage(args) => new_lineage::run(&args),
        Command::Cache(args) => cache::run(&args, &cli.globals),
        Command::Completions(args) => completions::run(&args, &mut Cli::command()),
    }
}
