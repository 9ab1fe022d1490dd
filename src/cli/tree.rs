//! `furrow tree`: one lineage, or several lineages and cues side by side.

use super::cell::FirstCellArgs;
use super::context::warn_of_store;
use super::interrupt;
use super::output::{to_json, writable_folder};
use super::prelude::*;
use super::progress::ProgressLine;
use furrow_analysis::scenarios::{Scenario, ScenarioError, Source, combine};
use furrow_analysis::{self as study, Grown, scenarios_csv, tree_settings};
use furrow_cell::{Cue, CueError};
use furrow_figures::plot::rounds;
use furrow_formats::files::FileSet;
use furrow_formats::tree_to_json;
use furrow_formats::{FounderRow, Provenance, founder_rows, newick};
use furrow_lineage::batch::Summary;
use furrow_lineage::batch::scheduler::workers;
use furrow_lineage::{Lineage, TerminalReason, Tree, TreeSettings};
use furrow_mechanics::equilibria::ShapeError;
use furrow_report as report;
use std::path::Path;
use std::time::Instant;

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

/// The files of one scenario, in a folder of its name.
const SCENARIO_FILES: [&str; 3] = ["tree.nwk", "tree.json", "tree.svg"];

/// The files beside the scenarios' folders.
const SCENARIOS_FILES: [&str; 3] = ["scenarios.csv", "report.html", "run.json"];

/// What `--json` prints: of a single tree its counts, of several the scenarios.
#[derive(Serialize)]
struct Answer<'a> {
    #[serde(flatten)]
    tree: Option<TreeCounts>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    scenarios: Vec<ScenarioCounts<'a>>,
    divisions_solved: usize,
    memo_hits: usize,
    elapsed_s: f64,
    out: String,
}

#[derive(Serialize)]
struct TreeCounts {
    founders: Vec<FounderRow>,
    cells: usize,
    generations: usize,
    ended: std::collections::BTreeMap<&'static str, usize>,
    slow_cells: usize,
}

#[derive(Serialize)]
struct ScenarioCounts<'a> {
    name: &'a str,
    lineage: &'a str,
    /// As it was asked for; null where the lineage's own cues are in force.
    cue: Option<&'a str>,
    #[serde(flatten)]
    tree: TreeCounts,
}

impl TreeCounts {
    fn of(tree: &Tree) -> TreeCounts {
        let report::TreeSummary { generations, ended, slow, .. } = report::TreeSummary::of(tree);
        let (founders, generations) = (founder_rows(tree), generations.len());
        TreeCounts { founders, cells: tree.len(), generations, ended, slow_cells: slow }
    }
}

impl ScenarioCounts<'_> {
    fn of<'a>((scenario, tree): (&'a Scenario, &Tree)) -> ScenarioCounts<'a> {
        let Scenario { name, label: lineage, cue, .. } = scenario;
        ScenarioCounts { name, lineage, cue: cue.as_deref(), tree: TreeCounts::of(tree) }
    }
}

