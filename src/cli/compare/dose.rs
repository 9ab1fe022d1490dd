//! `furrow compare dose`: asymmetry over the dose of a protein compared with the model's over the strength of its cue.

use std::fmt::Write;
use std::path::PathBuf;

use clap::Args;
use furrow_analysis::compare::dose::{DoseModel, MeasuredDoses, ModelDoses, document, over_dose};
use furrow_figures::plot::dose::{DoseComparison, Reading, draw};
use furrow_input::open_file;
use furrow_lineage::{Length, parse_cue};
use furrow_measured::dose::{DoseGroup, DoseTrend, DosedDivision, Doses, Spread};
use furrow_measured::statistics::{Line, RankCorrelation};

use super::{check_bins, ended, plus_minus, share, significance, skipped_text};
use crate::cli::cell::{length, load_lineage, set};
use crate::cli::context::Context;
use crate::cli::error::CliError;
use crate::cli::interrupt;
use crate::cli::output::{number, print_as};
use crate::cli::picture::PlotArgs;

/// Compares asymmetry over the dose of a protein with the model's over the strength of its cue
///
/// A table has the columns dose (or a name that ends in _dose or _dosage; 1 is the wild type) and larger_share, the larger
/// daughter's share of the total size, and optionally condition. Without a table the model is compared with published means
/// over the dose of PAR-6. The model's cell has its full cue at dose 1 and no cue at 0. Sizes are interpreted as areas and as volumes.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  furrow compare dose
  furrow compare dose --preset sulston1983 --plot dose.svg --json")]
pub struct DoseArgs {
    /// Table of doses, CSV
    #[arg(value_name = "FILE")]
    file: Option<PathBuf>,
    /// Edges of the bins of the dose, in ascending order; default bins are 0.2 wide
    #[arg(help_heading = "Statistics", long, value_name = "D,D,..", value_delimiter = ',', value_parser = number, requires = "file")]
    bins: Option<Vec<f64>>,
    /// Radius R0 of the model's cell, in L_h, or in µm, such as 17um; default the first cell's, 5.4 in gao2026
    #[arg(help_heading = "Model", long, value_name = "R", value_parser = length)]
    r0: Option<Length>,
    /// Cue at dose 1, as for furrow divide
    #[arg(help_heading = "Model", long, value_name = "CUE", default_value = "germline")]
    cue: String,
    /// Lineage file with named cues; default the built-in one
    #[arg(help_heading = "Model", long, value_name = "LINEAGE.ron")]
    lineage: Option<PathBuf>,
    #[command(flatten)]
    plot: PlotArgs,
}

pub fn run(args: &DoseArgs, context: &Context) -> Result<(), CliError> {
    let picture = args.plot.file()?;
    let measured = read(args)?;
    let (r0, model) = model(args, &measured, context)?;
    let cell = format!("R0 = {r0}, cue {}", args.cue);
    picture.write(|| {
        let MeasuredDoses { doses, conditions, bins, trend, .. } = &measured;
        let area = Reading {
            name: "areas",
            chi: DosedDivision::chi_area,
            mean_sd: |bin| (bin.chi_area.mean, bin.chi_area.sd),
            line: trend.chi_area,
        };
        let volume = Reading {
            name: "volumes",
            chi: DosedDivision::chi_volume,
            mean_sd: |bin| (bin.chi_volume.mean, bin.chi_volume.sd),
            line: trend.chi_volume,
        };
        let (divisions, readings, cell) = (&doses.divisions[..], [area, volume], cell.clone());
        draw(&DoseComparison { divisions, conditions, bins, readings, model: &model.curve, cell })
    })?;
    print_as(context.json, &document(&measured, &model, (r0, &args.cue)), || text(&measured, &model, &cell))
}

fn read(args: &DoseArgs) -> Result<MeasuredDoses, CliError> {
    check_bins(args.bins.as_deref())?;
    let Some(file) = &args.file else { return Ok(MeasuredDoses::published()?) };
    let doses = Doses::read(open_file(file)?, &file.display().to_string())?;
    Ok(MeasuredDoses::of(doses, args.bins.as_deref()))
}

