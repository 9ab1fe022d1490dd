//! `furrow tree`: one lineage, or several lineages and cues side by side.

use super::cell::{AxisArgs, FirstCellArgs, load_lineage, one_of};
use super::context::Context;
use super::error::CliError;
use super::interrupt;
use super::messages::{self, Level};
use super::output::{check_seeds, filled, merged, print_as, seed, to_json, writable_folder};
use super::picture::PlotArgs;
use clap::Args;
use furrow_analysis::scenarios::{Scenario, ScenarioError, Source, combine};
use furrow_analysis::{self as study, Grown, LineageRanges, scenarios_csv, spread_csv};
use furrow_analysis::{scenario_of, tree_settings};
use furrow_cell::{Cell, Cue, CueError};
use furrow_figures::plot::rounds;
use furrow_formats::files::FileSet;
use furrow_formats::{Provenance, founder_rows, newick, tree_to_json};
use furrow_input::InputError;
use furrow_lineage::batch::{Memo, Summary, scheduler::workers};
use furrow_lineage::clock::alive;
use furrow_lineage::units::{MOST_PLAIN, plain_radius};
use furrow_lineage::{Length, Lineage, Tree, TreeSettings};
use furrow_mechanics::equilibria::ShapeError;
use furrow_report::{self as report, TimeAxis};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use std::time::Instant;

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  furrow tree
  furrow tree --cue none --xi 26 --out no-cue --plot rounds.svg
  furrow tree --cue none --cue tension:gradient,amplitude=0.3 --replicates 5
  furrow tree lineages/c_elegans.ron --r0 3.5 --epsilon 0.85 --json")]
pub struct TreeArgs {
    /// Lineage files: founders, cues and limits; default the built-in C. elegans founders. Several are compared
    #[arg(value_name = "LINEAGE.ron")]
    pub lineage: Vec<PathBuf>,
    #[command(flatten)]
    pub cell: FirstCellArgs,
    #[command(flatten)]
    pub axis: AxisArgs,
    /// Output folder; files of an earlier tree in it are overwritten. Default furrow-out, and with --constants no files
    #[arg(help_heading = "Output", long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Seed of the noise in the first step of every division
    #[arg(help_heading = "Numerics", long, value_name = "S", default_value_t = 0, value_parser = seed)]
    pub seed: u64,
    /// Replaces all cues of the lineage by: none, a name in the lineage file, or terms
    /// FIELD:PROFILE,key=value,.. joined by +. Several are compared, and "NAME=CUE" names the scenario
    #[arg(help_heading = "Cell", long, value_name = "CUE")]
    pub cue: Vec<String>,
    /// Grows the lineage with every set of constants in a table and prints the ranges of the counts. With --out it writes
    /// ranges.csv, ranges.json, ranges.svg and run.json
    #[arg(help_heading = "Cell", long, value_name = "FILE.csv", conflicts_with = "replicates")]
    pub constants: Option<PathBuf>,
    /// Grows the tree with N seeds, S, S+1, ..., and prints the range of the counts; writes the files of seed S, and spread.csv
    ///
    /// If χ of a division agrees within 0.001 between seeds S and S+1, all trees share that division, and no other seed is computed.
    #[arg(help_heading = "Numerics", long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=100_000))]
    pub replicates: Option<u32>,
    /// Computes the division of every cell, including cells below the critical radius of their cue
    #[arg(help_heading = "Numerics", long, conflicts_with = "constants")]
    pub dynamics: bool,
    /// Axis of tree.svg: generations (default), or minutes by the clock of the lineage file
    #[arg(help_heading = "Output", long, value_name = "AXIS", value_parser = one_of(TimeAxis::NAMED), conflicts_with = "constants")]
    time_axis: Option<TimeAxis>,
    #[command(flatten)]
    pub plot: PlotArgs,
}

/// The files of a tree.
const TREE_FILES: [&str; 5] = ["tree.nwk", "tree.json", "tree.svg", "report.html", "run.json"];

/// With `--replicates`: the ranges over the seeds.
const SPREAD_FILE: &str = "spread.csv";

/// The files of one scenario, in a folder of its name.
const SCENARIO_FILES: [&str; 3] = ["tree.nwk", "tree.json", "tree.svg"];

/// The files next to the scenarios' folders.
const SCENARIOS_FILES: [&str; 3] = ["scenarios.csv", "report.html", "run.json"];

