//! The lineage tree.

use petgraph::Direction::Incoming;
use petgraph::graph::{DiGraph, NodeIndex};
use petgraph::visit::{Dfs, EdgeRef, NodeFiltered};
use serde::{Deserialize, Serialize};

use super::definition::Lineage;
use super::physics::FounderPhysics;
use super::rules::Place;
use crate::batch::Quantisation;
use furrow_cell::law::REGULATOR;
use furrow_cell::{Cell, Cue, Numerics, ZYGOTE};
use furrow_mechanics::critical::{BoundaryKind, End};
use furrow_mechanics::division::{Division, Outcome};

/// The reason why a cell has no daughters.
#[expect(missing_docs, reason = "the messages say what the fields are")]
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
#[serde(tag = "reason", rename_all = "snake_case", deny_unknown_fields)]
pub enum TerminalReason {
    /// In its computed division it came to rest undivided, in a stable shape.
    AtRest { growth_rate: Option<f64> },
    /// It has no cue, and R0 is below the critical radius at which the pitchfork is at the cell's activity.
    BelowPitchfork { r0_c: f64 },
    /// It has a cue, and R0 is below the radius at which the fold of the cued branch is at the cell's activity.
    BelowCuedFold { r0: f64 },
    /// Without axial symmetry, R0 is below the critical radius at which bent states become unstable at the cell's activity.
    BelowBentBoundary { r0_c: f64 },
    /// Its division could not be computed, so it is unknown whether it divides.
    Undecided { why: String },
    /// It dies, according to the lineage file.
    Dies,
    /// Its founder's `most_rounds` is reached.
    MostRounds { most_rounds: u32 },
    /// The lineage file's `limits.max_depth` is reached.
    MaxDepth { max_depth: u32 },
    /// The lineage file's `limits.max_cells` is reached.
    MaxCells { max_cells: usize },
}

impl TerminalReason {
    /// The reason for a founder's `most_rounds`.
    pub(crate) fn most(most_rounds: u32) -> TerminalReason {
        TerminalReason::MostRounds { most_rounds }
    }

    /// True if the cell does not divide for mechanical reasons, rather than because of limits, the lineage file or failed computations.
    fn is_mechanical(&self) -> bool {
        match self {
            TerminalReason::AtRest { .. }
            | TerminalReason::BelowPitchfork { .. }
            | TerminalReason::BelowCuedFold { .. }
            | TerminalReason::BelowBentBoundary { .. } => true,
            TerminalReason::Undecided { .. }
            | TerminalReason::Dies
            | TerminalReason::MostRounds { .. }
            | TerminalReason::MaxDepth { .. }
            | TerminalReason::MaxCells { .. } => false,
        }
    }

    /// The reason's name in files.
    pub fn name(&self) -> &'static str {
        match self {
            TerminalReason::AtRest { .. } => "at_rest",
            TerminalReason::BelowPitchfork { .. } => "below_pitchfork",
            TerminalReason::BelowCuedFold { .. } => "below_cued_fold",
            TerminalReason::BelowBentBoundary { .. } => "below_bent_boundary",
            TerminalReason::Undecided { .. } => "undecided",
            TerminalReason::Dies => "dies",
            TerminalReason::MostRounds { .. } => "most_rounds",
            TerminalReason::MaxDepth { .. } => "max_depth",
            TerminalReason::MaxCells { .. } => "max_cells",
        }
    }
}

impl std::fmt::Display for TerminalReason {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            TerminalReason::AtRest { growth_rate: Some(s) } => {
                write!(f, "failed: at rest, stable (growth rate {s:.3}/τ)")
            }
            TerminalReason::AtRest { growth_rate: None } => write!(f, "failed: at rest"),
            TerminalReason::BelowPitchfork { r0_c } => write!(f, "below the pitchfork boundary R0_c = {r0_c:.4}"),
            TerminalReason::BelowCuedFold { r0 } => write!(f, "below the fold of the cued branch, R0 = {r0:.4}"),
            TerminalReason::BelowBentBoundary { r0_c } => {
                write!(f, "below the boundary of bent states R0_c = {r0_c:.4}")
            }
            TerminalReason::Undecided { why } => write!(f, "undecided: {why}"),
            TerminalReason::Dies => write!(f, "dies"),
            TerminalReason::MostRounds { most_rounds: 1 } => write!(f, "after its one round"),
            TerminalReason::MostRounds { most_rounds } => write!(f, "after its {most_rounds} rounds"),
            TerminalReason::MaxDepth { max_depth } => write!(f, "limit: {max_depth} generations"),
            TerminalReason::MaxCells { max_cells } => write!(f, "limit: {max_cells} cells"),
        }
    }
}

