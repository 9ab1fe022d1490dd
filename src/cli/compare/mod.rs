//! `furrow compare`: the model beside measured embryos.

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
use furrow_lineage::{Lineage, Tree};

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
    interrupt::finish();
    match &args.what {
        What::Counts(args) => counts::run(args, context),
        What::Volumes(args) => volumes::run(args, context),
        What::Lifetimes(args) => lifetimes::run(args, context),
        What::Contour(args) => contour::run(args, context),
        What::Dose(args) => dose::run(args, context),
    }
}

/// Trees of several lineages with the parameters of the command, in one run.
fn trees_of(lineages: Vec<Lineage>, context: &Context) -> Result<Vec<Tree>, CliError> {
    context.settings.check_divisions("settings")?;
    let scenarios = scenarios_of(lineages, &context.settings, context.quantisation);
    Ok(grown(&scenarios, None, false, context)?.0.trees)
}
