//! `furrow branch`: stationary shapes of one cell over activity.

use super::cell::{AxisArgs, CellArgs, described, positive};
use super::context::Context;
use super::error::CliError;
use super::messages;
use super::output::{filled, merged, number, or_dash, print_as, records_csv, writable_file};
use super::picture::PlotArgs;
use super::steady::MOST_AZIMUTHAL;
use clap::Args;
use furrow_analysis::Diagram;
use furrow_analysis::bent::diagram_with_bent;
use furrow_analysis::diagram::reduced_volume;
use furrow_cell::Cell;
use furrow_figures::plot;
use furrow_formats::write_atomically;
use furrow_input::rounded_number;
use furrow_lineage::Units;
use furrow_mechanics::equilibria::azimuthal_scan::Crossing;
use furrow_mechanics::equilibria::{Branch, BranchEnd, BranchOptions, Criticality, HopfPoint, ShapeError, ShapePoint};
use furrow_report::surfaces::bent_report;
use furrow_report::{crossing_report, event_report, hopf_report};
use furrow_surface::bent::{BentBranch, BentPoint, NormalForm};
use serde_json::{Value, json};
use std::fmt::Write;
use std::path::PathBuf;

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  furrow branch --r0 2 --xi-max 30 --plot branch.svg --csv branch.csv
  furrow branch --r0 2.2 --cue germline --xi-max 30 --json
  furrow branch --r0 2 --xi-max 30 --azimuthal 2
  furrow branch --r0 1.4 --xi-max 30 --three-dimensional --plot bent.svg")]
pub struct BranchArgs {
    #[command(flatten)]
    cell: CellArgs,
    #[command(flatten)]
    pub axis: AxisArgs,
    /// Largest ξ_s
    #[arg(help_heading = "Numerics", long, value_name = "X", default_value_t = 100.0, value_parser = number)]
    xi_max: f64,
    /// Ends a branch where the reduced volume falls to V: the volume divided by the volume of a sphere with the same area
    #[arg(help_heading = "Numerics", long, value_name = "V", value_parser = number)]
    reduced_volume: Option<f64>,
    /// Largest step along a branch, in arclength
    #[arg(help_heading = "Numerics", long, value_name = "S", default_value_t = 1.0, value_parser = number)]
    max_step: f64,
    /// Also computes growth rates of disturbances cos mφ, m = 1 to M, at every point, and where they change sign
    #[arg(help_heading = "Numerics", long, value_name = "M", value_parser = clap::value_parser!(u8).range(1..=MOST_AZIMUTHAL))]
    azimuthal: Option<u8>,
    /// Prints every point of the branches, not only folds and pitchforks
    #[arg(help_heading = "Output", long)]
    points: bool,
    /// Writes every point of the branches as CSV
    #[arg(help_heading = "Output", long, value_name = "FILE.csv")]
    csv: Option<PathBuf>,
    #[command(flatten)]
    plot: PlotArgs,
}

/// The columns of `--csv`.
const HEADER: &str = "branch,xi_s,H,L,p,r_eq,stable,growth_rate,delta_u,reduced_volume,bending_energy";

fn point(branch: &str, p: &ShapePoint) -> Value {
    let stable = p.growth_rate.map(|rate| rate < 0.0);
    // The growth rate is absent where it could not be computed; delta_u is null without a furrow.
    let rate = filled(json!({ "stable": stable, "growth_rate": p.growth_rate }));
    let place = json!({
        "branch": branch, "xi_s": p.xi_s, "H": p.elongation, "L": p.length, "p": p.pressure, "r_eq": p.equator_radius,
    });
    let rest = json!({
        "delta_u": p.delta_u, "reduced_volume": p.reduced_volume, "bending_energy": p.bending_energy,
    });
    merged(merged(place, rate), rest)
}

/// The reason why a branch ends. For pinch-off it includes the neck radius of the criterion, in R0.
fn end(name: &str, branch: &Branch) -> Value {
    let neck = match branch.ended {
        BranchEnd::Pinched(neck) => Some(neck),
        _ => None,
    };
    filled(json!({ "branch": name, "xi_s": last(branch), "reason": branch.ended.name(), "neck": neck }))
}

