//! `furrow tree` of several lineages or cues: scenarios side by side.

use furrow_formats::tree_to_json;
use std::path::Path;
use std::time::Instant;

use serde::Serialize;

use super::context::Context;
use super::error::CliError;
use super::interrupt;
use super::output::{print_as, to_json, writable_folder};
use super::tree::{RunRecord, TreeArgs, bad_cue, grown, prepared, run_text};
use furrow_analysis::Grown;
use furrow_analysis::scenarios::{Scenario, ScenarioError, Source, combine};
use furrow_analysis::scenarios_csv;
use furrow_formats::files::FileSet;
use furrow_formats::{FounderRow, founder_rows, newick};
use furrow_input::InputError;
use furrow_lineage::Tree;
use furrow_report as report;

/// The files of one scenario, in a folder of its name.
const SCENARIO_FILES: [&str; 3] = ["tree.nwk", "tree.json", "tree.svg"];

/// The files beside the scenarios' folders.
const SCENARIOS_FILES: [&str; 3] = ["scenarios.csv", "report.html", "run.json"];

/// What `--json` prints.
#[derive(Serialize)]
struct Answer<'a> {
    scenarios: Vec<AnswerScenario<'a>>,
    divisions_solved: usize,
    memo_hits: usize,
    elapsed_s: f64,
    out: String,
}

#[derive(Serialize)]
struct AnswerScenario<'a> {
    name: &'a str,
    lineage: &'a str,
    /// As it was asked for; null where the lineage's own cues are in force.
    cue: Option<&'a str>,
    founders: Vec<FounderRow>,
    cells: usize,
    generations: usize,
    ended: std::collections::BTreeMap<&'static str, usize>,
    slow_cells: usize,
}

pub fn run(args: &TreeArgs, context: &Context) -> Result<(), CliError> {
    let start = Instant::now();
    interrupt::finish();
    if let Some(file) = &args.constants {
        let allowed = "given with one lineage and at most one --cue";
        return Err(InputError::not_allowed("--constants", "constants", format!("{file:?}"), allowed).into());
    }
    let picture = args.plot.file()?;
    let scenarios = read(args, context)?;
    writable_folder("--out", args.out.as_path(), &SCENARIOS_FILES)?;
    for scenario in &scenarios {
        writable_folder("--out", args.out.join(&scenario.name).as_path(), &SCENARIO_FILES)?;
    }
    let Grown { trees, summary, .. } = grown(&scenarios, args.dynamics, context)?;
    let mut files = FileSet::new(&args.out);
    for (Scenario { name, .. }, tree) in scenarios.iter().zip(&trees) {
        let [nwk, json, svg] = SCENARIO_FILES.map(|file| format!("{name}/{file}"));
        files.stage(&nwk, newick(tree).as_bytes())?;
        files.stage(&json, tree_to_json(&tree)?.as_bytes())?;
        files.stage(&svg, report::svg(tree).as_bytes())?;
    }
    files.stage("scenarios.csv", scenarios_csv(&scenarios, &trees).as_bytes())?;
    files.stage("report.html", report::scenarios_page(&scenarios, &trees).as_bytes())?;
    let names: Vec<&str> = scenarios.iter().map(|scenario| scenario.name.as_str()).collect();
    let named: Vec<(&str, &Tree)> = names.iter().copied().zip(&trees).collect();
    let record = RunRecord::of(args, context, &summary, start, trees.iter().map(Tree::len).sum(), Some(names));
    files.stage("run.json", to_json(&record)?.as_bytes())?;
    files.commit()?;
    if let Some(drawing) = furrow_figures::plot::rounds::draw_scenarios(&named) {
        picture.write(|| drawing)?;
    }
    let document = Answer {
        scenarios: scenarios.iter().zip(&trees).map(|(scenario, tree)| AnswerScenario::new(scenario, tree)).collect(),
        divisions_solved: summary.solved,
        memo_hits: summary.memo_hits,
        elapsed_s: start.elapsed().as_secs_f64(),
        out: args.out.display().to_string(),
    };
    print_as(context.json, &document, || {
        report::scenarios_table(&scenarios, &trees) + &run_text(args, &summary, document.elapsed_s)
    })
}

impl<'a> AnswerScenario<'a> {
    fn new(scenario: &'a Scenario, tree: &Tree) -> AnswerScenario<'a> {
        let counts = report::TreeSummary::of(tree);
        AnswerScenario {
            name: &scenario.name,
            lineage: &scenario.label,
            cue: scenario.cue.as_deref(),
            founders: founder_rows(tree),
            cells: tree.len(),
            generations: counts.generations.len(),
            ended: counts.ended,
            slow_cells: counts.slow,
        }
    }
}

/// Every lineage file with every cue.
fn read(args: &TreeArgs, context: &Context) -> Result<Vec<Scenario>, CliError> {
    let files: Vec<Option<&Path>> = match args.lineage.is_empty() {
        true => vec![None],
        false => args.lineage.iter().map(|file| Some(file.as_path())).collect(),
    };
    let mut sources = Vec::new();
    for file in files {
        let (lineage, settings) = prepared(&args.cell, args.seed, context, file)?;
        sources.push(Source { label: label(file), lineage, settings });
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

/// What a lineage file is called: its name without what stands behind the dot.
fn label(file: Option<&Path>) -> String {
    match file {
        None => "c_elegans".to_owned(),
        Some(file) => file.file_stem().map_or(String::new(), |stem| stem.to_string_lossy().into_owned()),
    }
}
