//! `tree.json`: the whole tree with the lineage and parameters it was grown from, byte-identical for equal inputs.

mod message;
mod read;

pub use read::{LONGEST_TREE, TreeFileError, read_tree, tree_from_json};

use std::borrow::Cow;
use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::provenance::Provenance;
use furrow_cell::Cue;
use furrow_lineage::clock::last_times;
use furrow_lineage::{
    CellId, CellTimes, FounderPhysics, Lineage, ObservedRounds, Rounds, Side, TerminalReason, Tree, TreeSettings,
    founder_rounds,
};
use furrow_mechanics::division::{Outcome, SecondNeck};

/// Name of the format.
pub const SCHEMA: &str = "furrow.tree";

/// Version of the format; it is raised when a field changes its meaning or goes.
pub const SCHEMA_VERSION: u32 = 3;

/// The JSON Schema (draft 2020-12) of `tree.json`, `docs/tree.schema.json`. A later furrow may add fields without another
/// version; the schema allows them.
pub const TREE_SCHEMA: &str = include_str!("../../tree.schema.json");

/// A row of the founders' table.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FounderRow {
    /// Name.
    pub name: String,
    /// Radius R0; `None` if it was never born.
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
    /// The last division among its descendants and itself, in minutes; `None` without a clock, or without such a division.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub last_division_min: Option<f64>,
    /// Whether the lifetime before that division is by a clock that was fitted to other sizes of cells.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub last_division_extrapolated: bool,
    /// Rounds observed.
    pub observed: Option<ObservedRounds>,
    /// The same, under its former name.
    pub sulston: Option<ObservedRounds>,
}

/// The founders' table, in the lineage file's order.
pub fn founder_rows(tree: &Tree) -> Vec<FounderRow> {
    rows_with(tree, tree.times().as_deref())
}

fn rows_with(tree: &Tree, times: Option<&[CellTimes]>) -> Vec<FounderRow> {
    let last = times.map(|times| last_times(tree, times)).unwrap_or_default();
    let mut cued = vec![BTreeMap::new(); tree.lineage.founders.len()];
    for id in tree.cells() {
        let cell = tree.cell(id);
        if tree.has_cue(id) && tree.founder_cell(cell.founder) != Some(id) {
            *cued[cell.founder].entry(tree.cue_name(id).to_owned()).or_insert(0) += 1;
        }
    }
    let row = |(founder, rounds): (usize, Option<Rounds>)| {
        let definition = &tree.lineage.founders[founder];
        let id = tree.founder_cell(founder);
        let cell = id.map(|id| tree.cell(id));
        FounderRow {
            name: definition.name.clone(),
            r0: cell.map(|c| c.r0),
            r0_um: cell.and_then(|c| tree.lineage.units().micrometres(c.r0)),
            volume_fraction: cell.map(|c| c.volume_fraction),
            cue: id.map_or("none", |id| tree.cue_name(id)).to_owned(),
            cued_descendants: cued[founder].clone(),
            outcome: cell.and_then(|c| c.fate.outcome()),
            chi: cell.and_then(|c| c.fate.chi()),
            rounds,
            last_division_min: last.get(founder).and_then(|last| (*last)?.division_min),
            last_division_extrapolated: last
                .get(founder)
                .is_some_and(|last| last.is_some_and(|last| last.lifetime_extrapolated)),
            observed: definition.observed,
            sulston: definition.observed,
        }
    };
    founder_rounds(tree).into_iter().enumerate().map(row).collect()
}

#[derive(Serialize)]
struct Head<'a> {
    schema: &'a str,
    schema_version: u32,
    provenance: Provenance,
    #[serde(flatten)]
    settings: &'a TreeSettings,
    lineage: &'a Lineage,
    founders: Vec<FounderRow>,
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
    /// Parameters from rules, which override the founder's.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    physics: Option<Cow<'a, FounderPhysics>>,
    outcome: Option<Outcome>,
    chi: Option<f64>,
    chi_signed: Option<f64>,
    u_furrow: Option<f64>,
    t_end: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    slow_growth_rate: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    phi: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    neck_offset: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    second_neck: Option<SecondNeck>,
    ended: Option<TerminalReason>,
    /// Minutes, where the lineage has a clock.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    birth_min: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    division_min: Option<f64>,
    /// Whether its lifetime is by a law that was fitted to other sizes.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    lifetime_extrapolated: bool,
}

impl<'a> Record<'a> {
    fn of(tree: &'a Tree, id: CellId, times: Option<CellTimes>) -> Record<'a> {
        let cell = tree.cell(id);
        let division = cell.fate.division();
        Record {
            name: Cow::Borrowed(&cell.name),
            mother: tree.mother(id).map(|m| Cow::Borrowed(tree.cell(m).name.as_str())),
            daughter: tree.side(id),
            founder: Cow::Borrowed(tree.founder_name(id)),
            generation: cell.generation,
            r0: cell.r0,
            volume_fraction: cell.volume_fraction,
            cue: Cow::Borrowed(&cell.cue),
            physics: cell.physics.as_deref().map(Cow::Borrowed),
            outcome: cell.fate.outcome(),
            chi: division.and_then(|d| d.chi()),
            chi_signed: division.and_then(|d| d.chi_signed()),
            u_furrow: division.and_then(|d| d.u_furrow()),
            t_end: division.map(|d| d.t_end),
            slow_growth_rate: division.and_then(|d| d.slow_growth_rate),
            phi: division.and_then(|d| d.phi),
            neck_offset: division.and_then(|d| d.neck_offset),
            second_neck: division.and_then(|d| d.second_neck),
            ended: cell.fate.terminal_reason().cloned(),
            birth_min: times.map(|times| times.birth_min),
            division_min: times.and_then(|times| times.division_min),
            lifetime_extrapolated: times.is_some_and(|times| times.lifetime_extrapolated),
        }
    }
}

/// The tree as the text of `tree.json`, one cell a line in breadth-first order.
///
/// # Errors
/// None in practice; serialisation to memory is typed as fallible.
pub fn tree_to_json(tree: &Tree) -> Result<String, serde_json::Error> {
    let times = tree.times();
    let head = Head {
        schema: SCHEMA,
        schema_version: SCHEMA_VERSION,
        provenance: Provenance::current(),
        settings: &tree.settings,
        lineage: &tree.lineage,
        founders: rows_with(tree, times.as_deref()),
    };
    let mut out = serde_json::to_vec_pretty(&head)?;
    out.reserve(360 * tree.len());
    out.truncate(out.len().saturating_sub("\n}".len()));
    out.extend_from_slice(b",\n  \"cells\": [\n");
    for id in tree.cells() {
        if id != tree.first() {
            out.extend_from_slice(b",\n");
        }
        out.extend_from_slice(b"    ");
        let times = times.as_ref().map(|times| times[id.index()]);
        serde_json::to_writer(&mut out, &Record::of(tree, id, times))?;
    }
    out.extend_from_slice(b"\n  ]\n}\n");
    // JSON is UTF-8 by construction.
    Ok(String::from_utf8(out).unwrap_or_else(|e| String::from_utf8_lossy(e.as_bytes()).into_owned()))
}
