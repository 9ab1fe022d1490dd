//! Reading `tree.json`: a file is a whole tree of its lineage, or an error with its place.

use std::borrow::Cow;
use std::collections::HashMap;
use std::path::Path;

use serde::Deserialize;

use super::message::malformed;
use super::{Record, SCHEMA, SCHEMA_VERSION};
use furrow_cell::settings::Settings;
use furrow_cell::{Cell, Cue, Numerics};
use furrow_input::{InputError, forbidden, read_text_up_to, shown};
use furrow_lineage::{CellId, CellTimes, Fate, Lineage, Side, TerminalReason, Tree, TreeCell, TreeSettings};
use furrow_mechanics::division::{Division, DivisionRow, Outcome};

/// The longest file of a tree that is read, in bytes: 512 MB, enough for the million cells to which a lineage grows by default.
pub const LONGEST_TREE: u64 = 512 << 20;

/// The oldest version that is read. It has cues by field.
const OLDEST: u32 = 2;

/// Why a tree file cannot be read.
#[derive(Debug, thiserror::Error)]
pub enum TreeFileError {
    /// Not JSON, or not these fields.
    #[error("line {line}, column {column}: {message}")]
    Malformed {
        /// Line, from 1.
        line: usize,
        /// Column, from 1.
        column: usize,
        /// The error in the text.
        message: String,
    },
    /// Another format or version.
    #[error("schema = {}, version {version}: must be {SCHEMA:?}, version {OLDEST} to {SCHEMA_VERSION}", shown(.schema))]
    Schema {
        /// The file's format.
        schema: String,
        /// The file's version.
        version: u32,
    },
    /// The parameters or the lineage are invalid.
    #[error(transparent)]
    Inputs(#[from] InputError),
    /// The cells do not form a tree of the file's lineage.
    #[error("cells[{index}] {}: {message}", shown(.cell))]
    Cell {
        /// Position in the list.
        index: usize,
        /// The cell's name.
        cell: String,
        /// The error of the cell.
        message: String,
    },
}

impl TreeFileError {
    /// The same of a file by name.
    fn in_file(self, file: &Path) -> InputError {
        let file = file.display().to_string();
        match self {
            TreeFileError::Malformed { line, column, message } => InputError::Malformed { file, line, column, message },
            other => InputError::Founders { file, message: other.to_string() },
        }
    }
}

#[derive(Deserialize)]
struct Document<'a> {
    #[serde(borrow)]
    schema: Cow<'a, str>,
    schema_version: u32,
    seed: u64,
    r0_step: f64,
    cell: Cell,
    numerics: Numerics,
    lineage: Lineage,
    #[serde(borrow)]
    cells: Vec<Record<'a>>,
}

/// Schema and version, of a document that lacks other fields.
#[derive(Deserialize)]
struct Heading<'a> {
    #[serde(borrow)]
    schema: Cow<'a, str>,
    schema_version: u32,
}

/// Reads a file `tree.json`, of at most [`LONGEST_TREE`] bytes. It may be a pipe.
///
/// # Errors
/// Names the file, the error in it and the allowed values.
pub fn read_tree(path: &Path) -> Result<Tree, InputError> {
    let text = read_text_up_to(path, LONGEST_TREE)?;
    let begun = text.trim_start_matches('\u{feff}').trim_start();
    if !begun.starts_with('{') {
        let reason = match begun.lines().next() {
            None => "it is empty".to_owned(),
            Some(line) => format!("it begins with {}, and a tree.json is JSON that begins with {{", shown(line)),
        };
        return Err(InputError::other_file(path.display(), "a tree.json", reason));
    }
    tree_from_json(&text).map_err(|error| error.in_file(path))
}

/// Reads the text of `tree.json`. A tree is whole: cells are in breadth-first order, each without daughters and with the
/// reason, or with an anterior and a posterior one and the division; founders are where the lineage has them.
///
/// # Errors
/// Malformed JSON, another schema, invalid parameters or lineage, or cells that do not form a tree.
pub fn tree_from_json(text: &str) -> Result<Tree, TreeFileError> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let another = |schema: &str, version| match schema == SCHEMA && (OLDEST..=SCHEMA_VERSION).contains(&version) {
        true => Ok(()),
        false => Err(TreeFileError::Schema { schema: schema.to_owned(), version }),
    };
    let document: Document<'_> = match serde_json::from_str(text) {
        Ok(document) => document,
        Err(error) => {
            // A document of another version may lack fields of this one; the version is then the helpful error.
            if let Ok(Heading { schema, schema_version }) = serde_json::from_str(text) {
                another(&schema, schema_version)?;
            }
            return Err(malformed(text, &error));
        }
    };
    another(&document.schema, document.schema_version)?;
    document.lineage.check("lineage")?;
    let numerics = document.numerics;
    Settings::of(document.cell.clone(), numerics).check_fields("cell and numerics")?;
    if !(0.0..=0.5).contains(&document.r0_step) {
        return Err(InputError::not_allowed("tree", "r0_step", document.r0_step, "from 0 to 0.5").into());
    }
    let settings = TreeSettings { cell: document.cell, numerics, seed: document.seed, r0_step: document.r0_step };
    build(document.lineage, settings, &document.cells)
}

