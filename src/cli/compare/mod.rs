//! `furrow compare`: the model compared with measured embryos.

mod by_size;
mod contour;
mod counts;
mod dose;
mod files;
mod lifetimes;
mod volumes;

use clap::{Args, Subcommand};

use super::tree::grown;
use crate::cli::context::Context;
use crate::cli::error::CliError;
use crate::cli::interrupt;
use furrow_analysis::scenarios_of;
use furrow_input::InputError;
use furrow_lineage::batch::Memo;
use furrow_lineage::{Lineage, Tree, Units};
use furrow_measured::significance::slope_p;
use furrow_measured::statistics::{Line, SPREAD_FROM};
use furrow_measured::volumes::Skipped;
use furrow_mechanics::division::Outcome;

#[derive(Debug, Args)]
pub struct CompareArgs {
    #[command(subcommand)]
    what: What,
}

#[derive(Debug, Subcommand)]
enum What {
    Counts(counts::CountsArgs),
    Volumes(volumes::VolumesArgs),
    Lifetimes(lifetimes::LifetimesArgs),
    Contour(contour::ContourArgs),
    Dose(dose::DoseArgs),
}

pub fn run(args: &CompareArgs, context: &Context) -> Result<(), CliError> {
    match &args.what {
        What::Counts(args) => counts::run(args, context),
        What::Volumes(args) => volumes::run(args, context),
        What::Lifetimes(args) => lifetimes::run(args, context),
        What::Contour(args) => contour::run(args, context),
        What::Dose(args) => dose::run(args, context),
    }
}

/// Largest number of skipped values that are listed.
const MOST_SKIPPED: usize = 10;

/// The first of the skipped values, and the number of further ones, for each list with its total count.
fn skipped_text(lists: &[(&[Skipped], u64)]) -> String {
    let shown = lists.iter().flat_map(|(skipped, _)| *skipped).take(MOST_SKIPPED);
    let out: String = shown.map(|skipped| format!("  skipped {skipped}\n")).collect();
    match (lists.iter().map(|(_, count)| *count as usize).sum::<usize>()).saturating_sub(MOST_SKIPPED) {
        0 => out,
        more => out + &format!("  and {more} more (--json gives their places)\n"),
    }
}

/// Checks the edges of `--bins`.
fn check_bins(edges: Option<&[f64]>) -> Result<(), InputError> {
    let Some(edges) = edges else { return Ok(()) };
    let rising = edges.len() >= 2 && !edges.windows(2).any(|pair| pair[0] >= pair[1]);
    let given = edges.iter().map(f64::to_string).collect::<Vec<_>>().join(",");
    InputError::require(rising, "--bins", "bins", given, "two numbers or more, rising")
}

/// The degrees of freedom and the p value of a slope, printed after its error.
fn significance(line: &Line) -> String {
    let p = slope_p(line).map_or("no test, nothing scatters".to_owned(), |p| format!("p = {p:.1e}"));
    format!(" (degrees of freedom {}, {p})", line.degrees_of_freedom())
}

/// A fraction of a variance, if it is defined.
fn share(r_squared: Option<f64>, digits: usize) -> String {
    r_squared.map_or("undefined".to_owned(), |share| format!("{share:.digits$}"))
}

/// A standard deviation, printed after a mean; empty for few values, for which it is unreliable.
fn plus_minus(sd: Option<f64>, n: usize) -> String {
    sd.filter(|_| n >= SPREAD_FROM).map_or(String::new(), |sd| format!(" ± {sd:.3}"))
}

/// The result of a computed division: χ, or the outcome if there is no χ, or a dash if it is unknown.
fn ended(chi: Option<f64>, outcome: Option<Outcome>) -> String {
    let outcome = || outcome.map_or("-".to_owned(), |outcome| outcome.name().to_owned());
    chi.map_or_else(outcome, |chi| format!("{chi:.3}"))
}

/// Trees of several lineages with the parameters of the command, in one run.
fn trees_of(lineages: Vec<Lineage>, memo: &Memo, context: &Context) -> Result<Vec<Tree>, CliError> {
    // Up to here only files were read, and Ctrl-C stops the command immediately.
    interrupt::finish();
    context.settings.check_divisions("settings")?;
    context.check_taken(&lineages.iter().collect::<Vec<_>>(), [])?;
    let units = lineages.first().map_or(Units::default(), Lineage::units);
    let scenarios = scenarios_of(lineages, &context.settings_in(&units)?, context.quantisation);
    Ok(grown(&scenarios, None, false, memo, context)?.0.trees)
}
