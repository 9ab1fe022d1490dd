//! `furrow divide`: one division, from the passive shape or from a disturbed stationary shape.

use super::cell::{self, ActiveCellArgs, AxisArgs, positive};
use super::context::Context;
use super::error::CliError;
use super::interrupt;
use super::messages;
use super::output::{check_seeds, filled, merged, named_as_file, not_writable, number, print_as, seed};
use super::picture::{DENSE, MovieArgs, MovieFile, Picture, PlotArgs};
use clap::Args;
use furrow_cell::{Cell, Cue, Numerics};
use furrow_figures::drawing::style::described;
use furrow_figures::movie::{Movie, SurfaceMovie, even_times};
use furrow_figures::plot;
use furrow_formats::film::{self, check_path, write_film};
use furrow_formats::frames::{self, FrameFiles, check_step, write_frames};
use furrow_input::{InputError, rounded_number};
use furrow_lineage::Units;
use furrow_lineage::batch::checks::{Checked, Effects, MeshEffect, NoiseEffect, checked};
use furrow_lineage::batch::memo::Solve;
use furrow_lineage::batch::perturbations::perturbations;
use furrow_lineage::batch::{self, Failure, Filming, Memo, SchedulerError, replicates_by};
use furrow_mechanics::division::{
    Division, DivisionInput, DivisionOptions, Ending, Frame, Recorder, Statistics, Trajectory,
};
use furrow_mechanics::equilibria::azimuthal_threshold::one_sided_from;
use furrow_mechanics::equilibria::stationary;
use furrow_mechanics::perturbation::{Perturbation, PerturbationError, WATCHED, perturb};
use furrow_mechanics::polarity;
use furrow_report::surfaces::neck_report;
use furrow_report::{FilmPage, checks_report};
use furrow_surface::film::Film;
use serde::{Serialize, Serializer};
use serde_json::{Value, json};
use std::fmt::Write;
use std::io;
use std::path::{Path, PathBuf};

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  furrow divide --r0 2.5 --plot division.svg
  furrow divide --r0 5.4 --cue germline --movie zygote.gif --movie-frames 5
  furrow divide --r0 2 --three-dimensional --movie one-sided.html
  furrow divide --r0 2 --xi 23 --from-steady --plot distance.svg
  furrow divide --r0 2 --replicates 3 --frames contours --frame-step 0.2")]
pub struct DivideArgs {
    #[command(flatten)]
    cell: ActiveCellArgs,
    #[command(flatten)]
    pub axis: AxisArgs,
    /// Seed of the noise in the first step
    #[arg(help_heading = "Numerics", long, value_name = "S", default_value_t = 0, value_parser = seed)]
    seed: u64,
    /// Number of divisions, with seeds S, S+1, ...
    #[arg(help_heading = "Numerics", long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    replicates: u32,
    /// Writes contours, curvatures, tensions, velocities and forces of the first replicate into a folder, after every step
    ///
    /// With a name that ends in .ply or .glb it writes the surface instead: for FILE.ply one file per frame, FILE_0000.ply and so on,
    /// listed in FILE.json; for FILE.glb one animated glTF file. Both have normals and the mean tension; lengths are in L_h.
    #[arg(help_heading = "Output", long, value_name = "DIR|FILE.ply|.glb")]
    frames: Option<PathBuf>,
    /// Writes a frame every TAU τ, interpolated linearly between steps, instead of after every step
    #[arg(help_heading = "Output", long, value_name = "TAU", requires = "frames", value_parser = number)]
    frame_step: Option<f64>,
    /// Starts from the stationary shape at the cell's activity; the outcome of a cell that does not divide is `failed`
    ///
    /// This is the first such shape on the branch that starts at the passive shape, whether stable or unstable. The noise of the first
    /// step disturbs it. The result includes the distance from the initial shape over time, ‖r − r0‖ + ‖z − z0‖ (L² over u).
    #[arg(help_heading = "Numerics", long)]
    from_steady: bool,
    /// Time limit with --from-steady, in τ
    #[arg(help_heading = "Numerics", long, value_name = "TAU", requires = "from_steady",
        default_value_t = WATCHED, value_parser = number)]
    until: f64,
    #[command(flatten)]
    plot: PlotArgs,
    #[command(flatten)]
    movie: MovieArgs,
}