/// The counts of a tree in `--json`.
fn tree_counts(tree: &Tree) -> Value {
    let report::TreeSummary { generations, ended, slow, .. } = report::TreeSummary::of(tree);
    let counts = json!({
        "founders": founder_rows(tree), "cells": tree.len(), "generations": generations.len(), "ended": ended,
        "slow_cells": slow,
    });
    let minutes = tree.times().zip(tree.time_origin());
    let minutes = minutes.map(|(times, origin)| json!({ "minute_zero": origin.to_string(), "alive": alive(&times) }));
    merged(counts, minutes.unwrap_or_default())
}

/// `run.json`: information on this run, which differs between runs. It lists the folders if there are several scenarios.
fn run_record(args: &TreeArgs, context: &Context, grown: &Grown, start: Instant, names: Option<Vec<&str>>) -> Value {
    let Summary { solved, memo_hits, store_hits, corrupt, max_size_shift, shift_effect, .. } = &grown.summary;
    filled(json!({
        "schema": if names.is_some() { "furrow.scenarios" } else { "furrow.run" },
        "schema_version": 1,
        "provenance": Provenance::current(),
        "elapsed_s": start.elapsed().as_secs_f64(),
        "threads": workers(context.threads),
        "dynamics": args.dynamics,
        "scenarios": names,
        "cells": grown.trees.iter().map(Tree::len).sum::<usize>(),
        "divisions_solved": solved,
        "memo_hits": memo_hits,
        "store_hits": store_hits,
        "corrupt_entries": corrupt,
        // Relative step of R0, the largest relative shift of R0 of a cell, and its estimated largest effect on χ.
        "quantisation": {
            "r0_step": context.quantisation.relative_step(), "max_r0_shift": max_size_shift, "chi_effect": shift_effect,
        },
        "warnings": grown.summary.described().collect::<Vec<_>>(),
    }))
}

pub fn run(args: &TreeArgs, context: &Context) -> Result<(), CliError> {
    let start = Instant::now();
    interrupt::finish();
    let several = args.lineage.len() > 1 || args.cue.len() > 1;
    for file in args.constants.iter() {
        let allowed = "given with one lineage and at most one --cue";
        InputError::require(!several, "--constants", "constants", format!("{file:?}"), allowed)?;
    }
    check_seeds(args.seed, args.replicates.unwrap_or(1))?;
    let picture = args.plot.file()?;
    let scenarios = if several { combined(args, context)? } else { vec![single(args, context)?] };
    let lineages: Vec<&Lineage> = scenarios.iter().map(|scenario| &scenario.lineage).collect();
    context.check_taken(&lineages, args.cell.given())?;
    scenarios.iter().for_each(|scenario| warn_of_rules(scenario, !args.cue.is_empty()));
    if let (Some(file), [scenario]) = (&args.constants, &scenarios[..]) {
        let sets = context.constants(file, &scenario.lineage, args.cell.given())?;
        return super::ensemble::grow_over((file, &sets), scenario, context, args.out.as_deref(), &picture);
    }
    let axis = time_axis(args, &scenarios)?;
    let out = args.out.as_deref().unwrap_or(Path::new("furrow-out"));
    let beside = if several { &SCENARIOS_FILES[..] } else { &TREE_FILES };
    let beside: Vec<&str> = beside.iter().copied().chain(args.replicates.map(|_| SPREAD_FILE)).collect();
    writable_folder("--out", out, &beside)?;
    picture.check_apart(Some(out), &beside)?;
    for scenario in scenarios.iter().filter(|_| several) {
        writable_folder("--out", out.join(&scenario.folder).as_path(), &SCENARIO_FILES)?;
    }
    let names = names_of_files(&scenarios, &beside, several);
    let mut files = FileSet::begin(out, names.iter().map(String::as_str));
    let (grown, spread) = grown(&scenarios, args.replicates, args.dynamics, &context.memo()?, context)?;
    let trees = &grown.trees;
    stage(&mut files, &scenarios, trees, &spread, (several, axis))?;
    let folders = several.then(|| scenarios.iter().map(|scenario| scenario.folder.as_str()).collect());
    let record = run_record(args, context, &grown, start, folders);
    files.stage("run.json", to_json(&record)?.as_bytes())?;
    files.commit()?;
    let only = trees.first().filter(|_| !several);
    let named = || scenarios.iter().map(|scenario| scenario.name.as_str()).zip(trees).collect::<Vec<_>>();
    let drawing = || match (only, spread.first()) {
        (Some(tree), Some(spread)) => Some(rounds::draw_ranges(&tree.lineage, spread)),
        (Some(tree), None) => Some(rounds::draw(tree)),
        (None, _) => rounds::draw_scenarios(&named()),
    };
    if let Some(drawing) = picture.is_wanted().then(drawing).flatten() {
        picture.write(|| drawing)?;
    }
    let (solved, hits, elapsed_s) = (grown.summary.solved, grown.summary.memo_hits, start.elapsed().as_secs_f64());
    let out = out.display().to_string();
    let ran = json!({ "divisions_solved": solved, "memo_hits": hits, "elapsed_s": elapsed_s, "out": out });
    print_as(context.json, &merged(counts(&scenarios, trees, &spread, several), ran), || {
        let table = match only {
            _ if !spread.is_empty() => report::spread_table(&scenarios, &spread),
            Some(tree) => report::founders_table(tree, &founder_rows(tree)),
            None => report::scenarios_table(&scenarios, trees),
        };
        format!("{table}{solved} divisions solved, {hits} memo hits, {elapsed_s:.2} s; files in {out}\n")
    })
}

