//! `furrow tree`: the main job.

use super::cell::FirstCellArgs;
use super::context::{Context, warn_of_store};
use super::error::CliError;
use super::interrupt;
use super::output::{print_as, to_json, writable_folder};
use super::plot::PlotArgs;
use super::progress::ProgressLine;
use clap::Args;
use furrow_analysis::scenarios::Scenario;
use furrow_analysis::{self as study, Grown, tree_settings};
use furrow_cell::{Cue, CueError};
use furrow_formats::files::FileSet;
use furrow_formats::tree_to_json;
use furrow_formats::{FounderRow, Provenance, founder_rows, newick};
use furrow_input::InputError;
use furrow_lineage::batch::Summary;
use furrow_lineage::batch::scheduler::workers;
use furrow_lineage::{Lineage, TerminalReason, Tree, TreeSettings};
use furrow_mechanics::equilibria::ShapeError;
use furrow_report as report;
use serde::Serialize;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Grows a lineage from one cell, division by division, until no cell can divide
///
/// Prints the rounds of division of each founder next to the observed ones. Writes tree.nwk, tree.json, tree.svg, report.html and
/// run.json.
///
/// With several lineages or several --cue, every combination is a scenario. One run grows and compares all of them, writes
/// scenarios.csv, report.html and run.json, and writes each tree into a folder with the scenario's name.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  furrow tree
  furrow tree --cue none --xi 26 --out no-cue --plot rounds.svg
  furrow tree --cue germline --cue none --cue tension:gradient,amplitude=0.3 --out cues
  furrow tree lineages/c_elegans.ron --r0 3.5 --epsilon 0.85 --json")]
pub struct TreeArgs {
    /// Lineage files: founders, cues and limits; default the built-in C. elegans founders. Several are compared
    #[arg(value_name = "LINEAGE.ron")]
    pub lineage: Vec<PathBuf>,
    #[command(flatten)]
    pub cell: FirstCellArgs,
    /// Output folder; files of an earlier tree in it are overwritten
    #[arg(help_heading = "Output", long, value_name = "DIR", default_value = "furrow-out")]
    pub out: PathBuf,
    /// Seed of the noise in the first step of every division
    #[arg(help_heading = "Numerics", long, value_name = "S", default_value_t = 0)]
    pub seed: u64,
    /// Replaces all cues of the lineage by: none, a name in the lineage file, or terms
    /// FIELD:PROFILE,key=value,.. joined by +. Several are compared
    #[arg(help_heading = "Cell", long, value_name = "CUE")]
    pub cue: Vec<String>,
    /// Grows the lineage with every set of constants in a table and prints the ranges of the counts; writes no files
    #[arg(help_heading = "Cell", long, value_name = "FILE.csv")]
    pub constants: Option<PathBuf>,
    /// Computes the division of every cell, including cells below the critical radius of their cue
    #[arg(help_heading = "Numerics", long)]
    pub dynamics: bool,
    #[command(flatten)]
    pub plot: PlotArgs,
}

/// The files of a tree.
const TREE_FILES: [&str; 5] = ["tree.nwk", "tree.json", "tree.svg", "report.html", "run.json"];

/// Undecided cells that get a warning each.
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

/// `run.json`: what this run did; it differs between runs.
#[derive(Serialize)]
pub struct RunRecord<'a> {
    schema: &'static str,
    schema_version: u32,
    provenance: Provenance,
    elapsed_s: f64,
    threads: usize,
    /// Whether every cell's division was computed.
    dynamics: bool,
    /// Names of the scenarios, which are those of their folders; nothing of a tree by itself.
    #[serde(skip_serializing_if = "Option::is_none")]
    scenarios: Option<Vec<&'a str>>,
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

impl<'a> RunRecord<'a> {
    /// Of a run that was begun at `start` and has grown so many cells.
    pub fn of(
        args: &TreeArgs,
        context: &Context,
        summary: &Summary,
        start: Instant,
        cells: usize,
        scenarios: Option<Vec<&'a str>>,
    ) -> RunRecord<'a> {
        RunRecord {
            schema: if scenarios.is_some() { "furrow.scenarios" } else { "furrow.run" },
            schema_version: 1,
            provenance: Provenance::current(),
            elapsed_s: start.elapsed().as_secs_f64(),
            threads: workers(context.threads),
            dynamics: args.dynamics,
            scenarios,
            cells,
            divisions_solved: summary.solved,
            memo_hits: summary.memo_hits,
            store_hits: summary.store_hits,
            corrupt_entries: summary.corrupt,
            quantisation: QuantisationRecord {
                r0_step: context.quantisation.relative_step(),
                max_r0_shift: summary.max_size_shift,
                chi_effect: summary.shift_effect,
            },
            warnings: summary.warnings.iter().map(ToString::to_string).collect(),
        }
    }
}

impl TreeArgs {
    /// Whether several trees are grown and set side by side.
    pub fn has_scenarios(&self) -> bool {
        self.lineage.len() > 1 || self.cue.len() > 1
    }
}

