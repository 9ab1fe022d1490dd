//! Growing lineages, and the contents of trees.

use furrow_formats::{tree_from_json, tree_to_json};
use std::path::PathBuf;
use std::sync::Arc;

use furrow_analysis::scenarios::{Scenario, ScenarioError, Source, combine};
use furrow_analysis::{Grown, grown, tree_settings};
use furrow_formats::exchange::{BranchLengths, Exported, Format, export};
use furrow_formats::tree_json::LONGEST_TREE;
use furrow_formats::{founder_rows, newick};
use furrow_input::{InputError, did_you_mean, read_text_up_to, shown};
use furrow_lineage::batch::{SchedulerOptions, Summary};
use furrow_lineage::{Tree, TreeCell};
use furrow_report::{self as report, TreeSummary};
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};
use serde::Serialize;

use crate::columns::{columns, or_nan};
use crate::errors::{Error, raised, unwritable};
use crate::inputs::{ARGUMENTS, Pairs, lineage_of, pairs, radius_of, settings_of};
use crate::memo::Memo;
use crate::supervise::{Interrupt, supervised};

/// A tree.
#[pyclass(frozen, module = "furrow._furrow")]
pub struct GrownTree {
    /// The tree.
    pub tree: Arc<Tree>,
}

/// The work of growing trees.
#[derive(Serialize)]
struct Work {
    divisions_solved: usize,
    memo_hits: usize,
    store_hits: usize,
    warnings: Vec<String>,
}

impl Work {
    fn of(summary: &Summary, unknown: usize) -> Work {
        let mut warnings: Vec<String> = summary.warnings.iter().map(ToString::to_string).collect();
        if unknown > 0 {
            warnings
                .push(format!("{unknown} cues have no critical radius: all divisions of their cells were computed"));
        }
        Work {
            divisions_solved: summary.solved,
            memo_hits: summary.memo_hits,
            store_hits: summary.store_hits,
            warnings,
        }
    }
}

/// The input of trees.
pub struct Plan {
    /// Lineages with their labels.
    pub lineages: Vec<(String, Option<String>)>,
    /// Cues that replace those of the lineages; empty to keep them.
    pub cues: Vec<String>,
    /// The preset.
    pub preset: String,
    /// A configuration file.
    pub config: Option<PathBuf>,
    /// Parameters.
    pub pairs: Pairs,
    /// Seed of the noise.
    pub seed: u64,
}

impl Plan {
    /// The scenarios: every lineage with every cue.
    pub fn scenarios(&self, quantisation: furrow_lineage::batch::Quantisation) -> Result<Vec<Scenario>, Error> {
        let mut sources = Vec::new();
        for (label, text) in &self.lineages {
            let mut lineage = lineage_of(text.as_deref())?;
            let mut pairs = self.pairs.clone();
            let first = pairs.iter_mut().find(|(name, _)| name == "r0" || name == "R0");
            let first_given = first.is_some();
            if let Some((_, text)) = first {
                *text = radius_of(text, &lineage)?.to_string();
            }
            let given = settings_of(&self.preset, self.config.as_ref(), &pairs)?;
            given.check_activity(ARGUMENTS)?;
            given.check_divisions(ARGUMENTS)?;
            if first_given {
                lineage.forget_first_radius();
            }
            let settings = tree_settings(given, &lineage, self.seed, quantisation);
            sources.push(Source { label: label.clone(), lineage, settings });
        }
        let cues: Vec<&str> = self.cues.iter().map(String::as_str).collect();
        let refused = |error| match error {
            ScenarioError::Cue(e) => InputError::not_allowed(ARGUMENTS, e.field, e.value, e.allowed),
            ScenarioError::Same { first, second } => {
                let allowed = format!("a different scenario; it duplicates {first}");
                InputError::not_allowed(ARGUMENTS, "cues", second, allowed)
            }
        };
        Ok(combine(&sources, &cues).map_err(refused)?)
    }
}

/// A tree with the name, the lineage and the cue of its scenario.
type Named = (String, String, Option<String>, GrownTree);

