//! `tree.json`: the whole tree with what it was grown from, byte-identical for equal inputs.

use super::provenance::Provenance;
use crate::cortex::{Cue, Numerics, Physics};
use crate::division::Outcome;
use crate::lineage::{
    Cell, EndReason, Fate, Lineage, ObservedRounds, Rounds, Side, Tree, TreeSettings, founder_rounds,
};
use serde::{Deserialize, Serialize};
use std::borrow::Cow;
use std::collections::HashMap;

/// Name of the format.
pub const SCHEMA: &str = "furrow.tree";

/// Version of the format; it is raised when a field changes its meaning or goes.
pub const SCHEMA_VERSION: u32 = 1;

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

/// A founder in the table that sets her rounds beside the observed ones.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FounderRow {
    /// Name.
    pub name: String,
    /// Radius R0; none if she was never born.
    pub r0: Option<f64>,
    /// Volume as a fraction of the first cell's.
    pub volume_fraction: Option<f64>,
    /// Name of her cue.
    pub cue: String,
    /// How her own division ended.
    pub outcome: Option<Outcome>,
    /// Its size asymmetry χ.
    pub chi: Option<f64>,
    /// Rounds grown.
    pub rounds: Option<Rounds>,
    /// Rounds observed.
    pub sulston: Option<ObservedRounds>,
}

/// The founders' table, in the lineage file's order.
pub fn founder_rows(tree: &Tree) -> Vec<FounderRow> {
    founder_rounds(tree)
        .into_iter()
        .map(|row| {
            let founder = &tree.lineage.founders[row.founder];
            let cell = tree.founder_cell(row.founder).map(|node| tree.cell(node));
            FounderRow {
                name: founder.name.clone(),
                r0: cell.map(|c| c.r0),
                volume_fraction: cell.map(|c| c.volume_fraction),
                cue: founder.cue.clone().unwrap_or_else(|| "none".to_owned()),
                outcome: cell.and_then(|c| c.fate.outcome),
                chi: cell.and_then(|c| c.fate.chi),
                rounds: row.rounds,
                sulston: founder.sulston,
            }
        })
        .collect()
}

#[derive(Serialize)]
struct Head<'a> {
    schema: &'a str,
    schema_version: u32,
    provenance: Provenance,
    seed: u64,
    r0_step: f64,
    physics: &'a Physics,
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
    physics: Physics,
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
    cue: Cue,
    outcome: Option<Outcome>,
    chi: Option<f64>,
    chi_signed: Option<f64>,
    u_furrow: Option<f64>,
    t_end: Option<f64>,
    ended: Option<EndReason>,
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
            physics: &self.settings.physics,
            numerics: &self.settings.numerics,
            lineage: &self.lineage,
            founders: founder_rows(self),
        };
        let mut out = serde_json::to_vec_pretty(&head)?;
        out.reserve(360 * self.len());
        out.truncate(out.len().saturating_sub("\n}".len()));
        out.extend_from_slice(b",\n  \"cells\": [\n");
        for node in self.nodes() {
            let cell = self.cell(node);
            let record = Record {
                name: Cow::Borrowed(&cell.name),
                mother: self.mother(node).map(|m| Cow::Borrowed(self.cell(m).name.as_str())),
                daughter: self.side(node),
                founder: Cow::Borrowed(self.founder_name(node)),
                generation: cell.generation,
                r0: cell.r0,
                volume_fraction: cell.volume_fraction,
                cue: cell.cue,
                outcome: cell.fate.outcome,
                chi: cell.fate.chi,
                chi_signed: cell.fate.chi_signed,
                u_furrow: cell.fate.u_furrow,
                t_end: cell.fate.t_end,
                ended: cell.fate.ended,
            };
            if node != self.first() {
                out.extend_from_slice(b",\n");
            }
            out.extend_from_slice(b"    ");
            serde_json::to_writer(&mut out, &record)?;
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
            physics: document.physics,
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
    let mut lineage = Some(lineage);
    for (index, record) in records.into_iter().enumerate() {
        let founder = *founders
            .get(record.founder.as_ref())
            .ok_or_else(|| wrong(index, &record.name, format!("founder {:?} is not in the lineage", record.founder)))?;
        let is_founder = record.name == record.founder;
        let cell = Cell {
            name: record.name.as_ref().to_owned(),
            founder,
            generation: record.generation,
            r0: record.r0,
            volume_fraction: record.volume_fraction,
            cue: record.cue,
            fate: Fate {
                outcome: record.outcome,
                chi: record.chi,
                chi_signed: record.chi_signed,
                u_furrow: record.u_furrow,
                t_end: record.t_end,
                ended: record.ended,
            },
        };
        let node = match (&mut tree, &record.mother, record.daughter) {
            (None, None, None) => {
                let Some(lineage) = lineage.take() else { break };
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
    for node in tree.nodes() {
        let daughters = tree.graph().edges(node).count();
        if daughters != 0 && (daughters != 2 || tree.daughters(node).is_none()) {
            let message = "its daughters are not one anterior and one posterior".to_owned();
            return Err(wrong(node.index(), &tree.cell(node).name, message));
        }
    }
    Ok(tree)
}
