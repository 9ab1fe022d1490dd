//! `furrow sweep`: many divisions, trees, pitchforks or critical radii.

use super::cell::AxisArgs;
use super::context::Context;
use super::error::CliError;
use super::interrupt;
use super::messages;
use super::output::{filled, print_as, writable_folder};
use super::picture::PlotArgs;
use super::progress::ProgressLine;
use clap::Args;
use furrow_analysis::sweep_files::{SWEEP_FILES, SweepTable};
use furrow_analysis::{Kind, Run, Shard, Sweep, SweepProgress};
use furrow_cell::settings::Overrides;
use furrow_figures::plot;
use furrow_formats::files::WriteError;
use furrow_lineage::batch::Summary;
use serde_json::json;
use std::path::PathBuf;
use std::time::Instant;

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  furrow sweep studies/cue-amplitude.ron --out cue-amplitude --shard 1/50
  furrow sweep studies/cue-amplitude.ron --out part --shard 2/50 --plot part.svg")]
pub struct SweepArgs {
    /// Sweep file: kind, axes and settings
    #[arg(value_name = "SWEEP.ron")]
    sweep: PathBuf,
    /// Output folder; files of another sweep in it are overwritten unless that sweep was interrupted and can be resumed
    #[arg(help_heading = "Output", long, value_name = "DIR")]
    out: PathBuf,
    /// Solves only part K of N, selected by the hashes of the points; see furrow merge
    #[arg(help_heading = "Run", long, value_name = "K/N")]
    shard: Option<Shard>,
    #[command(flatten)]
    pub axis: AxisArgs,
    #[command(flatten)]
    plot: PlotArgs,
}

pub fn run(args: &SweepArgs, context: &Context) -> Result<(), CliError> {
    let start = Instant::now();
    interrupt::finish();
    // The sweep file overrides --config; --set overrides the sweep file.
    let globals = &context.globals;
    let base = globals.load(globals.config.as_deref(), &[])?;
    let sweep = Sweep::read(&args.sweep, &base, &Overrides::read(&globals.set)?)?;
    if !matches!(sweep.kind, Kind::Division | Kind::Tree | Kind::Critical) {
        sweep.settings.check_axisymmetric("settings")?;
    }
    if sweep.kind == Kind::Tree {
        context.check_taken(&[&sweep.lineage], [])?;
    }
    messages::warn_of(sweep.doubts());
    messages::warn_of(sweep.lacks_regulator().map(|doubt| format!("--cue: {doubt}")));
    writable_folder("--out", args.out.as_path(), &SWEEP_FILES)?;
    let picture = args.plot.file()?;
    let memo = context.memo()?;
    let line = ProgressLine::new(context.progress);
    let show = |progress: SweepProgress| line.show_share(progress.done, progress.of, || "points".to_owned());
    let (shard, threads, quantisation) = (args.shard, context.threads, memo.quantisation());
    let journal = SweepTable::new(&sweep, quantisation, shard, Vec::new()).open_journal(&args.out)?;
    let all = Run::new(&sweep, &memo, interrupt::flag());
    let found = Run { shard, threads, journal: Some(&journal), progress: &show, ..all }.solve();
    drop(line);
    let mut found = found?;
    messages::warn_of(found.summary.described());
    if found.summary.interrupted {
        messages::warning!("finished rows are kept in {}; the same command resumes the sweep", args.out.display());
        return Err(CliError::Interrupted);
    }
    let undecided = found.undecided().count();
    messages::warn_of(found.undecided_points());
    let table = SweepTable::new(&sweep, quantisation, shard, std::mem::take(&mut found.rows));
    interrupt::defer(|| {
        table.write(&args.out)?;
        journal.finish().unwrap_or_else(|error| messages::warning!("the file of finished rows: {error}"));
        Ok::<_, WriteError>(())
    })?;
    picture.write(|| plot::sweep::draw(&sweep, &table.rows))?;
    let (points, elapsed_s, out) = (table.rows.len(), start.elapsed().as_secs_f64(), args.out.display().to_string());
    let Summary { solved, memo_hits, .. } = &found.summary;
    // Only points of this part of the sweep are counted; resumed points are those finished by an interrupted run.
    let document = json!({
        "points": points, "solved": solved, "reused": memo_hits, "resumed": found.resumed,
        "undecided": undecided, "shard": args.shard, "elapsed_s": elapsed_s, "out": out,
    });
    print_as(context.json, &filled(document), || {
        let part = args.shard.map_or(String::new(), |shard| format!(" of part {shard}"));
        let resumed = if found.resumed > 0 { format!(", {} resumed", found.resumed) } else { String::new() };
        let open = if undecided > 0 { format!(", {undecided} undecided") } else { String::new() };
        let counts = format!("{points} points{part}: {solved} solved, {memo_hits} reused{resumed}{open}");
        format!("{counts}, {elapsed_s:.2} s; files in {out}\n")
    })
}