/// The time axis of the drawings; minutes require a clock.
fn time_axis(args: &TreeArgs, scenarios: &[Scenario]) -> Result<TimeAxis, InputError> {
    let axis = args.time_axis.unwrap_or_default();
    let without = scenarios.iter().find(|scenario| scenario.lineage.clock.is_none());
    if let Some(Scenario { lineage, .. }) = without.filter(|_| axis == TimeAxis::Minutes) {
        let allowed = format!("generations: the lineage {:?} has no clock", lineage.name);
        return Err(InputError::not_allowed("--time-axis", "time_axis", "minutes", allowed));
    }
    Ok(axis)
}

/// Stages the files of a single tree, or of several scenarios in their folders, with the page and the tables.
fn stage(
    files: &mut FileSet,
    scenarios: &[Scenario],
    trees: &[Tree],
    spread: &[LineageRanges],
    (several, axis): (bool, TimeAxis),
) -> Result<(), CliError> {
    for (Scenario { folder, .. }, tree) in scenarios.iter().zip(trees) {
        let [nwk, json, svg] =
            SCENARIO_FILES.map(|file| if several { format!("{folder}/{file}") } else { file.to_owned() });
        files.stage(&nwk, newick(tree).as_bytes())?;
        files.stage(&json, tree_to_json(tree)?.as_bytes())?;
        files.stage(&svg, report::svg(tree, axis).as_bytes())?;
    }
    let page = match trees.first().filter(|_| !several) {
        Some(tree) => report::html(tree, &founder_rows(tree), spread.first()),
        None => {
            files.stage("scenarios.csv", scenarios_csv(scenarios, trees).as_bytes())?;
            report::scenarios_page(scenarios, trees, spread)
        }
    };
    files.stage("report.html", page.as_bytes())?;
    if !spread.is_empty() {
        files.stage(SPREAD_FILE, spread_csv(scenarios, spread).as_bytes())?;
    }
    Ok(())
}

/// The `--json` output: the counts of a single tree or of all scenarios; with several seeds their ranges. `cue` is the text given by
/// the user, null for the lineage's own cues.
fn counts(scenarios: &[Scenario], trees: &[Tree], spread: &[LineageRanges], several: bool) -> Value {
    let of = |(k, (Scenario { name, folder, label, cue, .. }, tree)): (usize, (&Scenario, &Tree))| {
        let named = json!({ "name": name, "folder": folder, "lineage": label, "cue": cue });
        let counts = merged(if several { named } else { json!({}) }, tree_counts(tree));
        merged(counts, json!(spread.get(k)))
    };
    let mut all = scenarios.iter().zip(trees).enumerate().map(of);
    if several { json!({ "scenarios": all.collect::<Vec<_>>() }) } else { all.next().unwrap_or_default() }
}

/// The files that a run writes, below its folder.
fn names_of_files(scenarios: &[Scenario], beside: &[&str], several: bool) -> Vec<String> {
    let of = |Scenario { folder, .. }: &Scenario| SCENARIO_FILES.map(|file| format!("{folder}/{file}"));
    let folders = scenarios.iter().filter(|_| several).flat_map(of);
    folders.chain(beside.iter().map(|file| (*file).to_owned())).collect()
}

/// The single lineage, with the single cue if it is given.
fn single(args: &TreeArgs, context: &Context) -> Result<Scenario, CliError> {
    let file = args.lineage.first().map(PathBuf::as_path);
    let (mut lineage, settings) = prepared(&args.cell, args.seed, context, file)?;
    if let Some(text) = args.cue.first() {
        tell_who_gets(text, &lineage, &settings.cell, "");
        lineage = lineage.carrying(text, &settings.cell).map_err(bad_cue)?;
    }
    Ok(scenario_of(lineage, settings))
}

