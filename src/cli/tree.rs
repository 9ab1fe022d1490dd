//! `furrow tree`: the main job.

use super::cell::FirstCellArgs;
use super::context::{Context, warn_of_store};
use super::divide::computed;
use super::error::CliError;
use super::interrupt;
use super::output::{answer, writable_folder};
use super::plot::PlotArgs;
use super::progress::ProgressLine;
use super::scenarios;
use crate::batch::profiles::seconds;
use crate::batch::scheduler::workers;
use crate::batch::{Profiled, Profiles, Summary};
use crate::cell::{Cell, Cue, CueError};
use crate::division::DivisionInput;
use crate::input::InputError;
use crate::io::earlier::{Replaced, TREE_FILES, other_tree};
use crate::io::files::FileSet;
use crate::io::{FounderRow, Provenance, founder_rows, newick};
use crate::lineage::{EndReason, Lineage, Tree, TreeCell, TreeSettings};
use crate::report::{self, ProfileReport};
use crate::shapes::ShapeError;
use crate::study::scenarios::Scenario;
use crate::study::{self, tree_settings};
use clap::Args;
use serde::Serialize;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Grows a lineage from one cell: every division is solved, its daughters divide next, until none can
///
/// Prints the rounds of division per founder beside the observed ones and writes tree.nwk, tree.json, tree.svg,
/// report.html and run.json.
///
/// Of several lineages, or with several --cue, every combination is a scenario. All are grown in one run and set side by side;
/// scenarios.csv, report.html and run.json are written, and the tree of each in a folder of its name.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  furrow tree
  furrow tree --cue none --xi 26 --out no-cue --plot rounds.svg --profile
  furrow tree --cue germline --cue none --cue tension:gradient,amplitude=0.3 --out cues
  furrow tree lineages/c_elegans.ron --r0 3.5 --epsilon 0.85 --json")]
pub struct TreeArgs {
    /// Founders, cues and limits; default the built-in C. elegans founders. Several are set side by side
    #[arg(value_name = "LINEAGE.ron")]
    pub lineage: Vec<PathBuf>,
    #[command(flatten)]
    pub cell: FirstCellArgs,
    /// Folder for the files; those of another tree in it are kept in a folder earlier-N there
    #[arg(help_heading = "Output", long, value_name = "DIR", default_value = "furrow-out")]
    pub out: PathBuf,
    /// Replaces the files of a tree that was grown from other inputs, and does not keep them
    #[arg(help_heading = "Output", long)]
    pub force: bool,
    /// Seed of the noise in the first step of every division
    #[arg(help_heading = "Numerics", long, value_name = "S", default_value_t = 0)]
    pub seed: u64,
    /// Replaces every cue that the lineage gives: none, a name in the lineage file, or terms
    /// FIELD:PROFILE,key=value,.. joined by +. Several are set side by side
    #[arg(help_heading = "Cell", long, value_name = "CUE")]
    pub cue: Vec<String>,
    /// Grows the lineage with every set of constants of a table, and prints the ranges of its counts; writes no files
    #[arg(help_heading = "Cell", long, value_name = "FILE.csv")]
    constants: Option<PathBuf>,
    /// Computes the division of every cell, those below the critical radius of their cue included
    #[arg(help_heading = "Numerics", long)]
    pub dynamics: bool,
    /// Tells what the time of the divisions went into: phases, steps, iterations, factorisations, mesh intervals
    ///
    /// Of all divisions that were computed, and of the slowest of them. What is known from the cache took no time: --no-cache has
    /// all divisions computed.
    #[arg(help_heading = "Output", long, conflicts_with = "constants")]
    pub profile: bool,
    #[command(flatten)]
    pub plot: PlotArgs,
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
    /// What the divisions took, where that is asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    profile: Option<&'a ProfileReport>,
}

