//! `furrow calibrate`: constants from thresholds.

use super::context::Context;
use super::ensemble::{SampleFiles, sample};
use super::error::CliError;
use super::output::answer;
use super::plot::PlotArgs;
use crate::calibration::{Calibration, Combination, Targets, ThresholdResidual, calibrate};
use crate::input::{parse_document, read_text};
use crate::study::{Exclusion, check_constraints};
use clap::Args;
use serde::Serialize;
use serde_json::{Map, Value};
use std::fmt::Write;
use std::path::PathBuf;

/// Finds material and shell constants from measured thresholds, and says what the thresholds leave open
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  furrow calibrate data/thresholds.ron --set intervals=32
  furrow calibrate data/thresholds.ron --set stages=3 --set intervals=32 --plot calibrate.svg --json")]
pub struct CalibrateArgs {
    /// Unknowns and thresholds in RON, as in data/thresholds.ron
    #[arg(value_name = "TARGETS.ron")]
    targets: PathBuf,
    /// Samples so many sets of constants that agree with the targets, instead of the one that fits best
    #[arg(help_heading = "Ensemble", long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=100_000))]
    ensemble: Option<u32>,
    /// Seed of the sample
    #[arg(help_heading = "Ensemble", long, value_name = "S", default_value_t = 0, requires = "ensemble")]
    seed: u64,
    /// File for the sample, as furrow tree --constants reads it; default stdout
    #[arg(help_heading = "Ensemble", long, value_name = "FILE.csv", requires = "ensemble")]
    out: Option<PathBuf>,
    #[command(flatten)]
    plot: PlotArgs,
}

/// What `--json` prints.
#[derive(Serialize)]
struct Answer {
    parameters: Map<String, Value>,
    residuals: Vec<ThresholdResidual>,
    rms: f64,
    /// In the order of `parameters`.
    combinations: Vec<Combination>,
    iterations: usize,
    /// Statements of the targets that are not true of these constants.
    excluded: Vec<Exclusion>,
}

pub fn run(args: &CalibrateArgs, context: &Context) -> Result<(), CliError> {
    let file = args.targets.display().to_string();
    let targets: Targets = parse_document(&read_text(&args.targets)?, &file, "a file of targets", "Targets")?;
    targets.check(&file)?;
    let picture = args.plot.file()?;
    if let Some(count) = args.ensemble {
        let files = SampleFiles { table: args.out.as_deref(), picture: picture.as_ref() };
        return sample(&targets, context, count as usize, args.seed, &files);
    }
    let found = calibrate(&targets, &context.settings.cell, &context.settings.numerics)?;
    let excluded = check_constraints(&targets, &found.cell, &context.settings.numerics, true).excluded;
    if let Some(picture) = picture {
        picture.write(&crate::plot::calibration::draw(&targets, &found, &excluded))?;
    }
    if context.json {
        let parameters = found.parameters.iter().map(|(parameter, value)| (parameter.to_string(), Value::from(*value)));
        let document = Answer {
            parameters: parameters.collect(),
            residuals: found.residuals,
            rms: found.rms,
            combinations: found.combinations,
            iterations: found.iterations,
            excluded,
        };
        answer(&format!("{}\n", serde_json::to_string_pretty(&document)?))
    } else {
        answer(&text(&found, &excluded))
    }
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
    let _ = writeln!(out, "\nchange of the thresholds per change of the constants, both relative, by combination:");
    for c in &found.combinations {
        let parts: Vec<String> =
            c.components.iter().zip(&found.parameters).map(|(x, (p, _))| format!("{x:+.3} {p}")).collect();
        let verdict = if c.determined { "" } else { "  (left open)" };
        let _ = writeln!(out, "{:>10.2e}  {}{verdict}", c.singular_value, parts.join(" "));
    }
    for Exclusion { datum, given, computed } in excluded {
        let _ = writeln!(out, "\nexcluded by {datum}: {given}; computed: {computed}");
    }
    out
}
