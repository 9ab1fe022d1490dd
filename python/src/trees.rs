//! Growing lineages, and the contents of trees.

use std::path::PathBuf;
use std::sync::Arc;

use furrow_analysis::observed::{Observed, ObservedOptions};
use furrow_analysis::scenarios::{Scenario, ScenarioError, Source, combine};
use furrow_analysis::{Grown, grown, grown_replicates, scenarios_csv, tree_settings};
use furrow_cell::Parameter;
use furrow_figures::plot;
use furrow_formats::exchange::{
    BranchLengths, Exported, Format, Sheet, TimedTree, check_sheet, check_tree, export_sheet,
};
use furrow_formats::tree_json::LONGEST_TREE;
use furrow_formats::{founder_rows, newick, tree_from_json, tree_to_json};
use furrow_input::{InputError, did_you_mean, read_text_up_to, shown};
use furrow_lineage::batch::scheduler::Summary;
use furrow_lineage::batch::{Memo as Solved, Quantisation};
use furrow_lineage::clock::alive;
use furrow_lineage::units::{MOST_PLAIN, plain_radius};
use furrow_lineage::{CellId, Length, Lineage, Tree, TreeCell};
use furrow_measured::tracked::{TableKind, embryo_files};
use furrow_mechanics::division::Division;
use furrow_report::{self as report, TreeSummary};
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict, PyList, PyString};
use serde_json::json;

use crate::document::Document;
use crate::drawings::Drawing;
use crate::errors::{ARGUMENTS, Error};
use crate::inputs::{Given, MatchAsked, arrays, bad_cue, fixed, lineage_of, matched_names};
use crate::memo::{Memo, run_warnings};
use crate::supervise::{Interrupt, supervised};

/// A tree.
#[pyclass(frozen, module = "furrow._furrow")]
pub struct GrownTree {
    /// The tree.
    pub tree: Arc<Tree>,
}

/// Numbers of cells over minutes.
type OverTime<'py> = (Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<i64>>);

/// A lineage's label, and the lineage as for [`lineage_of`].
pub type Labelled = (String, Option<String>);

/// Doubts about the lineage of each scenario, and about its cue and its first cell.
pub type Doubts = Vec<Vec<String>>;

/// The scenarios: every lineage with every cue; without cues the lineages keep theirs.
pub fn scenarios(
    lineages: &[Labelled],
    cues: &[String],
    given: &Given,
    seed: u64,
    quantisation: Quantisation,
) -> Result<(Vec<Scenario>, Doubts), InputError> {
    let (mut sources, mut doubts) = (Vec::new(), Doubts::new());
    for (label, text) in lineages {
        let (mut lineage, mut given) = (lineage_of(text.as_deref())?, given.clone());
        let first_given = given.parameters.scale_radius(&lineage)?;
        let settings = given.for_divisions()?;
        if let Some(r0) = first_given {
            if matches!(r0, Length::Natural(r0) if r0 > MOST_PLAIN) {
                return Err(InputError::not_allowed(ARGUMENTS, "r0", r0, plain_radius(settings.cell.r0)));
            }
            lineage.forget_first_radius();
        }
        let mut of_lineage = lineage.doubts();
        of_lineage.extend(lineage.first_size_doubt(first_given, settings.cell.r0));
        match cues {
            [] => doubts.push(of_lineage),
            cues => doubts.extend(cues.iter().map(|cue| {
                let who = lineage.who_gets(cue, &settings.cell);
                of_lineage.iter().cloned().chain(who).collect()
            })),
        }
        let settings = tree_settings(settings, &lineage, seed, quantisation);
        sources.push(Source { label: label.clone(), lineage, settings });
    }
    let of_call = given.parameters.overrides()?.pairs;
    let of_call = of_call.into_iter().map(|(name, value)| (ARGUMENTS, name, value.to_string()));
    Lineage::check_taken(&sources.iter().map(|source| &source.lineage).collect::<Vec<_>>(), of_call)?;
    let combined = combine(&sources, &cues.iter().map(String::as_str).collect::<Vec<_>>());
    let scenarios = combined.map_err(|error| match error {
        ScenarioError::Cue(error) => bad_cue(error),
        ScenarioError::Same { first, second } => {
            let allowed = format!("a different scenario; it duplicates {first}");
            InputError::not_allowed(ARGUMENTS, "cues", second, allowed)
        }
    })?;
    for (Scenario { lineage, settings, .. }, doubts) in scenarios.iter().zip(&mut doubts) {
        lineage.check_cells(&settings.cell, &settings.numerics, ARGUMENTS)?;
        // Rules for cues that the call took away are meant for other calls.
        if cues.is_empty() || !lineage.is_without_cues() {
            doubts.extend(lineage.rules_without_cue());
        }
    }
    Ok((scenarios, doubts))
}

