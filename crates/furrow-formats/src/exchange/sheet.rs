//! What all formats write: cells with their mothers, times and columns, of a model's tree or of an observed embryo.

use std::collections::HashMap;
use std::rc::Rc;

use furrow_input::{InputError, listed};
use furrow_lineage::CellId;

use super::column::{self, BranchLengths, Kind, TimedTree};

/// A cell.
#[derive(Clone, Debug, PartialEq)]
pub struct SheetCell<'a> {
    /// Its name.
    pub name: &'a str,
    /// The place of its mother.
    pub mother: Option<usize>,
    /// The places of its daughters, the anterior or the first-named one first.
    pub daughters: [Option<usize>; 2],
    /// The place of its founder among the founders.
    pub founder: usize,
    /// Divisions from the first cell.
    pub generation: u32,
    /// Its birth and its division, where the first is known.
    pub times: Option<(f64, Option<f64>)>,
    /// When it was seen last, where that is known.
    pub last: Option<f64>,
}

/// The value of a column for the cell at a place.
type Of<'a, T> = Box<dyn Fn(usize) -> Option<T> + 'a>;

/// A column of all cells.
pub struct SheetColumn<'a> {
    /// Its name.
    pub name: &'static str,
    /// The type of its values.
    pub kind: Kind,
    /// Whether comments of Newick and Nexus have it.
    pub note: bool,
    /// Whether a graph says which values are missing.
    pub may_miss: bool,
    /// Its value for a cell, if there is one.
    pub of: Of<'a, String>,
}

/// The cells of a lineage.
pub struct Sheet<'a> {
    /// The name of the lineage.
    pub name: &'a str,
    /// Mothers before daughters.
    pub cells: Vec<SheetCell<'a>>,
    /// Names of founders.
    pub founders: Vec<&'a str>,
    /// Columns, in the order in which they are written.
    pub columns: Vec<SheetColumn<'a>>,
    /// The unit of times: minute or frame.
    pub time: &'static str,
    /// The time that a division takes in τ.
    pub duration: Of<'a, f64>,
    /// The size asymmetry of a cell's division.
    pub chi: Of<'a, f64>,
    /// The remark in brackets behind the name in a label.
    pub remark: Box<dyn Fn(usize) -> String + 'a>,
}

/// Columns that comments of trees have, as GEFF calls and describes them.
pub(super) const GRAPH_COLUMNS: [(&str, &str, &str); 8] = [
    ("founder", "founder", "the founder that it is or descends from"),
    ("generation", "generation", "divisions from the first cell"),
    ("r0", "r0", "radius of the cell at rest, in L_h"),
    ("volume_fraction", "volume", "volume divided by the first cell's"),
    ("volume", "volume", "mean volume of the cell, in the unit of the recording"),
    ("chi", "chi", "size asymmetry of its division"),
    ("outcome", "outcome", "of its division: symmetric, asymmetric or failed"),
    ("tracked", "tracked", "what the cell was called where it was tracked"),
];

