//! The command line: one file a command. Results go to stdout, messages to stderr.

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
mod interrupt;
mod merge;
mod new_lineage;
mod output;
mod phase;
mod picture;
mod pitchfork;
mod prelude;
mod progress;
mod reproduce;
mod steady;
mod sweep;
mod tree;
mod vary;

use clap::{CommandFactory, Parser, Subcommand};
use context::{Context, Globals};
pub use error::CliError;
use std::process::ExitCode;

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
    #[command(subcommand)]
    command: Command,
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

/// The commands and their arguments.
pub fn command() -> clap::Command {
    Cli::command()
}

/// Runs the command line of this process. Exit code 0: done; 1: the computation failed; 2: bad input.
pub fn main() -> ExitCode {
    survive_full_disks();
    let done = match Cli::try_parse() {
        Ok(cli) => run(cli),
        Err(error) => output::print_usage(&error),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        // The reader of a pipe has closed it.
        Err(CliError::Stdout(e)) if e.kind() == std::io::ErrorKind::BrokenPipe => ExitCode::SUCCESS,
        Err(error) => {
            if !matches!(error, CliError::Usage) {
                output::eprint(&format!("error: {error}"));
            }
            ExitCode::from(error.exit_code())
        }
    }
}

/// Makes a write beyond the limit on file sizes fail like one to a full disk. Without a handler the signal would kill the process,
/// which would leave its temporary files behind.
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
