//! `furrow divide`: one division.

use super::context::{Context, answer, warn_of_store};
use super::error::CliError;
use super::progress::ProgressLine;
use crate::batch::{Failure, Job, SchedulerError, SchedulerOptions, scheduler};
use crate::cortex::Cue;
use crate::division::{Division, DivisionInput, Outcome, divide};
use crate::input::InputError;
use crate::io::{frames::write_frames, parse_cue};
use crate::lineage::Lineage;
use crate::report::table::outcome_name;
use clap::Args;
use serde::Serialize;
use std::fmt::Write;
use std::path::PathBuf;

/// Computes one division, from the passive shape to pinch-off or rest
#[derive(Debug, Args)]
pub struct DivideArgs {
    /// Radius R0 of the sphere with the cell's volume, in L_h
    #[arg(long, value_name = "R", allow_negative_numbers = true)]
    r0: f64,
    /// Volume of the cell over that of its shell, ε
    #[arg(long, value_name = "E", allow_negative_numbers = true)]
    epsilon: Option<f64>,
    /// Activity ξ_s, as published
    #[arg(long, value_name = "X", allow_negative_numbers = true)]
    xi: Option<f64>,
    /// Polarity cue: none, a name in the lineage file, or kappa:u0=..,omega=..,amplitude=..
    #[arg(long, value_name = "CUE", default_value = "none")]
    cue: String,
    /// Lineage file whose cues have names here; default the built-in one
    #[arg(long, value_name = "LINEAGE.ron")]
    lineage: Option<PathBuf>,
    /// Seed of the noise in the first step
    #[arg(long, value_name = "S", default_value_t = 0)]
    seed: u64,
    /// Divisions with seeds S, S+1, ...
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    replicates: u32,
    /// Writes the contour after every step of the first replicate into this folder
    #[arg(long, value_name = "DIR")]
    frames: Option<PathBuf>,
}

/// One replicate in the answer.
#[derive(Serialize)]
struct Replicate {
    seed: u64,
    outcome: Outcome,
    #[serde(skip_serializing_if = "Option::is_none")]
    chi: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    chi_signed: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    u_furrow: Option<f64>,
    t_end: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    daughters: Option<[f64; 2]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    growth_rate: Option<f64>,
    volume_drift: f64,
    steps: u32,
    rejected: u32,
    newton_iterations: u32,
    factorisations: u32,
    remeshings: u32,
}

impl Replicate {
    fn new(seed: u64, d: &Division) -> Replicate {
        Replicate {
            seed,
            outcome: d.outcome,
            chi: d.chi,
            chi_signed: d.chi_signed,
            u_furrow: d.u_furrow,
            t_end: d.t_end,
            daughters: d.daughters,
            growth_rate: d.growth_rate,
            volume_drift: d.volume_drift,
            steps: d.steps,
            rejected: d.rejected,
            newton_iterations: d.newton_iterations,
            factorisations: d.factorisations,
            remeshings: d.remeshings,
        }
    }
}

/// What `--json` prints: the first replicate at the top, then all of them and their statistics.
#[derive(Serialize)]
struct Answer {
    r0: f64,
    epsilon: f64,
    xi_s: f64,
    cue: Cue,
    #[serde(flatten)]
    first: Replicate,
    replicates: Vec<Replicate>,
    /// Over the replicates that divided.
    #[serde(skip_serializing_if = "Option::is_none")]
    chi_mean: Option<f64>,
    /// Sample standard deviation; 0 for one replicate.
    #[serde(skip_serializing_if = "Option::is_none")]
    chi_sd: Option<f64>,
    failed: usize,
}

