//! `furrow test`: comparison of hypotheses.

use std::path::PathBuf;
use std::time::Instant;

use clap::Args;
use furrow_analysis::Shard;
use furrow_analysis::fit::{FitProgress, FitRun};
use furrow_analysis::hypotheses::free::Free;
use furrow_analysis::hypotheses::observations::Chosen;
use furrow_analysis::hypotheses::{
    Effort, Hypothesis, Named, Noise, NoiseKind, Observations, Others, Question, samples_csv, test,
};
use furrow_analysis::tempering::Sampling;
use furrow_analysis::tree_settings;
use furrow_figures::plot;
use furrow_formats::write_atomically;
use furrow_input::{InputError, listed};
use furrow_lineage::batch::Store;
use furrow_lineage::{Lineage, TreeSettings};
use furrow_measured::lifetimes::{LifetimeOptions, Lifetimes};
use furrow_measured::published::jankele2021_lifetimes;
use furrow_measured::tracked::{EmbryoFile, TableKind};
use furrow_measured::volumes::{ReadOptions, Unit};
use serde_json::json;

use super::cell::{load_lineage, one_of};
use super::context::Context;
use super::embryos::{MatchArgs, OfEmbryo, files_of, of_embryo, sizes_text, voxels};
use super::error::CliError;
use super::interrupt;
use super::messages;
use super::output::{merged, print_as, seed};
use super::picture::PlotArgs;

#[derive(Debug, Args)]
#[command(after_help = "\
A table is one of furrow compare volumes: of volumes of cells, of divisions, or of χ with the columns mother and chi (or chi_signed) \
and optionally embryo, group, chi_sd (the standard deviation of that χ) and mother_um3; or a file of targets (.ron) of furrow fit cue.

Each hypothesis is fitted by itself. log L is its largest log likelihood under normal errors of |χ| (of χ with --folded), k the fitted \
numbers, and \"left out\" the log likelihood of each embryo under the fit to the others (of each division, if there are fewer than two \
embryos). Two hypotheses are distinguishable if the differences of these have p < 0.05 by Student's t and their sum is at least 1.

Examples:
  furrow test data/jankele2021_volumes.csv --cue none --cue germline
  furrow test chi.csv --cue germline --cue tension:gradient,amplitude=-0.3
  furrow test chi.csv --cue germline --free cue.amplitude,epsilon@somatic --json")]
