//! `furrow sweep`: many divisions, trees, pitchforks or critical radii.

use std::time::Instant;

use super::context::{Globals, warn_of_store};
use super::interrupt;
use super::output::writable_folder;
use super::prelude::*;
use super::progress::ProgressLine;
use furrow_analysis::sweep_files::{SWEEP_FILES, SweepFilesError, SweepTable, open_journal};
use furrow_analysis::{Run, Shard, Sweep, SweepProgress};
use furrow_cell::settings::Settings;

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  furrow sweep studies/cue-position.ron --out cue-position --shard 1/50
  furrow sweep studies/cue-position.ron --out part-2 --shard 2/50 --plot part.svg --json")]
pub struct SweepArgs {
    /// Sweep file: kind, axes and settings
    #[arg(value_name = "SWEEP.ron")]
    sweep: PathBuf,
    /// Output folder; files of another sweep in it are overwritten
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
    /// Points whose rows an interrupted run had finished.
    resumed: usize,
    undecided: usize,
    #[serde(skip_serializing_if = "Option::is_none")]
    shard: Option<Shard>,
    elapsed_s: f64,
    out: String,
}

pub fn run(args: &SweepArgs, context: &Context, globals: &Globals) -> Result<(), CliError> {
    let start = Instant::now();
    interrupt::finish();
    // The sweep file overrides --config; --set overrides the sweep file.
    let base = Settings::load(&globals.preset, globals.config.as_deref(), &[])?;
    let sweep = Sweep::read(&args.sweep, &base, &globals.set)?;
    writable_folder("--out", args.out.as_path(), &SWEEP_FILES)?;
    let picture = args.plot.file()?;
    let memo = context.memo()?;
    let line = ProgressLine::new(context.progress);
    let show = |progress: SweepProgress| line.show_share(progress.done, progress.of);
    let journal = open_journal(&sweep, memo.quantisation(), args.shard, &args.out)?;
    let solved = Run {
        shard: args.shard,
        threads: context.threads,
        journal: Some(&journal),
        progress: &show,
        ..Run::new(&sweep, &memo, interrupt::flag())
    }
    .solve();
    drop(line);
    let found = solved?;
    warn_of_store(&found.warnings);
    if found.interrupted {
        tracing::warn!("finished rows are kept in {}; the same command resumes the sweep", args.out.display());
        return Err(CliError::Interrupted);
    }
    let undecided = found.undecided().count();
    if let Some(first) = found.undecided().next() {
        let (of, why) = (found.rows.len(), first.why.as_deref().unwrap_or_default());
        let index = first.index;
        tracing::warn!(
            "{undecided} of {of} points are undecided, wholly or in part; the first has index {index}: {why}"
        );
    }
    let table = SweepTable::new(&sweep, memo.quantisation(), args.shard, found.rows)?;
    interrupt::defer(|| {
        table.write(&args.out)?;
        if let Err(error) = journal.finish() {
            tracing::warn!("the file of finished rows: {error}");
        }
        Ok::<_, SweepFilesError>(())
    })?;
    picture.write(|| furrow_figures::plot::sweep::draw(&sweep, &table.rows))?;
    let document = Answer {
        points: table.rows.len(),
        solved: found.solved,
        reused: found.reused,
        resumed: found.resumed,
        undecided,
        shard: args.shard,
        elapsed_s: start.elapsed().as_secs_f64(),
        out: args.out.display().to_string(),
    };
    print_as(context.json, &document, || {
        let part = args.shard.map_or(String::new(), |shard| format!(" of part {shard}"));
        let Answer { points, solved, reused, resumed, elapsed_s, out, .. } = &document;
        let resumed = if *resumed > 0 { format!(", {resumed} resumed") } else { String::new() };
        format!("{points} points{part}: {solved} solved, {reused} reused{resumed}, {elapsed_s:.2} s; files in {out}\n")
    })
}