pub fn run(args: &DivideArgs, mut context: Context) -> Result<(), CliError> {
    if !(args.r0.is_finite() && args.r0 > 0.0) {
        return Err(InputError::not_allowed("--r0", "r0", args.r0, "a finite number above 0").into());
    }
    if let Some(epsilon) = args.epsilon {
        context.settings.set_number("--epsilon", "epsilon", epsilon)?;
    }
    if let Some(xi) = args.xi {
        context.settings.set_number("--xi", "xi_s", xi)?;
    }
    let lineage = Lineage::load(args.lineage.as_deref())?;
    let cue = parse_cue(&args.cue, &lineage)?;
    let input = |seed| DivisionInput {
        physics: context.settings.physics,
        numerics: context.settings.numerics,
        r0: args.r0,
        cue,
        seed,
    };
    let divisions = solve(args, &context, &input)?;
    if let Some(folder) = &args.frames {
        write_frames(folder, &input(args.seed))?;
    }
    let replicates: Vec<Replicate> = divisions
        .iter()
        .enumerate()
        .map(|(k, division)| Replicate::new(args.seed.wrapping_add(k as u64), division))
        .collect();
    let (chi_mean, chi_sd) = mean_and_sd(&divisions.iter().filter_map(|d| d.chi).collect::<Vec<f64>>());
    let document = Answer {
        r0: args.r0,
        epsilon: context.settings.physics.epsilon,
        xi_s: context.settings.physics.xi_s,
        cue,
        first: Replicate::new(args.seed, &divisions[0]),
        chi_mean,
        chi_sd,
        failed: divisions.iter().filter(|d| d.outcome == Outcome::Failed).count(),
        replicates,
    };
    if context.json {
        answer(&format!("{}\n", serde_json::to_string_pretty(&document)?))
    } else {
        answer(&text(&document))
    }
}

/// All replicates, each as soon as a worker is free.
fn solve(
    args: &DivideArgs,
    context: &Context,
    input: &dyn Fn(u64) -> DivisionInput,
) -> Result<Vec<Division>, CliError> {
    let memo = context.memo()?;
    let line = ProgressLine::new(context.progress && args.replicates > 1);
    let show = |progress| line.show(progress);
    let options = SchedulerOptions {
        threads: context.threads,
        interrupt: Some(context.interruptible()),
        progress: Some(&show),
        ..SchedulerOptions::default()
    };
    let jobs =
        (0..args.replicates as usize).map(|id| Job { id, task: input(args.seed.wrapping_add(id as u64)) }).collect();
    let mut divisions = vec![None; args.replicates as usize];
    let summary = scheduler::run(jobs, &memo, &options, divide, |id, division| {
        divisions[id] = Some(division.clone());
        vec![]
    });
    drop(line);
    let summary = summary.map_err(|error| match error {
        SchedulerError::Unsolved { failure: Failure::Unsolved(error), .. } => CliError::Division(error),
        other => CliError::Scheduler(other),
    })?;
    warn_of_store(&summary.warnings);
    // Fewer than asked for only if the run was interrupted.
    divisions.into_iter().collect::<Option<Vec<Division>>>().ok_or(CliError::Interrupted)
}

/// Mean and sample standard deviation.
fn mean_and_sd(values: &[f64]) -> (Option<f64>, Option<f64>) {
    if values.is_empty() {
        return (None, None);
    }
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let squares: f64 = values.iter().map(|v| (v - mean).powi(2)).sum();
    (Some(mean), Some(if values.len() > 1 { (squares / (n - 1.0)).sqrt() } else { 0.0 }))
}

fn text(document: &Answer) -> String {
    let d = &document.first;
    let mut out = String::new();
    let _ = writeln!(
        out,
        "R0 = {}, ε = {}, ξ_s = {}: {}",
        document.r0,
        document.epsilon,
        document.xi_s,
        outcome_name(Some(d.outcome))
    );
    if let (Some(chi), Some(u), Some([anterior, posterior])) = (d.chi, d.u_furrow, d.daughters) {
        let _ = writeln!(
            out,
            "χ = {chi:.4}, furrow at u = {u:.4}, daughters R0 = {anterior:.4} (anterior), {posterior:.4} (posterior)"
        );
        let _ = writeln!(out, "pinch-off at t = {:.4} τ", d.t_end);
    } else {
        let _ = write!(out, "at rest at t = {:.2} τ", d.t_end);
        let _ = writeln!(out, "{}", d.growth_rate.map_or(String::new(), |s| format!(", stable: growth rate {s:.4}/τ")));
    }
    let _ = writeln!(
        out,
        "{} steps ({} rejected), {} Newton iterations, volume drift {:.1e}",
        d.steps, d.rejected, d.newton_iterations, d.volume_drift
    );
    if document.replicates.len() > 1 {
        let n = document.replicates.len();
        let _ = write!(out, "{n} replicates: {} divided", n - document.failed);
        if let (Some(mean), Some(sd)) = (document.chi_mean, document.chi_sd) {
            let _ = write!(out, ", χ = {mean:.4} ± {sd:.4} (sd)");
        }
        out.push('\n');
    }
    out
}