/// A tree with the name, the lineage and the cue of its scenario, and its warnings.
type Named = (ScenarioNames, GrownTree, Vec<String>);

/// The name, the folder, the lineage and the cue of a scenario.
type ScenarioNames = (String, String, String, Option<String>);

fn named(Scenario { name, folder, label, cue, .. }: Scenario, tree: Tree, mut doubts: Vec<String>) -> Named {
    doubts.extend(tree.doubts());
    ((name, folder, label, cue), GrownTree { tree: Arc::new(tree) }, doubts)
}

/// The work of a run and its warnings.
fn work(summary: &Summary, unknown: usize, memo: &Solved) -> Document {
    let mut warnings = run_warnings(summary, memo);
    if unknown > 0 {
        warnings.push(format!("{unknown} cues have no critical radius: all divisions of their cells were computed"));
    }
    let (solved, known, stored) = (summary.solved, summary.memo_hits, summary.store_hits);
    json!({ "divisions_solved": solved, "memo_hits": known, "store_hits": stored, "warnings": warnings }).into()
}

/// Grows every lineage with every cue in one run; returns the trees, and the run's work.
#[pyfunction]
#[pyo3(signature = (lineages, cues, given, memo, seed, dynamics, threads, progress=None))]
pub fn grow(
    py: Python<'_>,
    lineages: Vec<Labelled>,
    cues: Vec<String>,
    given: Given,
    memo: &Memo,
    seed: u64,
    dynamics: bool,
    threads: usize,
    progress: Option<&Bound<'_, PyAny>>,
) -> Result<(Vec<Named>, Document), Error> {
    let memo = memo.solved()?;
    supervised(py, Interrupt::Finishes, progress, move |watch| {
        let (scenarios, doubts) = scenarios(&lineages, &cues, &given, seed, memo.quantisation())?;
        let found = watch.scheduled(threads, |options| grown(&scenarios, dynamics, &memo, *options, &watch.stop))?;
        let Grown { trees, summary, unknown } = found;
        let work = work(&summary, unknown.len(), &memo);
        let named = scenarios.into_iter().zip(trees).zip(doubts).map(|((one, tree), doubts)| named(one, tree, doubts));
        Ok((named.collect(), work))
    })
}

/// A tree, ranges over seeds, their picture, the page of both, the run's work, and warnings of the tree.
type Spread = (GrownTree, Document, Drawing, String, Document, Vec<String>);

/// Grows one lineage with several seeds.
#[pyfunction]
#[pyo3(signature = (lineage, cues, given, memo, seed, count, dynamics, threads, progress=None))]
pub fn grow_spread(
    py: Python<'_>,
    lineage: Labelled,
    cues: Vec<String>,
    given: Given,
    memo: &Memo,
    seed: u64,
    count: u32,
    dynamics: bool,
    threads: usize,
    progress: Option<&Bound<'_, PyAny>>,
) -> Result<Spread, Error> {
    let memo = memo.solved()?;
    supervised(py, Interrupt::Finishes, progress, move |watch| {
        let (scenarios, doubts) = scenarios(&[lineage], &cues, &given, seed, memo.quantisation())?;
        let (found, ranges) = watch.scheduled(threads, |options| {
            grown_replicates(&scenarios, count, dynamics, &memo, *options, &watch.stop)
        })?;
        let (Some(tree), Some(ranges)) = (found.trees.into_iter().next(), ranges.first()) else {
            return Err(Error::not_allowed("lineage", "none", "one lineage"));
        };
        let drawing = Drawing::of(plot::rounds::draw_ranges(&tree.lineage, ranges));
        let page = report::html(&tree, &founder_rows(&tree), Some(ranges));
        let doubts = doubts.into_iter().flatten().chain(tree.doubts()).collect();
        let work = work(&found.summary, found.unknown.len(), &memo);
        Ok((GrownTree { tree: Arc::new(tree) }, Document::of(ranges)?, drawing, page, work, doubts))
    })
}