pub fn run(args: &TreeArgs, context: &Context) -> Result<(), CliError> {
    let start = Instant::now();
    interrupt::finish();
    let picture = args.plot.file()?;
    let (mut lineage, settings) = prepared(&args.cell, args.seed, context, args.lineage.first().map(PathBuf::as_path))?;
    if let Some(text) = args.cue.first() {
        lineage = lineage.carrying(text).map_err(bad_cue)?;
    }
    if let Some(file) = &args.constants {
        return super::ensemble::grow_over(file, &lineage, &settings, context, &picture);
    }
    writable_folder("--out", args.out.as_path(), &TREE_FILES)?;
    let only = Scenario { name: String::new(), label: String::new(), cue: None, lineage, settings };
    let Grown { trees, summary, .. } = grown(&[only], args.dynamics, context)?;
    for tree in &trees {
        let (rows, counts) = (founder_rows(tree), report::TreeSummary::of(tree));
        let mut files = FileSet::new(&args.out);
        files.stage("tree.nwk", newick(tree).as_bytes())?;
        files.stage("tree.json", tree_to_json(&tree)?.as_bytes())?;
        files.stage("tree.svg", report::svg(tree).as_bytes())?;
        files.stage("report.html", report::html(tree, &rows).as_bytes())?;
        let record = RunRecord::of(args, context, &summary, start, tree.len(), None);
        files.stage("run.json", to_json(&record)?.as_bytes())?;
        files.commit()?;
        picture.write(|| furrow_figures::plot::rounds::draw(tree))?;
        let document = Answer {
            founders: &rows,
            cells: tree.len(),
            generations: counts.generations.len(),
            ended: &counts.ended,
            slow_cells: counts.slow,
            divisions_solved: summary.solved,
            memo_hits: summary.memo_hits,
            elapsed_s: start.elapsed().as_secs_f64(),
            out: args.out.display().to_string(),
        };
        print_as(context.json, &document, || {
            report::founders_table(tree, &rows) + &run_text(args, &summary, document.elapsed_s)
        })?;
    }
    Ok(())
}

/// The lineage of a file, or the built-in one, with the parameters of its divisions.
pub fn prepared(
    cell: &FirstCellArgs,
    seed: u64,
    context: &Context,
    file: Option<&Path>,
) -> Result<(Lineage, TreeSettings), CliError> {
    let mut lineage = Lineage::load(file)?;
    let given = cell.settings(&context.settings, &lineage.units())?;
    given.check_divisions("settings")?;
    if cell.r0.is_some() {
        // What the option says counts, also where the lineage gives its first cell a radius.
        lineage.forget_first_radius();
    }
    let settings = tree_settings(given, &lineage, seed, context.quantisation);
    Ok((lineage, settings))
}

/// An invalid `--cue`.
pub fn bad_cue(error: CueError) -> InputError {
    InputError::not_allowed("--cue", error.field, error.value, error.allowed)
}

/// Grows all scenarios in one run and logs warnings.
///
/// With `dynamics` the division of every cell is computed, those below the critical radius of their cue included.
pub fn grown(scenarios: &[Scenario], dynamics: bool, context: &Context) -> Result<Grown, CliError> {
    let memo = context.memo()?;
    let line = ProgressLine::new(context.progress);
    let show = |progress| line.show(progress);
    let (options, flag) = (context.scheduling(&show), interrupt::flag());
    let grown = study::grown(scenarios, dynamics, &memo, options, flag);
    drop(line);
    let grown = grown?;
    warn_of_store(&grown.summary.warnings);
    warn_of_searches(&grown.unknown);
    for (tree, scenario) in grown.trees.iter().zip(scenarios) {
        warn_of_undecided(tree, &scenario.name);
    }
    Ok(grown)
}

/// Warns of undecided cells. Their branches end there; the rest of the tree is valid.
fn warn_of_undecided(tree: &Tree, scenario: &str) {
    let place = if scenario.is_empty() { String::new() } else { format!("{scenario}: ") };
    let undecided = tree.cells().map(|id| tree.cell(id)).filter_map(|cell| match cell.fate.terminal_reason() {
        Some(TerminalReason::Undecided { why }) => Some((cell, why)),
        _ => None,
    });
    for (k, (cell, why)) in undecided.enumerate() {
        if k == MOST_WARNINGS {
            tracing::warn!("{place}further cells are undecided: see tree.json");
            return;
        }
        tracing::warn!("{place}cell {} (R0 = {}) is undecided, and its branch ends there: {why}", cell.name, cell.r0);
    }
}

/// Logs cues without a critical radius; one warning names those whose search was given up.
fn warn_of_searches(unknown: &[(Cue, ShapeError)]) {
    let mut given_up = Vec::new();
    for (cue, error) in unknown {
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

/// What a run took and where its files are.
pub fn run_text(args: &TreeArgs, summary: &Summary, elapsed_s: f64) -> String {
    let Summary { solved, memo_hits, .. } = summary;
    format!("{solved} divisions solved, {memo_hits} memo hits, {elapsed_s:.2} s; files in {}\n", args.out.display())
}
