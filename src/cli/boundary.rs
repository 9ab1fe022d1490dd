//! `furrow boundary`: curves of pitchforks and folds, and the critical radius.

use super::cell::set;
use super::context::Context;
use super::error::CliError;
use super::interrupt::write_deferred;
use super::output::{csv_of, filled, number, print_as, to_json, writable_file};
use super::picture::PlotArgs;
use super::steady::MOST_AZIMUTHAL;
use super::vary::{Varied, VaryArgs};
use clap::Args;
use furrow_cell::{Cell, Cue, Numerics, Parameter};
use furrow_figures::plot::boundary::{self, Boundary};
use furrow_formats::write_atomically;
use furrow_input::InputError;
use furrow_mechanics::critical::{self, Stored};
use furrow_mechanics::equilibria::azimuthal_threshold::threshold_curve;
use furrow_mechanics::equilibria::curves::{self, Curve, CurveEnd, CurvePoint};
use furrow_mechanics::equilibria::{PointKind, StepBudget};
use serde_json::{Value, json};
use std::path::PathBuf;

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  furrow boundary --vary r0 --from 1.7 --to 2 --no-folds
  furrow boundary --vary r0 --from 1.6 --to 1.9 --critical --no-folds --json
  furrow boundary --vary r0 --from 1.6 --to 1.9 --no-folds --azimuthal 1 --plot all.svg
  furrow boundary --vary epsilon --from 0.85 --to 0.9 --r0 2 --no-folds")]
pub struct BoundaryArgs {
    #[command(flatten)]
    vary: VaryArgs,
    /// Activity ξ_s of --critical
    #[arg(help_heading = "Cell", long, value_name = "X", allow_negative_numbers = true, value_parser = number)]
    xi: Option<f64>,
    /// Solves for the value at which the boundary lies at the cell's own activity
    #[arg(help_heading = "Output", long)]
    critical: bool,
    /// Skips the folds of the symmetric shapes
    #[arg(help_heading = "Output", long)]
    no_folds: bool,
    /// Also follows the activity from which disturbances cos mφ, m = 1 to M, grow, which are not axisymmetric
    #[arg(help_heading = "Output", long, value_name = "M", value_parser = clap::value_parser!(u8).range(1..=MOST_AZIMUTHAL))]
    azimuthal: Option<u8>,
    /// Stores the boundary over R0, with the critical radii of all cues of the lineage
    #[arg(help_heading = "Output", long, value_name = "FILE.json")]
    write: Option<PathBuf>,
    /// Prints every point of the curves instead of a summary
    #[arg(help_heading = "Output", long)]
    points: bool,
    /// Writes every point of the curves as CSV
    #[arg(help_heading = "Output", long, value_name = "FILE.csv")]
    csv: Option<PathBuf>,
    #[command(flatten)]
    plot: PlotArgs,
}

/// The columns of `--csv`.
const HEADER: &str = "curve,r0,epsilon,value,xi_s,H,criticality,coefficient";

/// A point of a curve, which is named if there are several; `value` is that of the parameter that varies.
fn described(curve: impl Into<Value>, p: &CurvePoint) -> Value {
    filled(json!({
        "curve": curve.into(), "r0": p.r0, "epsilon": p.epsilon, "value": p.value, "xi_s": p.xi_s, "H": p.elongation,
        "criticality": p.criticality(), "coefficient": p.coefficient,
    }))
}