/// The page of scenarios, their table as CSV and as text.
#[pyfunction]
pub fn scenarios_files(py: Python<'_>, parts: Vec<(ScenarioNames, Py<GrownTree>)>) -> (String, String, String) {
    let scenario = |((name, folder, label, cue), tree): &(ScenarioNames, Py<GrownTree>)| {
        let tree = &tree.get().tree;
        let (name, folder, label, cue) = (name.clone(), folder.clone(), label.clone(), cue.clone());
        Scenario { name, folder, label, cue, lineage: tree.lineage.clone(), settings: tree.settings.clone() }
    };
    py.detach(|| {
        let scenarios: Vec<Scenario> = parts.iter().map(scenario).collect();
        let trees: Vec<Tree> = parts.iter().map(|(_, tree)| Tree::clone(&tree.get().tree)).collect();
        let page = report::scenarios_page(&scenarios, &trees, &[]);
        (page, scenarios_csv(&scenarios, &trees), report::scenarios_table(&scenarios, &trees))
    })
}

/// Reads a tree.json.
#[pyfunction]
pub fn read_tree(py: Python<'_>, file: PathBuf) -> Result<GrownTree, Error> {
    py.detach(|| tree_of(&read_text_up_to(&file, LONGEST_TREE)?, &file.display().to_string()))
}

fn tree_of(text: &str, file: &str) -> Result<GrownTree, Error> {
    let no_tree = |error| InputError::other_file(file, "a tree as furrow writes it", error);
    Ok(GrownTree { tree: Arc::new(tree_from_json(text).map_err(no_tree)?) })
}

/// The value of a name, of several that are known.
pub fn one_of<T>(field: &str, name: &str, known: impl IntoIterator<Item = (&'static str, T)>) -> Result<T, Error> {
    let (names, mut values): (Vec<_>, Vec<_>) = known.into_iter().unzip();
    match names.iter().position(|known| *known == name) {
        Some(at) => Ok(values.swap_remove(at)),
        None => {
            let allowed = format!("one of {}{}", names.join(", "), did_you_mean(name, names.iter().copied()));
            Err(Error::not_allowed(field, shown(name), allowed))
        }
    }
}

/// A cell and those below it, or all.
fn below<'t>(sheet: Sheet<'t>, subtree: Option<&str>) -> Result<Sheet<'t>, Error> {
    Ok(match subtree {
        Some(root) => sheet.below(root, ARGUMENTS)?,
        None => sheet,
    })
}

/// The branch lengths that are asked for, if the format can have them.
fn lengths_of(name: Option<&str>, format: Format) -> Result<Option<BranchLengths>, Error> {
    let lengths = name.map(|name| one_of("lengths", name, BranchLengths::NAMED)).transpose()?;
    lengths.map_or(Ok(()), |lengths| format.check_lengths(lengths))?;
    Ok(lengths)
}

/// The arguments of an export of an observed embryo; Python gives them as a dict.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct ExportAsked {
    embryo: PathBuf,
    format: String,
    lengths: Option<String>,
    lineage: Option<String>,
    volumes: Vec<PathBuf>,
    frame_minutes: Option<f64>,
    voxel: Option<f64>,
    matching: MatchAsked,
    subtree: Option<String>,
}

/// An observed embryo in a format of other programs: files by name, or one without a name. With a path it is written there.
#[pyfunction]
pub fn export_observed<'py>(
    py: Python<'py>,
    asked: ExportAsked,
    path: Option<PathBuf>,
) -> Result<Vec<(String, Bound<'py, PyAny>)>, Error> {
    let exported = py.detach(|| {
        let format = one_of("format", &asked.format, Format::ALL.map(|format| (format.name(), format)))?;
        // Time points come from the recording.
        let lengths = lengths_of(asked.lengths.as_deref(), format)?.unwrap_or(BranchLengths::Minutes);
        let lineage = lineage_of(asked.lineage.as_deref())?;
        let names = matched_names(&lineage, &asked.matching)?;
        let (frame_minutes, voxel, volumes) =
            (asked.frame_minutes, asked.voxel, embryo_files(&asked.volumes, TableKind::Volumes)?.0);
        let options = ObservedOptions { volumes, frame_minutes, voxel, names: names.clone() };
        let observed = Observed::read(&asked.embryo, &options)?.lineage;
        let founders: Vec<&str> = lineage.founders.iter().map(|founder| founder.name.as_str()).collect();
        let sheet = below(observed.sheet(&founders, &names), asked.subtree.as_deref())?;
        check_sheet(&sheet, format, lengths)?;
        let exported = export_sheet(&sheet, format, lengths, &report::founder_colours(&lineage));
        if let Some(path) = &path {
            exported.write(path).map_err(Error::system)?;
        }
        Ok::<_, Error>(exported)
    })?;
    Ok(if path.is_some() { Vec::new() } else { files_of(py, exported) })
}

