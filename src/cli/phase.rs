//! `furrow phase`: outcomes over a plane of size or confinement and activity.

use super::cell::read_cue;
use super::context::{Context, answer, warn_of_store};
use super::error::CliError;
use super::progress::ProgressLine;
use crate::batch::{Job, SchedulerError, SchedulerOptions, scheduler};
use crate::cortex::{Control, Cue, Numerics, Physics};
use crate::division::{Division, DivisionInput, Outcome, divide};
use crate::input::InputError;
use crate::steady::phase::{Edge, RestShapes, rest_shapes};
use clap::{Args, ValueEnum};
use rayon::prelude::*;
use serde::Serialize;
use std::fmt::Write;
use std::path::PathBuf;

/// Which parameter runs across the diagram.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Across {
    /// Radius R0
    R0,
    /// Volume fraction ε
    Epsilon,
}

/// Maps outcomes over R0 or ε and ξ_s: at rest by the exact edges of the stable shapes, χ by divisions elsewhere
#[derive(Debug, Args)]
pub struct PhaseArgs {
    /// Parameter across
    #[arg(long, value_name = "NAME")]
    vary: Across,
    /// Its first value
    #[arg(long, value_name = "A", allow_negative_numbers = true)]
    from: f64,
    /// Its last value
    #[arg(long, value_name = "B", allow_negative_numbers = true)]
    to: f64,
    /// Values across
    #[arg(long, value_name = "N", default_value_t = 8, value_parser = clap::value_parser!(u32).range(1..=10_000))]
    points: u32,
    /// First ξ_s
    #[arg(long, value_name = "X", default_value_t = 5.0, allow_negative_numbers = true)]
    xi_from: f64,
    /// Last ξ_s
    #[arg(long, value_name = "X", default_value_t = 30.0, allow_negative_numbers = true)]
    xi_to: f64,
    /// Values of ξ_s
    #[arg(long, value_name = "N", default_value_t = 6, value_parser = clap::value_parser!(u32).range(1..=10_000))]
    xi_points: u32,
    /// Radius R0 where ε varies
    #[arg(long, value_name = "R", allow_negative_numbers = true)]
    r0: Option<f64>,
    /// Volume fraction ε where R0 varies
    #[arg(long, value_name = "E", allow_negative_numbers = true)]
    epsilon: Option<f64>,
    /// Polarity cue: none, a name in the lineage file, or kappa:u0=..,omega=..,amplitude=..
    #[arg(long, value_name = "CUE", default_value = "none")]
    cue: String,
    /// Lineage file whose cues have names here; default the built-in one
    #[arg(long, value_name = "LINEAGE.ron")]
    lineage: Option<PathBuf>,
    /// Seed of the noise in the first step
    #[arg(long, value_name = "S", default_value_t = 0)]
    seed: u64,
}

/// One point of the plane.
#[derive(Serialize)]
struct CellAnswer {
    x: f64,
    xi_s: f64,
    outcome: &'static str,
    chi: Option<f64>,
    /// `curves`: a stable shape exists; `division`: solved in time.
    by: &'static str,
}

impl CellAnswer {
    /// The point of a cell whose division was asked for, with what came of it, or that has a stable shape.
    fn new(x: f64, xi_s: f64, division: Option<Option<&Division>>) -> CellAnswer {
        let outcome = match division {
            None => "failed",
            Some(None) => "undecided",
            Some(Some(division)) => match division.outcome {
                Outcome::Symmetric => "symmetric",
                Outcome::Asymmetric => "asymmetric",
                Outcome::Failed => "failed",
            },
        };
        let by = if division.is_some() { "division" } else { "curves" };
        CellAnswer { x, xi_s, outcome, chi: division.flatten().and_then(|division| division.chi), by }
    }
}

/// The exact edges at one value across.
#[derive(Serialize)]
struct Column {
    x: f64,
    at_rest: Vec<[f64; 2]>,
    edges: Vec<Edge>,
}

/// What `--json` prints.
#[derive(Serialize)]
struct Answer {
    vary: Control,
    cue: Cue,
    cells: Vec<CellAnswer>,
    columns: Vec<Column>,
}

