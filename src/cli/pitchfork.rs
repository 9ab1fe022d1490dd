//! `furrow pitchfork`: the symmetry-breaking threshold of one cell.

use super::cell::{CellArgs, described, positive};
use super::context::Context;
use super::error::CliError;
use super::output::{filled, merged, number, print_as};
use clap::Args;
use furrow_cell::Cell;
use furrow_mechanics::equilibria::{BranchOptions, pitchfork};
use furrow_report::threshold_report;
use serde_json::json;

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  furrow pitchfork --r0 2
  furrow pitchfork --r0 2.22 --epsilon 0.64 --json")]
pub struct PitchforkArgs {
    #[command(flatten)]
    cell: CellArgs,
    /// Upper limit of ξ_s in the search
    #[arg(help_heading = "Numerics", long, value_name = "X", default_value_t = 100.0, value_parser = number)]
    xi_max: f64,
}

pub fn run(args: &PitchforkArgs, mut context: Context) -> Result<(), CliError> {
    let cell = args.cell.read(&mut context)?;
    let xi_max = positive("--xi-max", args.xi_max)?;
    let options = BranchOptions { xi: [0.0, xi_max], ..BranchOptions::default() };
    let found = pitchfork::first(&cell, &context.settings.numerics, &options)?;
    let Cell { r0, epsilon, cue, .. } = &cell;
    let document = merged(
        filled(json!({ "r0": r0, "r0_um": context.units.micrometres(*r0), "epsilon": epsilon, "cue": cue })),
        threshold_report(&found),
    );
    print_as(context.json, &document, || {
        format!(
            "{}: pitchfork at ξ_s* = {:.8} ({}), H = {:.6}\n\
             ξ_s = ξ_s* + c (u_furrow − ½)² with c = {:.4} on the asymmetric branch\n{}",
            described(&cell, &context.units, None),
            found.point.xi_s,
            found.criticality(),
            found.point.elongation,
            found.coefficient,
            found.beyond_fold.map_or(String::new(), beyond)
        )
    })
}

/// The note about a pitchfork beyond a fold of the branch.
fn beyond(fold: f64) -> String {
    format!(
        "it lies beyond the fold at ξ_s = {fold:.6}, where the branch of the passive shape turns: a cell whose activity rises meets the fold first\n"
    )
}