/// A replicate that could be computed.
#[derive(Serialize)]
struct Replicate {
    seed: u64,
    #[serde(flatten)]
    division: Division,
    /// With --from-steady.
    #[serde(flatten, serialize_with = "return_and_distances")]
    perturbation: Option<Perturbation>,
}

/// Whether the cell returned to its start, and [t, dis(t)].
fn return_and_distances<S: Serializer>(found: &Option<Perturbation>, serializer: S) -> Result<S::Ok, S::Error> {
    found.as_ref().map(|p| json!({ "returned": p.returned(), "dis": p.distances })).serialize(serializer)
}

/// The replicates that could be computed, and the effects of noise and mesh on the first of them.
#[derive(Default)]
struct Divisions {
    replicates: Vec<Replicate>,
    /// The number of failed replicates.
    undecided: usize,
    effects: Effects,
    /// The cue with position and width from the cell's PAR polarity, if the cue follows it.
    resolved: Option<Cue>,
}

impl Divisions {
    /// Places the cue by the cell's PAR polarity. A warning replaces the text that JSON lacks if the cell has no polarity.
    fn resolve(&mut self, cell: &Cell, json: bool) {
        self.resolved = resolved_cue(cell);
        if json && self.resolved.as_ref().is_some_and(Cue::is_none) {
            messages::warning!("{NO_POLARITY}");
        }
    }
}

/// Describes the effect of the noise on `first`.
fn noise_text(effect: &NoiseEffect, first: &Division) -> String {
    let NoiseEffect { seed, other, .. } = effect;
    format!(
        "the noise decides how unequal: {} with this seed, {} with seed {seed}; --replicates 20 shows the spread\n",
        found(first),
        found(other)
    )
}

/// Describes the effect of the mesh on `first`.
fn mesh_text(effect: &MeshEffect, first: &Division) -> String {
    let MeshEffect { finer: Numerics { intervals, time_tolerance, .. }, other, chi_apart, .. } = effect;
    let what = if chi_apart.is_some() { "how unequal" } else { "whether it divides" };
    let there = other.as_ref().map_or_else(|failure| format!("no answer ({failure})"), found);
    format!(
        "the mesh or the time steps decide {what}: {} with these, {there} with --set intervals={intervals} --set time_tolerance={time_tolerance}\n",
        found(first)
    )
}

/// The outcome of a division in one word.
fn found(division: &Division) -> String {
    division.chi().map_or("no division".to_owned(), |chi| format!("χ = {chi:.4}"))
}

/// The reason why a division has no outcome.
fn reason(failure: Failure) -> CliError {
    match failure {
        Failure::Unsolved(error) => error.into(),
        failure => failure.into(),
    }
}

pub fn run(args: &DivideArgs, mut context: Context) -> Result<(), CliError> {
    let cell = args.cell.read(&mut context)?;
    context.settings.check_divisions("settings")?;
    let input = DivisionInput { cell, numerics: context.settings.numerics, seed: args.seed };
    check_seeds(args.seed, args.replicates)?;
    writable_frames(args.frames.as_deref())?;
    let every = args.frame_step.map(|step| positive("--frame-step", step)).transpose()?;
    let picture = args.plot.file()?;
    let movie = args.movie.file()?;
    let until = args.from_steady.then(|| positive("--until", args.until)).transpose()?;
    if input.numerics.modes > 0 {
        let allowed = "absent with --three-dimensional: disturbances of stationary shapes have axial symmetry";
        InputError::require(until.is_none(), "--from-steady", "from_steady", true, allowed)?;
        args.frames.iter().try_for_each(|path| check_path("--frames", "frames", path))?;
        return without_axis(args, &context, &input, (picture, movie, every));
    }
    let mut found = match until {
        Some(until) => disturb(args, &context, &input, until)?,
        None => divide(args, &context, &input)?,
    };
    found.resolve(&input.cell, context.json);
    if args.frames.is_some() || movie.is_wanted() || until.is_none() && picture.is_wanted() {
        interrupt::listen();
        interrupt::abort();
        let film = match until {
            Some(until) => disturbed(&input, until)?,
            None => Trajectory::compute(&input)?,
        };
        if let Some(folder) = &args.frames {
            check_step("--frame-step", film.division.t_end, every)?;
            interrupt::defer(|| write_frames(folder, &film, every))?;
        }
        let film = film.with_places(DENSE);
        if until.is_none() {
            picture.write(|| plot::division::draw(&input.cell, &film))?;
        }
        let of_film = |format, frames, shown: &dyn Fn(usize, usize)| {
            Movie { cell: &input.cell, film: &film, frames }.bytes_shown(format, shown)
        };
        movie.write(of_film, |frames| page(&input, &film, frames), context.progress)?;
    }
    if until.is_some() {
        let named = |one: &Replicate| Some((format!("seed {}", one.seed), one.perturbation.clone()?));
        let named: Vec<_> = found.replicates.iter().filter_map(named).collect();
        let title = format!("Disturbed stationary shape at {}", described(&input.cell, &[]));
        picture.write(|| plot::perturbation::draw(&title, &named))?;
    }
    // Results from a stationary shape are given only in natural units.
    let units = if until.is_some() { Units::default() } else { context.units };
    print_as(context.json, &document(&input.cell, &units, until, &found), || {
        text(&input, &units, &found) + &one_sided(&input.cell, &found.replicates)
    })
}