fn last(branch: &Branch) -> f64 {
    branch.points.last().map_or(f64::NAN, |point| point.xi_s)
}

pub fn run(args: &BranchArgs, mut context: Context) -> Result<(), CliError> {
    let cell = args.cell.read(&mut context)?;
    context.check_azimuthal(args.azimuthal)?;
    let picture = args.plot.file()?;
    writable_file("--csv", args.csv.as_deref())?;
    let options = BranchOptions {
        contours: picture.is_wanted(),
        xi: [0.0, positive("--xi-max", args.xi_max)?],
        reduced_volume: reduced_volume("--reduced-volume", args.reduced_volume)?,
        growth_rates: true,
        azimuthal: args.azimuthal.map_or(0, usize::from),
        ..BranchOptions::default()
    };
    let options = options.with_max_step(positive("--max-step", args.max_step)?);
    let numerics = &context.settings.numerics;
    let (found, bent) = diagram_with_bent(&cell, numerics, &options)?;
    messages::warn_of(found.all_warnings());
    let units = context.units;
    let mut document =
        merged(document(&cell, &found, args.max_step), filled(json!({ "r0_um": units.micrometres(cell.r0) })));
    if let Some(bent) = &bent {
        document["bent"] = bent_report(bent);
    }
    if let (Some(file), Some(points)) = (&args.csv, document["points"].as_array()) {
        write_atomically(file, &records_csv(HEADER, points)?)?;
    }
    picture.write(|| plot::branch::draw(&cell, &found.branches, bent.as_ref()))?;
    print_as(context.json, &document, || {
        text((&cell, &units), &found, args.points) + &bent.as_ref().map_or(String::new(), bent_text)
    })
}

/// The threshold of the bent states, their odd pitchfork and their fold.
fn bent_text(bent: &BentBranch) -> String {
    let NormalForm { xi_s, coefficient, .. } = bent.threshold;
    let criticality = Criticality::of(coefficient);
    let mut out = format!("the bent branch begins at ξ_s = {xi_s:.6}: {criticality}\n");
    for (name, point) in [("odd pitchfork", &bent.pitchfork), ("fold", &bent.fold)] {
        let Some(BentPoint { xi_s, bend, .. }) = point else { continue };
        let _ = writeln!(out, "{name} of the bent branch at ξ_s = {xi_s:.6}, its middle {bend:.6} R0 from the axis");
    }
    out
}

/// The points of a branch, with `stability` if growth rates of non-axisymmetric disturbances are requested.
fn points(name: &'static str, branch: &Branch) -> Vec<Value> {
    let mut points: Vec<Value> = branch.points.iter().map(|p| point(name, p)).collect();
    for (point, rates) in points.iter_mut().zip(&branch.azimuthal.rates) {
        let row = |(k, rate): (usize, &Option<f64>)| filled(json!({ "m": k + 1, "growth_rate": rate }));
        point["stability"] = json!({ "azimuthal": rates.iter().enumerate().map(row).collect::<Vec<_>>() });
    }
    points
}

/// The points where growth rates of non-axisymmetric disturbances change sign; empty unless requested.
fn azimuthal(found: &Diagram) -> Option<Vec<Value>> {
    let scanned = found.branches.iter().any(|(_, branch)| !branch.azimuthal.rates.is_empty());
    let crossings = found.branches.iter().flat_map(|(name, branch)| {
        branch.azimuthal.crossings.iter().map(move |crossing| crossing_report(name, crossing))
    });
    scanned.then(|| crossings.collect())
}