/// Evenly spaced values, both ends included; the first alone if there is one.
fn spaced(from: f64, to: f64, points: u32) -> Vec<f64> {
    let last = f64::from(points.max(2) - 1);
    (0..points).map(|k| if k + 1 == points && k > 0 { to } else { from + (to - from) * f64::from(k) / last }).collect()
}

impl PhaseArgs {
    fn check(&self) -> Result<(), InputError> {
        let (name, allowed, ok): (_, _, fn(f64) -> bool) = match self.vary {
            Across::R0 => ("r0", "a finite number above 0", |v| v.is_finite() && v > 0.0),
            Across::Epsilon => ("epsilon", "above 0 and below 1", |v| v > 0.0 && v < 1.0),
        };
        for (option, value) in [("--from", self.from), ("--to", self.to)] {
            if !ok(value) {
                return Err(InputError::not_allowed(option, name, value, allowed));
            }
        }
        for (option, value) in [("--xi-from", self.xi_from), ("--xi-to", self.xi_to)] {
            if !(value.is_finite() && value >= 0.0) {
                return Err(InputError::not_allowed(option, "xi_s", value, "a finite number, 0 or above"));
            }
        }
        match (self.vary, self.r0) {
            (Across::Epsilon, None) => {
                Err(InputError::not_allowed("--vary epsilon", "r0", "absent", "given by --r0 where ε varies"))
            }
            (Across::Epsilon, Some(r0)) if !(r0.is_finite() && r0 > 0.0) => {
                Err(InputError::not_allowed("--r0", "r0", r0, "a finite number above 0"))
            }
            (Across::R0, Some(r0)) => {
                Err(InputError::not_allowed("--r0", "r0", r0, "left out where R0 varies: see --from and --to"))
            }
            _ => Ok(()),
        }
    }

    /// Physics and R0 of a column.
    fn cell(&self, physics: &Physics, x: f64) -> (Physics, f64) {
        match self.vary {
            Across::R0 => (*physics, x),
            Across::Epsilon => (Physics { epsilon: x, ..*physics }, self.r0.unwrap_or(physics.r0)),
        }
    }
}

pub fn run(args: &PhaseArgs, mut context: Context) -> Result<(), CliError> {
    args.check()?;
    if let Some(epsilon) = args.epsilon {
        if args.vary == Across::Epsilon {
            let allowed = "left out where ε varies: see --from and --to";
            return Err(InputError::not_allowed("--epsilon", "epsilon", epsilon, allowed).into());
        }
        context.settings.set_number("--epsilon", "epsilon", epsilon)?;
    }
    let cue = read_cue(&args.cue, args.lineage.as_deref())?;
    let (physics, numerics) = (context.settings.physics, context.settings.numerics);
    let across = spaced(args.from, args.to, args.points);
    let up = spaced(args.xi_from, args.xi_to, args.xi_points);
    let shapes = edges(args, &context, &across, &physics, &numerics, &cue)?;
    let points: Vec<(usize, f64)> = (0..across.len()).flat_map(|k| up.iter().map(move |xi| (k, *xi))).collect();
    let mut jobs = Vec::new();
    for (id, &(k, xi_s)) in points.iter().enumerate() {
        if !shapes[k].contains(xi_s) {
            let (physics, r0) = args.cell(&physics, across[k]);
            let physics = Physics { xi_s, ..physics };
            jobs.push(Job { id, task: DivisionInput { physics, numerics, r0, cue, seed: args.seed } });
        }
    }
    let mut by_division = vec![false; points.len()];
    jobs.iter().for_each(|job| by_division[job.id] = true);
    let divisions = solve(&context, jobs, points.len())?;
    let cells = points.iter().zip(divisions.iter().zip(by_division));
    let document = Answer {
        vary: if args.vary == Across::R0 { Control::R0 } else { Control::Epsilon },
        cue,
        cells: cells
            .map(|(&(k, xi_s), (division, by_division))| {
                let division = by_division.then_some(division.as_ref());
                CellAnswer::new(across[k], xi_s, division)
            })
            .collect(),
        columns: across
            .iter()
            .zip(shapes)
            .map(|(x, s)| Column { x: *x, at_rest: s.intervals, edges: s.edges })
            .collect(),
    };
    if context.json {
        answer(&format!("{}\n", serde_json::to_string_pretty(&document)?))
    } else {
        answer(&text(&document, &up))
    }
}

