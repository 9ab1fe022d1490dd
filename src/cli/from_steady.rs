//! `furrow divide --from-steady`: a stationary shape that is disturbed, and what becomes of it.

use std::fmt::Write;
use std::path::Path;

use clap::Args;
use serde::Serialize;

use super::cell::{number, positive};
use super::context::Context;
use super::error::CliError;
use super::interrupt;
use super::movie::{DENSE, MovieFile};
use super::output::print_as;
use super::plot::Picture;
use furrow_cell::Cue;
use furrow_figures::drawing::style::described;
use furrow_figures::plot::perturbation::draw;
use furrow_formats::frames::{check_step, write_frames};
use furrow_lineage::batch::perturbations::{Disturbed, perturbations};
use furrow_mechanics::division::{Division, DivisionInput, Film, Statistics};
use furrow_mechanics::perturbation::{Perturbation, WATCHED, film_perturbed};

/// The options of a start from a stationary shape.
#[derive(Debug, Args)]
pub struct FromSteadyArgs {
    /// Starts from the stationary shape at the cell's activity; the outcome of a cell that does not divide is `failed`
    ///
    /// This is the first such shape on the branch that starts at the passive shape, stable or not. The noise of the first step
    /// disturbs it. The result has its distance from the start over time, ‖r − r0‖ + ‖z − z0‖ (L² over u).
    #[arg(help_heading = "Numerics", long)]
    pub from_steady: bool,
    /// Time limit with --from-steady, in τ
    #[arg(help_heading = "Numerics", long, value_name = "TAU", requires = "from_steady", allow_negative_numbers = true,
        default_value_t = WATCHED, value_parser = number)]
    until: f64,
}

/// Files that are asked for.
pub struct Output<'a> {
    pub frames: Option<&'a Path>,
    pub every: Option<f64>,
    pub picture: Picture,
    pub movie: MovieFile,
}

/// One replicate in the result.
#[derive(Serialize)]
struct Replicate<'a> {
    seed: u64,
    #[serde(flatten)]
    division: &'a Division,
    /// Whether the cell returned to its start.
    returned: bool,
    /// [t, dis(t)].
    dis: &'a [[f64; 2]],
}

/// What `--json` prints: as of a division, with data of the start.
#[derive(Serialize)]
struct Answer<'a> {
    r0: f64,
    epsilon: f64,
    xi_s: f64,
    cue: &'a Cue,
    from_steady: bool,
    until: f64,
    start_growth_rate: f64,
    #[serde(flatten)]
    first: Replicate<'a>,
    replicates: Vec<Replicate<'a>>,
    #[serde(flatten)]
    statistics: Statistics,
    /// Replicates that could not be computed, and are left out.
    undecided: usize,
}

pub fn run(
    args: &FromSteadyArgs,
    context: &Context,
    input: &DivisionInput,
    count: usize,
    output: Output<'_>,
) -> Result<(), CliError> {
    let until = positive("--until", args.until)?;
    let (mut watched, mut failures): (Vec<(u64, Perturbation)>, Vec<_>) = (Vec::new(), Vec::new());
    for Disturbed { seed, found } in perturbations(input, count, until, context.threads)? {
        match found {
            Ok(perturbation) => watched.push((seed, perturbation)),
            Err(error) => failures.push((seed, error)),
        }
    }
    if watched.is_empty()
        && let Some((_, error)) = failures.pop()
    {
        return Err(error.into());
    }
    for (seed, error) in &failures {
        tracing::warn!("the replicate of seed {seed} is left out: {error}");
    }
    write_files(input, until, &watched, output)?;
    let replicate = |k: usize| {
        let (seed, perturbation) = &watched[k];
        let (division, dis) = (&perturbation.division, perturbation.distances.as_slice());
        Replicate { seed: *seed, division, returned: perturbation.returned(), dis }
    };
    let document = Answer {
        r0: input.cell.r0,
        epsilon: input.cell.epsilon,
        xi_s: input.cell.xi_s,
        cue: &input.cell.cue,
        from_steady: true,
        until,
        start_growth_rate: watched[0].1.start_growth_rate,
        first: replicate(0),
        replicates: (0..watched.len()).map(replicate).collect(),
        statistics: Statistics::of(watched.iter().map(|(_, perturbation)| &perturbation.division)),
        undecided: failures.len(),
    };
    print_as(context.json, &document, || text(&document))
}

fn write_files(
    input: &DivisionInput,
    until: f64,
    watched: &[(u64, Perturbation)],
    output: Output<'_>,
) -> Result<(), CliError> {
    if output.frames.is_some() || output.movie.is_wanted() {
        let (film, _) = film_perturbed(input, until)?;
        write_all_frames(output.frames, &film, output.every)?;
        output.movie.write(&input.cell, &film.with_places(DENSE))?;
    }
    let title = format!("Disturbed stationary shape at {}", described(&input.cell, &[]));
    let named: Vec<_> = watched.iter().map(|(seed, found)| (format!("seed {seed}"), found.clone())).collect();
    output.picture.write(|| draw(&title, &named))
}

/// Writes the frames of a film into a folder, if one is given, after every step or every so many τ; an interruption waits for them.
pub fn write_all_frames(folder: Option<&Path>, film: &Film, every: Option<f64>) -> Result<(), CliError> {
    let Some(folder) = folder else { return Ok(()) };
    check_step("--frame-step", film, every)?;
    Ok(interrupt::defer(|| write_frames(folder, film, every))?)
}

fn text(document: &Answer<'_>) -> String {
    let mut out = format!("R0 = {}, ε = {}, ξ_s = {}", document.r0, document.epsilon, document.xi_s);
    if !document.cue.is_none() {
        let _ = write!(out, ", {}", document.cue);
    }
    let rate = document.start_growth_rate;
    let stable = if rate < 0.0 { "stable" } else { "unstable" };
    let _ = writeln!(out, ", from its stationary shape, which is {stable}: growth rate {rate:.4}/τ");
    for replicate in &document.replicates {
        let distance = |k: usize| replicate.dis.get(k).map_or(0.0, |[_, distance]| *distance);
        let _ = write!(out, "seed {}: dis = {:.2e} after the noise", replicate.seed, distance(1));
        let last = distance(replicate.dis.len().saturating_sub(1));
        let division = replicate.division;
        let _ = match (division.chi, replicate.returned) {
            (Some(chi), _) => writeln!(out, "; divides at t = {:.4} τ, χ = {chi:.4}", division.t_end),
            (None, true) => writeln!(out, ", {last:.2e} at t = {:.2} τ: it returns", division.t_end),
            (None, false) => writeln!(out, ", {last:.2e} at t = {:.2} τ: it leaves", division.t_end),
        };
    }
    out
}