pub struct TestArgs {
    /// Measured χ: tables (CSV), embryos tracked by other programs, or folders of these; or targets (RON)
    #[arg(value_name = "TABLE", required = true)]
    tables: Vec<PathBuf>,
    /// Hypotheses, one for each --cue: none, a name in the lineage file, or terms FIELD:PROFILE,key=value,.. joined by +; "NAME=CUE"
    /// names the hypothesis
    #[arg(help_heading = "Hypotheses", long, value_name = "CUE", required_unless_present = "hypotheses")]
    cue: Vec<String>,
    /// A file of hypotheses (RON). Each has a cue and may have its own list of free numbers:
    /// Hypotheses(hypotheses: [(name: "a", cue: "germline", free: ["epsilon", "epsilon@somatic"])])
    #[arg(help_heading = "Hypotheses", long, value_name = "FILE.ron")]
    hypotheses: Option<PathBuf>,
    /// Numbers to fit: PARAMETER, PARAMETER@CLASS for a class of cells (germline, somatic or a founder), or PARAMETER@embryo, which varies
    /// between embryos in the posterior. The default is every number of the cue; "none" fits nothing
    ///
    /// A number of a cue is fitted only in hypotheses with this cue. With epsilon,epsilon@P2 the cells of P2 have their own ε; all other
    /// cells share one. r0 is the radius of the first cell; all given radii scale with it, which is equivalent to fitting L_h. growth is
    /// the volume at division divided by the volume at birth, from 0.5 to 2. The default ranges are the same as
    /// in furrow fit cue for numbers of a cue, and as in furrow solve for other numbers; PARAMETER@CLASS=FROM..TO sets another range.
    #[arg(help_heading = "Hypotheses", long, value_name = "NAME@CLASS,..", value_delimiter = ',')]
    free: Option<Vec<String>>,
    /// Founders with their cues, which the hypotheses replace; default the built-in C. elegans founders
    #[arg(help_heading = "Hypotheses", long, value_name = "LINEAGE.ron")]
    lineage: Option<PathBuf>,
    /// Errors of χ: given by the table; one common error that is fitted; or from replicates, increasing as cells become smaller. Default
    /// given if the table has them, otherwise common
    #[arg(help_heading = "Measurements", long, value_name = "KIND", value_parser = one_of(NoiseKind::NAMED))]
    noise: Option<NoiseKind>,
    /// Models measured |χ| as the absolute value of a χ with a normal error, so that an equal division may look slightly unequal
    #[arg(help_heading = "Measurements", long)]
    folded: bool,
    /// Cells to use, such as P0,P1,P2,P3; default all that are in the lineage
    #[arg(help_heading = "Measurements", long, value_name = "NAME,NAME,..", value_delimiter = ',')]
    cells: Option<Vec<String>>,
    /// Groups of the table to use; default all
    #[arg(help_heading = "Measurements", long, value_name = "NAME,NAME,..", value_delimiter = ',')]
    population: Option<Vec<String>>,
    /// Columns whose joined texts are the mother's class, a founder of the lineage: population,generation for Mac6, Mac7, ..
    /// For tables of divisions and of χ
    #[arg(help_heading = "Measurements", long, value_name = "COLUMN,..", value_delimiter = ',')]
    class: Vec<String>,
    /// Edge length of a voxel in µm, which converts voxels to µm³; EMBRYO=UM sets it for one embryo
    #[arg(help_heading = "Measurements", long, value_name = "UM|EMBRYO=UM", value_parser = of_embryo)]
    voxel: Vec<OfEmbryo>,
    /// Includes the observed mean rounds of the lineage's founders, with this standard deviation in rounds
    #[arg(help_heading = "Measurements", long, value_name = "SD", num_args = 0..=1, require_equals = true,
        default_missing_value = "1")]
    rounds: Option<f64>,
    /// Includes lifetimes of cells, compared with the lineage's clock: tables as for furrow compare lifetimes, or
    /// published for the means of 28 embryos of C. elegans
    #[arg(help_heading = "Measurements", long, value_name = "TABLE")]
    lifetimes: Vec<PathBuf>,
    /// Standard deviation of ln lifetime of the cells of a generation about the clock
    #[arg(help_heading = "Measurements", long, value_name = "SD", default_value_t = 0.2, requires = "lifetimes")]
    lifetime_sd: f64,
    #[command(flatten)]
    matching: MatchArgs,
    /// Unit of volumes in a table that gives no unit: um3, voxels or relative
    #[arg(help_heading = "Measurements", long, value_name = "UNIT", value_parser = str::parse::<Unit>)]
    unit: Option<Unit>,
    /// Particles of the swarm that searches for each best fit; default 12 per free number
    #[arg(help_heading = "Search", long, value_name = "N", value_parser = clap::value_parser!(u32).range(2..=10_000))]
    particles: Option<u32>,
    /// Moves of the swarm; default 10 per free number
    #[arg(help_heading = "Search", long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=100_000))]
    moves: Option<u32>,
    /// Seed of the search and of the samples
    #[arg(help_heading = "Search", long, value_name = "S", default_value_t = 0, value_parser = seed)]
    seed: u64,
    /// Also draws a sample of each posterior with this many points, and prints intervals, evidence, combinations of numbers that remain
    /// undetermined, and cells that contradict the hypothesis
    #[arg(help_heading = "Posterior", long, value_name = "N", value_parser = clap::value_parser!(u32).range(20..=100_000))]
    samples: Option<u32>,
    /// Writes the samples as a table (CSV): a column for each number, a row for each point
    #[arg(help_heading = "Posterior", long, value_name = "FILE.csv", requires = "samples")]
    posterior: Option<PathBuf>,
    /// Draws part K of N of a sample, each with --samples points; furrow merge combines the parts
    #[arg(help_heading = "Posterior", long, value_name = "K/N", requires = "posterior")]
    shard: Option<Shard>,
    #[command(flatten)]
    plot: PlotArgs,
}