/// The radius of the model's cell and its divisions.
fn model(args: &DoseArgs, measured: &MeasuredDoses, context: &Context) -> Result<(f64, ModelDoses), CliError> {
    let lineage = load_lineage(args.lineage.as_deref())?;
    let cue = parse_cue(&args.cue, &lineage)?;
    let mut settings = context.settings_in(&lineage.units())?;
    let r0 = args.r0.map(|r0| r0.in_units(&lineage.units()));
    set(&context.globals, &mut settings, [("--r0", "r0", r0)])?;
    settings.check_divisions("settings")?;
    interrupt::finish();
    let memo = context.memo()?;
    let model =
        context.scheduled(|options| over_dose(&settings.cell, &cue, measured, settings.numerics, &memo, options))?;
    Ok((settings.cell.r0, model))
}

fn text(measured: &MeasuredDoses, model: &ModelDoses, cell: &str) -> String {
    let MeasuredDoses { source, doses, conditions, bins, trend } = measured;
    let mut out = match source {
        Some(source) => format!("measured: means published by {source}\n\n"),
        None => format!("{} divisions used, {} rows skipped\n", doses.divisions.len(), doses.skipped_count),
    };
    out += &skipped_text(&[(&doses.skipped, doses.skipped_count)]);
    let head = |first: &str| format!("{first:<12}   n          dose    larger share  χ (as areas)  χ (as volumes)");
    let _ = writeln!(out, "{}", head("condition"));
    for group in conditions {
        let _ = writeln!(out, "{}", row(group));
    }
    let _ = writeln!(out, "\n{}   model", head("doses"));
    for (group, model) in bins.iter().zip(&model.by_bin) {
        let _ = writeln!(out, "{}   {}", row(group), ended(model.chi, model.outcome));
    }
    let outside = measured.outside_bins();
    if outside > 0 {
        let _ = writeln!(out, "divisions with doses outside the bins: {outside}");
    }
    out + "\n" + &trend_text(trend) + &model_text(model, cell)
}

fn row(group: &DoseGroup) -> String {
    let DoseGroup { name, n, dose, larger_share, chi_area, chi_volume } = group;
    let spread = |Spread { mean, sd }: &Spread| format!("{mean:.3}{}", plus_minus(*sd, *n));
    let [dose, share, area, volume] = [dose, larger_share, chi_area, chi_volume].map(spread);
    format!("{name:<12}{n:>4} {dose:>13} {share:>15} {area:>13} {volume:>15}")
}

fn trend_text(trend: &DoseTrend) -> String {
    let mut out = String::new();
    if let Some(RankCorrelation { n, rho, p, .. }) = trend.spearman {
        let _ = writeln!(out, "Trend of {n} divisions: Spearman ρ = {rho:+.3}, p = {p:.3e}");
    }
    for (name, line) in [
        ("larger share", trend.larger_share),
        ("χ, sizes as areas", trend.chi_area),
        ("χ, sizes as volumes", trend.chi_volume),
    ] {
        let Some(line) = line else { continue };
        let Line { slope, slope_error, intercept, intercept_error, r_squared, .. } = line;
        let error = intercept_error.unwrap_or_default();
        let _ = writeln!(
            out,
            "  {name}: slope {slope:+.4} ± {slope_error:.4}{}, at dose 0 {intercept:.4} ± {error:.4}, R² = {}",
            significance(&line),
            share(r_squared, 3)
        );
    }
    out
}

fn model_text(model: &ModelDoses, cell: &str) -> String {
    let at =
        |dose: f64| {
            let nearest = |point: &&DoseModel| (point.dose - dose).abs();
            model.curve.iter().min_by(|a, b| nearest(a).total_cmp(&nearest(b))).map_or(String::new(), |point| {
                format!("χ = {} at dose {:.3}", ended(point.chi, point.outcome), point.dose)
            })
        };
    format!("Model, {cell}, amplitude × dose: {}, {}\n", at(0.0), at(1.0))
}