/// The files of an export, as texts or bytes.
fn files_of(py: Python<'_>, exported: Exported) -> Vec<(String, Bound<'_, PyAny>)> {
    match exported {
        Exported::File(text) => vec![(String::new(), PyString::new(py, &text).into_any())],
        Exported::Folder(files) => {
            files.into_iter().map(|(name, text)| (name.to_owned(), PyString::new(py, &text).into_any())).collect()
        }
        Exported::Binary(files) => {
            files.into_iter().map(|(name, bytes)| (name, PyBytes::new(py, &bytes).into_any())).collect()
        }
    }
}

impl GrownTree {
    fn exported(&self, format: &str, lengths: Option<&str>, subtree: Option<&str>) -> Result<Exported, Error> {
        let format = one_of("format", format, Format::ALL.map(|format| (format.name(), format)))?;
        let lengths = lengths_of(lengths, format)?.unwrap_or_default();
        check_tree(&self.tree, format, lengths)?;
        let (timed, colours) = (TimedTree::new(&self.tree), report::founder_colours(&self.tree.lineage));
        let sheet = below(Sheet::of_tree(&timed), subtree)?;
        Ok(export_sheet(&sheet, format, lengths, &colours))
    }
}

#[pymethods]
impl GrownTree {
    fn __len__(&self) -> usize {
        self.tree.len()
    }

    /// As the text of `tree.json`.
    fn to_json(&self, py: Python<'_>) -> Result<String, Error> {
        Ok(py.detach(|| tree_to_json(&self.tree))?)
    }

    /// Reads what [`to_json`](GrownTree::to_json) wrote.
    #[staticmethod]
    fn from_json(py: Python<'_>, text: &str) -> Result<GrownTree, Error> {
        py.detach(|| tree_of(text, ARGUMENTS))
    }