pub fn run(args: &TestArgs, context: &Context) -> Result<(), CliError> {
    let start = Instant::now();
    let picture = args.plot.file()?;
    let lineage = load_lineage(args.lineage.as_deref())?;
    context.settings.check_divisions("settings")?;
    context.settings.check_activity("settings")?;
    context.check_taken(&[&lineage], [])?;
    let settings = tree_settings(context.settings_in(&lineage.units())?, &lineage, 0, context.quantisation);
    let free = args.free.as_ref().map(|texts| Free::list(texts, &lineage, "--free")).transpose()?;
    let hypotheses = hypotheses(args, free.as_deref(), &lineage, &settings)?;
    if let Some(file) = &args.posterior {
        let is_free = hypotheses.iter().any(|hypothesis| hypothesis.free() > 0);
        let allowed = "left out: no hypothesis has a number that is fitted, and the table would have no column";
        InputError::require(is_free, "--posterior", "posterior", format!("{:?}", file.display().to_string()), allowed)?;
    }
    let files = files_of(&args.tables, TableKind::Volumes)?;
    let observations = observations(args, &files, &lineage)?;
    let table = files.first().map_or(String::new(), |file| file.path.display().to_string());
    let noise = Noise::of(&observations, args.noise, args.folded, (&table, "--noise"))?;
    let memo = context.memo()?;
    interrupt::finish();
    let (particles, moves) = (args.particles.map(|count| count as usize), args.moves.map(u64::from));
    let effort = Effort { particles, moves, seed: args.seed };
    let seed = args.shard.map_or(args.seed, |shard| shard.seed(args.seed));
    let sampling = args.samples.map(|samples| Sampling { particles: samples as usize, seed });
    let question =
        Question { observations: &observations, hypotheses: &hypotheses, noise: &noise, effort, sampling, memo: &memo };
    question.check("--free")?;
    let found = context.shown(|line| {
        let show = |FitProgress { done, of, .. }| line.show_share(done, of, || "candidates".to_owned());
        let run = FitRun::new(&lineage, &settings, context.threads, interrupt::flag());
        test(&FitRun { progress: Some(&show), ..run }, &question)
    })?;
    if !found.near_zero.is_empty() {
        messages::warning!(
            "|χ| of {} lies within two errors of 0 in the table and in a hypothesis: an equal division then looks unequal, which favours a \
             weak cue; --folded takes this into account",
            listed(found.near_zero.iter().map(String::as_str), ", ")
        );
    }
    messages::warn_of(memo.store().map_or_else(Vec::new, Store::take_warnings));
    picture.write(|| plot::hypotheses::draw(&found))?;
    if let Some(file) = &args.posterior {
        let sampled =
            found.hypotheses.iter().filter_map(|tested| Some((tested.name.as_str(), tested.posterior.as_ref()?)));
        write_atomically(file, samples_csv(sampled, args.shard).as_bytes())?;
    }
    let elapsed_s = start.elapsed().as_secs_f64();
    let document = merged(json!(found), json!({ "seed": args.seed, "elapsed_s": elapsed_s }));
    print_as(context.json, &document, || {
        let sizes = if files.len() > 1 { sizes_text(&found.embryos, None) } else { String::new() };
        sizes + &found.to_string()
    })
}

/// The hypotheses of the options and of the file.
fn hypotheses(
    args: &TestArgs,
    free: Option<&[Free]>,
    lineage: &Lineage,
    settings: &TreeSettings,
) -> Result<Vec<Hypothesis>, CliError> {
    let mut asked = Named::list(&args.cue, "--cue")?;
    if let Some(file) = &args.hypotheses {
        asked.extend(Named::file(file)?);
    }
    let file = args.hypotheses.as_ref().map(|file| file.display().to_string());
    let source = file.as_deref().filter(|_| args.cue.is_empty()).unwrap_or("--cue");
    Ok(Hypothesis::all(&asked, free, lineage, &settings.cell, [source, "--free"])?)
}

/// Observations other than χ.
fn others(args: &TestArgs, lineage: &Lineage) -> Result<Vec<Others>, CliError> {
    let rounds = args.rounds.map(|sd| Others::rounds(lineage, sd, "--rounds"));
    let lifetimes = |files: &[PathBuf]| {
        let names = args.matching.names(lineage)?;
        let found = match files {
            [one] if one.as_os_str() == PUBLISHED => jankele2021_lifetimes()?,
            files => Lifetimes::read_files(
                &files_of(files, TableKind::Lifetimes)?,
                &LifetimeOptions { names, ..LifetimeOptions::default() },
            )?,
        };
        Ok::<_, CliError>(Others::lifetimes(&found, lineage, args.lifetime_sd, "--lifetimes")?)
    };
    let of_lifetimes = (!args.lifetimes.is_empty()).then(|| lifetimes(&args.lifetimes));
    rounds.map(|found| found.map_err(CliError::from)).into_iter().chain(of_lifetimes).collect()
}

/// The value that selects the published lifetimes.
const PUBLISHED: &str = "published";

/// The measured χ of the table, or of a file of targets.
fn observations(args: &TestArgs, files: &[EmbryoFile], lineage: &Lineage) -> Result<Observations, CliError> {
    let (voxel, names) = (voxels(&args.voxel)?, args.matching.names(lineage)?);
    let reading = ReadOptions { voxel, group: None, unit: args.unit, names, class: args.class.clone() };
    let chosen = Chosen { cells: args.cells.as_deref(), groups: args.population.as_deref() };
    let observations = Observations::read(files, &reading, lineage, chosen, ["--cells", "--population"])?;
    if observations.of_nuclei {
        messages::warning!("AceTree and StarryNite measure nuclei: χ is that of their nuclei, not of the cells");
    }
    if !observations.pooled.is_empty() {
        let groups = observations.pooled.iter().map(|group| if group.is_empty() { "(none)" } else { group.as_str() });
        messages::warning!("the groups {} are taken together; --population selects one", listed(groups, ", "));
    }
    Ok(Observations { others: others(args, lineage)?, ..observations })
}