impl From<End> for TerminalReason {
    fn from(end: End) -> TerminalReason {
        match end.kind {
            BoundaryKind::CuedFold => TerminalReason::BelowCuedFold { r0: end.critical_r0 },
            BoundaryKind::BentPitchfork | BoundaryKind::BentFold => {
                TerminalReason::BelowBentBoundary { r0_c: end.critical_r0 }
            }
            _ => TerminalReason::BelowPitchfork { r0_c: end.critical_r0 },
        }
    }
}

/// The fate of a cell.
#[derive(Clone, Debug, PartialEq)]
pub enum Fate {
    /// It has two daughters.
    Divides(Division),
    /// The cell has no daughters.
    Terminal {
        /// Why.
        reason: TerminalReason,
        /// Its division, if computed, in which it came to rest.
        division: Option<Division>,
    },
}

impl From<Division> for Fate {
    fn from(division: Division) -> Fate {
        match division.outcome() {
            Outcome::Arrested => {
                let reason = TerminalReason::AtRest { growth_rate: division.growth_rate() };
                Fate::Terminal { reason, division: Some(division) }
            }
            _ => Fate::Divides(division),
        }
    }
}

impl From<TerminalReason> for Fate {
    /// The fate of a cell without a computed division.
    fn from(reason: TerminalReason) -> Fate {
        Fate::Terminal { reason, division: None }
    }
}

impl Fate {
    /// Its division, if computed.
    pub fn division(&self) -> Option<&Division> {
        match self {
            Fate::Divides(division) => Some(division),
            Fate::Terminal { division, .. } => division.as_ref(),
        }
    }

    /// The reason why there are no daughters; `None` if there are daughters.
    pub fn terminal_reason(&self) -> Option<&TerminalReason> {
        if let Fate::Terminal { reason, .. } = self { Some(reason) } else { None }
    }

    /// The outcome of its division; `None` for an undecided cell, and for a cell stopped by a limit or the lineage file.
    pub fn outcome(&self) -> Option<Outcome> {
        match self {
            Fate::Terminal { reason, division: None } => reason.is_mechanical().then_some(Outcome::Arrested),
            fate => fate.division().map(|division| division.outcome()),
        }
    }

    /// Size asymmetry χ of its division.
    pub fn chi(&self) -> Option<f64> {
        self.division()?.chi()
    }

    /// Time of pinch-off or of rest, in τ; `None` if no division was computed.
    pub fn t_end(&self) -> Option<f64> {
        self.division().map(|division| division.t_end)
    }

    /// Volumes of the anterior and the posterior daughter of a mother of volume `mother`; `None` if it does not divide. Their sum is
    /// `mother` to rounding error, and they are equal to the last bit if the division is symmetric.
    pub fn daughter_volumes(&self, mother: f64) -> Option<[f64; 2]> {
        let Fate::Divides(division) = self else { return None };
        let [posterior, _] = division.shares()?;
        let posterior = posterior * mother;
        Some([mother - posterior, posterior])
    }
}

/// Which daughter a cell is. The pole u = 0 is the posterior one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Side {
    /// The side of larger u.
    Anterior,
    /// The side of smaller u.
    Posterior,
}

impl Side {
    /// Whether it is the larger of two daughters of these volumes, anterior first. Of equal daughters the anterior counts as larger.
    pub fn is_larger(self, [anterior, posterior]: [f64; 2]) -> bool {
        (self == Side::Anterior) == (anterior >= posterior)
    }

    /// The adjective used in drawings.
    pub fn adjective(self) -> &'static str {
        match self {
            Side::Anterior => "anterior, ",
            Side::Posterior => "posterior, ",
        }
    }
}