/// `run.json`: what this run did, which need not be the same another time.
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

    /// As the text of `run.json`.
    pub fn text(&self) -> Result<String, CliError> {
        Ok(format!("{}\n", serde_json::to_string_pretty(self)?))
    }
}

pub fn run(args: &TreeArgs, context: &Context) -> Result<(), CliError> {
    let start = Instant::now();
    interrupt::gently();
    if args.lineage.len() > 1 || args.cue.len() > 1 {
        if let Some(file) = &args.constants {
            let allowed = "given with one lineage and at most one --cue";
            return Err(InputError::not_allowed("--constants", "constants", format!("{file:?}"), allowed).into());
        }
        return scenarios::run(args, context, start);
    }
    let picture = args.plot.file()?;
    let (mut lineage, settings) = prepared(&args.cell, args.seed, context, args.lineage.first().map(PathBuf::as_path))?;
    if let Some(text) = args.cue.first() {
        lineage = lineage.carrying(text).map_err(bad_cue)?;
    }
    if let Some(file) = &args.constants {
        return super::ensemble::grow_over(file, &lineage, &settings, context, picture.as_ref());
    }
    writable_folder("--out", "out", &args.out, &TREE_FILES)?;
    let replaced = other_tree(&args.out, &lineage, &settings, args.dynamics);
    let only = Scenario { name: String::new(), label: String::new(), cue: None, lineage, settings };
    let Grown { trees, summary, profile } = grown(&[only], args.dynamics, args.profile, context)?;
    for tree in &trees {
        let rows = founder_rows(tree);
        write_files(args, context, tree, &rows, &summary, start, replaced.as_ref())?;
        if let Some(picture) = &picture {
            picture.write(&crate::plot::rounds::draw(tree))?;
        }
        respond(args, context, tree, &rows, &summary, start.elapsed().as_secs_f64(), profile.as_ref())?;
    }
    Ok(())
}

/// The lineage of a file, or the built-in one, and the parameters of its divisions, the first cell's as `cell` gives them.
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

/// What is wrong with a cue of the command line.
pub fn bad_cue(error: CueError) -> InputError {
    InputError::not_allowed("--cue", error.field, error.value, error.allowed)
}

/// Trees and what growing them took.
#[derive(Default)]
pub struct Grown {
    /// One for each scenario.
    pub trees: Vec<Tree>,
    pub summary: Summary,
    /// Where it is asked for.
    pub profile: Option<ProfileReport>,
}

/// Grows all scenarios in one run, and says what the user should know of it.
///
/// With `dynamics` the division of every cell is computed, those below the critical radius of their cue included; where they
/// are `profiled`, what they took is told.
pub fn grown(scenarios: &[Scenario], dynamics: bool, profiled: bool, context: &Context) -> Result<Grown, CliError> {
    let memo = context.memo()?;
    let line = ProgressLine::new(context.progress);
    let show = |progress| line.show(progress);
    let profiles = profiled.then(|| Profiles::new(Some(seconds)));
    let solve = |input: &DivisionInput| computed(input, profiles.as_ref());
    let (options, flag) = (context.scheduling(&show), interrupt::flag());
    let grown = study::grown_by(scenarios, dynamics, &memo, options, flag, solve);
    drop(line);
    let study::Grown { trees, summary, unknown } = grown?;
    warn_of_store(&summary.warnings);
    warn_of_searches(unknown);
    for (tree, scenario) in trees.iter().zip(scenarios) {
        warn_of_undecided(tree, &scenario.name);
    }
    let named = |one: &Profiled| name_in(&trees, scenarios, context, one);
    let profile = profiles.map(|profiles| ProfileReport::new(profiles.taken(), named));
    Ok(Grown { trees, summary, profile })
}

