//! `furrow calibrate`: constants from thresholds.

use super::context::Context;
use super::ensemble::{SearchOptions, SearchRun, sample};
use super::error::CliError;
use super::output::{print_as, seed, to_json};
use super::picture::PlotArgs;
use clap::Args;
use furrow_analysis::fit::CalibrationStudy;
use furrow_analysis::{Exclusion, Front, front};
use furrow_cell::Parameter;
use furrow_figures::plot;
use furrow_input::{parse_document, read_text};
use furrow_mechanics::calibration::{Targets, Unknown};
use std::fmt::Write;
use std::path::PathBuf;

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  furrow calibrate data/thresholds.ron --set intervals=32
  furrow calibrate data/statements.ron --front 40 --set intervals=32
  furrow calibrate data/thresholds.ron --set intervals=32 --plot calibrate.svg")]
pub struct CalibrateArgs {
    /// File of unknowns and thresholds, such as data/thresholds.ron
    #[arg(value_name = "TARGETS.ron")]
    targets: PathBuf,
    /// Samples N sets of constants that agree with the targets instead of finding the best fit
    #[arg(help_heading = "Ensemble", long, value_name = "N", group = "search",
        value_parser = clap::value_parser!(u32).range(1..=100_000))]
    ensemble: Option<u32>,
    /// Searches N sets of constants for the front: for each number of statements met, the set that minimises the largest deviation of a
    /// threshold
    #[arg(help_heading = "Front", long, value_name = "N", group = "search", conflicts_with = "plot",
        value_parser = clap::value_parser!(u32).range(1..=10_000_000))]
    front: Option<u32>,
    /// Constants to vary instead of those in the file; each starts at its current value
    #[arg(help_heading = "Parameters", long, value_name = "NAME,..", value_delimiter = ',')]
    unknowns: Option<Vec<Parameter>>,
    /// Seed of the sample or of the search
    #[arg(help_heading = "Ensemble", long, value_name = "S", default_value_t = 0, value_parser = seed, requires = "search")]
    seed: u64,
    /// File for the sample, for furrow tree --constants, or for the front, as JSON; default stdout. An interrupted run with this option
    /// can be resumed
    #[arg(help_heading = "Output", long, value_name = "FILE", requires = "search")]
    out: Option<PathBuf>,
    #[command(flatten)]
    plot: PlotArgs,
}

pub fn run(args: &CalibrateArgs, context: &Context) -> Result<(), CliError> {
    let file = args.targets.display().to_string();
    let mut targets: Targets = parse_document(&read_text(&args.targets)?, &file, "a file of targets", "Targets")?;
    if let Some(names) = &args.unknowns {
        targets.unknowns = names.iter().map(|&parameter| Unknown { parameter, start: None }).collect();
    }
    targets.check(&file)?;
    let picture = args.plot.file()?;
    let options = |count: u32| SearchOptions { count: count as usize, seed: args.seed, out: args.out.as_deref() };
    match (args.ensemble, args.front) {
        (Some(count), _) => return sample(&targets, context, &options(count), &picture),
        (_, Some(count)) => return search(&targets, context, &options(count)),
        (None, None) => {}
    }
    let study = CalibrationStudy::of(&targets, &context.settings)?;
    picture.write(|| plot::calibration::draw(&targets, &study.found, &study.excluded))?;
    print_as(context.json, &study, || text(&study))
}

/// Searches for the front and prints it.
fn search(targets: &Targets, context: &Context, search: &SearchOptions<'_>) -> Result<(), CliError> {
    let run = SearchRun { schema: "furrow.front", counted: "checked", progress: "sets of constants checked" };
    let found = run.find(targets, context, search, front, |found| to_json(&serde_json::to_value(found)?))?;
    print_as(context.json, &serde_json::to_value(&found)?, || front_text(&found))
}

fn front_text(found: &Front) -> String {
    let mut out = format!(
        "{} sets of constants checked, {} statements\n\n{:>9} {:>6}",
        found.checked, found.statements, "worst", "met"
    );
    for parameter in &found.parameters {
        let _ = write!(out, " {:>10}", parameter.to_string());
    }
    out.push('\n');
    for member in &found.members {
        let _ = write!(out, "{:>7.3} % {:>6}", 100.0 * member.worst, member.met);
        for value in &member.values {
            let _ = write!(out, " {value:>10.6}");
        }
        out.push('\n');
        for missed in &member.missed {
            let _ = writeln!(out, "{:>17} {missed}", "not");
        }
    }
    out
}

fn text(CalibrationStudy { found, goodness, excluded }: &CalibrationStudy) -> String {
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
    let _ = writeln!(out, "by the tolerances of the thresholds {goodness}");
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