/// The page with the movie of an axisymmetric division.
fn page(input: &DivisionInput, film: &Trajectory, frames: usize) -> io::Result<String> {
    let times = even_times(film.times().last().copied().unwrap_or(0.0), frames);
    let frames: Vec<_> = times.into_iter().map(|t| frames::surface(&film.at(t))).collect();
    FilmPage { input, division: &film.division, wall: &film.wall(), value: frames::TENSION, frames: &frames }.html()
}

/// The page with the movie of a division without axial symmetry.
fn surface_page(input: &DivisionInput, film: &Film, frames: usize) -> io::Result<String> {
    let frames: Vec<_> = even_times(film.end(), frames).into_iter().map(|t| film::frame(&film.at(t))).collect();
    FilmPage { input, division: &film.found.division, wall: &film.wall, value: film::TENSION, frames: &frames }.html()
}

/// Divides the cell without axial symmetry; shapes are computed if the memo lacks part of the requested results.
fn without_axis(
    args: &DivideArgs,
    context: &Context,
    input: &DivisionInput,
    (picture, movie, every): (Picture, MovieFile, Option<f64>),
) -> Result<(), CliError> {
    let memo = context.memo()?;
    let filming = Filming::of(input.seed);
    let mut found = solve(args, context, input, &memo, |one: &DivisionInput| filming.solve(one))?;
    found.resolve(&input.cell, context.json);
    let draws = args.frames.is_some() || picture.is_wanted() || movie.is_wanted();
    // The bend of a cell without a waist is not stored.
    let bends = found.replicates[0].division.neck_offset.is_none();
    let film = match filming.into_film() {
        None if draws || context.json || bends => {
            Some(Film::compute(&DivisionInput { seed: found.replicates[0].seed, ..memo.canonical(input) })?)
        }
        film => film,
    };
    if let Some(film) = &film {
        if let Some(path) = &args.frames {
            check_step("--frame-step", film.found.division.t_end, every)?;
            interrupt::defer(|| write_film(path, film, every))?;
        }
        picture.write(|| plot::surface::draw(&input.cell, film))?;
        let of_film = |format, frames, shown: &dyn Fn(usize, usize)| {
            SurfaceMovie { cell: &input.cell, film, frames }.bytes_shown(format, shown)
        };
        movie.write(of_film, |frames| surface_page(input, film, frames), context.progress)?;
    }
    let document = || {
        merged(
            document(&input.cell, &context.units, None, &found),
            film.as_ref().map_or(Value::Null, |film| neck_report(&film.found)),
        )
    };
    print_as(context.json, &document(), || {
        let rest = film.as_ref().filter(|_| bends).and_then(|film| film.found.rest.as_ref());
        let bend =
            rest.map(|rest| format!("no waist; the middle of the cell is {:.4} L_h from the axis\n", rest.offset()));
        text(input, &context.units, &found) + &bend.unwrap_or_default()
    })
}

/// Checks that the frames can be written, before the computation.
fn writable_frames(path: Option<&Path>) -> Result<(), InputError> {
    let Some(path) = path else { return Ok(()) };
    let files = FrameFiles::of(path);
    let folder = matches!(files, FrameFiles::Csv(_));
    let allowed = "a folder, or a file whose name ends in .ply or .glb";
    InputError::require(!folder || !named_as_file(path), "--frames", "frames", format!("{path:?}"), allowed)?;
    let allowed = match files {
        FrameFiles::Glb(_) => "a file that can be written",
        FrameFiles::Csv(_) | FrameFiles::Ply(..) => "a folder that can be written to",
    };
    files.check().map_err(|error| not_writable("--frames", path, allowed, &error))
}

