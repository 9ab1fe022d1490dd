//! `tree.json`: the whole tree with what it was grown from, byte-identical for equal inputs.

use std::borrow::Cow;
use std::collections::{BTreeMap, HashMap};

use serde::{Deserialize, Serialize};

use super::provenance::Provenance;
use crate::cell::{Cell, Cue, Numerics};
use crate::division::{Division, Outcome};
use crate::lineage::{
    CellId, EndReason, Fate, Lineage, ObservedRounds, Place, Rounds, Side, Tree, TreeCell, TreeSettings, founder_rounds,
};

/// Name of the format.
pub const SCHEMA: &str = "furrow.tree";

/// Version of the format; it is raised when a field changes its meaning or goes.
pub const SCHEMA_VERSION: u32 = 2;

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
        /// What is wrong.
        message: String,
    },
    /// Another format or version.
    #[error("schema = {schema:?}, version {version}: must be {SCHEMA:?}, version {SCHEMA_VERSION}")]
    Schema {
        /// The file's format.
        schema: String,
        /// The file's version.
        version: u32,
    },
    /// The cells do not form a tree of the file's lineage.
    #[error("cells[{index}] {cell:?}: {message}")]
    Cell {
        /// Position in the list.
        index: usize,
        /// The cell's name.
        cell: String,
        /// What is wrong.
        message: String,
    },
}

/// A founder in the table that sets its rounds beside the observed ones.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FounderRow {
    /// Name.
    pub name: String,
    /// Radius R0; none if it was never born.
    pub r0: Option<f64>,
    /// The same in µm, where the lineage says how long L_h is.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub r0_um: Option<f64>,
    /// Volume as a fraction of the first cell's.
    pub volume_fraction: Option<f64>,
    /// Name of the cue that it carries.
    pub cue: String,
    /// Cues of the cells below it, up to the next founder, by name, and how many carry each.
    pub cued_descendants: BTreeMap<String, usize>,
    /// How its own division ended.
    pub outcome: Option<Outcome>,
    /// Its size asymmetry χ.
    pub chi: Option<f64>,
    /// Rounds grown.
    pub rounds: Option<Rounds>,
    /// Rounds observed.
    pub observed: Option<ObservedRounds>,
    /// The same under the name that it had when the worm was the only animal.
    pub sulston: Option<ObservedRounds>,
}

/// The founders' table, in the lineage file's order.
pub fn founder_rows(tree: &Tree) -> Vec<FounderRow> {
    let founders = tree.lineage.founders.len();
    let birth: Vec<Option<CellId>> = (0..founders).map(|founder| tree.founder_cell(founder)).collect();
    let mut cued = vec![BTreeMap::new(); founders];
    for id in tree.cells() {
        let cell = tree.cell(id);
        let Some(born) = birth[cell.founder].filter(|born| *born != id) else { continue };
        if !cell.cue.is_none() {
            let round = cell.generation - tree.cell(born).generation;
            let place = Place { founder: cell.founder, round, generation: cell.generation, r0: cell.r0 };
            *cued[cell.founder].entry(tree.lineage.cue_name_at(place).to_owned()).or_insert(0) += 1;
        }
    }
    let row = |founder: usize, rounds: Option<Rounds>| {
        let definition = &tree.lineage.founders[founder];
        let cell = tree.founder_cell(founder).map(|id| tree.cell(id));
        let place = cell.map(|c| Place { founder, round: 0, generation: c.generation, r0: c.r0 });
        FounderRow {
            name: definition.name.clone(),
            r0: cell.map(|c| c.r0),
            r0_um: cell.and_then(|c| tree.lineage.units().micrometres(c.r0)),
            volume_fraction: cell.map(|c| c.volume_fraction),
            cue: place.map_or("none", |place| tree.lineage.cue_name_at(place)).to_owned(),
            cued_descendants: cued[founder].clone(),
            outcome: cell.and_then(|c| c.fate.outcome()),
            chi: cell.and_then(|c| c.fate.chi()),
            rounds,
            observed: definition.observed,
            sulston: definition.observed,
        }
    };
    founder_rounds(tree).into_iter().map(|found| row(found.founder, found.rounds)).collect()
}

