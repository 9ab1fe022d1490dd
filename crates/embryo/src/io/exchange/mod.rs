//! The tree for other programs: formats, what a cell has to say in them, and what its branch is as long as.
//!
//! | format | file |
//! |---|---|
//! | Newick, NHX | `notes` (plain Newick: [`newick()`](super::newick())) |
//! | Nexus | `notes` |
//! | annotations for iTOL | `itol` |
//! | cells as CSV | `cells_csv` |
//! | numeric CSV of LineageTree | `lineage_tree` |
//! | GraphML | `graphml` |

mod cells_csv;
mod column;
mod graphml;
mod itol;
mod lengths;
mod lineage_tree;
mod notes;

pub use column::{COLUMNS, Column, Kind, Value};
pub use itol::ITOL_FILES;
pub use lengths::BranchLengths;

use super::newick::{newick_with, push_length};
use crate::lineage::{CellId, Tree};

/// A format that other programs read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Format {
    /// Plain Newick: names and branch lengths.
    Newick,
    /// Newick with what each cell has to say in `[&&NHX:key=value:…]` behind it.
    Nhx,
    /// A Nexus file of one tree, with `[&key=value,…]` behind each name, as FigTree reads it.
    Nexus,
    /// A folder of a Newick file and annotations of it for iTOL.
    Itol,
    /// One row a cell, with all that is known of it.
    Csv,
    /// The numeric CSV of the Python package LineageTree, one row a cell at the time point of its generation.
    LineageTree,
    /// A directed graph from mothers to daughters, with all that is known of each cell.
    GraphMl,
}

impl Format {
    /// All formats.
    pub const ALL: [Format; 7] =
        [Format::Newick, Format::Nhx, Format::Nexus, Format::Itol, Format::Csv, Format::LineageTree, Format::GraphMl];

    /// Its name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Format::Newick => "newick",
            Format::Nhx => "nhx",
            Format::Nexus => "nexus",
            Format::Itol => "itol",
            Format::Csv => "csv",
            Format::LineageTree => "lineagetree",
            Format::GraphMl => "graphml",
        }
    }

    /// Whether its branches have lengths that can be chosen. The CSV of cells holds all that a length can be, and the time
    /// points of LineageTree are whole numbers, of which generations alone come one after the other.
    pub fn has_lengths(self) -> bool {
        !matches!(self, Format::Csv | Format::LineageTree)
    }
}

/// What a tree is in another format.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Exported {
    /// The text of one file.
    File(String),
    /// Several files that belong together, by name.
    Folder(Vec<(&'static str, String)>),
}

/// A tree in another format. `lengths` are those of the branches where the format [has such](Format::has_lengths); `colours`
/// are those of the founders, as `#rrggbb`, for the formats that have colours (grey if there are too few).
///
/// ```
/// use furrow::cell::Cue;
/// use furrow::io::exchange::{BranchLengths, Exported, Format, export};
/// use furrow::lineage::{Fate, Lineage, Tree, TreeCell, TreeSettings};
///
/// let lineage = Lineage::parse(r#"(name: "one cell", founders: [(name: "S")])"#, "one.ron")?;
/// let cell = TreeCell { name: "S".to_owned(), founder: 0, generation: 0, r0: 1.0, volume_fraction: 1.0, cue: Cue::none(), fate: Fate::default() };
/// let tree = Tree::new(lineage, TreeSettings::default(), cell);
/// let nhx = export(&tree, Format::Nhx, BranchLengths::Generation, &[]);
/// assert_eq!(nhx, Exported::File("S:0[&&NHX:founder=S:generation=0:r0=1:volume_fraction=1:cue=none];\n".to_owned()));
/// # Ok::<(), furrow::input::InputError>(())
/// ```
pub fn export(tree: &Tree, format: Format, lengths: BranchLengths, colours: &[&str]) -> Exported {
    Exported::File(match format {
        Format::Newick => {
            let text = newick_with(tree, |cell, out| push_length(out, lengths.of(tree, cell)));
            format!("{text}\n")
        }
        Format::Nhx => notes::nhx(tree, lengths),
        Format::Nexus => notes::nexus(tree, lengths),
        Format::Csv => cells_csv::cells_csv(tree),
        Format::LineageTree => lineage_tree::lineage_tree_csv(tree),
        Format::GraphMl => graphml::graphml(tree, lengths),
        Format::Itol => return Exported::Folder(itol::itol(tree, lengths, colours)),
    })
}

/// The cells without daughters, from anterior to posterior.
fn ends(tree: &Tree) -> Vec<CellId> {
    let mut ends = Vec::new();
    let mut stack = vec![tree.first()];
    while let Some(id) = stack.pop() {
        match tree.daughters(id) {
            Some([anterior, posterior]) => stack.extend([posterior, anterior]),
            None => ends.push(id),
        }
    }
    ends
}
