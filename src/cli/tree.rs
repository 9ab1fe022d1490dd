//! `furrow tree`: the main job.

use super::cell::FirstCellArgs;
use super::context::{Context, warn_of_store, warning_text};
use super::error::CliError;
use super::interrupt;
use super::output::{answer, writable_folder};
use super::progress::ProgressLine;
use crate::batch::Summary;
use crate::batch::scheduler::workers;
use crate::cell::{Cell, Cue};
use crate::division::{DivisionInput, divide};
use crate::io::earlier::{TREE_FILES, other_tree};
use crate::io::files::FileSet;
use crate::io::{FounderRow, Provenance, founder_rows, newick, parse_cue};
use crate::lineage::{EndReason, Ends, Grower, Lineage, Tree, TreeSettings, expected_work};
use crate::report;
use crate::shapes::{CriticalRadii, ShapeError};
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
    /// Folder for the files; those of another tree in it are kept in a folder earlier-N there
    #[arg(help_heading = "Output", long, value_name = "DIR", default_value = "furrow-out")]
    out: PathBuf,
    /// Replaces the files of a tree that was grown from other inputs, and does not keep them
    #[arg(help_heading = "Output", long)]
    force: bool,
    /// Seed of the noise in the first step of every division
    #[arg(help_heading = "Numerics", long, value_name = "S", default_value_t = 0)]
    seed: u64,
    /// Replaces every cue that the lineage gives: none, a name in the lineage file, or terms
    /// FIELD:PROFILE,key=value,.. joined by +
    #[arg(help_heading = "Cell", long, value_name = "CUE")]
    cue: Option<String>,
    /// Grows the lineage with every set of constants of a table, and prints the ranges of its counts; writes no files
    #[arg(help_heading = "Cell", long, value_name = "FILE.csv")]
    constants: Option<PathBuf>,
    /// Computes the division of every cell, those below the critical radius of their cue included
    #[arg(help_heading = "Numerics", long)]
    dynamics: bool,
}

/// Undecided cells that are warned of one by one.
const MOST_WARNINGS: usize = 5;

/// What `--json` prints.
#[derive(Serialize)]
struct Answer<'a> {
    founders: &'a [FounderRow],
    cells: usize,
    generations: usize,
    ended: &'a std::collections::BTreeMap<&'static str, usize>,
    slow_cells: usize,
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
    /// Whether every cell's division was computed.
    dynamics: bool,
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
    interrupt::gently();
    let mut lineage = Lineage::load(args.lineage.as_deref())?;
    let given = args.cell.settings(&context.settings, &lineage.units())?;
    given.check_divisions("settings")?;
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
    let r0 = lineage.given_r0(lineage.first()).unwrap_or(given.cell.r0);
    let settings = TreeSettings {
        cell: Cell { r0, ..given.cell },
        numerics: given.numerics,
        seed: args.seed,
        r0_step: context.quantisation.relative_step(),
    };
    if let Some(file) = &args.constants {
        return super::ensemble::grow_over(file, &lineage, &settings, context);
    }
    writable_folder("--out", "out", &args.out, &TREE_FILES)?;
    let replaced = other_tree(&args.out, &lineage, &settings, args.dynamics).filter(|_| !args.force);
    let memo = context.memo()?;
    let line = ProgressLine::new(context.progress);
    let show = |progress| line.show(progress);
    let rule = Ends::new(CriticalRadii::new(&settings.numerics).interrupted_by(interrupt::flag()));
    let plain = settings.cell.clone().with_cue(Cue::none());
    // The order of the work is no reason to search for a radius, which growth does when it comes to such cells.
    let order = |input: &DivisionInput| {
        let critical = if rule.knows(&plain) { rule.critical_radius(&plain) } else { None };
        critical.map_or(input.cell.r0, |critical| expected_work(critical)(input))
    };
    let mut options = context.scheduling(&show);
    if !args.dynamics {
        options.expected_work = &order;
    }
    // The first cell is asked about first. Its division costs less than a search, and where it fails there is no other.
    let first = std::cell::Cell::new(true);
    let by_dynamics = |cell: &Cell| first.replace(false) && !rule.knows(cell) || args.dynamics;
    let ends = |cell: &Cell| if by_dynamics(cell) { None } else { rule.of(cell) };
    let grown = Grower { lineage: &lineage, settings, ends: &ends, memo: &memo, options }.grow(divide);
    drop(line);
    let (tree, summary) = grown?;
    warn_of_store(&summary.warnings);
    warn_of_searches(&rule);
    warn_of_undecided(&tree);
    let rows = founder_rows(&tree);
    write_files(args, context, &tree, &rows, &summary, start, replaced)?;
    respond(args, context, &tree, &rows, &summary, start.elapsed().as_secs_f64())
}

/// Says which cells are undecided: their branches end there, the rest of the tree stands.
fn warn_of_undecided(tree: &Tree) {
    let undecided = tree.cells().map(|id| tree.cell(id)).filter_map(|cell| match &cell.fate.ended {
        Some(EndReason::Undecided { why }) => Some((cell, why)),
        _ => None,
    });
    for (k, (cell, why)) in undecided.enumerate() {
        if k == MOST_WARNINGS {
            tracing::warn!("further cells are undecided; tree.json says which");
            return;
        }
        tracing::warn!("cell {} (R0 = {}) is undecided, and its branch ends there: {why}", cell.name, cell.r0);
    }
}

/// Says which cells have no critical radius; in one warning, which were not searched for to the end.
fn warn_of_searches(rule: &Ends) {
    let mut given_up = Vec::new();
    for (cue, error) in rule.unknown() {
        if let ShapeError::Effort { .. } = error {
            given_up.push(cue.to_string());
        }
        tracing::info!("no critical radius for cells with the cue {cue}, whose divisions tell instead: {error}");
    }
    if !given_up.is_empty() {
        tracing::warn!(
            "the search for a critical radius was given up for cells with the cue {}: all their divisions are computed",
            given_up.join(" and ")
        );
    }
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
            slow_cells: counts.slow,
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
    replaced: Option<String>,
) -> Result<(), CliError> {
    let mut files = FileSet::new(&args.out);
    files.stage("tree.nwk", newick(tree).as_bytes())?;
    files.stage("tree.json", tree.to_json()?.as_bytes())?;
    files.stage("tree.svg", report::svg(tree).as_bytes())?;
    files.stage("report.html", report::html(tree, rows).as_bytes())?;
    let record = RunRecord {
        schema: "furrow.run",
        schema_version: 1,
        provenance: Provenance::current(),
        elapsed_s: start.elapsed().as_secs_f64(),
        threads: workers(context.threads),
        dynamics: args.dynamics,
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
    files.stage("run.json", format!("{}\n", serde_json::to_string_pretty(&record)?).as_bytes())?;
    let Some(replaced) = replaced else { return Ok(files.commit()?) };
    let aside = files.commit_keeping(&TREE_FILES)?;
    tracing::warn!("the files of another tree are kept in {}: {replaced}", aside.display());
    Ok(())
}
