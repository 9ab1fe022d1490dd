//! `furrow calibrate`: constants from thresholds.

use super::context::Context;
use super::ensemble::{journal_beside, sample, told_of_resuming};
use super::error::CliError;
use super::interrupt;
use super::messages;
use super::output::{print_as, to_json, writable_file};
use super::picture::PlotArgs;
use super::progress::ProgressLine;
use clap::Args;
use furrow_analysis::fit::Goodness;
use furrow_analysis::{Exclusion, Extent, Front, check_constraints, front};
use furrow_cell::Parameter;
use furrow_cell::settings::Settings;
use furrow_figures::plot;
use furrow_formats::{Provenance, write_atomically};
use furrow_input::{parse_document, read_text};
use furrow_mechanics::calibration::{Calibration, Targets, Unknown, calibrate};
use serde_json::{Value, json};
use std::fmt::Write;
use std::path::{Path, PathBuf};

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  furrow calibrate data/thresholds.ron --set intervals=32
  furrow calibrate data/statements.ron --front 40 --set intervals=32
  furrow calibrate data/thresholds.ron --set stages=3 --set intervals=32 --plot calibrate.svg --json")]
pub struct CalibrateArgs {
    /// File of unknowns and thresholds, such as data/thresholds.ron
    #[arg(value_name = "TARGETS.ron")]
    targets: PathBuf,
    /// Samples N sets of constants that agree with the targets, instead of finding the best fit
    #[arg(help_heading = "Ensemble", long, value_name = "N", group = "search",
        value_parser = clap::value_parser!(u32).range(1..=100_000))]
    ensemble: Option<u32>,
    /// Searches among N sets of constants for the front: the least worst threshold for each number of statements met
    #[arg(help_heading = "Front", long, value_name = "N", group = "search", conflicts_with = "plot",
        value_parser = clap::value_parser!(u32).range(1..=10_000_000))]
    front: Option<u32>,
    /// Constants to vary, in place of the file's; each starts at its present value
    #[arg(help_heading = "Parameters", long, value_name = "NAME,..", value_delimiter = ',')]
    unknowns: Option<Vec<Parameter>>,
    /// Seed of the sample or of the search
    #[arg(help_heading = "Ensemble", long, value_name = "S", default_value_t = 0, requires = "search")]
    seed: u64,
    /// File for the sample, for furrow tree --constants, or for the front, as JSON; default stdout. With it an interrupted run
    /// resumes
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
    if let Some(count) = args.ensemble {
        return sample(&targets, context, count as usize, args.seed, args.out.as_deref(), &picture);
    }
    if let Some(count) = args.front {
        return search(&targets, context, count as usize, args.seed, args.out.as_deref());
    }
    let found = calibrate(&targets, &context.settings.cell, &context.settings.numerics)?;
    let excluded =
        check_constraints(&targets, &found.cell, &context.settings.numerics, Extent::Within(f64::INFINITY)).excluded;
    picture.write(|| plot::calibration::draw(&targets, &found, &excluded))?;
    let goodness = Goodness::of_thresholds(&targets, &found);
    let parameters = found.parameters.iter().map(|(parameter, value)| (parameter.to_string(), Value::from(*value)));
    // `combinations` are in the order of the parameters, `excluded` are statements of the targets that these contradict.
    let document = json!({
        "parameters": parameters.collect::<serde_json::Map<_, _>>(),
        "residuals": found.residuals,
        "rms": found.rms,
        "goodness": goodness,
        "combinations": found.combinations,
        "iterations": found.iterations,
        "excluded": excluded,
    });
    print_as(context.json, &document, || text(&found, goodness, &excluded))
}

/// Searches for the front and prints it.
fn search(targets: &Targets, context: &Context, count: usize, seed: u64, out: Option<&Path>) -> Result<(), CliError> {
    writable_file("--out", out)?;
    let Settings { cell, numerics } = &context.settings;
    let definition = json!({
        "schema": "furrow.front", "provenance": Provenance::current(), "targets": targets, "cell": cell, "numerics": numerics,
        "checked": count, "seed": seed,
    });
    let journal = journal_beside(out, &definition)?;
    let line = ProgressLine::new(context.progress);
    let shown = |done, of| line.show_share(done, of, || "sets of constants checked".to_owned());
    let flag = interrupt::flag();
    let found = front(targets, cell, numerics, count, seed, context.threads, flag, journal.as_ref(), &shown);
    drop(line);
    let found = told_of_resuming(found, out)?;
    if let Some(file) = out {
        write_atomically(file, to_json(&serde_json::to_value(&found)?)?.as_bytes())?;
    }
    if let Some(journal) = journal {
        journal.finish().unwrap_or_else(|error| messages::warning!("the file of checked sets: {error}"));
    }
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

fn text(found: &Calibration, goodness: Goodness, excluded: &[Exclusion]) -> String {
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