#[derive(Serialize)]
struct Head<'a> {
    schema: &'a str,
    schema_version: u32,
    provenance: Provenance,
    seed: u64,
    r0_step: f64,
    /// The first cell; what all cells share is taken from it.
    cell: &'a Cell,
    numerics: &'a Numerics,
    lineage: &'a Lineage,
    founders: Vec<FounderRow>,
}

#[derive(Deserialize)]
struct Document<'a> {
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

#[derive(Serialize, Deserialize)]
struct Record<'a> {
    #[serde(borrow)]
    name: Cow<'a, str>,
    #[serde(borrow)]
    mother: Option<Cow<'a, str>>,
    daughter: Option<Side>,
    #[serde(borrow)]
    founder: Cow<'a, str>,
    generation: u32,
    r0: f64,
    volume_fraction: f64,
    cue: Cow<'a, Cue>,
    outcome: Option<Outcome>,
    chi: Option<f64>,
    chi_signed: Option<f64>,
    u_furrow: Option<f64>,
    t_end: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    slow_growth_rate: Option<f64>,
    ended: Option<EndReason>,
}

impl<'a> Record<'a> {
    fn of(tree: &'a Tree, id: CellId) -> Record<'a> {
        let cell = tree.cell(id);
        let division = cell.fate.division.as_ref();
        Record {
            name: Cow::Borrowed(&cell.name),
            mother: tree.mother(id).map(|m| Cow::Borrowed(tree.cell(m).name.as_str())),
            daughter: tree.side(id),
            founder: Cow::Borrowed(tree.founder_name(id)),
            generation: cell.generation,
            r0: cell.r0,
            volume_fraction: cell.volume_fraction,
            cue: Cow::Borrowed(&cell.cue),
            outcome: cell.fate.outcome(),
            chi: division.and_then(|d| d.chi),
            chi_signed: division.and_then(|d| d.chi_signed),
            u_furrow: division.and_then(|d| d.u_furrow),
            t_end: division.map(|d| d.t_end),
            slow_growth_rate: division.and_then(|d| d.slow_growth_rate),
            ended: cell.fate.ended.clone(),
        }
    }

    /// The cell's fate; what a tree file does not keep of a division, the work it took, is zero.
    fn fate(&self) -> Fate {
        let growth_rate = match self.ended {
            Some(EndReason::AtRest { growth_rate }) => growth_rate,
            _ => None,
        };
        let division = self.outcome.zip(self.t_end).map(|(outcome, t_end)| {
            let division = Division {
                outcome,
                chi: self.chi,
                chi_signed: self.chi_signed,
                u_furrow: self.u_furrow,
                t_end,
                daughters: None,
                growth_rate,
                slow_growth_rate: self.slow_growth_rate,
                volume_drift: 0.0,
                work: bvp::Work::default(),
            };
            division.with_daughters_of(self.r0)
        });
        Fate { division, ended: self.ended.clone() }
    }
}

impl Tree {
    /// The tree as the text of `tree.json`, one cell a line in breadth-first order.
    ///
    /// # Errors
    /// None in practice; serialisation to memory is typed as fallible.
    pub fn to_json(&self) -> Result<String, serde_json::Error> {
        let head = Head {
            schema: SCHEMA,
            schema_version: SCHEMA_VERSION,
            provenance: Provenance::current(),
            seed: self.settings.seed,
            r0_step: self.settings.r0_step,
            cell: &self.settings.cell,
            numerics: &self.settings.numerics,
            lineage: &self.lineage,
            founders: founder_rows(self),
        };
        let mut out = serde_json::to_vec_pretty(&head)?;
        out.reserve(360 * self.len());
        out.truncate(out.len().saturating_sub("\n}".len()));
        out.extend_from_slice(b",\n  \"cells\": [\n");
        for id in self.cells() {
            if id != self.first() {
                out.extend_from_slice(b",\n");
            }
            out.extend_from_slice(b"    ");
            serde_json::to_writer(&mut out, &Record::of(self, id))?;
        }
        out.extend_from_slice(b"\n  ]\n}\n");
        // JSON is UTF-8 by construction.
        Ok(String::from_utf8(out).unwrap_or_else(|e| String::from_utf8_lossy(e.as_bytes()).into_owned()))
    }