/// The stable shapes of every column.
fn edges(
    args: &PhaseArgs,
    context: &Context,
    across: &[f64],
    physics: &Physics,
    numerics: &Numerics,
    cue: &Cue,
) -> Result<Vec<RestShapes>, CliError> {
    // A little beyond the diagram, so that its upper rim is inside.
    let xi_max = 1.01 * args.xi_from.max(args.xi_to) + 0.1;
    let column = |x: &f64| {
        let (physics, r0) = args.cell(physics, *x);
        rest_shapes(&physics, numerics, r0, cue, xi_max)
    };
    let pool = rayon::ThreadPoolBuilder::new().num_threads(context.threads).build().map_err(std::io::Error::other)?;
    Ok(pool.install(|| across.par_iter().map(column).collect::<Result<Vec<_>, _>>())?)
}

/// The divisions of all jobs by their numbers; a cell that neither divides nor comes to rest in time is left out, with a
/// warning.
fn solve(context: &Context, jobs: Vec<Job<DivisionInput>>, cells: usize) -> Result<Vec<Option<Division>>, CliError> {
    let memo = context.memo()?;
    let line = ProgressLine::new(context.progress);
    let show = |progress| line.show(progress);
    let options = SchedulerOptions {
        threads: context.threads,
        interrupt: Some(context.interruptible()),
        progress: Some(&show),
        ..SchedulerOptions::default()
    };
    let wanted = jobs.len();
    let mut divisions = vec![None; cells];
    let summary = scheduler::run(jobs, &memo, &options, divide, |id, division| {
        divisions[id] = Some(division.clone());
        vec![]
    });
    drop(line);
    match summary {
        Ok(summary) => {
            warn_of_store(&summary.warnings);
            if divisions.iter().flatten().count() < wanted {
                return Err(CliError::Interrupted);
            }
        }
        Err(SchedulerError::Unsolved { failure, unsolved, .. }) => {
            let others = if unsolved > 1 { format!(" (and {} more)", unsolved - 1) } else { String::new() };
            tracing::warn!("left undecided: {failure}{others}");
        }
        Err(error) => return Err(error.into()),
    }
    Ok(divisions)
}

fn text(document: &Answer, up: &[f64]) -> String {
    let mut out = String::new();
    let name = if document.vary == Control::R0 { "R0" } else { "ε" };
    let _ = writeln!(out, "χ where the cell divides (0: equal daughters), - where it stays at rest, ? undecided");
    let _ = write!(out, "{:>9}", "ξ_s");
    for column in &document.columns {
        let _ = write!(out, " {:>8}", format!("{:.4}", column.x));
    }
    let _ = writeln!(out, "  {name}");
    for (row, xi_s) in up.iter().enumerate().rev() {
        let _ = write!(out, "{xi_s:>9.4}");
        for k in 0..document.columns.len() {
            let cell = &document.cells[k * up.len() + row];
            let shown = match (cell.outcome, cell.chi) {
                ("symmetric", _) => "0".to_owned(),
                (_, Some(chi)) => format!("{chi:.3}"),
                ("failed", _) => "-".to_owned(),
                _ => "?".to_owned(),
            };
            let _ = write!(out, " {shown:>8}");
        }
        let _ = writeln!(out);
    }
    let _ = writeln!(out, "edges of the stable shapes (pitchfork P, fold F):");
    for column in &document.columns {
        let edges: Vec<String> = column
            .edges
            .iter()
            .map(|edge| match edge {
                Edge::Pitchfork { xi_s, .. } => format!("P {xi_s:.4}"),
                Edge::Fold { xi_s, .. } => format!("F {xi_s:.4}"),
            })
            .collect();
        let _ = writeln!(out, "{name} = {:.4}: {}", column.x, edges.join(", "));
    }
    out
}