/// All combinations of lineage file and cue.
fn combined(args: &TreeArgs, context: &Context) -> Result<Vec<Scenario>, CliError> {
    let files = args.lineage.iter().map(|file| Some(file.as_path()));
    let built_in = args.lineage.is_empty().then_some(None);
    let mut sources = Vec::new();
    for file in files.chain(built_in) {
        let (lineage, settings) = prepared(&args.cell, args.seed, context, file)?;
        let stem = |file: &Path| file.file_stem().map_or(String::new(), |stem| stem.to_string_lossy().into_owned());
        let label = file.map_or("c_elegans".to_owned(), stem);
        args.cue.iter().for_each(|text| tell_who_gets(text, &lineage, &settings.cell, &label));
        sources.push(Source { label, lineage, settings });
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
    let mut lineage = load_lineage(file)?;
    if let Some(r0) = cell.r0 {
        let units = lineage.units().asked_in(r0);
        lineage.units = Some(units).filter(|units| *units != Default::default());
    }
    // The radius given by an option overrides that in the lineage file.
    if cell.r0.is_some() || context.sets("r0")? {
        lineage.forget_first_radius();
    }
    let given = cell.settings(context, &lineage.units())?;
    given.check_divisions("settings")?;
    if let (Some(Length::Natural(r0)), true) = (cell.r0, given.cell.r0 > MOST_PLAIN) {
        return Err(InputError::not_allowed("--r0", "r0", r0, plain_radius(r0)).into());
    }
    messages::warn_of(lineage.first_size_doubt(cell.r0, given.cell.r0));
    let settings = tree_settings(given, &lineage, seed, context.quantisation);
    let named = file.map_or(lineage.name.clone(), |file| file.display().to_string());
    lineage.check_physics(&settings.cell, &settings.numerics, &named)?;
    Ok((lineage, settings))
}

/// Prints which founders get a cue in a lineage without cues.
fn tell_who_gets(text: &str, lineage: &Lineage, cell: &Cell, label: &str) {
    warn_at(label, lineage.who_gets(text, cell));
}

/// The error for an invalid `--cue`.
pub fn bad_cue(error: CueError) -> InputError {
    InputError::not_allowed("--cue", error.field, error.value, error.allowed)
}

/// Grows all scenarios in one run, with several seeds if replicates are requested, and logs warnings. Returns the trees of the first
/// seed and the ranges over all seeds.
///
/// With `dynamics` the division of every cell is computed, including cells below the critical radius of their cue.
pub fn grown(
    scenarios: &[Scenario],
    replicates: Option<u32>,
    dynamics: bool,
    memo: &Memo,
    context: &Context,
) -> Result<(Grown, Vec<LineageRanges>), CliError> {
    for Scenario { lineage, settings, .. } in scenarios {
        lineage.check_cells(&settings.cell, &settings.numerics, &lineage.name)?;
    }
    let (grown, spread) = context.shown(|line| {
        let show = |progress| line.show(progress);
        let (options, flag) = (context.scheduling(&show), interrupt::flag());
        match replicates {
            Some(count) => study::grown_replicates(scenarios, count, dynamics, memo, options, flag),
            None => study::grown(scenarios, dynamics, memo, options, flag).map(|grown| (grown, vec![])),
        }
    })?;
    messages::warn_of(grown.summary.described());
    warn_of_searches(&grown.unknown);
    for (tree, scenario) in grown.trees.iter().zip(scenarios) {
        warn_at(&scenario.name, tree.doubts());
    }
    Ok((grown, spread))
}

/// Warns of rules for a number that no cue of the lineage has, unless an option removed all cues.
fn warn_of_rules(scenario: &Scenario, is_replaced: bool) {
    if is_replaced && scenario.lineage.is_without_cues() {
        return;
    }
    warn_at(&scenario.name, scenario.lineage.rules_without_cue());
}

/// Warns of doubts about one of several scenarios; a single scenario has no name.
fn warn_at(name: &str, doubts: impl IntoIterator<Item = String>) {
    let place = if name.is_empty() { String::new() } else { format!("{name}: ") };
    messages::warn_of(doubts.into_iter().map(|doubt| format!("{place}{doubt}")));
}

/// Logs cues without a critical radius, and warns once of all cues whose search was abandoned.
fn warn_of_searches(unknown: &[(Cue, ShapeError)]) {
    for (cue, error) in unknown {
        messages::write(
            Level::Info,
            format_args!("no critical radius for cells with the cue {cue}, whose divisions tell instead: {error}"),
        );
    }
    let given_up = unknown.iter().filter(|(_, error)| matches!(error, ShapeError::OutOfBudget { .. }));
    let given_up = given_up.map(|(cue, _)| cue.to_string()).collect::<Vec<_>>().join(" and ");
    if !given_up.is_empty() {
        messages::warning!(
            "the search for a critical radius was given up for cells with the cue {given_up}: all their divisions are computed"
        );
    }
}