    /// Reads `tree.json` back.
    ///
    /// # Errors
    /// Malformed JSON, another schema, or cells that do not form a tree.
    pub fn from_json(text: &str) -> Result<Tree, TreeFileError> {
        let document: Document<'_> = serde_json::from_str(text).map_err(|e| TreeFileError::Malformed {
            line: e.line(),
            column: e.column(),
            message: e.to_string(),
        })?;
        if document.schema != SCHEMA || document.schema_version != SCHEMA_VERSION {
            let schema = document.schema.into_owned();
            return Err(TreeFileError::Schema { schema, version: document.schema_version });
        }
        let settings = TreeSettings {
            cell: document.cell,
            numerics: document.numerics,
            seed: document.seed,
            r0_step: document.r0_step,
        };
        build(document.lineage, settings, document.cells)
    }
}

fn build(lineage: Lineage, settings: TreeSettings, records: Vec<Record<'_>>) -> Result<Tree, TreeFileError> {
    let wrong =
        |index: usize, cell: &str, message: String| TreeFileError::Cell { index, cell: cell.to_owned(), message };
    let founders: HashMap<String, usize> =
        lineage.founders.iter().enumerate().map(|(i, f)| (f.name.clone(), i)).collect();
    let mut nodes = HashMap::with_capacity(records.len());
    let mut tree: Option<Tree> = None;
    // Given away to the tree with its first cell.
    let mut lineage = Some((lineage, settings));
    for (index, record) in records.into_iter().enumerate() {
        let founder = *founders
            .get(record.founder.as_ref())
            .ok_or_else(|| wrong(index, &record.name, format!("founder {:?} is not in the lineage", record.founder)))?;
        let is_founder = record.name == record.founder;
        let cell = TreeCell {
            name: record.name.as_ref().to_owned(),
            founder,
            generation: record.generation,
            r0: record.r0,
            volume_fraction: record.volume_fraction,
            cue: record.cue.as_ref().clone(),
            fate: record.fate(),
        };
        let node = match (&mut tree, &record.mother, record.daughter) {
            (None, None, None) => {
                let Some((lineage, settings)) = lineage.take() else { break };
                let new = Tree::new(lineage, settings, cell);
                let node = new.first();
                tree = Some(new);
                node
            }
            (Some(tree), Some(mother), Some(side)) => {
                let mother = *nodes.get(mother.as_ref()).ok_or_else(|| {
                    wrong(index, &record.name, format!("mother {mother:?} is not among the cells before it"))
                })?;
                if tree.cell(mother).generation + 1 != record.generation {
                    let message = format!("generation {} does not follow the mother's", record.generation);
                    return Err(wrong(index, &record.name, message));
                }
                tree.add(mother, side, cell, is_founder)
            }
            _ => {
                let message = "the first cell, and no other, has neither mother nor daughter side".to_owned();
                return Err(wrong(index, &record.name, message));
            }
        };
        if nodes.insert(record.name.clone(), node).is_some() {
            return Err(wrong(index, &record.name, "its name appears twice".to_owned()));
        }
    }
    let tree = tree.ok_or_else(|| wrong(0, "", "there are no cells".to_owned()))?;
    for id in tree.cells() {
        let daughters = tree.daughter_count(id);
        if daughters != 0 && (daughters != 2 || tree.daughters(id).is_none()) {
            let message = "its daughters are not one anterior and one posterior".to_owned();
            return Err(wrong(id.index(), &tree.cell(id).name, message));
        }
    }
    Ok(tree)
}