pub fn run(args: &BoundaryArgs, mut context: Context) -> Result<(), CliError> {
    set(&mut context.settings, [("--xi", "xi_s", args.xi)])?;
    let varied = args.vary.read(&mut context)?;
    args.check(&varied)?;
    let picture = args.plot.file()?;
    let Varied { cell, parameter, range } = &varied;
    let numerics = &context.settings.numerics;
    if let Some(path) = &args.write {
        let cues: Vec<Cue> = args.vary.cue.lineage()?.cues.into_values().filter(|cue| !cue.is_none()).collect();
        let stored = Stored::compute(cell, numerics, &[vec![Cue::none()], cues].concat(), *range)?;
        write_deferred(path, to_json(&stored)?.as_bytes())?;
    }
    let (kind, mut found) = curves::boundary_curves(cell, numerics, *parameter, *range)?;
    let (pitchfork, folds) = match kind {
        PointKind::Pitchfork if args.no_folds => (found.remove(0), Vec::new()),
        PointKind::Pitchfork => (found.remove(0), curves::fold_curves(cell, numerics, *parameter, *range)?),
        _ => (Curve::default(), found),
    };
    let critical = args.critical.then(|| critical_point(&varied, numerics)).transpose()?;
    for (k, fold) in folds.iter().enumerate() {
        match &fold.ended {
            CurveEnd::Stopped(error) => tracing::warn!("fold {k} is followed no further: {error}"),
            CurveEnd::Cusp(cusp) if kind != PointKind::Pitchfork => {
                tracing::warn!("fold {k} ends within the range, in a cusp at {parameter} = {:.6}", cusp.value);
            }
            _ => {}
        }
    }
    let azimuthal = args.azimuthal.map(|most| thresholds(cell, numerics, *parameter, *range, usize::from(most)));
    let cusps = &cusps(&folds)[..];
    let (parameter, range, pitchfork, folds) = (*parameter, *range, &pitchfork, &folds[..]);
    let thresholds = azimuthal.as_deref().unwrap_or_default();
    let found = Boundary { cell, parameter, range, pitchfork, folds, cusps, critical, azimuthal: thresholds };
    let named = named(&found);
    if let Some(file) = &args.csv {
        write_atomically(file, &csv_of(HEADER, named.iter().map(|(name, p)| described(name.as_str(), p)))?)?;
    }
    picture.write(|| boundary::draw(&found))?;
    let mut document = document(&found);
    if azimuthal.is_some() {
        document["azimuthal"] = azimuthal_document(thresholds);
    }
    print_as(context.json, &document, || if args.points { list(&named) } else { text(&found) })
}

/// The thresholds of disturbances of azimuthal number 1 … `most`, with a warning for each that is not found or not to its end.
pub fn thresholds(
    cell: &Cell,
    numerics: &Numerics,
    parameter: Parameter,
    range: [f64; 2],
    most: usize,
) -> Vec<(usize, Curve)> {
    let mut found = Vec::new();
    for m in 1..=most {
        match threshold_curve(cell, numerics, parameter, range, m) {
            Ok(curve) => {
                curve.error().iter().for_each(|error| tracing::warn!("{error}"));
                found.push((m, curve));
            }
            Err(error) => tracing::warn!("no threshold for m = {m}: {error}"),
        }
    }
    found
}

/// What `--json` prints of them.
fn azimuthal_document(curves: &[(usize, Curve)]) -> Value {
    let of = |m: usize, p: &CurvePoint| json!({ "m": m, "r0": p.r0, "epsilon": p.epsilon, "value": p.value, "xi_s": p.xi_s, "H": p.elongation });
    curves.iter().flat_map(|(m, curve)| curve.points.iter().map(move |p| of(*m, p))).collect()
}

/// Where the boundary lies at the cell's activity. Along R0 it is the critical radius of a tree, from wherever the range begins; a
/// warning says if smaller cells divide all the same.
fn critical_point(varied: &Varied, numerics: &Numerics) -> Result<CurvePoint, CliError> {
    let Varied { cell, parameter, range: [from, to] } = varied;
    let budget = StepBudget::unlimited();
    if *parameter != Parameter::R0 {
        let starts = [0.5 * (from + to), *from, *to];
        return Ok(critical::critical_value(cell, numerics, *parameter, &starts, &budget)?.1);
    }
    let (kind, point) = critical::critical_value(cell, numerics, *parameter, &critical::STARTS, &budget)?;
    if let Err(error) = critical::rests_from(cell, numerics, (kind, point.value), None) {
        tracing::warn!("{error}");
    }
    Ok(point)
}

/// The cusps of fold curves, each of which two curves lead to.
fn cusps(folds: &[Curve]) -> Vec<CurvePoint> {
    let mut cusps: Vec<CurvePoint> = Vec::new();
    for cusp in folds.iter().filter_map(Curve::cusp) {
        let same =
            |c: &CurvePoint| (c.value - cusp.value).abs() + (c.xi_s - cusp.xi_s).abs() < 1e-6 * (1.0 + cusp.xi_s.abs());
        if !cusps.iter().any(same) {
            cusps.push(cusp);
        }
    }
    cusps
}

impl BoundaryArgs {
    fn check(&self, varied: &Varied) -> Result<(), InputError> {
        let [from, to] = varied.range;
        InputError::require(from != to, "--to", "to", to, "different from --from")?;
        let fine = self.write.is_none() || varied.parameter == Parameter::R0;
        InputError::require(fine, "--write", "vary", varied.parameter, "r0: what is stored is a boundary over R0")?;
        writable_file("--csv", self.csv.as_deref())?;
        writable_file("--write", self.write.as_deref())
    }
}

