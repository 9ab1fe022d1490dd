//! `furrow divide`: one division, from the passive shape or from a stationary shape that is disturbed.

use super::cell::ActiveCellArgs;
use super::context::warn_of_store;
use super::interrupt;
use super::output::writable_folder;
use super::picture::{DENSE, MovieArgs};
use super::prelude::*;
use super::progress::ProgressLine;
use furrow_cell::Cue;
use furrow_figures::drawing::style::described;
use furrow_figures::plot;
use furrow_formats::frames::{INDEX, check_step, write_frames};
use furrow_lineage::Units;
use furrow_lineage::batch::perturbations::perturbations;
use furrow_lineage::batch::{Failure, replicates};
use furrow_mechanics::division::{Division, DivisionInput, DivisionOptions, Frame, Recorder, Statistics, Trajectory};
use furrow_mechanics::equilibria::stationary;
use furrow_mechanics::perturbation::{Perturbation, PerturbationError, WATCHED, perturb};

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
    /// Starts from the stationary shape at the cell's activity; the outcome of a cell that does not divide is `failed`
    ///
    /// This is the first such shape on the branch that starts at the passive shape, stable or not. The noise of the first step
    /// disturbs it. The result has its distance from the start over time, ‖r − r0‖ + ‖z − z0‖ (L² over u).
    #[arg(help_heading = "Numerics", long)]
    from_steady: bool,
    /// Time limit with --from-steady, in τ
    #[arg(help_heading = "Numerics", long, value_name = "TAU", requires = "from_steady", allow_negative_numbers = true,
        default_value_t = WATCHED, value_parser = number)]
    until: f64,
    #[command(flatten)]
    plot: PlotArgs,
    #[command(flatten)]
    movie: MovieArgs,
}

/// A replicate that could be computed.
struct Solved {
    seed: u64,
    division: Division,
    /// With --from-steady.
    perturbation: Option<Perturbation>,
}

/// One replicate in the result.
#[derive(Serialize)]
struct Replicate<'a> {
    seed: u64,
    #[serde(flatten)]
    division: &'a Division,
    /// With --from-steady, whether the cell returned to its start.
    #[serde(skip_serializing_if = "Option::is_none")]
    returned: Option<bool>,
    /// With --from-steady, [t, dis(t)].
    #[serde(skip_serializing_if = "Option::is_none")]
    dis: Option<&'a [[f64; 2]]>,
}

impl Replicate<'_> {
    fn of(Solved { seed, division, perturbation }: &Solved) -> Replicate<'_> {
        let returned = perturbation.as_ref().map(Perturbation::returned);
        Replicate { seed: *seed, division, returned, dis: perturbation.as_ref().map(|p| p.distances.as_slice()) }
    }
}

/// The start of --from-steady.
#[derive(Serialize)]
struct Start {
    from_steady: bool,
    until: f64,
    start_growth_rate: f64,
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
    start: Option<Start>,
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
    let until = args.from_steady.then(|| positive("--until", args.until)).transpose()?;
    let (solved, undecided) = match until {
        Some(until) => disturb(args, &context, &input, until)?,
        None => solve(args, &context, &input)?,
    };
    if args.frames.is_some() || movie.is_wanted() || until.is_none() && picture.is_wanted() {
        interrupt::abort();
        let film = match until {
            Some(until) => disturbed(&input, until)?,
            None => Trajectory::compute(&input)?,
        };
        if let Some(folder) = &args.frames {
            check_step("--frame-step", &film, every)?;
            interrupt::defer(|| write_frames(folder, &film, every))?;
        }
        let film = film.with_places(DENSE);
        if until.is_none() {
            picture.write(|| plot::division::draw(&input.cell, &film))?;
        }
        movie.write(&input.cell, &film)?;
    }
    if until.is_some() {
        let named = solved
            .iter()
            .filter_map(|Solved { seed, perturbation, .. }| Some((format!("seed {seed}"), perturbation.clone()?)));
        let title = format!("Disturbed stationary shape at {}", described(&input.cell, &[]));
        picture.write(|| plot::perturbation::draw(&title, &named.collect::<Vec<_>>()))?;
    }
    // Results from a stationary shape are in natural units alone.
    let units = if until.is_some() { Units::default() } else { context.units };
    let Solved { division, perturbation, .. } = &solved[0];
    let start =
        |(until, p): (f64, &Perturbation)| Start { from_steady: true, until, start_growth_rate: p.start_growth_rate };
    let document = Answer {
        r0: input.cell.r0,
        epsilon: input.cell.epsilon,
        xi_s: input.cell.xi_s,
        cue: &input.cell.cue,
        r0_um: units.micrometres(input.cell.r0),
        t_end_min: units.minutes(division.t_end),
        start: until.zip(perturbation.as_ref()).map(start),
        first: Replicate::of(&solved[0]),
        replicates: solved.iter().map(Replicate::of).collect(),
        statistics: Statistics::of(solved.iter().map(|one| &one.division)),
        undecided,
    };
    print_as(context.json, &document, || text(&document, &units))
}

