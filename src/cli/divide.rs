//! `furrow divide`: one division.

use std::fmt::Write;
use std::path::PathBuf;

use clap::Args;
use serde::Serialize;

use super::cell::{ActiveCellArgs, number, positive};
use super::context::{Context, warn_of_store};
use super::error::CliError;
use super::from_steady::{self, FromSteadyArgs, Output, write_all_frames};
use super::interrupt;
use super::movie::{DENSE, MovieArgs};
use super::output::{print_as, writable_folder};
use super::plot::PlotArgs;
use super::progress::ProgressLine;
use furrow_cell::Cue;
use furrow_formats::frames::INDEX;
use furrow_lineage::Units;
use furrow_lineage::batch::{Failure, Replicates, Unsolved, replicates};
use furrow_mechanics::division::{Division, DivisionInput, Statistics, film};

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  furrow divide --r0 2.5 --plot division.svg
  furrow divide --r0 5.4 --cue germline --json --movie zygote.gif --movie-frames 5
  furrow divide --r0 2 --xi 23 --from-steady --plot distance.svg
  furrow divide --r0 2 --replicates 3 --frames contours --frame-step 0.2")]
pub struct DivideArgs {
    #[command(flatten)]
    cell: ActiveCellArgs,
    /// Seed of the noise in the first step
    #[arg(help_heading = "Numerics", long, value_name = "S", default_value_t = 0)]
    seed: u64,
    /// Number of divisions, with seeds S, S+1, ...
    #[arg(help_heading = "Numerics", long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    replicates: u32,
    /// Writes contours, curvatures, tensions, velocities and forces of the first replicate into a folder, after every step
    #[arg(help_heading = "Output", long, value_name = "DIR")]
    frames: Option<PathBuf>,
    /// Writes a frame every TAU τ instead of after every step
    #[arg(help_heading = "Output", long, value_name = "TAU", requires = "frames", allow_negative_numbers = true, value_parser = number)]
    frame_step: Option<f64>,
    #[command(flatten)]
    from: FromSteadyArgs,
    #[command(flatten)]
    plot: PlotArgs,
    #[command(flatten)]
    movie: MovieArgs,
}

/// One replicate in the result.
#[derive(Serialize)]
struct Replicate<'a> {
    seed: u64,
    #[serde(flatten)]
    division: &'a Division,
}

/// What `--json` prints: the first replicate at the top, then all of them and their statistics.
#[derive(Serialize)]
struct Answer<'a> {
    r0: f64,
    epsilon: f64,
    xi_s: f64,
    cue: &'a Cue,
    /// R0 in µm and the time in minutes, where the lineage file has units.
    #[serde(skip_serializing_if = "Option::is_none")]
    r0_um: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    t_end_min: Option<f64>,
    #[serde(flatten)]
    first: Replicate<'a>,
    replicates: Vec<Replicate<'a>>,
    #[serde(flatten)]
    statistics: Statistics,
    /// Replicates that could not be computed, and are left out.
    undecided: usize,
}

pub fn run(args: &DivideArgs, mut context: Context) -> Result<(), CliError> {
    let cell = args.cell.read(&mut context)?;
    context.settings.check_divisions("settings")?;
    let input = DivisionInput { cell, numerics: context.settings.numerics, seed: args.seed };
    writable_folder("--frames", args.frames.as_deref(), &[INDEX])?;
    let every = args.frame_step.map(|step| positive("--frame-step", step)).transpose()?;
    let picture = args.plot.file()?;
    let movie = args.movie.file()?;
    if args.from.from_steady {
        let output = Output { frames: args.frames.as_deref(), every, picture, movie };
        return from_steady::run(&args.from, &context, &input, args.replicates as usize, output);
    }
    let Replicates { divisions, undecided, .. } = solve(args, &context, &input)?;
    if args.frames.is_some() || picture.is_wanted() || movie.is_wanted() {
        interrupt::abort();
        let film = film(&input)?;
        write_all_frames(args.frames.as_deref(), &film, every)?;
        let film = film.with_places(DENSE);
        picture.write(|| furrow_figures::plot::division::draw(&input.cell, &film))?;
        movie.write(&input.cell, &film)?;
    }
    let replicate = |k: usize| Replicate { seed: divisions[k].0, division: &divisions[k].1 };
    let document = Answer {
        r0: input.cell.r0,
        epsilon: input.cell.epsilon,
        xi_s: input.cell.xi_s,
        cue: &input.cell.cue,
        r0_um: context.units.micrometres(input.cell.r0),
        t_end_min: context.units.minutes(divisions[0].1.t_end),
        first: replicate(0),
        replicates: (0..divisions.len()).map(replicate).collect(),
        statistics: Statistics::of(divisions.iter().map(|(_, division)| division)),
        undecided: undecided.len(),
    };
    print_as(context.json, &document, || text(&document, &context.units))
}