/// One cell of the tree.
#[derive(Clone, Debug, PartialEq)]
pub struct TreeCell {
    /// Name, unique in the tree.
    pub name: String,
    /// The nearest founder that it is or descends from (an index into the lineage's founders).
    pub founder: usize,
    /// Number of divisions from the first cell.
    pub generation: u32,
    /// Radius R0 of the sphere with the cell's volume, in L_h.
    pub r0: f64,
    /// Volume as a fraction of the first cell's.
    pub volume_fraction: f64,
    /// Polarity cue.
    pub cue: Cue,
    /// Parameters set by rules, which override the founder's and the run's.
    pub physics: Option<Box<FounderPhysics>>,
    /// Its fate.
    pub fate: Fate,
}

/// The index of a cell in breadth-first order; the first cell has 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct CellId(NodeIndex);

impl CellId {
    /// The index as a number, for tables by cell.
    pub fn index(self) -> usize {
        self.0.index()
    }
}

/// Parameters of all divisions of a tree.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TreeSettings {
    /// Seed of the noise.
    pub seed: u64,
    /// Relative step to which R0 is rounded before a division is solved; 0 without rounding.
    pub r0_step: f64,
    /// Radius of the first cell, and confinement, activity, material and shell of all cells. Cues come from the lineage.
    pub cell: Cell,
    /// Discretisation.
    pub numerics: Numerics,
}

impl Default for TreeSettings {
    /// The preset's C. elegans zygote, seed 0 and the default rounding of R0.
    fn default() -> TreeSettings {
        let r0_step = Quantisation::DEFAULT.relative_step();
        TreeSettings { cell: Cell::new(ZYGOTE), numerics: Numerics::default(), seed: 0, r0_step }
    }
}

/// A grown lineage. Cells are in breadth-first order, the anterior daughter before the posterior one, independent of the order
/// in which they were solved.
///
/// # Examples
/// [`Grower`](super::Grower) has an example.
#[derive(Clone, Debug)]
pub struct Tree {
    /// Its lineage.
    pub lineage: Lineage,
    /// Parameters of its divisions.
    pub settings: TreeSettings,
    /// Edges from mother to daughter. The index of a node is its index in breadth-first order.
    graph: DiGraph<TreeCell, Side>,
    founder_cells: Vec<Option<CellId>>,
}

impl Tree {
    /// A tree of only the first cell.
    pub fn new(lineage: Lineage, settings: TreeSettings, first: TreeCell) -> Tree {
        let (mut founder_cells, mut graph) = (vec![None; lineage.founders.len()], DiGraph::new());
        let founder = first.founder;
        founder_cells[founder] = Some(CellId(graph.add_node(first)));
        Tree { lineage, settings, graph, founder_cells }
    }

    /// Adds a daughter, which must come after all cells of earlier generations and after its anterior sister. `is_founder` says that it
    /// is the founder `cell.founder` itself.
    pub fn add(&mut self, mother: CellId, side: Side, cell: TreeCell, is_founder: bool) -> CellId {
        let founder = cell.founder;
        let id = CellId(self.graph.add_node(cell));
        self.graph.add_edge(mother.0, id.0, side);
        if is_founder {
            self.founder_cells[founder] = Some(id);
        }
        id
    }

    /// The first cell.
    pub fn first(&self) -> CellId {
        CellId(NodeIndex::new(0))
    }

    /// Number of cells in all generations together.
    pub fn len(&self) -> usize {
        self.graph.node_count()
    }

    /// A tree has at least its first cell.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// All cells in breadth-first order.
    pub fn cells(&self) -> impl DoubleEndedIterator<Item = CellId> + ExactSizeIterator + use<> {
        self.graph.node_indices().map(CellId)
    }

    /// Cells in depth-first order from the first, mothers before their daughters and anterior daughters before posterior
    /// ones. Descendants of the generation `last` are omitted.
    pub fn depth_first(&self, last: u32) -> impl Iterator<Item = CellId> {
        let shown = NodeFiltered::from_fn(&self.graph, move |node| self.graph[node].generation <= last);
        let mut walk = Dfs::new(&self.graph, self.first().0);
        std::iter::from_fn(move || walk.next(&shown).map(CellId))
    }

