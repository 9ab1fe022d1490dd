//! Rounds of founders compared with the observed ones (figure 4C), by every reading of "rounds" and at every stage.
//!
//! The paper compares rounds with Sulston's without defining them: fewest, mean or most divisions from the founder to a
//! terminal cell, or full doublings. All are reported, at hatching and at earlier stages.

use furrow_input::{InputError, parse_document};
use furrow_lineage::{Founder, FounderRounds, Tree, founder_rounds};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Observed rounds at several stages, as shipped.
const STAGES: &str = include_str!("../../data/sulston1983_stages.ron");

/// Observed rounds of a founder at a stage.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ObservedAtStage {
    /// The founder.
    pub founder: String,
    /// Its cells.
    pub cells: u32,
    /// Fewest divisions to a cell.
    pub min: u32,
    /// Their mean.
    pub mean: f64,
    /// Most.
    pub max: u32,
    /// Generations that doubled fully.
    pub full_doublings: u32,
}

/// A stage of the embryo.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Stage {
    /// Cells of the embryo, those that have died included.
    pub cells: u32,
    /// Founders.
    pub founders: Vec<ObservedAtStage>,
}

/// The stages of the *C. elegans* embryo.
#[derive(Clone, Debug, Deserialize)]
#[serde(rename = "Stages", deny_unknown_fields)]
struct Stages {
    stages: Vec<Stage>,
}

/// The readings of "rounds".
pub const READINGS: [&str; 5] = ["min", "mean", "max", "full_doublings", "terminal"];

/// A founder's count by one reading.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Count {
    /// The model's; `None` if the founder is never born.
    pub model: Option<f64>,
    /// The observed.
    pub observed: f64,
    /// Whether they are within one round; of terminal cells, within a factor of two, which is one round.
    pub within_one: bool,
}

/// A founder beside what was observed at a stage.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FounderCounts {
    /// The founder.
    pub founder: String,
    /// By reading, in the order of [`READINGS`].
    pub counts: BTreeMap<&'static str, Count>,
}

/// The paper's sentence by one reading: rounds "to within a single round for the EMS and P lineages", and deviations elsewhere.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Sentence {
    /// The reading.
    pub reading: &'static str,
    /// Of EMS.
    pub ems: bool,
    /// Of the germline: rounds from P0 to P4, and whether P4 divides.
    pub germline: bool,
    /// Whether AB, C and D are each off by more.
    pub elsewhere_not: bool,
    /// All of it.
    pub holds: bool,
}

/// The model beside one stage.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct StageCounts {
    /// Cells of the embryo.
    pub cells: u32,
    /// Founders.
    pub founders: Vec<FounderCounts>,
}

/// Terminal cells of a founder, by reason.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TerminalCells {
    /// The founder.
    pub founder: String,
    /// Its terminal cells by reason.
    pub ended: BTreeMap<String, usize>,
    /// Their radii R0 from the smallest to the largest.
    pub r0: Option<[f64; 2]>,
}

/// A tree beside the observed embryo.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Counts {
    /// At every stage, the last one hatching.
    pub stages: Vec<StageCounts>,
    /// The paper's sentence by every reading.
    pub sentence: Vec<Sentence>,
    /// Which cells ended where, and why.
    pub ends: Vec<TerminalCells>,
    /// Divisions on the way P0, P1, P2, P3, P4 in the model, and in the embryo to Z2 and Z3.
    pub germline: [u32; 2],
}

/// Divisions from P0 to Z2 and Z3.
const GERMLINE: u32 = 5;

/// A tree beside the observed embryo.
///
/// # Errors
/// None, as long as the shipped table is one.
pub fn counts(tree: &Tree) -> Result<Counts, InputError> {
    let rounds = founder_rounds(tree);
    let observed: Stages = parse_document(STAGES, "sulston1983_stages.ron", "observed stages", "Stages")?;
    let stages: Vec<StageCounts> = observed.stages.iter().map(|stage| at_stage(tree, &rounds, stage)).collect();
    let germline = germline_divisions(tree);
    let hatching = stages.last();
    let sentence = READINGS[..4].iter().map(|reading| {
        let within = |name: &str| {
            let founder = hatching.and_then(|stage| stage.founders.iter().find(|founder| founder.founder == name));
            founder.is_some_and(|founder| founder.counts[reading].within_one)
        };
        let (ems, germline) = (within("EMS"), germline.abs_diff(GERMLINE) <= 1);
        let elsewhere_not = !["AB", "C", "D"].into_iter().any(within);
        Sentence { reading, ems, germline, elsewhere_not, holds: ems && germline && elsewhere_not }
    });
    let sentence = sentence.collect();
    Ok(Counts { stages, sentence, ends: ends(tree), germline: [germline, GERMLINE] })
}

fn at_stage(tree: &Tree, rounds: &[FounderRounds], stage: &Stage) -> StageCounts {
    let of = |observed: &ObservedAtStage| {
        let founder = tree.lineage.founders.iter().position(|founder| founder.name == observed.founder);
        let model = founder.and_then(|k| rounds.iter().find(|row| row.founder == k)?.rounds);
        let model = model.map(|r| [r.min.into(), r.mean, r.max.into(), r.full_doublings.into(), r.terminal.into()]);
        let ObservedAtStage { min, mean, max, full_doublings, cells, .. } = *observed;
        let seen: [f64; 5] = [min.into(), mean, max.into(), full_doublings.into(), cells.into()];
        let count = |(k, reading): (usize, &&'static str)| {
            // A factor of two in cells is one round.
            let off = |model: f64| if *reading == "terminal" { (model / seen[k]).log2() } else { model - seen[k] };
            let model = model.map(|model: [f64; 5]| model[k]);
            (*reading, Count { model, observed: seen[k], within_one: model.is_some_and(|m| off(m).abs() <= 1.0) })
        };
        let counts = READINGS.iter().enumerate().map(count).collect();
        FounderCounts { founder: observed.founder.clone(), counts }
    };
    StageCounts { cells: stage.cells, founders: stage.founders.iter().map(of).collect() }
}

/// Divisions of P0, P1, P2, P3 and P4, as far as each is born.
fn germline_divisions(tree: &Tree) -> u32 {
    let divides = |name: &str| {
        let founder = tree.lineage.founders.iter().position(|founder| founder.name == name);
        founder.and_then(|k| tree.founder_cell(k)).is_some_and(|id| tree.daughters(id).is_some())
    };
    ["P0", "P1", "P2", "P3", "P4"].iter().take_while(|name| divides(name)).count() as u32
}

/// Which cells ended where, and why; by the founder that they descend from directly.
fn ends(tree: &Tree) -> Vec<TerminalCells> {
    let of = |(k, founder): (usize, &Founder)| {
        let (mut ended, mut r0) = (BTreeMap::new(), None);
        for cell in tree.cells().map(|id| tree.cell(id)).filter(|cell| cell.founder == k) {
            let Some(reason) = cell.fate.terminal_reason() else { continue };
            *ended.entry(reason.name().to_owned()).or_insert(0) += 1;
            r0 = Some(r0.map_or([cell.r0; 2], |[least, most]: [f64; 2]| [least.min(cell.r0), most.max(cell.r0)]));
        }
        TerminalCells { founder: founder.name.clone(), ended, r0 }
    };
    tree.lineage.founders.iter().enumerate().map(of).filter(|ends| !ends.ended.is_empty()).collect()
}