/// The cue with position and width from the cell's PAR polarity, if the cue depends on it; no cue if the cell is not polarised.
fn resolved_cue(cell: &Cell) -> Option<Cue> {
    let resolved = cell.cue.follows_par().then(|| polarity::resolved(cell).ok()).flatten()?;
    Some(resolved.cue.clone())
}

/// Said of a cell with a cue that follows PAR polarity and does not act.
const NO_POLARITY: &str = "the cell has no PAR polarity, and no cue acts";

/// The result as JSON: the cell, the first replicate, and all replicates.
fn document(cell: &Cell, units: &Units, until: Option<f64>, found: &Divisions) -> Value {
    let Divisions { replicates, undecided, .. } = found;
    let (first, Cell { r0, epsilon, xi_s, cue, .. }) = (&replicates[0], cell);
    let start = filled(json!({
        "r0_um": units.micrometres(*r0),
        "t_end_min": units.minutes(first.division.t_end),
        "from_steady": until.map(|_| true),
        "until": until,
        "start_growth_rate": first.perturbation.as_ref().map(|p| p.start_growth_rate),
    }));
    // A cell that does not divide has these keys too, without values.
    let keys = ["u_furrow", "daughters", "chi_mean", "chi_sd"].map(|key| (key.to_owned(), Value::Null));
    let parts = [
        start,
        Value::Object(keys.into_iter().collect()),
        json!(first),
        json!({ "replicates": replicates }),
        json!(Statistics::of(replicates.iter().map(|one| &one.division))),
        checks_report(&found.effects),
        json!({ "undecided": undecided }),
    ];
    let of_cell = json!({ "r0": r0, "epsilon": epsilon, "xi_s": xi_s, "cue": cue, "resolved_cue": found.resolved });
    let of_cell = filled(of_cell);
    parts.into_iter().fold(of_cell, merged)
}

/// The replicates, with the effects of the noise and of the mesh on the first.
fn divide(args: &DivideArgs, context: &Context, input: &DivisionInput) -> Result<Divisions, CliError> {
    let memo = context.memo()?;
    if args.replicates == 1 {
        return divide_once(context, input, &memo);
    }
    let mut found = solve(args, context, input, &memo, batch::solve)?;
    let Replicate { seed, division, .. } = &found.replicates[0];
    let first = DivisionInput { seed: *seed, ..input.clone() };
    let mesh = MeshEffect::of(&first, division, &memo, &context.scheduling(&|_| ()))?;
    let others = found.replicates[1..].iter().map(|one| (one.seed, &one.division));
    found.effects = Effects { settled: None, noise: NoiseEffect::of(&first, division, others), mesh };
    Ok(found)
}

/// One replicate with its checks.
fn divide_once(context: &Context, input: &DivisionInput, memo: &Memo) -> Result<Divisions, CliError> {
    if memo.known(input).is_none() {
        interrupt::listen();
        interrupt::finish();
    }
    let found = checked(input, memo, &context.scheduling(&|_| ())).map_err(|error| match error {
        SchedulerError::Unsolved { mut jobs, .. } if !jobs.is_empty() => reason(jobs.remove(0).failure),
        error => error.into(),
    })?;
    let Checked { division, effects, summary } = found.ok_or(CliError::Interrupted)?;
    messages::warn_of(&summary.warnings);
    let replicates = vec![Replicate { seed: input.seed, division, perturbation: None }];
    Ok(Divisions { replicates, effects, ..Divisions::default() })
}

