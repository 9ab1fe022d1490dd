//! Shared by the formats: the columns of a cell, branch lengths, the leaves.

use std::ops::Deref;

use furrow_lineage::{CellId, CellTimes, Side, Tree};

/// A tree with the times of its cells, where its lineage has a clock.
#[derive(Clone, Debug)]
pub struct TimedTree<'t> {
    tree: &'t Tree,
    times: Option<Vec<CellTimes>>,
}

impl<'t> TimedTree<'t> {
    /// The tree with its times.
    pub fn new(tree: &'t Tree) -> TimedTree<'t> {
        TimedTree { tree, times: tree.times() }
    }

    /// The times of a cell.
    pub(super) fn times(&self, id: CellId) -> Option<CellTimes> {
        self.times.as_ref().map(|times| times[id.index()])
    }

    /// The columns of its cells: [`COLUMNS`], where the last ones, in minutes, need a clock.
    pub fn columns(&self) -> &'static [Column] {
        &COLUMNS[..COLUMNS.len() - if self.times.is_some() { 0 } else { MINUTES }]
    }
}

impl Deref for TimedTree<'_> {
    type Target = Tree;

    fn deref(&self) -> &Tree {
        self.tree
    }
}

/// Type of the values of a column.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Words.
    Text,
    /// Whole numbers.
    Count,
    /// Numbers.
    Number,
}

/// A property of cells. The name of a cell is no column: every format has another place for it.
#[derive(Clone, Copy, Debug)]
pub struct Column {
    /// Name of the column.
    pub name: &'static str,
    /// Type of its values.
    pub kind: Kind,
    /// Whether the comments of Newick and Nexus have it too: not if the brackets already contain it, nor if it is a sentence.
    pub note: bool,
    /// Its value for a cell, if there is one.
    pub of: fn(&TimedTree<'_>, CellId) -> Option<String>,
}

type Value = fn(&TimedTree<'_>, CellId) -> Option<String>;

const fn column(name: &'static str, kind: Kind, note: bool, of: Value) -> Column {
    Column { name, kind, note, of }
}

/// How many columns are in minutes.
const MINUTES: usize = 3;

/// All columns, in the order in which they are written.
pub const COLUMNS: [Column; 22] = [
    column("mother", Kind::Text, false, |tree, id| Some(tree.cell(tree.mother(id)?).name.clone())),
    column("daughter", Kind::Text, false, |tree, id| daughter(tree, id)),
    column("founder", Kind::Text, true, |tree, id| Some(tree.founder_name(id).to_owned())),
    column("generation", Kind::Count, true, |tree, id| Some(tree.cell(id).generation.to_string())),
    column("r0", Kind::Number, true, |tree, id| Some(tree.cell(id).r0.to_string())),
    column("volume_fraction", Kind::Number, true, |tree, id| Some(tree.cell(id).volume_fraction.to_string())),
    column("cue", Kind::Text, true, |tree, id| Some(tree.cue_name(id).to_owned())),
    column("cue_terms", Kind::Text, false, |tree, id| Some(tree.cell(id).cue.to_string())),
    column("outcome", Kind::Text, true, |tree, id| Some(tree.cell(id).fate.outcome()?.name().to_owned())),
    column("chi", Kind::Number, true, |tree, id| chi(tree, id)),
    column("chi_signed", Kind::Number, true, |tree, id| number(tree.cell(id).fate.division()?.chi_signed())),
    column("u_furrow", Kind::Number, true, |tree, id| number(tree.cell(id).fate.division()?.u_furrow())),
    column("t_end", Kind::Number, true, |tree, id| number(tree.cell(id).fate.t_end())),
    column("slow_growth_rate", Kind::Number, true, |tree, id| number(tree.cell(id).fate.division()?.slow_growth_rate)),
    column("phi", Kind::Number, true, |tree, id| number(tree.cell(id).fate.division()?.phi)),
    column("neck_offset", Kind::Number, true, |tree, id| number(tree.cell(id).fate.division()?.neck_offset)),
    column("ended", Kind::Text, true, |tree, id| Some(tree.cell(id).fate.terminal_reason()?.name().to_owned())),
    column("ended_why", Kind::Text, false, |tree, id| ended_why(tree, id)),
    column("birth_chi", Kind::Number, false, |tree, id| birth_chi(tree, id)),
    column("birth_min", Kind::Number, true, |tree, id| number(Some(tree.times(id)?.birth_min))),
    column("division_min", Kind::Number, true, |tree, id| number(tree.times(id)?.division_min)),
    column("lifetime_extrapolated", Kind::Count, false, |tree, id| extrapolated(tree.times(id)?)),
];

/// 1 for a cell that divides after an extrapolated lifetime.
fn extrapolated(times: CellTimes) -> Option<String> {
    times.lifetime_extrapolated.then(|| "1".to_owned())
}

fn number(number: Option<f64>) -> Option<String> {
    number.map(|number| number.to_string())
}

fn chi(tree: &Tree, id: CellId) -> Option<String> {
    number(tree.cell(id).fate.chi())
}

/// χ of the division that a cell was born from.
fn birth_chi(tree: &Tree, id: CellId) -> Option<String> {
    chi(tree, tree.mother(id)?)
}

fn daughter(tree: &Tree, id: CellId) -> Option<String> {
    let side = match tree.side(id)? {
        Side::Anterior => "anterior",
        Side::Posterior => "posterior",
    };
    Some(side.to_owned())
}

/// Why a cell has no daughters, in one line: the reason of an undecided cell may contain line breaks.
fn ended_why(tree: &Tree, id: CellId) -> Option<String> {
    let why = tree.cell(id).fate.terminal_reason()?.to_string();
    Some(why.chars().map(|c| if c.is_control() { ' ' } else { c }).collect())
}

/// Length of the branch that leads to a cell.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum BranchLengths {
    /// The time in τ from the cell's birth to its pinch-off, or to its rest; no length without a computed division. A cell just
    /// above the threshold of division takes thousands of τ: drawn to scale, all else is a point.
    #[default]
    Time,
    /// One, and 0 for the first cell: the distance of a cell from it is its generation. Every branch has a length then, as some
    /// programs demand.
    Generation,
    /// The time from the cell's birth to its division in minutes, by the lineage's clock; no length for a cell without daughters.
    Minutes,
    /// No lengths.
    None,
}

impl BranchLengths {
    /// All of them, by their names on the command line.
    pub const NAMED: [(&str, BranchLengths); 4] = [
        ("time", BranchLengths::Time),
        ("generation", BranchLengths::Generation),
        ("minutes", BranchLengths::Minutes),
        ("none", BranchLengths::None),
    ];

    /// Its name on the command line.
    pub fn name(self) -> &'static str {
        Self::NAMED.iter().find(|(_, known)| *known == self).map_or("", |(name, _)| *name)
    }
}
