//! `furrow branch`: stationary shapes of one cell over activity.

use super::cell::CellArgs;
use super::output::{csv_of, writable_file};
use super::prelude::*;
use furrow_analysis::{Diagram, diagram};
use furrow_cell::{Cell, Cue};
use furrow_figures::plot::{self, branch::Named};
use furrow_formats::write_atomically;
use furrow_mechanics::equilibria::asymmetric::Scaling;
use furrow_mechanics::equilibria::{Branch, BranchEnd, BranchOptions, ShapePoint};
use furrow_report::EventReport;

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  furrow branch --r0 2 --xi-max 30
  furrow branch --r0 2 --xi-max 30 --plot branch.svg --csv branch.csv
  furrow branch --r0 2.2 --cue germline --xi-max 30 --json")]
pub struct BranchArgs {
    #[command(flatten)]
    cell: CellArgs,
    /// Largest ξ_s
    #[arg(help_heading = "Numerics", long, value_name = "X", default_value_t = 100.0, allow_negative_numbers = true, value_parser = number)]
    xi_max: f64,
    /// Largest step along a branch, in arclength
    #[arg(help_heading = "Numerics", long, value_name = "S", default_value_t = 1.0, allow_negative_numbers = true, value_parser = number)]
    max_step: f64,
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
const HEADER: &str = "branch,xi_s,H,L,p,r_eq,stable,growth_rate,delta_u";

#[derive(Serialize)]
#[allow(non_snake_case)]
struct PointAnswer {
    branch: &'static str,
    xi_s: f64,
    H: f64,
    L: f64,
    p: f64,
    r_eq: f64,
    /// Absent if the growth rate could not be computed.
    #[serde(skip_serializing_if = "Option::is_none")]
    stable: Option<bool>,
    #[serde(skip_serializing_if = "Option::is_none")]
    growth_rate: Option<f64>,
    delta_u: f64,
}

impl PointAnswer {
    fn new(branch: &'static str, p: &ShapePoint) -> PointAnswer {
        PointAnswer {
            branch,
            xi_s: p.xi_s,
            H: p.elongation,
            L: p.length,
            p: p.pressure,
            r_eq: p.equator_radius,
            stable: p.growth_rate.map(|rate| rate < 0.0),
            growth_rate: p.growth_rate,
            delta_u: p.delta_u,
        }
    }
}

/// Why a branch ends.
#[derive(Serialize)]
struct EndAnswer {
    branch: &'static str,
    xi_s: f64,
    reason: &'static str,
    /// Of `pinched`: the neck at which shapes count as pinched off, in R0.
    #[serde(skip_serializing_if = "Option::is_none")]
    neck: Option<f64>,
    #[serde(skip)]
    why: String,
}

impl EndAnswer {
    fn new(name: &'static str, branch: &Branch) -> EndAnswer {
        let neck = match branch.ended {
            BranchEnd::Pinched(neck) => Some(neck),
            _ => None,
        };
        let xi_s = branch.points.last().map_or(f64::NAN, |point| point.xi_s);
        EndAnswer { branch: name, xi_s, reason: branch.ended.name(), neck, why: branch.ended.to_string() }
    }
}

#[derive(Serialize)]
struct Answer {
    r0: f64,
    epsilon: f64,
    cue: Cue,
    points: Vec<PointAnswer>,
    events: Vec<EventReport>,
    /// Of the asymmetric branch of the first pitchfork.
    #[serde(skip_serializing_if = "Option::is_none")]
    scaling: Option<Scaling>,
    steps: usize,
    newton_iterations: usize,
    ends: Vec<EndAnswer>,
    /// What went wrong where a branch ended.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    stopped_by: Vec<String>,
}

pub fn run(args: &BranchArgs, mut context: Context) -> Result<(), CliError> {
    let cell = args.cell.read(&mut context)?;
    let picture = args.plot.file()?;
    writable_file("--csv", args.csv.as_deref())?;
    let options = BranchOptions {
        contours: picture.is_wanted(),
        xi: [0.0, positive("--xi-max", args.xi_max)?],
        growth_rates: true,
        ..BranchOptions::default()
    };
    let options = options.with_max_step(positive("--max-step", args.max_step)?);
    let found = diagram(&cell, &context.settings.numerics, &options)?;
    let document = Answer::new(&cell, &found);
    if let Some(file) = &args.csv {
        write_atomically(file, &csv_of(HEADER, &document.points)?)?;
    }
    let named: Vec<Named<'_>> = found.branches.iter().map(|(name, branch)| Named { name, branch }).collect();
    picture.write(|| plot::branch::draw(&cell, &named))?;
    print_as(context.json, &document, || document.text(args.points))
}

impl Answer {
    fn new(cell: &Cell, found: &Diagram) -> Answer {
        let branches = || found.branches.iter().map(|(name, branch)| (*name, branch));
        let stopped = |(name, branch): (&str, &Branch)| {
            let reason = branch.ended.error()?;
            tracing::warn!("the {name} branch is followed no further: {reason}");
            Some(reason.to_string())
        };
        let points = |(name, branch): (&'static str, &Branch)| -> Vec<PointAnswer> {
            branch.points.iter().map(|p| PointAnswer::new(name, p)).collect()
        };
        let events = |(name, branch): (&'static str, &Branch)| -> Vec<EventReport> {
            branch.events.iter().map(|event| EventReport::new(name, event)).collect()
        };
        Answer {
            r0: cell.r0,
            epsilon: cell.epsilon,
            cue: cell.cue.clone(),
            points: branches().flat_map(points).collect(),
            events: branches().flat_map(events).collect(),
            scaling: found.scaling,
            steps: branches().map(|(_, branch)| branch.work.steps).sum(),
            newton_iterations: branches().map(|(_, branch)| branch.work.iterations).sum(),
            ends: branches().map(|(name, branch)| EndAnswer::new(name, branch)).collect(),
            stopped_by: branches().filter_map(stopped).collect(),
        }
    }

    fn text(&self, points: bool) -> String {
        let mut out = format!("R0 = {}, ε = {}, cue {}\n", self.r0, self.epsilon, self.cue);
        if points {
            self.list_points(&mut out);
        }
        for e in &self.events {
            let of = match (e.criticality, e.maximum) {
                (Some(criticality), _) => criticality.to_string(),
                (_, Some(true)) => "largest ξ_s".to_owned(),
                _ => "smallest ξ_s".to_owned(),
            };
            let _ = writeln!(out, "{} of the {} branch at ξ_s = {:.6}, H = {:.6}: {of}", e.kind, e.branch, e.xi_s, e.H);
        }
        for end in &self.ends {
            let EndAnswer { branch, xi_s, why, .. } = end;
            let count = self.points.iter().filter(|point| point.branch == *branch).count();
            let _ = writeln!(out, "the {branch} branch is followed to ξ_s = {xi_s:.6}, in {count} points: {why}");
        }
        if let Some(s) = &self.scaling {
            let _ = writeln!(out, "|Δu| = {:.4} |ξ_s − ξ_s*|^{:.4} from {} points", s.prefactor, s.exponent, s.points);
        }
        out
    }

    fn list_points(&self, out: &mut String) {
        out.push_str("branch          ξ_s         H         L   growth rate        Δu\n");
        for p in &self.points {
            let rate = p.growth_rate.map_or("-".to_owned(), |rate| format!("{rate:.4}"));
            let _ = writeln!(
                out,
                "{:<10} {:>9.5} {:>9.6} {:>9.5} {rate:>13} {:>9.5}",
                p.branch, p.xi_s, p.H, p.L, p.delta_u
            );
        }
    }
}