/// Solves the replicates. At least one must succeed.
fn solve(
    args: &DivideArgs,
    context: &Context,
    input: &DivisionInput,
    memo: &Memo,
    solver: impl Solve,
) -> Result<Divisions, CliError> {
    let count = args.replicates as usize;
    if let Some(division) = memo.known(input).filter(|_| count == 1) {
        return at_least_one(vec![Replicate { seed: input.seed, division, perturbation: None }], vec![]);
    }
    interrupt::listen();
    interrupt::finish();
    let found = match count {
        1 => replicates_by(solver, input, count, memo, &context.scheduling(&|_| ()))?,
        _ => context.scheduled(|options| replicates_by(solver, input, count, memo, options))?,
    };
    messages::warn_of(&found.summary.warnings);
    if found.divisions.len() + found.undecided.len() < count {
        return Err(CliError::Interrupted);
    }
    let failed = found.undecided.into_iter().map(|job| (args.seed.wrapping_add(job.id as u64), reason(job.failure)));
    let solved = found.divisions.into_iter().map(|(seed, division)| Replicate { seed, division, perturbation: None });
    at_least_one(solved.collect(), failed.collect())
}

/// Disturbs the stationary shape with every seed; at least one division must succeed.
fn disturb(args: &DivideArgs, context: &Context, input: &DivisionInput, until: f64) -> Result<Divisions, CliError> {
    interrupt::listen();
    let (mut solved, mut failed) = (Vec::new(), Vec::new());
    for one in perturbations(input, args.replicates as usize, until, context.threads)? {
        match one.found {
            Ok(p) => solved.push(Replicate { seed: one.seed, division: p.division.clone(), perturbation: Some(p) }),
            Err(error) => failed.push((one.seed, error.into())),
        }
    }
    at_least_one(solved, failed)
}

/// The successful replicates and the number of failed ones. A warning is printed for every failure.
fn at_least_one(solved: Vec<Replicate>, mut failed: Vec<(u64, CliError)>) -> Result<Divisions, CliError> {
    if solved.is_empty()
        && let Some((_, error)) = failed.pop()
    {
        return Err(error);
    }
    for (seed, error) in &failed {
        messages::warning!("the replicate of seed {seed} is left out: {error}");
    }
    Ok(Divisions { replicates: solved, undecided: failed.len(), ..Divisions::default() })
}

fn text(DivisionInput { cell, numerics, .. }: &DivisionInput, units: &Units, found: &Divisions) -> String {
    let Divisions { replicates, effects: Effects { noise, mesh, .. }, .. } = found;
    let first = &replicates[0].division;
    let mut out = cell::described(cell, units, Some(cell.xi_s));
    if cell.has_cue() {
        let _ = write!(out, ", {}", cell.cue);
    }
    if let Some(Perturbation { start_growth_rate: rate, .. }) = &replicates[0].perturbation {
        let stable = if *rate < 0.0 { "stable" } else { "unstable" };
        let _ = writeln!(out, ", from its stationary shape, which is {stable}: growth rate {rate:.4}/τ");
        out.extend(replicates.iter().filter_map(|one| disturbed_line(one, numerics.intervals)));
        return out;
    }
    let _ = writeln!(out, ": {}", first.outcome());
    match &found.resolved {
        Some(cue) if cue.is_none() => {
            let _ = writeln!(out, "{NO_POLARITY}");
        }
        Some(cue) => {
            let _ = writeln!(out, "with PAR polarity the cue is {cue}");
        }
        None => {}
    }
    out += &division_text(first, units);
    if replicates.len() > 1 {
        let statistics = Statistics::of(replicates.iter().map(|one| &one.division));
        let chi = statistics.chi_mean.zip(statistics.chi_sd);
        let chi = chi.map_or(String::new(), |(mean, sd)| format!(", χ = {mean:.4} ± {sd:.4} (sd)"));
        let divided = replicates.len() - statistics.failed;
        let _ = writeln!(out, "{} replicates: {divided} divided{chi}", replicates.len());
    }
    out.extend(noise.iter().filter(|noise| noise.decides).map(|noise| noise_text(noise, first)));
    out.extend(mesh.iter().filter(|mesh| mesh.decides).map(|mesh| mesh_text(mesh, first)));
    out
}

/// A time with the given number of decimals; long times are rounded to significant digits.
fn time(t: f64, decimals: usize) -> String {
    if t < 1000.0 { format!("{t:.decimals$}") } else { rounded_number(t, 5) }
}

