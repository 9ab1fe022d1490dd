//! The lineage tree.

use super::definition::Lineage;
use crate::batch::Quantisation;
use crate::cortex::{Cue, Numerics, Physics};
use crate::division::{Division, Outcome};
use petgraph::Direction;
use petgraph::graph::{DiGraph, NodeIndex};
use petgraph::visit::EdgeRef;
use serde::{Deserialize, Serialize};

/// Why a cell has no daughters.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "reason", rename_all = "snake_case", deny_unknown_fields)]
pub enum EndReason {
    /// Its division was computed and came to rest, undivided, in a stable shape.
    AtRest {
        /// Leading growth rate of perturbations of that shape, in 1/τ (negative: stable).
        growth_rate: Option<f64>,
    },
    /// No cue, and R0 below the critical radius at which the pitchfork lies at the cell's activity.
    BelowPitchfork {
        /// The critical radius R0_c.
        r0_c: f64,
    },
    /// A cue, and R0 below the radius at which the fold of the cued branch lies at the cell's activity.
    BelowCuedFold {
        /// The radius of the fold.
        r0: f64,
    },
    /// The lineage file's `limits.max_depth` is reached.
    MaxDepth {
        /// The limit.
        max_depth: u32,
    },
    /// The lineage file's `limits.max_cells` is reached.
    MaxCells {
        /// The limit.
        max_cells: usize,
    },
}

impl EndReason {
    /// True if a limit stopped the cell and mechanics did not.
    pub fn is_limit(&self) -> bool {
        matches!(self, EndReason::MaxDepth { .. } | EndReason::MaxCells { .. })
    }

    /// The reason's name in files.
    pub fn name(&self) -> &'static str {
        match self {
            EndReason::AtRest { .. } => "at_rest",
            EndReason::BelowPitchfork { .. } => "below_pitchfork",
            EndReason::BelowCuedFold { .. } => "below_cued_fold",
            EndReason::MaxDepth { .. } => "max_depth",
            EndReason::MaxCells { .. } => "max_cells",
        }
    }
}

impl std::fmt::Display for EndReason {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            EndReason::AtRest { growth_rate: Some(s) } => write!(f, "failed: at rest, stable (growth rate {s:.3}/τ)"),
            EndReason::AtRest { growth_rate: None } => write!(f, "failed: at rest"),
            EndReason::BelowPitchfork { r0_c } => write!(f, "below the pitchfork boundary R0_c = {r0_c:.4}"),
            EndReason::BelowCuedFold { r0 } => write!(f, "below the fold of the cued branch, R0 = {r0:.4}"),
            EndReason::MaxDepth { max_depth } => write!(f, "limit: {max_depth} generations"),
            EndReason::MaxCells { max_cells } => write!(f, "limit: {max_cells} cells"),
        }
    }
}

/// What becomes of a cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fate {
    /// How the division ended; none for a cell that a limit stopped.
    pub outcome: Option<Outcome>,
    /// Size asymmetry χ of a division.
    pub chi: Option<f64>,
    /// χ with the sign of (V_posterior − V_anterior).
    pub chi_signed: Option<f64>,
    /// Furrow position in arclength fraction from the anterior pole.
    pub u_furrow: Option<f64>,
    /// Time of pinch-off or of rest, in τ; none if the division was not computed.
    pub t_end: Option<f64>,
    /// Why there are no daughters; none if there are.
    pub ended: Option<EndReason>,
}

impl Fate {
    /// The fate that a computed division gives.
    pub fn of(division: &Division) -> Fate {
        let failed = division.outcome == Outcome::Failed;
        Fate {
            outcome: Some(division.outcome),
            chi: division.chi,
            chi_signed: division.chi_signed,
            u_furrow: division.u_furrow,
            t_end: Some(division.t_end),
            ended: failed.then_some(EndReason::AtRest { growth_rate: division.growth_rate }),
        }
    }

    /// The fate of a cell whose division need not be computed: it cannot divide (outcome failed), or a limit stops it.
    pub fn ended(reason: EndReason) -> Fate {
        let outcome = (!reason.is_limit()).then_some(Outcome::Failed);
        Fate { outcome, chi: None, chi_signed: None, u_furrow: None, t_end: None, ended: Some(reason) }
    }

    /// Volumes of the anterior and posterior daughter of a mother of volume `mother`; none if it does not divide. They
    /// sum to `mother` to rounding, and are equal to the last bit where the division is symmetric.
    pub fn daughter_volumes(&self, mother: f64) -> Option<[f64; 2]> {
        match (self.outcome?, self.ended) {
            (Outcome::Symmetric, None) => Some([0.5 * mother, 0.5 * mother]),
            (Outcome::Asymmetric, None) => {
                let anterior = 0.5 * (1.0 - self.chi_signed.or(self.chi)?) * mother;
                Some([anterior, mother - anterior])
            }
            _ => None,
        }
    }
}

