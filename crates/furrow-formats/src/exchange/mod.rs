//! Trees for other programs.

mod column;
mod graphml;
mod itol;
mod newick;
mod tables;

pub use column::{BranchLengths, COLUMNS, Column, Kind};
pub use itol::ITOL_FILES;
pub use newick::newick;

use furrow_lineage::Tree;

/// A format that other programs read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Format {
    /// Plain Newick: names and branch lengths.
    Newick,
    /// Newick with the columns of each cell in `[&&NHX:key=value:…]` behind it.
    Nhx,
    /// A Nexus file of one tree, with `[&key=value,…]` behind each name, as FigTree reads it.
    Nexus,
    /// A folder of a Newick file and annotations of it for iTOL.
    Itol,
    /// One row a cell, with all columns.
    Csv,
    /// The numeric CSV of the Python package LineageTree, one row a cell at the time point of its generation.
    LineageTree,
    /// A directed graph from mothers to daughters, with all columns of each cell.
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

    /// Whether its branch lengths can be chosen. The CSV of cells has all lengths as columns; LineageTree needs consecutive
    /// whole numbers, which are the generations.
    pub fn has_lengths(self) -> bool {
        !matches!(self, Format::Csv | Format::LineageTree)
    }
}

/// A tree in another format.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Exported {
    /// The text of one file.
    File(String),
    /// Several files that belong together, by name.
    Folder(Vec<(&'static str, String)>),
}

/// A tree in another format. `lengths` are those of the branches where the format [has them](Format::has_lengths); `colours`
/// are those of the founders, as `#rrggbb`, for the formats with colours (grey if there are too few).
///
/// ```
/// use furrow_cell::Cue;
/// use furrow_formats::exchange::{BranchLengths, Exported, Format, export};
/// use furrow_lineage::{Lineage, TerminalReason, Tree, TreeCell, TreeSettings};
///
/// let lineage = Lineage::parse(r#"(name: "one cell", founders: [(name: "S")])"#, "one.ron")?;
/// let fate = TerminalReason::BelowPitchfork { r0_c: 1.7 }.into();
/// let cell = TreeCell { name: "S".to_owned(), founder: 0, generation: 0, r0: 1.0, volume_fraction: 1.0, cue: Cue::none(), physics: None, fate };
/// let tree = Tree::new(lineage, TreeSettings::default(), cell);
/// let nhx = export(&tree, Format::Nhx, BranchLengths::Generation, &[]);
/// assert_eq!(nhx, Exported::File("S:0[&&NHX:founder=S:generation=0:r0=1:volume_fraction=1:cue=none:outcome=failed:ended=below_pitchfork];\n".to_owned()));
/// # Ok::<(), furrow_input::InputError>(())
/// ```
pub fn export(tree: &Tree, format: Format, lengths: BranchLengths, colours: &[&str]) -> Exported {
    Exported::File(match format {
        Format::Newick => newick::plain(tree, lengths),
        Format::Nhx => newick::nhx(tree, lengths),
        Format::Nexus => newick::nexus(tree, lengths),
        Format::Csv => tables::cells_csv(tree),
        Format::LineageTree => tables::lineage_tree_csv(tree),
        Format::GraphMl => graphml::graphml(tree, lengths),
        Format::Itol => return Exported::Folder(itol::itol(tree, lengths, colours)),
    })
}