/// The error of a cell, with the allowed values.
type Complaint = String;

/// Adds cells to a tree after checking them.
fn build(lineage: Lineage, settings: TreeSettings, records: &[Record<'_>]) -> Result<Tree, TreeFileError> {
    let wrong = |index: usize, message: Complaint| {
        let cell = records.get(index).map_or(String::new(), |record| record.name.to_string());
        TreeFileError::Cell { index, cell, message }
    };
    let founders: HashMap<String, usize> =
        lineage.founders.iter().enumerate().map(|(i, founder)| (founder.name.clone(), i)).collect();
    // The cue checked last: most cells have their mother's cue.
    let mut checked = Cue::none();
    let mut cell = |record: &Record<'_>| {
        in_range(record)?;
        if *record.cue != checked {
            record.cue.check().map_err(|error| format!("cue: {error}"))?;
            checked = record.cue.as_ref().clone();
        }
        let unknown = || format!("founder {} is not in the lineage", shown(&record.founder));
        Ok(TreeCell {
            name: record.name.to_string(),
            founder: *founders.get(record.founder.as_ref()).ok_or_else(unknown)?,
            generation: record.generation,
            r0: record.r0,
            volume_fraction: record.volume_fraction,
            cue: record.cue.as_ref().clone(),
            physics: record.physics.as_deref().copied().filter(|physics| !physics.is_empty()).map(Box::new),
            fate: record.fate()?,
        })
    };
    let first = records.first().ok_or_else(|| wrong(0, "there are no cells".to_owned()))?;
    let root = cell(first).and_then(|root| is_first(&lineage, first, &root).map(|()| root));
    let mut tree = Tree::new(lineage, settings, root.map_err(|message| wrong(0, message))?);
    let mut nodes = HashMap::from([(first.name.as_ref(), tree.first())]);
    // The mother and the side of the cell before.
    let mut last: Option<(CellId, Side)> = None;
    for (index, record) in records.iter().enumerate().skip(1) {
        let mut add = || {
            let cell = cell(record)?;
            let (Some(mother), Some(side)) = (&record.mother, record.daughter) else {
                return Err(ONE_FIRST.to_owned());
            };
            let unknown = || format!("mother {} is not among the cells before it", shown(mother));
            let mother = *nodes.get(mother.as_ref()).ok_or_else(unknown)?;
            let is_founder = follows(&tree, mother, record, cell.founder)?;
            if last.is_some_and(|(before, last)| {
                mother < before || mother == before && (last, side) == (Side::Posterior, Side::Anterior)
            }) {
                return Err(
                    "it is out of order: cells stand in the order of their mothers, the anterior daughter first"
                        .to_owned(),
                );
            }
            last = Some((mother, side));
            match nodes.insert(&record.name, tree.add(mother, side, cell, is_founder)) {
                None => Ok(()),
                Some(_) => Err("its name appears twice".to_owned()),
            }
        };
        add().map_err(|message| wrong(index, message))?;
    }
    let times = tree.times();
    for (id, record) in tree.cells().zip(records) {
        whole(&tree, id, record)
            .and_then(|()| on_time(times.as_ref().map(|times| times[id.index()]), record))
            .map_err(|message| wrong(id.index(), message))?;
    }
    Ok(tree)
}

/// The error if several cells, or the only one, have no mother.
const ONE_FIRST: &str = "the first cell, and no other, has neither mother nor daughter side";

/// Checks the first cell.
fn is_first(lineage: &Lineage, record: &Record<'_>, cell: &TreeCell) -> Result<(), Complaint> {
    if record.mother.is_some() || record.daughter.is_some() {
        return Err(ONE_FIRST.to_owned());
    }
    if cell.founder != lineage.first() || record.name != record.founder {
        let first = lineage.founders.get(lineage.first()).map_or("", |first| &first.name);
        return Err(format!("the first cell must be the first founder of the lineage, {}", shown(first)));
    }
    match cell.generation {
        0 => Ok(()),
        generation => Err(format!("generation = {generation}: must be 0 for the first cell")),
    }
}

/// Whether a cell can be a daughter of `mother`, and whether it is the founder that it belongs to.
fn follows(tree: &Tree, mother: CellId, record: &Record<'_>, founder: usize) -> Result<bool, Complaint> {
    let above = tree.cell(mother);
    if above.generation.checked_add(1) != Some(record.generation) {
        return Err(format!("generation {} does not follow the mother's", record.generation));
    }
    let is_founder = record.name == record.founder;
    // A founder is a daughter of its mother in the lineage; other cells are of their mother's founder.
    let right = match is_founder {
        true => tree.lineage.founders.get(founder).is_some_and(|f| f.mother.as_deref() == Some(&*above.name)),
        false => founder == above.founder,
    };
    let (founder, mother) = (shown(&record.founder), shown(&above.name));
    let refused = || format!("founder {founder} is not what a daughter of {mother} belongs to in the lineage");
    right.then_some(is_founder).ok_or_else(refused)
}

