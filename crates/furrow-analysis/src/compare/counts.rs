//! Rounds of founders compared with the observed ones (figure 4C), by every reading of "rounds" and at every stage.
//!
//! The paper compares rounds with Sulston's without defining them: fewest, mean or most divisions from the founder to a
//! terminal cell, or full doublings. All are reported: of the worm at hatching and at earlier stages, of another lineage beside the
//! counts that its file gives.

use furrow_input::{InputError, listed, parse_document};
use furrow_lineage::{Founder, Lineage, ObservedRounds, Rounds, Tree, founder_rounds};
use furrow_measured::matching::Matched;
use furrow_measured::names::Names;
use furrow_measured::tracked::{Absent, FollowedRounds, TrackedLineage, TrackedRounds};
use furrow_measured::volumes::Skipped;
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
    /// Cells of the embryo, including dead ones.
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
    /// By reading; only observed readings are present.
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
    /// Cells of the embryo; `None` where the lineage's own counts are compared, which are of no stage.
    pub cells: Option<u32>,
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
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Counts {
    /// The name of the lineage.
    pub lineage: String,
    /// At every stage, the last one hatching; one for a lineage with counts of its own.
    pub stages: Vec<StageCounts>,
    /// The paper's sentence by every reading; empty for a lineage that is not the worm's.
    pub sentence: Vec<Sentence>,
    /// Which cells ended where, and why.
    pub ends: Vec<TerminalCells>,
    /// Divisions on the way P0, P1, P2, P3, P4 in the model, and in the embryo to Z2 and Z3; `None` for another lineage.
    pub germline: Option<[u32; 2]>,
    /// Founders without rounds in an embryo that was followed.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub absent: Vec<Absent>,
    /// Cells of such an embryo that were not followed although their sisters were: each counts as one terminal cell.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub not_followed: Vec<String>,
    /// Values of such an embryo that cannot be used, and its cells with other names than the lineage's; the first of them.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub skipped: Vec<Skipped>,
    /// How many there are.
    pub skipped_count: u64,
    /// How the cells of such an embryo were matched to the lineage.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub matched: Option<Matched>,
}

/// Divisions from P0 to Z2 and Z3.
const GERMLINE: u32 = 5;

/// A tree beside an embryo that was followed, at its last frame; cells have these names. Errors name the embryo's file `source_name`.
///
/// # Errors
/// None of the lineage's founders was followed.
pub fn counts_of_embryo(
    tree: &Tree,
    measured: &TrackedLineage,
    cells: &Names,
    source_name: &str,
) -> Result<Counts, InputError> {
    let names: Vec<&str> = tree.lineage.founders.iter().map(|founder| founder.name.as_str()).collect();
    let observed = |TrackedRounds { cell, terminal, min, mean, max }| {
        // As in the model: the first generation with a terminal cell is the first that does not double fully.
        ObservedAtStage { founder: cell, cells: terminal, min, mean, max, full_doublings: min }
    };
    let FollowedRounds { founders, absent, terminal, not_followed } = measured.rounds(&names, cells);
    let founders: Vec<ObservedAtStage> = founders.into_iter().map(observed).collect();
    let names = listed(names.iter().copied(), ", ");
    let allowed = format!("those of at least one founder: {names}; other names can be matched (--names, --root)");
    let known = listed(measured.cells.iter().map(|cell| cell.name.as_str()), ", ");
    InputError::require(!founders.is_empty(), source_name, "names", known, allowed)?;
    let stage = Stage { cells: terminal, founders };
    let stages = vec![at_stage(tree, &founder_rounds(tree), &stage)];
    let (skipped, skipped_count) = measured.skipped_with_names(cells);
    let matched = measured.matched.clone();
    Ok(Counts { absent, not_followed, skipped, skipped_count, matched, ..Counts::of(tree, stages) })
}

impl Counts {
    /// Stages alone.
    fn of(tree: &Tree, stages: Vec<StageCounts>) -> Counts {
        Counts { lineage: tree.lineage.name.clone(), stages, ends: ends(tree), ..Counts::default() }
    }
}