/// Grows every lineage with every cue in one run; returns the trees, and the run's work as JSON.
#[pyfunction]
#[pyo3(signature = (lineages, cues, parameters, memo, preset, config, seed, dynamics, threads, progress=None))]
pub fn grow(
    py: Python<'_>,
    lineages: Vec<(String, Option<String>)>,
    cues: Vec<String>,
    parameters: &Bound<'_, PyDict>,
    memo: &Memo,
    preset: String,
    config: Option<PathBuf>,
    seed: u64,
    dynamics: bool,
    threads: usize,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<(Vec<Named>, String)> {
    let plan = Plan { lineages, cues, preset, config, pairs: pairs(parameters)?, seed };
    let memo = Arc::clone(&memo.solved);
    let (scenarios, grown) = supervised(py, Interrupt::Finishes, progress, move |watch| {
        let scenarios = plan.scenarios(memo.quantisation())?;
        let show = |progress| watch.divisions(progress);
        let options = SchedulerOptions { threads, progress: Some(&show), ..SchedulerOptions::default() };
        let found = grown(&scenarios, dynamics, &memo, options, watch.stop())?;
        Ok((scenarios, found))
    })?;
    let Grown { trees, summary, unknown } = grown;
    let named = scenarios
        .into_iter()
        .zip(trees)
        .map(|(Scenario { name, label, cue, .. }, tree)| (name, label, cue, GrownTree { tree: Arc::new(tree) }));
    let work = serde_json::to_string(&Work::of(&summary, unknown.len())).map_err(unwritable)?;
    Ok((named.collect(), work))
}

/// Reads a tree.json.
#[pyfunction]
pub fn read_tree(py: Python<'_>, file: PathBuf) -> PyResult<GrownTree> {
    let read = || {
        let text = read_text_up_to(&file, LONGEST_TREE)?;
        tree_of(&text, &file.display().to_string())
    };
    py.detach(read).map_err(|error| raised(py, error.into(), 0))
}

fn tree_of(text: &str, file: &str) -> Result<GrownTree, InputError> {
    let tree = tree_from_json(text).map_err(|error| InputError::OtherFile {
        file: file.to_owned(),
        wanted: "a tree as furrow writes it".to_owned(),
        reason: error.to_string(),
    })?;
    Ok(GrownTree { tree: Arc::new(tree) })
}

#[pymethods]
impl GrownTree {
    fn __len__(&self) -> usize {
        self.tree.len()
    }

    /// As the text of `tree.json`.
    fn to_json(&self, py: Python<'_>) -> PyResult<String> {
        py.detach(|| tree_to_json(&self.tree)).map_err(unwritable)
    }

    /// Reads what [`to_json`](GrownTree::to_json) wrote.
    #[staticmethod]
    fn from_json(py: Python<'_>, text: &str) -> PyResult<GrownTree> {
        py.detach(|| tree_of(text, ARGUMENTS)).map_err(|error| raised(py, error.into(), 0))
    }

    fn __reduce__<'py>(slf: &Bound<'py, GrownTree>) -> PyResult<(Bound<'py, PyAny>, (String,))> {
        let text = slf.get().to_json(slf.py())?;
        Ok((slf.get_type().getattr("from_json")?, (text,)))
    }

    /// Name of the organism.
    #[getter]
    fn organism(&self) -> String {
        self.tree.lineage.name.clone()
    }

    /// The founders' table, as JSON.
    fn founders(&self) -> PyResult<String> {
        serde_json::to_string(&founder_rows(&self.tree)).map_err(unwritable)
    }

    /// The founders' table with the growth by generation, as `furrow tree` prints it.
    fn table(&self) -> String {
        report::founders_table(&self.tree, &founder_rows(&self.tree))
    }

    /// Cells that ended, by why they did, as JSON.
    fn ended(&self) -> PyResult<String> {
        serde_json::to_string(&TreeSummary::of(&self.tree).ended).map_err(unwritable)
    }

    /// The colour of each founder in all drawings.
    fn colours(&self) -> Vec<(String, String)> {
        let colours = report::founder_colours(&self.tree.lineage).into_iter().map(str::to_owned);
        self.tree.lineage.founders.iter().map(|founder| founder.name.clone()).zip(colours).collect()
    }

    /// The tree as Newick.
    fn newick(&self, py: Python<'_>) -> String {
        py.detach(|| newick(&self.tree))
    }

    /// The tree as a drawing; of a large tree only the first generations.
    fn svg(&self, py: Python<'_>) -> String {
        py.detach(|| report::svg(&self.tree))
    }

    /// The tree as an interactive page.
    fn html(&self, py: Python<'_>) -> String {
        py.detach(|| report::html(&self.tree, &founder_rows(&self.tree)))
    }

    /// The tree in a format of other programs, as files by name; a single file has no name.
    fn export(&self, py: Python<'_>, format: &str, lengths: &str) -> PyResult<Vec<(String, String)>> {
        let exported = || -> Result<Exported, InputError> {
            let names = || Format::ALL.into_iter().map(Format::name);
            let format = Format::ALL.into_iter().find(|known| known.name() == format).ok_or_else(|| {
                let allowed =
                    format!("one of {}{}", names().collect::<Vec<_>>().join(", "), did_you_mean(format, names()));
                InputError::not_allowed(ARGUMENTS, "format", shown(format), allowed)
            })?;
            let lengths = lengths_of(lengths)?;
            Ok(export(&self.tree, format, lengths, &report::founder_colours(&self.tree.lineage)))
        };
        match exported().map_err(|error| raised(py, error.into(), 0))? {
            Exported::File(text) => Ok(vec![(String::new(), text)]),
            Exported::Folder(files) => Ok(files.into_iter().map(|(name, text)| (name.to_owned(), text)).collect()),
        }
    }

    /// All cells as columns, in breadth-first order; numbers as arrays, words as lists. `mother` is the mother's number, -1 of the first.
    fn cells<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let tree = &self.tree;
        let number = |of: &dyn Fn(&TreeCell) -> f64| tree.cells().map(|id| of(tree.cell(id))).collect::<Vec<f64>>();
        let division = |of: fn(&furrow_mechanics::division::Division) -> Option<f64>| {
            number(&|cell| or_nan(cell.fate.division().and_then(of)))
        };
        let dict = columns(
            py,
            vec![
                ("r0", number(&|cell| cell.r0)),
                ("volume_fraction", number(&|cell| cell.volume_fraction)),
                ("chi", division(|d| d.chi())),
                ("chi_signed", division(|d| d.chi_signed())),
                ("u_furrow", division(|d| d.u_furrow())),
                ("t_end", division(|d| Some(d.t_end))),
            ],
        )?;
        let whole = |of: &dyn Fn(furrow_lineage::CellId) -> i64| PyArray1::from_vec(py, tree.cells().map(of).collect());
        dict.set_item("generation", whole(&|id| i64::from(tree.cell(id).generation)))?;
        dict.set_item("mother", whole(&|id| tree.mother(id).map_or(-1, |mother| mother.index() as i64)))?;
        let words = |of: &dyn Fn(furrow_lineage::CellId) -> Option<String>| PyList::new(py, tree.cells().map(of));
        dict.set_item("name", words(&|id| Some(tree.cell(id).name.clone()))?)?;
        dict.set_item("founder", words(&|id| Some(tree.founder_name(id).to_owned()))?)?;
        dict.set_item("cue", words(&|id| Some(tree.cell(id).cue.to_string()))?)?;
        dict.set_item("outcome", words(&|id| tree.cell(id).fate.outcome().map(|outcome| outcome.name().to_owned()))?)?;
        dict.set_item(
            "ended",
            words(&|id| tree.cell(id).fate.terminal_reason().map(|ended| ended.name().to_owned()))?,
        )?;
        Ok(dict)
    }
}

fn lengths_of(name: &str) -> Result<BranchLengths, InputError> {
    match name {
        "time" => Ok(BranchLengths::Time),
        "generation" => Ok(BranchLengths::Generation),
        "none" => Ok(BranchLengths::None),
        _ => Err(InputError::not_allowed(ARGUMENTS, "lengths", shown(name), "time, generation or none")),
    }
}
