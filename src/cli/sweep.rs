//! `furrow sweep`: many divisions, trees, pitchforks or critical radii.

use std::path::PathBuf;
use std::time::Instant;

use clap::Args;
use serde::Serialize;

use super::context::{Context, Globals, warn_of_store};
use super::error::CliError;
use super::interrupt;
use super::output::{print_as, writable_folder};
use super::plot::PlotArgs;
use super::progress::ProgressLine;
use crate::io::Settings;
use crate::io::sweep_files::{SWEEP_FILES, SweepTable};
use crate::study::{Done, Run, Shard, Standing, Sweep};

/// Computes divisions, trees, pitchforks or critical radii over axes of parameters
///
/// Writes results.csv (one row per point, the first axis varies slowest), the same rows in results.jsonl, and all inputs in
/// sweep.json. Interrupted sweeps resume.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  furrow sweep studies/cue-position.ron --out cue-position --shard 1/50
  furrow sweep studies/cue-position.ron --out part-2 --shard 2/50 --plot part.svg --json")]
pub struct SweepArgs {
    /// Sweep file: kind, axes and settings
    #[arg(value_name = "SWEEP.ron")]
    sweep: PathBuf,
    /// Output folder; files of another sweep in it are moved to a folder earlier-N inside
    #[arg(help_heading = "Output", long, value_name = "DIR")]
    out: PathBuf,
    /// Solves only part K of N, chosen by the points' hashes; see furrow merge
    #[arg(help_heading = "Run", long, value_name = "K/N")]
    shard: Option<Shard>,
    #[command(flatten)]
    plot: PlotArgs,
}

/// What `--json` prints.
#[derive(Serialize)]
struct Answer {
    /// Points of the sweep, or of this part of it.
    points: usize,
    solved: usize,
    reused: usize,
    undecided: usize,
    #[serde(skip_serializing_if = "Option::is_none")]
    shard: Option<Shard>,
    elapsed_s: f64,
    out: String,
}

pub fn run(args: &SweepArgs, context: &Context, globals: &Globals) -> Result<(), CliError> {
    let start = Instant::now();
    interrupt::finish();
    // What the sweep file says comes between the configuration file and the settings of the command line.
    let base = Settings::load(&globals.preset, globals.config.as_deref(), &[])?;
    let sweep = Sweep::read(&args.sweep, &base, &globals.set)?;
    writable_folder("--out", args.out.as_path(), &SWEEP_FILES)?;
    let picture = args.plot.file()?;
    let memo = context.memo()?;
    let line = ProgressLine::new(context.progress);
    let show = |standing: Standing| line.show_share(standing.done, standing.of);
    let run = Run {
        sweep: &sweep,
        shard: args.shard,
        memo: &memo,
        threads: context.threads,
        interrupt: interrupt::flag(),
        progress: &show,
    };
    let solved = run.solve();
    drop(line);
    let Done { rows, undecided, solved, reused, interrupted, warnings } = solved?;
    warn_of_store(&warnings);
    if interrupted {
        return Err(CliError::Interrupted);
    }
    if let Some(first) = undecided.first().and_then(|place| rows.get(*place)) {
        let why = first.why.as_deref().unwrap_or_default();
        tracing::warn!(
            "{} of {} points are undecided, wholly or in part; the first has index {}: {why}",
            undecided.len(),
            rows.len(),
            first.index
        );
    }
    let table = SweepTable::new(&sweep, memo.quantisation(), args.shard, rows)?;
    if let Some((aside, what)) = interrupt::defer(|| table.write(&args.out))? {
        tracing::warn!("the files of another sweep were moved to {}: {what}", aside.display());
    }
    picture.write(|| crate::plot::sweep::draw(&sweep, &table.rows))?;
    let document = Answer {
        points: table.rows.len(),
        solved,
        reused,
        undecided: undecided.len(),
        shard: args.shard,
        elapsed_s: start.elapsed().as_secs_f64(),
        out: args.out.display().to_string(),
    };
    print_as(context.json, &document, || {
        let part = args.shard.map_or(String::new(), |shard| format!(" of part {shard}"));
        let Answer { points, elapsed_s, out, .. } = &document;
        format!("{points} points{part}: {solved} solved, {reused} reused, {elapsed_s:.2} s; files in {out}\n")
    })
}