impl<'t> Sheet<'t> {
    /// The cells of a tree.
    pub fn of_tree(tree: &'t TimedTree<'_>) -> Sheet<'t> {
        let ids: Rc<[CellId]> = tree.cells().collect();
        let cell = |id: &CellId| {
            let cell = tree.cell(*id);
            let daughters = tree.daughters(*id);
            SheetCell {
                name: &cell.name,
                mother: tree.mother(*id).map(CellId::index),
                daughters: daughters.map_or([None; 2], |daughters| daughters.map(|id| Some(id.index()))),
                founder: cell.founder,
                generation: cell.generation,
                times: tree.times(*id).map(|times| (times.birth_min, times.division_min)),
                last: None,
            }
        };
        let cells = ids.iter().map(cell).collect();
        let at = move |place: usize| ids.get(place).copied();
        let column = |column: &'t column::Column| {
            let at = at.clone();
            let may_miss = ["chi", "outcome"].contains(&column.name);
            let of: Of<'t, String> = Box::new(move |place| (column.of)(tree, at(place)?));
            SheetColumn { name: column.name, kind: column.kind, note: column.note, may_miss, of }
        };
        let (end, division, label) = (at.clone(), at.clone(), at.clone());
        Sheet {
            name: &tree.lineage.name,
            cells,
            founders: tree.lineage.founders.iter().map(|founder| founder.name.as_str()).collect(),
            columns: tree.columns().iter().map(column).collect(),
            time: "minute",
            duration: Box::new(move |place| tree.cell(end(place)?).fate.t_end()),
            chi: Box::new(move |place| tree.cell(division(place)?).fate.chi()),
            remark: Box::new(move |place| label(place).map_or(String::new(), |id| remark(tree, id))),
        }
    }

    /// The cell with this name, or with this name in the column `tracked`, and its descendants. Errors say the name came from `source_name`.
    ///
    /// # Errors
    /// No cell has this name.
    pub fn below(self, root: &str, source_name: &str) -> Result<Sheet<'t>, InputError> {
        let tracked = self.columns.iter().find(|column| column.name == "tracked");
        let is_tracked = |cell: usize| tracked.and_then(|column| (column.of)(cell)).is_some_and(|name| name == root);
        let named = self.cells.iter().position(|cell| cell.name == root);
        let Some(root) = named.or_else(|| (0..self.len()).find(|cell| is_tracked(*cell))) else {
            let those = listed(self.cells.iter().map(|cell| cell.name), ", ");
            let allowed = format!("a cell of {}: {those}", self.name);
            return Err(InputError::not_allowed(source_name, "cell", format!("{root:?}"), allowed));
        };
        let mut kept: Vec<usize> = self.depth_first(root);
        kept.sort_unstable();
        let places: HashMap<usize, usize> = kept.iter().enumerate().map(|(new, old)| (*old, new)).collect();
        let kept: Rc<[usize]> = kept.into();
        let cell = |old: &usize| {
            let cell = &self.cells[*old];
            let mother = cell.mother.and_then(|mother| places.get(&mother).copied());
            let daughters = cell.daughters.map(|daughter| daughter.and_then(|daughter| places.get(&daughter).copied()));
            SheetCell { mother, daughters, ..cell.clone() }
        };
        let cells = kept.iter().map(cell).collect();
        let column = |SheetColumn { name, kind, note, may_miss, of }: SheetColumn<'t>| {
            // The first cell's mother is not here.
            let first = if name == "mother" { Some(0) } else { None };
            let old = kept.clone();
            let of: Of<'t, String> = Box::new(move |new| if Some(new) == first { None } else { of(*old.get(new)?) });
            SheetColumn { name, kind, note, may_miss, of }
        };
        let [for_duration, for_chi, for_remark] = [kept.clone(), kept.clone(), kept.clone()];
        let (duration, chi, remark) = (self.duration, self.chi, self.remark);
        Ok(Sheet {
            cells,
            columns: self.columns.into_iter().map(column).collect(),
            duration: Box::new(move |new| duration(*for_duration.get(new)?)),
            chi: Box::new(move |new| chi(*for_chi.get(new)?)),
            remark: Box::new(move |new| for_remark.get(new).map_or(String::new(), |old| remark(*old))),
            name: self.name,
            founders: self.founders,
            time: self.time,
        })
    }

    /// How many cells there are.
    pub(super) fn len(&self) -> usize {
        self.cells.len()
    }

    /// The cells without a mother.
    pub(super) fn roots(&self) -> impl Iterator<Item = usize> {
        self.cells.iter().enumerate().filter(|(_, cell)| cell.mother.is_none()).map(|(place, _)| place)
    }

    /// A cell and those below it, mothers first, the first daughter before the second.
    pub(super) fn depth_first(&self, root: usize) -> Vec<usize> {
        let (mut found, mut left) = (Vec::new(), vec![root]);
        while let Some(cell) = left.pop() {
            found.push(cell);
            left.extend(self.cells[cell].daughters.into_iter().flatten().rev());
        }
        found
    }

    /// Cells without daughters, in the order of a drawing.
    pub(super) fn leaves(&self) -> impl Iterator<Item = usize> {
        let all: Vec<usize> = self.roots().flat_map(|root| self.depth_first(root)).collect();
        all.into_iter().filter(|cell| self.is_leaf(*cell))
    }

    /// Whether a cell has no daughters.
    pub(super) fn is_leaf(&self, cell: usize) -> bool {
        self.cells[cell].daughters == [None, None]
    }

    /// The length of a cell's branch.
    pub fn length(&self, cell: usize, lengths: BranchLengths) -> Option<f64> {
        match lengths {
            BranchLengths::Time => (self.duration)(cell),
            BranchLengths::Generation => Some(if self.cells[cell].mother.is_none() { 0.0 } else { 1.0 }),
            BranchLengths::Minutes => {
                let (birth, division) = self.cells[cell].times?;
                division.map(|division| division - birth)
            }
            BranchLengths::None => None,
        }
    }

    /// The name of a cell's founder.
    pub(super) fn founder(&self, cell: usize) -> &str {
        self.founders.get(self.cells[cell].founder).copied().unwrap_or_default()
    }
}

/// The radius of a cell and, of a leaf, why it is one.
fn remark(tree: &TimedTree<'_>, id: CellId) -> String {
    let cell = tree.cell(id);
    let reason = cell.fate.terminal_reason();
    let ended = reason.map_or(String::new(), |reason| format!(", {}", reason.name().replace('_', " ")));
    format!("R0 {:.3}{ended}", cell.r0)
}