/// Solves all replicates; at least one succeeds.
fn solve(args: &DivideArgs, context: &Context, input: &DivisionInput) -> Result<(Vec<Solved>, usize), CliError> {
    let memo = context.memo()?;
    interrupt::finish();
    let line = ProgressLine::new(context.progress && args.replicates > 1);
    let show = |progress| line.show(progress);
    let count = args.replicates as usize;
    let found = replicates(input, count, &memo, &context.scheduling(&show));
    drop(line);
    let found = found?;
    warn_of_store(&found.summary.warnings);
    if found.divisions.len() + found.undecided.len() < count {
        return Err(CliError::Interrupted);
    }
    let failed = found.undecided.into_iter().map(|job| {
        let error = match job.failure {
            Failure::Unsolved(error) => error.into(),
            failure => failure.into(),
        };
        (args.seed.wrapping_add(job.id as u64), error)
    });
    let solved = found.divisions.into_iter().map(|(seed, division)| Solved { seed, division, perturbation: None });
    at_least_one(solved.collect(), failed.collect())
}

/// Disturbs the stationary shape with every seed; at least one succeeds.
fn disturb(
    args: &DivideArgs,
    context: &Context,
    input: &DivisionInput,
    until: f64,
) -> Result<(Vec<Solved>, usize), CliError> {
    let (mut solved, mut failed) = (Vec::new(), Vec::new());
    for one in perturbations(input, args.replicates as usize, until, context.threads)? {
        match one.found {
            Ok(p) => solved.push(Solved { seed: one.seed, division: p.division.clone(), perturbation: Some(p) }),
            Err(error) => failed.push((one.seed, error.into())),
        }
    }
    at_least_one(solved, failed)
}

/// The replicates that succeeded and the number of the others, each of which gets a warning.
fn at_least_one(solved: Vec<Solved>, mut failed: Vec<(u64, CliError)>) -> Result<(Vec<Solved>, usize), CliError> {
    if solved.is_empty()
        && let Some((_, error)) = failed.pop()
    {
        return Err(error);
    }
    for (seed, error) in &failed {
        tracing::warn!("the replicate of seed {seed} is left out: {error}");
    }
    Ok((solved, failed.len()))
}

fn text(document: &Answer<'_>, units: &Units) -> String {
    let size = units.in_micrometres(document.r0);
    let mut out = format!("R0 = {}{size}, ε = {}, ξ_s = {}", document.r0, document.epsilon, document.xi_s);
    if !document.cue.is_none() {
        let _ = write!(out, ", {}", document.cue);
    }
    if let Some(Start { start_growth_rate: rate, .. }) = document.start {
        let stable = if rate < 0.0 { "stable" } else { "unstable" };
        let _ = writeln!(out, ", from its stationary shape, which is {stable}: growth rate {rate:.4}/τ");
        document.replicates.iter().for_each(|replicate| disturbed_text(&mut out, replicate));
        return out;
    }
    let d = document.first.division;
    let _ = writeln!(out, ": {}", d.outcome());
    if let (Some(chi), Some(u), Some([below, above])) = (d.chi(), d.u_furrow(), d.daughters()) {
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
        let stable = d.growth_rate().map_or(String::new(), |s| format!(", {}: growth rate {s:.4}/τ", stability(s)));
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

/// One line of a result of --from-steady.
fn disturbed_text(out: &mut String, Replicate { seed, division, returned, dis }: &Replicate<'_>) {
    let dis = dis.unwrap_or_default();
    let distance = |k: usize| dis.get(k).map_or(0.0, |[_, distance]| *distance);
    let _ = write!(out, "seed {seed}: dis = {:.2e} after the noise", distance(1));
    let (last, t_end) = (distance(dis.len().saturating_sub(1)), division.t_end);
    let _ = match division.chi() {
        Some(chi) => writeln!(out, "; divides at t = {t_end:.4} τ, χ = {chi:.4}"),
        None => {
            let way = if *returned == Some(true) { "returns" } else { "leaves" };
            writeln!(out, ", {last:.2e} at t = {t_end:.2} τ: it {way}")
        }
    };
}

/// The trajectory of a disturbed stationary shape.
fn disturbed(input: &DivisionInput, until: f64) -> Result<Trajectory, PerturbationError> {
    let start = stationary(&input.cell, &input.numerics)?;
    let mut recorder = Recorder::default();
    let mut record = |frame: Frame<'_>| recorder.record(frame);
    let division = perturb(input, &start, until, DivisionOptions::observed_by(&mut record))?.division;
    Ok(recorder.finish(input, division))
}