    fn __reduce__<'py>(slf: &Bound<'py, GrownTree>) -> Result<(Bound<'py, PyAny>, (String,)), Error> {
        Ok((slf.get_type().getattr("from_json")?, (slf.get().to_json(slf.py())?,)))
    }

    /// Name of the organism.
    #[getter]
    fn organism(&self) -> &str {
        &self.tree.lineage.name
    }

    /// The founders' table.
    fn founders(&self) -> Result<Document, Error> {
        Document::of(founder_rows(&self.tree))
    }

    /// The founders' table with the growth by generation, as `furrow tree` prints it.
    fn table(&self) -> String {
        report::founders_table(&self.tree, &founder_rows(&self.tree))
    }

    /// Cells that ended, by why they did.
    fn ended(&self) -> Result<Document, Error> {
        Document::of(&TreeSummary::of(&self.tree).ended)
    }

    /// The colour of each founder in all drawings.
    fn colours(&self) -> Vec<(&str, &str)> {
        let names = self.tree.lineage.founders.iter().map(|founder| founder.name.as_str());
        names.zip(report::founder_colours(&self.tree.lineage)).collect()
    }

    /// The tree as Newick.
    fn newick(&self, py: Python<'_>) -> String {
        py.detach(|| newick(&self.tree))
    }

    /// The tree as a drawing, over generations or minutes; of a large tree only the first generations.
    #[pyo3(signature = (axis="generations"))]
    fn svg(&self, py: Python<'_>, axis: &str) -> Result<String, Error> {
        let axis = one_of("time_axis", axis, report::TimeAxis::NAMED)?;
        if axis == report::TimeAxis::Minutes && self.tree.lineage.clock.is_none() {
            let allowed = format!("generations: the lineage {:?} has no clock", self.tree.lineage.name);
            return Err(Error::not_allowed("time_axis", "minutes", allowed));
        }
        Ok(py.detach(|| report::svg(&self.tree, axis)))
    }

    /// Minutes, and the cells alive then; `None` without a clock.
    fn alive<'py>(&self, py: Python<'py>) -> PyResult<Option<OverTime<'py>>> {
        let Some(times) = self.tree.times() else { return Ok(None) };
        let alive = alive(&times);
        let minutes = alive.iter().map(|alive| alive.min).collect();
        let cells = alive.iter().map(|alive| alive.cells as i64).collect();
        Ok(Some((fixed(PyArray1::from_vec(py, minutes))?, fixed(PyArray1::from_vec(py, cells))?)))
    }

    /// The tree as an interactive page.
    fn html(&self, py: Python<'_>) -> String {
        py.detach(|| report::html(&self.tree, &founder_rows(&self.tree), None))
    }

    /// The tree in a format of other programs, as files by name; a single file has no name.
    fn export<'py>(
        &self,
        py: Python<'py>,
        format: &str,
        lengths: Option<&str>,
        subtree: Option<&str>,
    ) -> Result<Vec<(String, Bound<'py, PyAny>)>, Error> {
        Ok(files_of(py, self.exported(format, lengths, subtree)?))
    }

    /// Writes the tree in a format of other programs: a file, or a folder of several.
    fn write_export(
        &self,
        py: Python<'_>,
        format: &str,
        lengths: Option<&str>,
        subtree: Option<&str>,
        path: PathBuf,
    ) -> Result<(), Error> {
        py.detach(|| self.exported(format, lengths, subtree)?.write(&path).map_err(Error::system))
    }

    /// All cells as columns, in breadth-first order; numbers as arrays, words as lists. `mother` is the mother's number, -1 of the first.
    fn cells<'py>(&self, py: Python<'py>) -> Result<Bound<'py, PyDict>, Error> {
        let tree = &self.tree;
        let number = |of: &dyn Fn(&TreeCell) -> Option<f64>| {
            tree.cells().map(|id| of(tree.cell(id)).unwrap_or(f64::NAN)).collect::<Vec<f64>>()
        };
        let division = |of: fn(&Division) -> Option<f64>| number(&|cell| of(cell.fate.division()?));
        let numbers = vec![
            ("r0", number(&|cell| Some(cell.r0))),
            ("volume_fraction", number(&|cell| Some(cell.volume_fraction))),
            ("chi", division(|d| d.chi())),
            ("chi_signed", division(|d| d.chi_signed())),
            ("u_furrow", division(|d| d.u_furrow())),
            ("t_end", division(|d| Some(d.t_end))),
            ("phi", division(|d| d.phi)),
        ];
        // Parameters that rules give cells are of all cells then.
        let ruled = |parameter: &Parameter| {
            let mut cells = tree.cells().filter_map(|id| tree.cell(id).physics.as_ref());
            cells.any(|physics| physics.values().any(|(of, _)| of == *parameter))
        };
        let values = |parameter: Parameter| tree.cells().map(|id| parameter.get(&tree.parameters(id))).collect();
        let by_rules = Parameter::ALL.into_iter().filter(ruled).map(|parameter| (parameter.name(), values(parameter)));
        let times = tree.times();
        let minutes = times.iter().flat_map(|times| {
            let births = times.iter().map(|cell| cell.birth_min).collect();
            let divisions = times.iter().map(|cell| cell.division_min.unwrap_or(f64::NAN)).collect();
            [("birth_min", births), ("division_min", divisions)]
        });
        let dict = arrays(py, numbers.into_iter().chain(by_rules).chain(minutes).collect())?;
        let whole = |of: &dyn Fn(CellId) -> i64| fixed(PyArray1::from_vec(py, tree.cells().map(of).collect()));
        dict.set_item("generation", whole(&|id| i64::from(tree.cell(id).generation))?)?;
        dict.set_item("mother", whole(&|id| tree.mother(id).map_or(-1, |mother| mother.index() as i64))?)?;
        let words = |of: &dyn Fn(CellId) -> Option<String>| PyList::new(py, tree.cells().map(of));
        if let Some(times) = &times {
            let beyond = times.iter().map(|cell| cell.lifetime_extrapolated).collect();
            dict.set_item("lifetime_extrapolated", fixed(PyArray1::from_vec(py, beyond))?)?;
        }
        dict.set_item("name", words(&|id| Some(tree.cell(id).name.clone()))?)?;
        dict.set_item("founder", words(&|id| Some(tree.founder_name(id).to_owned()))?)?;
        dict.set_item("cue", words(&|id| Some(tree.cell(id).cue.to_string()))?)?;
        dict.set_item("outcome", words(&|id| Some(tree.cell(id).fate.outcome()?.name().to_owned()))?)?;
        dict.set_item("ended", words(&|id| Some(tree.cell(id).fate.terminal_reason()?.name().to_owned()))?)?;
        Ok(dict)
    }
}