    /// Cells without daughters, from anterior to posterior.
    pub fn leaves(&self) -> impl Iterator<Item = CellId> {
        self.depth_first(u32::MAX).filter(|id| self.daughter_count(*id) == 0)
    }

    /// A cell.
    pub fn cell(&self, id: CellId) -> &TreeCell {
        &self.graph[id.0]
    }

    /// A cell's mother.
    pub fn mother(&self, id: CellId) -> Option<CellId> {
        self.graph.neighbors_directed(id.0, Incoming).next().map(CellId)
    }

    /// Which daughter of its mother a cell is.
    pub fn side(&self, id: CellId) -> Option<Side> {
        self.graph.edges_directed(id.0, Incoming).next().map(|edge| *edge.weight())
    }

    /// The anterior and posterior daughter.
    pub fn daughters(&self, id: CellId) -> Option<[CellId; 2]> {
        let daughter =
            |side| self.graph.edges(id.0).find(|edge| *edge.weight() == side).map(|edge| CellId(edge.target()));
        Some([daughter(Side::Anterior)?, daughter(Side::Posterior)?])
    }

    /// The current number of daughters of a cell; 0 or 2 in a complete tree.
    pub fn daughter_count(&self, id: CellId) -> usize {
        self.graph.neighbors(id.0).count()
    }

    /// The cell of a founder (an index into the lineage's founders); `None` if it does not exist in the tree.
    pub fn founder_cell(&self, founder: usize) -> Option<CellId> {
        self.founder_cells[founder]
    }

    /// Name of the founder a cell is or descends from.
    pub fn founder_name(&self, id: CellId) -> &str {
        &self.lineage.founders[self.cell(id).founder].name
    }

    /// A cell with the parameters of its division. Rules override the founder's parameters, which override the run's.
    pub fn parameters(&self, id: CellId) -> Cell {
        let TreeCell { founder, r0, cue, physics, .. } = self.cell(id);
        self.lineage.parameters((*founder, *r0, cue), physics.as_deref(), &self.settings.cell)
    }

    /// Whether a cell carries a cue that has an effect with the law of the tree.
    pub fn has_cue(&self, id: CellId) -> bool {
        self.settings.cell.clone().with_cue(self.cell(id).cue.clone()).has_cue()
    }

    /// A warning if the law uses a regulator that some cells lack.
    pub fn lacks_regulator(&self) -> Option<String> {
        let of = |id: CellId| self.settings.cell.clone().with_cue(self.cell(id).cue.clone());
        let law = self.settings.cell.law.as_ref()?;
        let without: Vec<CellId> = self.cells().filter(|id| of(*id).lacks_regulator().is_some()).collect();
        let (count, first) = (without.len(), self.cell(*without.first()?));
        Some(format!(
            "the law {:?} names phi, and {count} of {} cells have no regulator, {} among them: phi is 0 there. Add one to their cue, for example {REGULATOR}",
            law.name(),
            self.len(),
            first.name
        ))
    }

    /// Name of the cue that a cell carries.
    pub fn cue_name(&self, id: CellId) -> &str {
        let TreeCell { founder, generation, r0, .. } = *self.cell(id);
        let born = self.founder_cell(founder).map_or(generation, |born| self.cell(born).generation);
        let round = generation.saturating_sub(born);
        self.lineage.cue_name_at(Place { founder, round, generation, r0, apart: self.apart(id) })
    }

    /// [`Place::apart`] of a cell.
    fn apart(&self, id: CellId) -> u32 {
        let founder = self.cell(id).founder;
        if self.lineage.founders[founder].cue_passes_to.is_none() || self.founder_cell(founder) == Some(id) {
            return 0;
        }
        let (Some(mother), Some(side)) = (self.mother(id), self.side(id)) else { return 0 };
        let volumes = self.daughters(mother).map(|pair| pair.map(|daughter| self.cell(daughter).volume_fraction));
        volumes.map_or(0, |volumes| self.lineage.apart(founder, self.apart(mother), side.is_larger(volumes)))
    }
}