/// The `--json` output. A warning names every branch that was lost, with a smaller step than `max_step`.
fn document(cell: &Cell, found: &Diagram, max_step: f64) -> Value {
    fn of(found: &Diagram, all: impl Fn(&'static str, &Branch) -> Vec<Value>) -> Vec<Value> {
        found.branches.iter().flat_map(|(name, branch)| all(name, branch)).collect()
    }
    let stopped = |name: &'static str, branch: &Branch| {
        let reason = branch.ended.error();
        let lost = matches!(reason, Some(ShapeError::Branch { .. }));
        let advice =
            if lost { format!(", or --max-step {}", rounded_number(0.3 * max_step, 2)) } else { String::new() };
        reason
            .iter()
            .for_each(|reason| messages::warning!("the {name} branch is followed no further: {reason}{advice}"));
        Vec::from_iter(reason.map(|reason| reason.to_string().into()))
    };
    let mut document = json!({
        "r0": cell.r0,
        "epsilon": cell.epsilon,
        "cue": cell.cue,
        "points": of(found, points),
        "events": of(found, |name, branch| branch.events.iter().map(|event| event_report(name, event)).collect()),
        "hopf": of(found, |name, branch| branch.hopf.iter().map(|hopf| hopf_report(name, hopf)).collect()),
        "azimuthal": azimuthal(found),
        "scaling": found.scaling,
        "steps": found.branches.iter().map(|(_, branch)| branch.work.steps).sum::<usize>(),
        "newton_iterations": found.branches.iter().map(|(_, branch)| branch.work.iterations).sum::<usize>(),
        "ends": of(found, |name, branch| vec![end(name, branch)]),
    });
    let stopped = of(found, stopped);
    if !stopped.is_empty() {
        document["stopped_by"] = stopped.into();
    }
    filled(document)
}

fn text((cell, units): (&Cell, &Units), found: &Diagram, points: bool) -> String {
    let mut out = format!("{}, cue {}\n", described(cell, units, None), cell.cue);
    if points {
        out.push_str("branch          ξ_s         H         L   growth rate        Δu\n");
        for (name, p) in found.branches.iter().flat_map(|(name, branch)| branch.points.iter().map(move |p| (name, p))) {
            let ShapePoint { xi_s, elongation: h, length: l, delta_u, .. } = p;
            let (rate, delta_u) = (or_dash(p.growth_rate, 4), or_dash(*delta_u, 5));
            let _ = writeln!(out, "{name:<10} {xi_s:>9.5} {h:>9.6} {l:>9.5} {rate:>13} {delta_u:>9}");
        }
    }
    for (name, event) in found.branches.iter().flat_map(|(name, branch)| branch.events.iter().map(move |e| (name, e))) {
        let of = match (event.pitchfork(), event.fold()) {
            (Some(pitchfork), _) => pitchfork.criticality().to_string(),
            (_, Some(fold)) if fold.maximum => "largest ξ_s".to_owned(),
            _ => "smallest ξ_s".to_owned(),
        };
        let (kind, ShapePoint { xi_s, elongation: h, .. }) = (event.kind(), event.point());
        let error = match event.error() {
            // An error below the last printed digit is not shown.
            error if error < 5e-7 => String::new(),
            error if error.is_infinite() => " (absent on halved intervals)".to_owned(),
            error => format!(" ± {error:.0e}"),
        };
        let _ = writeln!(out, "{kind} of the {name} branch at ξ_s = {xi_s:.6}{error}, H = {h:.6}: {of}");
    }
    for (name, branch) in &found.branches {
        for HopfPoint { point, period, grows } in &branch.hopf {
            let (verb, period) = (if *grows { "begin to grow" } else { "stop growing" }, rounded_number(*period, 5));
            let ShapePoint { xi_s, elongation: h, .. } = point;
            let _ = writeln!(
                out,
                "Hopf point of the {name} branch at ξ_s = {xi_s:.6}, H = {h:.6}: oscillations of period {period} τ {verb}"
            );
        }
    }
    for (name, branch) in &found.branches {
        for Crossing { m, point, grows } in &branch.azimuthal.crossings {
            let verb = if *grows { "begin to grow" } else { "stop growing" };
            let _ = writeln!(out, "disturbances m = {m} of the {name} branch {verb} at ξ_s = {:.6}", point.xi_s);
        }
    }
    for (name, branch) in &found.branches {
        let (xi_s, count, why) = (last(branch), branch.points.len(), &branch.ended);
        let _ = writeln!(out, "the {name} branch is followed to ξ_s = {xi_s:.6}, in {count} points: {why}");
    }
    if let Some(s) = &found.scaling {
        let _ = writeln!(out, "|Δu| = {:.4} |ξ_s − ξ_s*|^{:.4} from {} points", s.prefactor, s.exponent, s.points);
    }
    out
}