/// `run.json`: what this run did; it differs between runs.
#[derive(Serialize)]
struct RunRecord<'a> {
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
    fn of(
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

pub fn run(args: &TreeArgs, context: &Context) -> Result<(), CliError> {
    let start = Instant::now();
    interrupt::finish();
    let several = args.lineage.len() > 1 || args.cue.len() > 1;
    if let (true, Some(file)) = (several, &args.constants) {
        let allowed = "given with one lineage and at most one --cue";
        return Err(InputError::not_allowed("--constants", "constants", format!("{file:?}"), allowed).into());
    }
    let picture = args.plot.file()?;
    let scenarios = if several { combined(args, context)? } else { vec![single(args, context)?] };
    if let (Some(file), [Scenario { lineage, settings, .. }]) = (&args.constants, &scenarios[..]) {
        return super::ensemble::grow_over(file, lineage, settings, context, &picture);
    }
    writable_folder("--out", args.out.as_path(), if several { &SCENARIOS_FILES[..] } else { &TREE_FILES })?;
    for scenario in scenarios.iter().filter(|_| several) {
        writable_folder("--out", args.out.join(&scenario.name).as_path(), &SCENARIO_FILES)?;
    }
    let Grown { trees, summary, .. } = grown(&scenarios, args.dynamics, context)?;
    let mut files = FileSet::new(&args.out);
    for (Scenario { name, .. }, tree) in scenarios.iter().zip(&trees) {
        let [nwk, json, svg] =
            SCENARIO_FILES.map(|file| if several { format!("{name}/{file}") } else { file.to_owned() });
        files.stage(&nwk, newick(tree).as_bytes())?;
        files.stage(&json, tree_to_json(tree)?.as_bytes())?;
        files.stage(&svg, report::svg(tree).as_bytes())?;
    }
    let names: Vec<&str> = scenarios.iter().map(|scenario| scenario.name.as_str()).collect();
    let named: Vec<(&str, &Tree)> = names.iter().copied().zip(&trees).collect();
    let only = trees.first().filter(|_| !several);
    let page = match only {
        Some(tree) => report::html(tree, &founder_rows(tree)),
        None => {
            files.stage("scenarios.csv", scenarios_csv(&scenarios, &trees).as_bytes())?;
            report::scenarios_page(&scenarios, &trees)
        }
    };
    files.stage("report.html", page.as_bytes())?;
    let cells = trees.iter().map(Tree::len).sum();
    let record = RunRecord::of(args, context, &summary, start, cells, several.then_some(names));
    files.stage("run.json", to_json(&record)?.as_bytes())?;
    files.commit()?;
    let drawing = || match only {
        Some(tree) => Some(rounds::draw(tree)),
        None => rounds::draw_scenarios(&named),
    };
    if let Some(drawing) = picture.is_wanted().then(drawing).flatten() {
        picture.write(|| drawing)?;
    }
    let document = Answer {
        tree: only.map(TreeCounts::of),
        scenarios: scenarios.iter().zip(&trees).filter(|_| several).map(ScenarioCounts::of).collect(),
        divisions_solved: summary.solved,
        memo_hits: summary.memo_hits,
        elapsed_s: start.elapsed().as_secs_f64(),
        out: args.out.display().to_string(),
    };
    print_as(context.json, &document, || {
        let table = match only {
            Some(tree) => report::founders_table(tree, &founder_rows(tree)),
            None => report::scenarios_table(&scenarios, &trees),
        };
        let Answer { divisions_solved, memo_hits, elapsed_s, out, .. } = &document;
        format!("{table}{divisions_solved} divisions solved, {memo_hits} memo hits, {elapsed_s:.2} s; files in {out}\n")
    })
}

/// The one lineage, with the one cue if it is given.
fn single(args: &TreeArgs, context: &Context) -> Result<Scenario, CliError> {
    let file = args.lineage.first().map(PathBuf::as_path);
    let (mut lineage, settings) = prepared(&args.cell, args.seed, context, file)?;
    if let Some(text) = args.cue.first() {
        lineage = lineage.carrying(text).map_err(bad_cue)?;
    }
    Ok(Scenario { name: String::new(), label: String::new(), cue: None, lineage, settings })
}

/// Every lineage file with every cue.
fn combined(args: &TreeArgs, context: &Context) -> Result<Vec<Scenario>, CliError> {
    let files = args.lineage.iter().map(|file| Some(file.as_path()));
    let built_in = args.lineage.is_empty().then_some(None);
    let mut sources = Vec::new();
    for file in files.chain(built_in) {
        let (lineage, settings) = prepared(&args.cell, args.seed, context, file)?;
        let stem = |file: &Path| file.file_stem().map_or(String::new(), |stem| stem.to_string_lossy().into_owned());
        sources.push(Source { label: file.map_or("c_elegans".to_owned(), stem), lineage, settings });
    }
    let cues: Vec<&str> = args.cue.iter().map(String::as_str).collect();
    combine(&sources, &cues).map_err(|error| match error {
        ScenarioError::Cue(error) => bad_cue(error).into(),
        ScenarioError::Same { first, second } => {
            let option = if args.cue.len() > 1 { "--cue" } else { "LINEAGE.ron" };
            let allowed = format!("a different scenario; it duplicates {first}");
            InputError::not_allowed("tree", option, second, allowed).into()
        }
    })
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
        // The option overrides the radius in the lineage file.
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
        if let ShapeError::OutOfBudget { .. } = error {
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