/// The first cell of the trees that has divided like this, with its scenario if there are several; its size where a cell
/// is the mirror image of what was computed.
fn name_in(trees: &[Tree], scenarios: &[Scenario], context: &Context, one: &Profiled) -> String {
    let same = |tree: &Tree, id| {
        let TreeCell { r0, cue, founder, .. } = tree.cell(id);
        let mut cell = Cell { r0: context.quantisation.apply(*r0), cue: cue.clone(), ..tree.settings.cell.clone() };
        tree.lineage.founders[*founder].physics.apply(&mut cell);
        cell == one.input.cell
    };
    let found = trees.iter().zip(scenarios).find_map(|(tree, Scenario { name, .. })| {
        let id = tree.cells().find(|id| same(tree, *id))?;
        let place = if name.is_empty() { String::new() } else { format!("{name}: ") };
        Some(format!("{place}{}, R0 = {:.4}", tree.cell(id).name, one.input.cell.r0))
    });
    found.unwrap_or_else(|| format!("R0 = {:.4}", one.input.cell.r0))
}

/// Says which cells are undecided: their branches end there, the rest of the tree stands.
fn warn_of_undecided(tree: &Tree, scenario: &str) {
    let place = if scenario.is_empty() { String::new() } else { format!("{scenario}: ") };
    let undecided = tree.cells().map(|id| tree.cell(id)).filter_map(|cell| match &cell.fate.ended {
        Some(EndReason::Undecided { why }) => Some((cell, why)),
        _ => None,
    });
    for (k, (cell, why)) in undecided.enumerate() {
        if k == MOST_WARNINGS {
            tracing::warn!("{place}further cells are undecided; tree.json says which");
            return;
        }
        tracing::warn!("{place}cell {} (R0 = {}) is undecided, and its branch ends there: {why}", cell.name, cell.r0);
    }
}

/// Says which cells have no critical radius; in one warning, which were not searched for to the end.
fn warn_of_searches(unknown: Vec<(Cue, ShapeError)>) {
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

fn respond(
    args: &TreeArgs,
    context: &Context,
    tree: &Tree,
    rows: &[FounderRow],
    summary: &Summary,
    elapsed_s: f64,
    profile: Option<&ProfileReport>,
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
            profile,
        };
        return answer(&format!("{}\n", serde_json::to_string_pretty(&document)?));
    }
    answer(&format!(
        "{}{} divisions solved, {} memo hits, {elapsed_s:.2} s; files in {}\n{}",
        report::founders_table(tree, rows),
        summary.solved,
        summary.memo_hits,
        args.out.display(),
        profile_text(profile)
    ))
}

/// A profile behind an answer, if it is asked for.
pub fn profile_text(profile: Option<&ProfileReport>) -> String {
    profile.map_or(String::new(), |profile| format!("\n{}", profile.text()))
}

fn write_files(
    args: &TreeArgs,
    context: &Context,
    tree: &Tree,
    rows: &[FounderRow],
    summary: &Summary,
    start: Instant,
    replaced: Option<&Replaced>,
) -> Result<(), CliError> {
    let mut files = FileSet::new(&args.out);
    files.stage("tree.nwk", newick(tree).as_bytes())?;
    files.stage("tree.json", tree.to_json()?.as_bytes())?;
    files.stage("tree.svg", report::svg(tree).as_bytes())?;
    files.stage("report.html", report::html(tree, rows).as_bytes())?;
    let record = RunRecord::of(args, context, summary, start, tree.len(), None);
    files.stage("run.json", record.text()?.as_bytes())?;
    commit(files, replaced, args.force)
}

/// Puts files in place, after those that they would replace were moved aside; by `force` these go.
pub fn commit(files: FileSet, replaced: Option<&Replaced>, force: bool) -> Result<(), CliError> {
    match replaced {
        None => Ok(files.commit()?),
        Some(Replaced { files: there, .. }) if force => Ok(files.commit_in_place_of(there)?),
        Some(Replaced { files: there, why }) => {
            let aside = files.commit_keeping(there)?;
            tracing::warn!("the files of another tree are kept in {}: {why}", aside.display());
            Ok(())
        }
    }
}