/// Which daughter a cell is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Side {
    /// From u below the furrow.
    Anterior,
    /// From u above the furrow.
    Posterior,
}

/// One cell of the tree.
#[derive(Clone, Debug, PartialEq)]
pub struct Cell {
    /// Name, unique in the tree.
    pub name: String,
    /// The founder it is or descends from, the nearest one (an index into the lineage's founders).
    pub founder: usize,
    /// Divisions from the first cell.
    pub generation: u32,
    /// Radius R0 of the sphere with the cell's volume, in L_h.
    pub r0: f64,
    /// Volume as a fraction of the first cell's.
    pub volume_fraction: f64,
    /// Polarity cue.
    pub cue: Cue,
    /// What becomes of it.
    pub fate: Fate,
}

/// What all divisions of a tree share.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TreeSettings {
    /// Physical parameters; `physics.r0` is the first cell's radius.
    pub physics: Physics,
    /// Discretisation.
    pub numerics: Numerics,
    /// Seed of the noise.
    pub seed: u64,
    /// Relative step to which R0 is rounded before a division is solved; 0 if it is not.
    pub r0_step: f64,
}

impl Default for TreeSettings {
    /// The preset, seed 0 and the default rounding of R0.
    fn default() -> TreeSettings {
        TreeSettings {
            physics: Physics::default(),
            numerics: Numerics::default(),
            seed: 0,
            r0_step: Quantisation::DEFAULT.relative_step(),
        }
    }
}

/// A grown lineage. Cells are held in breadth-first order, the anterior daughter before the posterior, whatever the order
/// in which they were solved.
#[derive(Clone, Debug)]
pub struct Tree {
    /// What it was grown from.
    pub lineage: Lineage,
    /// Parameters of its divisions.
    pub settings: TreeSettings,
    graph: DiGraph<Cell, Side>,
    founder_cells: Vec<Option<NodeIndex>>,
}

impl Tree {
    /// A tree of the first cell alone.
    pub fn new(lineage: Lineage, settings: TreeSettings, first: Cell) -> Tree {
        let mut founder_cells = vec![None; lineage.founders.len()];
        let mut graph = DiGraph::new();
        let founder = first.founder;
        founder_cells[founder] = Some(graph.add_node(first));
        Tree { lineage, settings, graph, founder_cells }
    }

    /// Adds a daughter, after all cells of earlier generations and after her anterior sister. `is_founder` tells that
    /// she is the founder `cell.founder` herself.
    pub fn add(&mut self, mother: NodeIndex, side: Side, cell: Cell, is_founder: bool) -> NodeIndex {
        let founder = cell.founder;
        let node = self.graph.add_node(cell);
        self.graph.add_edge(mother, node, side);
        if is_founder {
            self.founder_cells[founder] = Some(node);
        }
        node
    }

    /// The graph: edges from mother to daughter.
    pub fn graph(&self) -> &DiGraph<Cell, Side> {
        &self.graph
    }

    /// The first cell.
    pub fn first(&self) -> NodeIndex {
        NodeIndex::new(0)
    }

    /// Number of cells, all generations together.
    pub fn len(&self) -> usize {
        self.graph.node_count()
    }

    /// A tree has at least its first cell.
    pub fn is_empty(&self) -> bool {
        self.graph.node_count() == 0
    }

    /// All cells in breadth-first order.
    pub fn nodes(&self) -> impl DoubleEndedIterator<Item = NodeIndex> + ExactSizeIterator + use<> {
        (0..self.graph.node_count()).map(NodeIndex::new)
    }

    /// A cell.
    pub fn cell(&self, node: NodeIndex) -> &Cell {
        &self.graph[node]
    }

    pub(super) fn cell_mut(&mut self, node: NodeIndex) -> &mut Cell {
        &mut self.graph[node]
    }

    /// A cell's mother.
    pub fn mother(&self, node: NodeIndex) -> Option<NodeIndex> {
        self.graph.neighbors_directed(node, Direction::Incoming).next()
    }

    /// Which daughter of her mother a cell is.
    pub fn side(&self, node: NodeIndex) -> Option<Side> {
        self.graph.edges_directed(node, Direction::Incoming).next().map(|edge| *edge.weight())
    }

    /// The anterior and posterior daughter.
    pub fn daughters(&self, node: NodeIndex) -> Option<[NodeIndex; 2]> {
        let mut daughters = [None, None];
        for edge in self.graph.edges(node) {
            daughters[(*edge.weight() == Side::Posterior) as usize] = Some(edge.target());
        }
        Some([daughters[0]?, daughters[1]?])
    }

    /// The cell of a founder (an index into the lineage's founders); none if she was never born.
    pub fn founder_cell(&self, founder: usize) -> Option<NodeIndex> {
        self.founder_cells[founder]
    }

    /// Name of the founder a cell is or descends from.
    pub fn founder_name(&self, node: NodeIndex) -> &str {
        &self.lineage.founders[self.graph[node].founder].name
    }
}
