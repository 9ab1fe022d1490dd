//! `furrow steady`: one stationary shape and its stability.

use super::cell::ActiveCellArgs;
use super::prelude::*;
use furrow_cell::Cue;
use furrow_mechanics::equilibria::{StationaryShape, stationary};
use furrow_mechanics::stability::Spectrum;
use furrow_report::StationaryReport;

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  furrow steady --r0 2
  furrow steady --r0 2 --xi 15 --epsilon 0.8 --json
  furrow steady --r0 2 --xi 15 --cue germline")]
pub struct SteadyArgs {
    #[command(flatten)]
    cell: ActiveCellArgs,
}

/// What `--json` prints; lengths in L_h, p in κ0/L_h³, growth rates in 1/τ.
#[derive(Serialize)]
struct Answer {
    r0: f64,
    epsilon: f64,
    xi_s: f64,
    cue: Cue,
    #[serde(flatten)]
    found: StationaryReport,
}

pub fn run(args: &SteadyArgs, mut context: Context) -> Result<(), CliError> {
    let cell = args.cell.read(&mut context)?;
    let shape = stationary(&cell, &context.settings.numerics)?;
    let spectrum = shape.spectrum()?;
    let document = describe(&shape, &spectrum);
    print_as(context.json, &document, || text(&document))
}

fn describe(shape: &StationaryShape, spectrum: &Spectrum) -> Answer {
    let cell = &shape.cortex.cell;
    Answer {
        r0: cell.r0,
        epsilon: cell.epsilon,
        xi_s: cell.xi_s,
        cue: cell.cue.clone(),
        found: StationaryReport::new(shape, spectrum),
    }
}

fn text(d: &Answer) -> String {
    let mut out = String::new();
    let found = &d.found;
    let verdict = if found.stable { "stable" } else { "unstable" };
    let _ = writeln!(out, "R0 = {}, ε = {}, ξ_s = {}: {verdict}", d.r0, d.epsilon, d.xi_s);
    let _ =
        writeln!(out, "L = {:.6}, p = {:.6}, H = {:.6}, equator radius {:.6}", found.L, found.p, found.H, found.r_eq);
    let _ = writeln!(out, "growth rates (1/τ):");
    for rate in &found.growth_rates {
        let imaginary = if rate.im == 0.0 { String::new() } else { format!(" {:+.6}i", rate.im) };
        let _ = writeln!(out, "  {:>14.6}{imaginary}  {}", rate.re, rate.parity);
    }
    if !found.folds_passed.is_empty() {
        let folds: Vec<String> = found.folds_passed.iter().map(|x| format!("{x:.5}")).collect();
        let _ = writeln!(out, "reached after folds at ξ_s = {}", folds.join(", "));
    }
    out
}
