//! `furrow tree`: the main job.

use super::cell::FirstCellArgs;
use super::context::{Context, answer, warn_of_store, warning_text};
use super::error::CliError;
use super::progress::ProgressLine;
use crate::batch::Summary;
use crate::batch::scheduler::workers;
use crate::cell::Cell;
use crate::division::divide;
use crate::io::{FounderRow, Provenance, founder_rows, newick, parse_cue, write_atomically};
use crate::lineage::{Ends, Grower, Lineage, Tree, TreeSettings, expected_work};
use crate::report;
use crate::shapes::CriticalRadii;
use clap::Args;
use serde::Serialize;
use std::path::PathBuf;
use std::time::Instant;

/// Grows a lineage from one cell: every division is solved, its daughters divide next, until none can
///
/// Prints the rounds of division per founder beside the observed ones and writes tree.nwk, tree.json, tree.svg,
/// report.html and run.json.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  furrow tree
  furrow tree --cue none --xi 26 --out no-cue
  furrow tree lineages/c_elegans.ron --r0 3.5 --epsilon 0.85 --json")]
pub struct TreeArgs {
    /// Founders, cues and limits; default the built-in C. elegans founders
    #[arg(value_name = "LINEAGE.ron")]
    lineage: Option<PathBuf>,
    #[command(flatten)]
    cell: FirstCellArgs,
    /// Folder for the files
    #[arg(help_heading = "Output", long, value_name = "DIR", default_value = "furrow-out")]
    out: PathBuf,
    /// Seed of the noise in the first step of every division
    #[arg(help_heading = "Numerics", long, value_name = "S", default_value_t = 0)]
    seed: u64,
    /// Replaces every cue that the lineage gives: none, a name in the lineage file, or terms
    /// FIELD:PROFILE,key=value,.. joined by +
    #[arg(help_heading = "Cell", long, value_name = "CUE")]
    cue: Option<String>,
    /// Computes the division of every cell, those below the critical radius of their cue included
    #[arg(help_heading = "Numerics", long)]
    dynamics: bool,
}

/// What `--json` prints.
#[derive(Serialize)]
struct Answer<'a> {
    founders: &'a [FounderRow],
    cells: usize,
    generations: usize,
    ended: &'a std::collections::BTreeMap<&'static str, usize>,
    divisions_solved: usize,
    memo_hits: usize,
    elapsed_s: f64,
    out: String,
}

/// `run.json`: what this run did, which need not be the same another time.
#[derive(Serialize)]
struct RunRecord {
    schema: &'static str,
    schema_version: u32,
    provenance: Provenance,
    elapsed_s: f64,
    threads: usize,
    cells: usize,
    divisions_solved: usize,
    memo_hits: usize,
    store_hits: usize,
    corrupt_entries: usize,
    quantisation: QuantisationRecord,
    warnings: Vec<String>,
}

#[derive(Serialize)]
struct QuantisationRecord {
    /// Relative step of R0.
    r0_step: f64,
    /// Largest relative shift of a cell's R0.
    max_r0_shift: f64,
    /// Estimated largest effect of it on χ.
    chi_effect: f64,
}

pub fn run(args: &TreeArgs, context: &Context) -> Result<(), CliError> {
    let start = Instant::now();
    let given = args.cell.settings(&context.settings)?;
    let mut lineage = Lineage::load(args.lineage.as_deref())?;
    if args.cell.r0.is_some() {
        // What the option says counts, also where the lineage gives its first cell a radius.
        let first = lineage.first();
        lineage.founders[first].r0 = None;
    }
    if let Some(text) = &args.cue {
        let cue = parse_cue(text, &lineage)?;
        let name = match lineage.cue(text) {
            _ if cue.is_none() => "none",
            Some(_) => text,
            None => "given",
        };
        lineage = lineage.with_cues_replaced(name, &cue);
    }
    let memo = context.memo()?;
    let line = ProgressLine::new(context.progress);
    let show = |progress| line.show(progress);
    let settings = TreeSettings {
        cell: given.cell,
        numerics: given.numerics,
        seed: args.seed,
        r0_step: context.quantisation.relative_step(),
    };
    let rule = Ends::new(CriticalRadii::new(&settings.numerics));
    let order = if args.dynamics { None } else { rule.critical_radius(&settings.cell).map(expected_work) };
    let mut options = context.scheduling(&show);
    if let Some(order) = &order {
        options.expected_work = order;
    }
    let ends = |cell: &Cell| if args.dynamics { None } else { rule.of(cell) };
    let grown = Grower { lineage: &lineage, settings, ends: &ends, memo: &memo, options }.grow(divide);
    drop(line);
    let (tree, summary) = grown?;
    warn_of_store(&summary.warnings);
    for (cue, error) in rule.unknown() {
        tracing::info!("no critical radius for cells with the cue {cue}, whose divisions tell instead: {error}");
    }
    let rows = founder_rows(&tree);
    write_files(args, context, &tree, &rows, &summary, start)?;
    respond(args, context, &tree, &rows, &summary, start.elapsed().as_secs_f64())
}

fn respond(
    args: &TreeArgs,
    context: &Context,
    tree: &Tree,
    rows: &[FounderRow],
    summary: &Summary,
    elapsed_s: f64,
) -> Result<(), CliError> {
    let counts = report::TreeSummary::of(tree);
    if context.json {
        let document = Answer {
            founders: rows,
            cells: tree.len(),
            generations: counts.generations.len(),
            ended: &counts.ended,
            divisions_solved: summary.solved,
            memo_hits: summary.memo_hits,
            elapsed_s,
            out: args.out.display().to_string(),
        };
        return answer(&format!("{}\n", serde_json::to_string_pretty(&document)?));
    }
    answer(&format!(
        "{}{} divisions solved, {} memo hits, {elapsed_s:.2} s; files in {}\n",
        report::founders_table(tree, rows),
        summary.solved,
        summary.memo_hits,
        args.out.display()
    ))
}

fn write_files(
    args: &TreeArgs,
    context: &Context,
    tree: &Tree,
    rows: &[FounderRow],
    summary: &Summary,
    start: Instant,
) -> Result<(), CliError> {
    let write = |name: &str, content: &str| write_atomically(&args.out.join(name), content.as_bytes());
    write("tree.nwk", &newick(tree))?;
    write("tree.json", &tree.to_json()?)?;
    write("tree.svg", &report::svg(tree))?;
    write("report.html", &report::html(tree, rows))?;
    let record = RunRecord {
        schema: "furrow.run",
        schema_version: 1,
        provenance: Provenance::current(),
        elapsed_s: start.elapsed().as_secs_f64(),
        threads: workers(context.threads),
        cells: tree.len(),
        divisions_solved: summary.solved,
        memo_hits: summary.memo_hits,
        store_hits: summary.store_hits,
        corrupt_entries: summary.corrupt,
        quantisation: QuantisationRecord {
            r0_step: tree.settings.r0_step,
            max_r0_shift: summary.max_size_shift,
            chi_effect: summary.shift_effect,
        },
        warnings: summary.warnings.iter().map(warning_text).collect(),
    };
    write("run.json", &format!("{}\n", serde_json::to_string_pretty(&record)?))?;
    Ok(())
}