/// A tree beside the observed embryo: the worm's stages if the tree's lineage has the worm's counts, else its own counts. Errors
/// name the tree `source_name`.
///
/// # Errors
/// The tree's lineage has no observed counts.
pub fn counts(tree: &Tree, source_name: &str) -> Result<Counts, InputError> {
    let rounds = founder_rounds(tree);
    let observed: Stages = parse_document(STAGES, "sulston1983_stages.ron", "observed stages", "Stages")?;
    if !is_worm(&tree.lineage, &observed)? {
        let own = own_counts(tree, &rounds);
        let allowed = "observed counts of at least one founder, in the lineage file that the tree was grown from";
        InputError::require(!own.founders.is_empty(), source_name, "founders.observed", "none", allowed)?;
        return Ok(Counts::of(tree, vec![own]));
    }
    let stages: Vec<StageCounts> = observed.stages.iter().map(|stage| at_stage(tree, &rounds, stage)).collect();
    let germline = germline_divisions(tree);
    let hatching = stages.last();
    let sentence = READINGS[..4].iter().map(|reading| {
        let within = |name: &str| {
            let founder = hatching.and_then(|stage| stage.founders.iter().find(|founder| founder.founder == name));
            founder.and_then(|founder| founder.counts.get(reading)).is_some_and(|count| count.within_one)
        };
        let (ems, germline) = (within("EMS"), germline.abs_diff(GERMLINE) <= 1);
        let elsewhere_not = !["AB", "C", "D"].into_iter().any(within);
        Sentence { reading, ems, germline, elsewhere_not, holds: ems && germline && elsewhere_not }
    });
    let sentence = sentence.collect();
    Ok(Counts { sentence, germline: Some([germline, GERMLINE]), ..Counts::of(tree, stages) })
}

/// Whether a lineage has the observed counts of the worm.
pub(super) fn is_of_worm(lineage: &Lineage) -> bool {
    let observed = parse_document(STAGES, "sulston1983_stages.ron", "observed stages", "Stages");
    observed.and_then(|observed| is_worm(lineage, &observed)).unwrap_or(false)
}

/// Whether a lineage has the observed counts of the worm, as the built-in lineage and files based on it have.
fn is_worm(lineage: &Lineage, observed: &Stages) -> Result<bool, InputError> {
    let worm = Lineage::c_elegans()?;
    let counts = |lineage: &Lineage, name: &str| Some(lineage.founders[lineage.founder_named(name)?].observed);
    let founders = observed.stages.iter().flat_map(|stage| &stage.founders);
    Ok(founders.into_iter().all(|at| {
        let of_worm = counts(&worm, &at.founder);
        of_worm.is_some() && counts(lineage, &at.founder) == of_worm
    }))
}

/// The counts that the lineage gives for its founders.
fn own_counts(tree: &Tree, rounds: &[Option<Rounds>]) -> StageCounts {
    let of = |(k, founder): (usize, &Founder)| {
        let ObservedRounds { min, mean, max, full_doublings, terminal, .. } = founder.observed?;
        let [min, max, full_doublings, terminal] = [min, max, full_doublings, terminal].map(|n| n.map(f64::from));
        let counts = beside(rounds[k], [min, mean, max, full_doublings, terminal]);
        (!counts.is_empty()).then(|| FounderCounts { founder: founder.name.clone(), counts })
    };
    StageCounts { cells: None, founders: tree.lineage.founders.iter().enumerate().filter_map(of).collect() }
}

fn at_stage(tree: &Tree, rounds: &[Option<Rounds>], stage: &Stage) -> StageCounts {
    let of = |observed: &ObservedAtStage| {
        let ObservedAtStage { min, mean, max, full_doublings, cells, .. } = *observed;
        let seen = [f64::from(min), mean, max.into(), full_doublings.into(), cells.into()];
        let founder = tree.lineage.founder_named(&observed.founder)?;
        Some(FounderCounts { founder: observed.founder.clone(), counts: beside(rounds[founder], seen.map(Some)) })
    };
    StageCounts { cells: Some(stage.cells), founders: stage.founders.iter().filter_map(of).collect() }
}

/// The model's counts of a founder beside the observed ones, in the order of [`READINGS`].
fn beside(rounds: Option<Rounds>, seen: [Option<f64>; 5]) -> BTreeMap<&'static str, Count> {
    let model = rounds.map(|r| [r.min.into(), r.mean, r.max.into(), r.full_doublings.into(), r.terminal.into()]);
    let count = |(k, reading): (usize, &&'static str)| {
        let observed = seen[k]?;
        // A factor of two in cells is one round.
        let off = |model: f64| if *reading == "terminal" { (model / observed).log2() } else { model - observed };
        let model = model.map(|model: [f64; 5]| model[k]);
        Some((*reading, Count { model, observed, within_one: model.is_some_and(|m| off(m).abs() <= 1.0) }))
    };
    READINGS.iter().enumerate().filter_map(count).collect()
}

/// Divisions of P0, P1, P2, P3 and P4, as far as each is born.
fn germline_divisions(tree: &Tree) -> u32 {
    let divides = |name: &str| {
        let founder = tree.lineage.founder_named(name);
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
