//! `furrow calibrate`: constants from thresholds.

use super::context::Context;
use super::ensemble::sample;
use super::error::CliError;
use super::output::print_as;
use super::picture::PlotArgs;
use clap::Args;
use furrow_analysis::{Exclusion, check_constraints};
use furrow_figures::plot;
use furrow_input::{parse_document, read_text};
use furrow_mechanics::calibration::{Calibration, Targets, calibrate};
use serde_json::{Value, json};
use std::fmt::Write;
use std::path::PathBuf;

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  furrow calibrate data/thresholds.ron --set intervals=32
  furrow calibrate data/thresholds.ron --set stages=3 --set intervals=32 --plot calibrate.svg --json")]
pub struct CalibrateArgs {
    /// File of unknowns and thresholds, such as data/thresholds.ron
    #[arg(value_name = "TARGETS.ron")]
    targets: PathBuf,
    /// Samples N sets of constants that agree with the targets, instead of finding the best fit
    #[arg(help_heading = "Ensemble", long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=100_000))]
    ensemble: Option<u32>,
    /// Seed of the sample
    #[arg(help_heading = "Ensemble", long, value_name = "S", default_value_t = 0, requires = "ensemble")]
    seed: u64,
    /// File for the sample, for furrow tree --constants; default stdout
    #[arg(help_heading = "Ensemble", long, value_name = "FILE.csv", requires = "ensemble")]
    out: Option<PathBuf>,
    #[command(flatten)]
    plot: PlotArgs,
}

pub fn run(args: &CalibrateArgs, context: &Context) -> Result<(), CliError> {
    let file = args.targets.display().to_string();
    let targets: Targets = parse_document(&read_text(&args.targets)?, &file, "a file of targets", "Targets")?;
    targets.check(&file)?;
    let picture = args.plot.file()?;
    if let Some(count) = args.ensemble {
        return sample(&targets, context, count as usize, args.seed, args.out.as_deref(), &picture);
    }
    let found = calibrate(&targets, &context.settings.cell, &context.settings.numerics)?;
    let excluded = check_constraints(&targets, &found.cell, &context.settings.numerics, true).excluded;
    picture.write(|| plot::calibration::draw(&targets, &found, &excluded))?;
    let parameters = found.parameters.iter().map(|(parameter, value)| (parameter.to_string(), Value::from(*value)));
    // `combinations` are in the order of the parameters, `excluded` are statements of the targets that these contradict.
    let document = json!({
        "parameters": parameters.collect::<serde_json::Map<_, _>>(),
        "residuals": found.residuals,
        "rms": found.rms,
        "combinations": found.combinations,
        "iterations": found.iterations,
        "excluded": excluded,
    });
    print_as(context.json, &document, || text(&found, &excluded))
}

fn text(found: &Calibration, excluded: &[Exclusion]) -> String {
    let mut out = String::new();
    for (parameter, value) in &found.parameters {
        let _ = writeln!(out, "{:<10} {value:.9}", parameter.to_string());
    }
    let _ = writeln!(out, "\n{:>8} {:>8} {:>12} {:>12} {:>10}", "R0", "ε", "ξ_s* given", "computed", "deviation");
    for r in &found.residuals {
        let percent = 100.0 * r.relative;
        let _ = writeln!(out, "{:>8} {:>8} {:>12} {:>12.6} {percent:>8.4} %", r.r0, r.epsilon, r.xi_s, r.computed);
    }
    let _ = writeln!(out, "rms deviation {:.3e}, {} steps", found.rms, found.iterations);
    let _ = writeln!(out, "\nrelative change of the thresholds per relative change of the constants, by combination:");
    for c in &found.combinations {
        let parts: Vec<String> =
            c.components.iter().zip(&found.parameters).map(|(x, (p, _))| format!("{x:+.3} {p}")).collect();
        let verdict = if c.determined { "" } else { "  (undetermined)" };
        let _ = writeln!(out, "{:>10.2e}  {}{verdict}", c.singular_value, parts.join(" "));
    }
    for Exclusion { datum, given, computed } in excluded {
        let _ = writeln!(out, "\nexcluded by {datum}: {given}; computed: {computed}");
    }
    out
}
