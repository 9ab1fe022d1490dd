//! `furrow steady`: one stationary shape and its stability.

use super::cell::ActiveCellArgs;
use super::context::Context;
use super::error::CliError;
use super::output::{merged, print_as};
use clap::Args;
use furrow_cell::Cell;
use furrow_mechanics::equilibria::stationary;
use furrow_report::stationary_report;
use serde_json::json;
use std::fmt::Write;

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  furrow steady --r0 2
  furrow steady --r0 2 --xi 15 --epsilon 0.8 --json
  furrow steady --r0 2 --xi 15 --cue germline
  furrow steady --r0 1.65 --cue regulator:none,turnover=10,diffusion=1,activity=0.3")]
pub struct SteadyArgs {
    #[command(flatten)]
    cell: ActiveCellArgs,
}

pub fn run(args: &SteadyArgs, mut context: Context) -> Result<(), CliError> {
    let cell = args.cell.read(&mut context)?;
    let shape = stationary(&cell, &context.settings.numerics)?;
    let spectrum = shape.spectrum()?;
    let Cell { r0, epsilon, xi_s, cue, .. } = &shape.cortex.cell;
    let found = stationary_report(&shape, &spectrum);
    let document = merged(json!({ "r0": r0, "epsilon": epsilon, "xi_s": xi_s, "cue": cue }), found);
    print_as(context.json, &document, || {
        let verdict = if spectrum.is_stable() { "stable" } else { "unstable" };
        let mut out = format!("R0 = {r0}, ε = {epsilon}, ξ_s = {xi_s}: {verdict}\n");
        let (l, p, h) = (shape.length(), shape.pressure(), shape.elongation());
        let _ = writeln!(out, "L = {l:.6}, p = {p:.6}, H = {h:.6}, equator radius {:.6}", shape.equator_radius());
        if let (Some(middle), Some(pole)) = (shape.regulator_at(0.5), shape.regulator_at(0.0)) {
            let _ = writeln!(out, "regulator φ = {middle:.5} at u = 0.5, {pole:.5} at u = 0");
        }
        out += "growth rates (1/τ):\n";
        for rate in &spectrum.values {
            let imaginary = if rate.im == 0.0 { String::new() } else { format!(" {:+.6}i", rate.im) };
            let _ = writeln!(out, "  {:>14.6}{imaginary}  {}", rate.re, format!("{:?}", rate.parity).to_lowercase());
        }
        if !shape.folds.is_empty() {
            let folds: Vec<String> = shape.folds.iter().map(|x| format!("{x:.5}")).collect();
            let _ = writeln!(out, "reached after folds at ξ_s = {}", folds.join(", "));
        }
        out
    })
}