/// What `--json` prints.
fn document(found: &Boundary<'_>) -> Value {
    let points = |points: &[CurvePoint]| points.iter().map(|p| described(Value::Null, p)).collect::<Vec<_>>();
    let folds = || found.folds.iter().enumerate();
    let end = |(curve, fold): (usize, &Curve)| {
        let value = fold.cusp().or(fold.points.last().copied()).map_or(f64::NAN, |point| point.value);
        json!({ "curve": curve, "value": value, "reason": fold.ended.name() })
    };
    let mut document = json!({
        "vary": found.parameter.to_string(),
        "cue": found.cell.cue,
        "pitchfork": points(&found.pitchfork.points),
        "degenerate": points(&degenerate(found)),
        "folds": folds().flat_map(|(k, fold)| fold.points.iter().map(move |p| described(k, p))).collect::<Vec<_>>(),
        "ends": folds().map(end).collect::<Vec<_>>(),
        "cusps": points(found.cusps),
        "critical": found.critical.map(|point| point.value),
    });
    if let Some(point) = &found.critical {
        document["critical_point"] = described(Value::Null, point);
    }
    document
}

/// Where criticality changes; such points are neither sub- nor supercritical.
fn degenerate(found: &Boundary<'_>) -> Vec<CurvePoint> {
    found.pitchfork.degenerate.iter().map(|p| CurvePoint { coefficient: None, ..*p }).collect()
}

/// All points, each with the name of its curve.
fn named(found: &Boundary<'_>) -> Vec<(String, CurvePoint)> {
    let folds = found.folds.iter().enumerate().map(|(k, fold)| (format!("fold {k}"), fold.points.clone()));
    let before =
        [("pitchfork".to_owned(), found.pitchfork.points.clone()), ("degenerate".to_owned(), degenerate(found))];
    let after = [("cusp".to_owned(), found.cusps.to_vec()), ("critical".to_owned(), Vec::from_iter(found.critical))];
    let azimuthal = found.azimuthal.iter().map(|(m, curve)| (format!("m = {m}"), curve.points.clone()));
    let curves = before.into_iter().chain(folds).chain(azimuthal).chain(after);
    curves.flat_map(|(name, points)| points.into_iter().map(move |point| (name.clone(), point))).collect()
}

const HEADING: &str = "curve              R0         ε      value         ξ_s         H\n";

/// Every point.
fn list(named: &[(String, CurvePoint)]) -> String {
    named.iter().fold(HEADING.to_owned(), |out, (name, point)| out + &line(name, point))
}

/// Every curve by its two ends, and the points at which something happens.
fn text(found: &Boundary<'_>) -> String {
    let ends = |name: &str, curve: &Curve| {
        let (Some(first), Some(last)) = (curve.points.first(), curve.points.last()) else { return String::new() };
        let how = match &curve.ended {
            CurveEnd::Reached => String::new(),
            ended => format!("; {} at {:.6}", ended.name(), curve.cusp().unwrap_or(*last).value),
        };
        format!("{}{}  in {} points{how}\n", line(name, first), line("  to", last), curve.points.len())
    };
    let pitchfork = Curve { ended: CurveEnd::Reached, ..found.pitchfork.clone() };
    let folds = found.folds.iter().enumerate().map(|(k, fold)| ends(&format!("fold {k}"), fold));
    let events =
        named(found).into_iter().filter(|(name, _)| ["degenerate", "cusp", "critical"].contains(&name.as_str()));
    let events = events.map(|(name, point)| line(&name, &point));
    let azimuthal = found.azimuthal.iter().map(|(m, curve)| ends(&format!("m = {m}"), curve));
    let curves = folds.chain(azimuthal).chain(events);
    [HEADING.to_owned(), ends("pitchfork", &pitchfork)].into_iter().chain(curves).collect()
}

fn line(name: &str, p: &CurvePoint) -> String {
    let CurvePoint { r0, epsilon, value, xi_s, elongation: h, .. } = p;
    let of = p.criticality().map_or(String::new(), |criticality| format!("  {criticality}"));
    format!("{name:<12} {r0:>8.5} {epsilon:>9.6} {value:>10.6} {xi_s:>11.6} {h:>9.6}{of}\n")
}
