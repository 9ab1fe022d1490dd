//! `furrow fit`: constants, activities, a cue or a clock fitted to observations.

mod activity;
mod clock;
mod constants;
mod cue;

use clap::{Args, Subcommand};

use super::cell::load_lineage;
use super::context::Context;
use super::error::CliError;
use super::interrupt;
use super::output::seed;
use furrow_analysis::fit::{FitProgress, FitRun, NumberAtLimit, SearchBudget, Targets};
use furrow_analysis::tree_settings;
use furrow_input::{parse_document, read_text};
use furrow_lineage::{Lineage, TreeSettings};
use std::path::PathBuf;
use std::time::Instant;

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  furrow fit constants --out fitted.ron
  furrow fit activity --rounds max
  furrow fit cue --preset sulston1983
  furrow fit cue --cue tension:gradient,amplitude=0.3 --particles 4 --moves 1
  furrow fit clock")]
pub struct FitArgs {
    #[command(subcommand)]
    what: What,
}

#[derive(Debug, Subcommand)]
enum What {
    /// Fits one set of constants to the observed rounds and terminal cells of founders and the measured χ of the germline
    ///
    /// Prints the Pareto front between this fit and the published thresholds, and how far each constant can change.
    #[command(after_help = "\
Examples:
  furrow fit constants --out fitted.ron
  furrow fit constants --particles 8 --moves 4 --json")]
    Constants(constants::ConstantsArgs),
    Activity(activity::ActivityArgs),
    Cue(cue::CueArgs),
    Clock(clock::ClockArgs),
}

// The lineage used by all fits.
#[derive(Debug, Args)]
struct LineageArgs {
    /// Founders with their observed rounds; default the built-in C. elegans founders
    #[arg(help_heading = "Targets", long, value_name = "LINEAGE.ron")]
    lineage: Option<PathBuf>,
}

// The targets of constants and cues.
#[derive(Debug, Args)]
struct TargetsArgs {
    /// Observations to which constants and cues are fitted; default the built-in data/embryo.ron
    #[arg(help_heading = "Targets", long, value_name = "TARGETS.ron")]
    targets: Option<PathBuf>,
}

// Options of a search by a particle swarm.
#[derive(Debug, Args)]
#[command(next_help_heading = "Search")]
struct SearchArgs {
    /// Particles of the swarm
    #[arg(long, value_name = "N", default_value_t = 24, value_parser = clap::value_parser!(u32).range(2..=10_000))]
    particles: u32,
    /// Moves of the swarm
    #[arg(long, value_name = "N", default_value_t = 20, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    moves: u32,
    /// Seed of the search
    #[arg(long, value_name = "S", default_value_t = 0, value_parser = seed)]
    seed: u64,
}

pub fn run(args: &FitArgs, context: &Context) -> Result<(), CliError> {
    match &args.what {
        What::Constants(args) => constants::run(args, context),
        What::Activity(args) => activity::run(args, context),
        What::Cue(args) => cue::run(args, context),
        What::Clock(args) => clock::run(args, context),
    }
}

/// The input of a fit.
struct Fit {
    lineage: Lineage,
    settings: TreeSettings,
    start: Instant,
}

impl Fit {
    fn new(args: &LineageArgs, context: &Context) -> Result<Fit, CliError> {
        let start = Instant::now();
        let lineage = load_lineage(args.lineage.as_deref())?;
        context.settings.check_divisions("settings")?;
        context.settings.check_activity("settings")?;
        context.check_taken(&[&lineage], [])?;
        let settings = tree_settings(context.settings_in(&lineage.units())?, &lineage, 0, context.quantisation);
        Ok(Fit { lineage, settings, start })
    }

    /// The checked targets of a file, or the built-in ones, and the file's name.
    fn targets(&self, args: &TargetsArgs) -> Result<(Targets, String), CliError> {
        let (targets, file) = match &args.targets {
            None => (Targets::embryo()?, "embryo.ron (built in)".to_owned()),
            Some(path) => {
                let file = path.display().to_string();
                (parse_document(&read_text(path)?, &file, "a file of targets of a fit", "Fit")?, file)
            }
        };
        targets.check(&file, &self.lineage)?;
        Ok((targets, file))
    }

    /// Runs a search with a progress line that counts the tried `what`.
    fn search<T>(&self, context: &Context, what: &str, search: impl FnOnce(&FitRun<'_>) -> T) -> T {
        context.shown(|line| {
            let show = |FitProgress { done, of, least }| {
                let least = least.map_or(String::new(), |least| format!(", least misfit {least:.3}"));
                line.show_share(done, of, || format!("{what}{least}"));
            };
            let run = FitRun::new(&self.lineage, &self.settings, context.threads, interrupt::flag());
            search(&FitRun { progress: Some(&show), ..run })
        })
    }

    fn elapsed_s(&self) -> f64 {
        self.start.elapsed().as_secs_f64()
    }
}

impl SearchArgs {
    fn budget(&self) -> SearchBudget {
        let SearchArgs { particles, moves, seed } = *self;
        SearchBudget { particles: particles as usize, moves: u64::from(moves), seed }
    }
}

/// A line for each number that ended at the edge of its range; `advice` describes how to change the range.
fn at_limit_text(numbers: &[NumberAtLimit], advice: &str) -> String {
    let line = |out: String, NumberAtLimit { name, limit, searched: [from, to], .. }: &NumberAtLimit| {
        let end = limit.of([from.min(*to), from.max(*to)]);
        out + &format!("{name} ended at the edge of its range, {end}, searched from {from} to {to}: {advice}\n")
    };
    numbers.iter().fold(String::new(), line)
}

/// A number that may be missing.
fn or_dash(value: Option<impl std::fmt::Display>) -> String {
    value.map_or("-".to_owned(), |value| value.to_string())
}