/// The description of a division.
fn division_text(d: &Division, units: &Units) -> String {
    let (mut out, t_end, minutes) = (String::new(), d.t_end, units.in_minutes(d.t_end));
    if let (Some(chi), Some(u), Some([below, above])) = (d.chi(), d.u_furrow(), d.daughters()) {
        let [um_below, um_above] = [below, above].map(|r0| units.in_micrometres(r0));
        let _ = writeln!(
            out,
            "χ = {chi:.4}, furrow at u = {u:.4}, daughters R0 = {below:.4}{um_below} (at u = 0), {above:.4}{um_above} (at u = 1)\n\
             pinch-off at t = {} τ{minutes}",
            time(t_end, 4)
        );
    } else {
        let stability = |s: f64| if s < 0.0 { "stable" } else { "where the published scheme cannot leave" };
        let stable = d.growth_rate().map_or(String::new(), |s| format!(", {}: growth rate {s:.4}/τ", stability(s)));
        let _ = writeln!(out, "at rest at t = {} τ{minutes}{stable}", time(t_end, 2));
    }
    if let (Some(second), Some(u), Some([below, above])) = (d.second_neck, d.u_furrow(), d.shares()) {
        let outer = if second.u < u { above } else { below };
        let mut parts = [outer, 1.0 - outer - second.share, second.share];
        if second.u < u {
            parts.reverse();
        }
        let [first, middle, last] = parts.map(|share| format!("{:.1} %", 100.0 * share));
        let _ = writeln!(
            out,
            "a second neck at u = {:.4} is nearly closed too (r = {:.4} L_h): the cell falls into three parts, {first}, {middle} and {last} of its volume from u = 0 on; χ is that of the first neck",
            second.u, second.radius
        );
    }
    if let Some(offset) = d.neck_offset {
        let _ = writeln!(out, "neck {offset:.4} L_h from the axis at the end");
    }
    if let Some(phi) = d.phi {
        let place = if d.u_furrow().is_some() { "the furrow" } else { "u = 0.5" };
        let _ = writeln!(out, "regulator φ = {phi:.4} at {place}");
    }
    if let Some(rate) = d.slow_growth_rate {
        let _ = writeln!(out, "just above the threshold: the stationary shape is left at {rate:.2e}/τ");
    }
    let (work, drift) = (&d.work, d.volume_drift);
    let counts = format!("{} steps ({} rejected), {} Newton iterations", work.steps, work.rejected, work.iterations);
    let _ = writeln!(out, "{counts}, volume drift {drift:.1e}");
    out
}

/// The prediction of linear theory for a cell that does not divide with axial symmetry, if a non-axisymmetric disturbance grows.
fn one_sided(cell: &Cell, solved: &[Replicate]) -> String {
    let is_stable = |ending: &Ending| matches!(ending, Ending::Arrested { growth_rate: Some(rate) } if *rate < 0.0);
    let rests = solved.iter().any(|one| is_stable(&one.division.ending));
    match one_sided_from(cell).filter(|from| rests && cell.xi_s > *from) {
        Some(from) => format!(
            "it rests only while it keeps its axis: above ξ_s = {from:.1} a bend to one side (m = 1) grows by linear theory; --three-dimensional computes how it ends\n"
        ),
        None => String::new(),
    }
}

/// One line of a result of --from-steady.
fn disturbed_line(Replicate { seed, division, perturbation }: &Replicate, intervals: usize) -> Option<String> {
    let p = perturbation.as_ref()?;
    let distance = |k: usize| p.distances.get(k).map_or(0.0, |[_, distance]| *distance);
    let (last, t_end) = (distance(p.distances.len().saturating_sub(1)), division.t_end);
    let end = match division.chi() {
        Some(chi) => format!("; divides at t = {} τ, χ = {chi:.4}", time(t_end, 4)),
        None => {
            let way = match (p.is_resolved(), p.returned()) {
                (false, _) => {
                    format!("this mesh does not resolve so slow a motion, try --set intervals={}", 2 * intervals)
                }
                (true, true) => "it returns".to_owned(),
                (true, false) => "it leaves".to_owned(),
            };
            format!(", {last:.2e} at t = {} τ: {way}", time(t_end, 2))
        }
    };
    Some(format!("seed {seed}: dis = {:.2e} after the noise{end}\n", distance(1)))
}

/// The trajectory of a disturbed stationary shape.
fn disturbed(input: &DivisionInput, until: f64) -> Result<Trajectory, PerturbationError> {
    let start = stationary(&input.cell, &input.numerics)?;
    let mut recorder = Recorder::default();
    let mut record = |frame: Frame<'_>| recorder.record(frame);
    let division = perturb(input, &start, until, DivisionOptions::observed_by(&mut record))?.division;
    Ok(recorder.finish(input, division))
}