/// Checks the values of a cell.
fn in_range(record: &Record<'_>) -> Result<(), Complaint> {
    if record.name.is_empty() || forbidden(&record.name).is_some() {
        return Err("name: must not be empty, nor have control characters".to_owned());
    }
    if record.name.chars().any(|c| c.is_whitespace() || "()[]{}:;,'\"=".contains(c)) {
        return Err(
            "name: must be free of blanks, brackets, quotes and of : ; , = (tree files reserve them)".to_owned()
        );
    }
    // The least number above 0.
    let least = f64::from_bits(1);
    let ranges = [
        ("r0", Some(record.r0), least..=f64::MAX, "a finite number above 0"),
        ("volume_fraction", Some(record.volume_fraction), least..=f64::MAX, "a finite number above 0"),
        ("chi", record.chi, 0.0..=1.0, "from 0 to 1"),
        ("chi_signed", record.chi_signed, -1.0..=1.0, "from -1 to 1"),
        ("u_furrow", record.u_furrow, 0.0..=1.0, "from 0 to 1"),
        ("t_end", record.t_end, 0.0..=f64::MAX, "a finite number of at least 0"),
    ];
    for (name, value, range, allowed) in ranges {
        if let Some(value) = value.filter(|value| !range.contains(value)) {
            // With an exponent where digits would fill the screen.
            return Err(format!("{name} = {value:?}: must be {allowed}"));
        }
    }
    for (parameter, value) in record.physics.iter().flat_map(|physics| physics.values()) {
        let refused = |allowed| format!("physics.{parameter} = {value:?}: must be {allowed}");
        parameter.validate(value).map_err(refused)?;
    }
    Ok(())
}

/// Whether a cell has ended, or has two daughters and the division that gave them.
fn whole(tree: &Tree, id: CellId, record: &Record<'_>) -> Result<(), Complaint> {
    let divided = record.t_end.is_some() && matches!(record.outcome, Some(Outcome::Symmetric | Outcome::Asymmetric));
    let complaint = match (tree.daughter_count(id), &record.ended) {
        (0, Some(_)) => return Ok(()),
        (0, None) => "ended = null: must be the reason why it has no daughters",
        (count, _) if count != 2 || tree.daughters(id).is_none() => {
            "its daughters are not one anterior and one posterior"
        }
        (_, Some(reason)) => {
            return Err(format!("ended = {:?}: must be null where there are daughters", reason.name()));
        }
        (_, None) if divided => return Ok(()),
        (_, None) => "outcome: must be symmetric or asymmetric, with t_end, where there are daughters",
    };
    Err(complaint.to_owned())
}

/// Largest difference in minutes between times of a file and its clock: powers differ between machines in their last digits.
const SAME_MIN: f64 = 1e-6;

/// Checks that the times of a cell, if the file gives them, agree with the lineage's clock.
fn on_time(times: Option<CellTimes>, record: &Record<'_>) -> Result<(), Complaint> {
    let [birth, division] = [times.map(|times| times.birth_min), times.and_then(|times| times.division_min)];
    for (name, given, known) in
        [("birth_min", record.birth_min, birth), ("division_min", record.division_min, division)]
    {
        let Some(given) = given else { continue };
        let same = |known: f64| (given - known).abs() <= SAME_MIN * known.abs().max(1.0);
        if !known.is_some_and(same) {
            let allowed = known.map_or("left out: the cell has none by the lineage's clock".to_owned(), |known| {
                format!("{known:?} by the lineage's clock, or left out")
            });
            return Err(format!("{name} = {given:?}: must be {allowed}"));
        }
    }
    Ok(())
}

impl Record<'_> {
    /// The cell's fate. A tree file does not keep the work of a division, which is zero.
    fn fate(&self) -> Result<Fate, Complaint> {
        let growth_rate = match self.ended {
            Some(TerminalReason::AtRest { growth_rate }) => growth_rate,
            _ => None,
        };
        let row = self.outcome.zip(self.t_end).map(|(outcome, t_end)| DivisionRow {
            outcome,
            chi: self.chi,
            chi_signed: self.chi_signed,
            u_furrow: self.u_furrow,
            t_end,
            daughters: Some([0.0; 2]),
            growth_rate,
            slow_growth_rate: self.slow_growth_rate,
            phi: self.phi,
            neck_offset: self.neck_offset,
            second_neck: self.second_neck,
            volume_drift: 0.0,
            work: furrow_bvp::Work::default(),
        });
        let missing = |outcome: Outcome| format!("outcome = {outcome}: needs chi and u_furrow");
        let division = |row: DivisionRow| {
            let outcome = row.outcome;
            let division = Division::try_from(row).map_err(|_| missing(outcome))?;
            Ok::<_, Complaint>(division.with_daughters_of(self.r0))
        };
        let division = row.map(division).transpose()?;
        Ok(match (self.ended.clone(), division) {
            (None, Some(division)) => Fate::Divides(division),
            (Some(reason), division) => Fate::Terminal { reason, division },
            // Refused with the whole tree, when its daughters are known.
            (None, None) => TerminalReason::Undecided { why: String::new() }.into(),
        })
    }
}