/// Solves all replicates; at least one succeeds.
fn solve(args: &DivideArgs, context: &Context, input: &DivisionInput) -> Result<Replicates, CliError> {
    let memo = context.memo()?;
    interrupt::finish();
    let line = ProgressLine::new(context.progress && args.replicates > 1);
    let show = |progress| line.show(progress);
    let count = args.replicates as usize;
    let solved = replicates(input, count, &memo, &context.scheduling(&show));
    drop(line);
    let mut found = solved?;
    warn_of_store(&found.summary.warnings);
    if found.divisions.len() + found.undecided.len() < count {
        return Err(CliError::Interrupted);
    }
    if found.divisions.is_empty()
        && let Some(Unsolved { failure, .. }) = found.undecided.pop()
    {
        return Err(match failure {
            Failure::Unsolved(error) => error.into(),
            failure => failure.into(),
        });
    }
    for Unsolved { id, failure, .. } in &found.undecided {
        tracing::warn!("the replicate of seed {} is left out: {failure}", args.seed.wrapping_add(*id as u64));
    }
    Ok(found)
}

fn text(document: &Answer<'_>, units: &Units) -> String {
    let d = document.first.division;
    let size = units.in_micrometres(document.r0);
    let mut out = format!("R0 = {}{size}, ε = {}, ξ_s = {}", document.r0, document.epsilon, document.xi_s);
    if !document.cue.is_none() {
        let _ = write!(out, ", {}", document.cue);
    }
    let _ = writeln!(out, ": {}", d.outcome);
    if let (Some(chi), Some(u), Some([below, above])) = (d.chi, d.u_furrow, d.daughters) {
        let _ = writeln!(
            out,
            "χ = {chi:.4}, furrow at u = {u:.4}, daughters R0 = {below:.4}{} (at u = 0), {above:.4}{} (at u = 1)",
            units.in_micrometres(below),
            units.in_micrometres(above)
        );
        let _ = writeln!(out, "pinch-off at t = {:.4} τ{}", d.t_end, units.in_minutes(d.t_end));
    } else {
        let _ = write!(out, "at rest at t = {:.2} τ{}", d.t_end, units.in_minutes(d.t_end));
        let stability = |s: f64| if s < 0.0 { "stable" } else { "where the published scheme cannot leave" };
        let stable = d.growth_rate.map_or(String::new(), |s| format!(", {}: growth rate {s:.4}/τ", stability(s)));
        let _ = writeln!(out, "{stable}");
    }
    if let Some(rate) = d.slow_growth_rate {
        let _ = writeln!(out, "just above the threshold: the stationary shape is left at {rate:.2e}/τ");
    }
    let _ = writeln!(
        out,
        "{} steps ({} rejected), {} Newton iterations, volume drift {:.1e}",
        d.work.steps, d.work.rejected, d.work.iterations, d.volume_drift
    );
    if document.replicates.len() > 1 {
        let (n, statistics) = (document.replicates.len(), &document.statistics);
        let _ = write!(out, "{n} replicates: {} divided", n - statistics.failed);
        if let (Some(mean), Some(sd)) = (statistics.chi_mean, statistics.chi_sd) {
            let _ = write!(out, ", χ = {mean:.4} ± {sd:.4} (sd)");
        }
        out.push('\n');
    }
    out
}
