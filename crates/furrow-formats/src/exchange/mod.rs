//! Trees for other programs.

mod column;
mod geff;
mod graphml;
mod itol;
mod newick;
mod sheet;
mod tables;

pub use column::{BranchLengths, COLUMNS, Column, Kind, TimedTree};
pub use itol::ITOL_FILES;
pub use newick::newick;
pub use sheet::{Sheet, SheetCell, SheetColumn};

use std::path::Path;

use furrow_input::InputError;
use furrow_lineage::Tree;

use crate::files::{FileSet, WriteError, write_atomically};

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
    /// The numeric CSV of the Python package LineageTree: with a clock a row for each minute of a cell's life, else one at the time
    /// point of its generation.
    LineageTree,
    /// A directed graph from mothers to daughters, with all columns of each cell.
    GraphMl,
    /// A folder in GEFF, the graph exchange format of trackers: arrays of Zarr.
    Geff,
    /// The text file of tracks of the Cell Tracking Challenge: label, first and last time point, mother's label.
    Ctc,
}

impl Format {
    /// All formats.
    pub const ALL: [Format; 9] = {
        use Format::*;
        [Newick, Nhx, Nexus, Itol, Csv, LineageTree, GraphMl, Geff, Ctc]
    };

    /// Its name on the command line.
    pub fn name(self) -> &'static str {
        ["newick", "nhx", "nexus", "itol", "csv", "lineagetree", "graphml", "geff", "ctc"][self as usize]
    }

    /// The branch lengths that it can have. The CSV of cells has all as columns; the time points of LineageTree, GEFF and
    /// the Cell Tracking Challenge are minutes or generations.
    fn lengths(self) -> &'static [BranchLengths] {
        match self {
            Format::Csv => &[],
            Format::LineageTree | Format::Geff | Format::Ctc => &[BranchLengths::Generation, BranchLengths::Minutes],
            _ => &[BranchLengths::Time, BranchLengths::Generation, BranchLengths::Minutes, BranchLengths::None],
        }
    }

    /// Refuses branch lengths that the format cannot have.
    ///
    /// # Errors
    /// Names the lengths and the allowed values.
    pub fn check_lengths(self, lengths: BranchLengths) -> Result<(), InputError> {
        let why = match self {
            Format::Csv => "left out with --to csv: it has a column for each".to_owned(),
            _ => format!("generation or minutes with --to {}: they are its time points", self.name()),
        };
        let ok = self.lengths().contains(&lengths);
        InputError::require(ok, "--branch-lengths", "branch_lengths", lengths.name(), why)
    }
}

/// Most rows of a file for LineageTree.
const MOST_ROWS: u64 = 20_000_000;

/// Refuses branch lengths that the tree does not have, or that would make its file too long.
///
/// # Errors
/// Names the lengths and the allowed values.
pub fn check_tree(tree: &Tree, format: Format, lengths: BranchLengths) -> Result<(), InputError> {
    let refused = |value: String, allowed: &str| {
        Err(InputError::not_allowed("--branch-lengths", "branch_lengths", value, allowed))
    };
    if lengths == BranchLengths::Minutes && tree.lineage.clock.is_none() {
        return refused("minutes".to_owned(), "time, generation or none: the tree's lineage has no clock");
    }
    if format == Format::LineageTree {
        check_rows(&Sheet::of_tree(&TimedTree::new(tree)), lengths)?;
    }
    Ok(())
}

/// Refuses branch lengths that would make the file of LineageTree too long.
fn check_rows(sheet: &Sheet<'_>, lengths: BranchLengths) -> Result<(), InputError> {
    let rows = tables::lineage_tree_rows(sheet, lengths);
    let allowed = "generation: a file has at most 20000000 rows";
    let value = format!("minutes, {rows} rows");
    InputError::require(rows <= MOST_ROWS, "--branch-lengths", "branch_lengths", value, allowed)
}

/// A tree in another format.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Exported {
    /// The text of one file.
    File(String),
    /// Several files that belong together, by name.
    Folder(Vec<(&'static str, String)>),
    /// The same of files that are no text; names may have folders before them.
    Binary(Vec<(String, Vec<u8>)>),
}

impl Exported {
    /// Writes the file, or all files into a folder.
    ///
    /// # Errors
    /// What cannot be written.
    pub fn write(&self, out: &Path) -> Result<(), WriteError> {
        let mut set = FileSet::new(out);
        match self {
            Exported::File(text) => return write_atomically(out, text.as_bytes()),
            Exported::Folder(files) => files.iter().try_for_each(|(name, text)| set.stage(name, text.as_bytes()))?,
            Exported::Binary(files) => files.iter().try_for_each(|(name, bytes)| set.stage(name, bytes))?,
        }
        set.commit()
    }
}

/// A tree in another format. `lengths` selects the branch lengths, for formats that [have them](Format::check_lengths); `colours`
/// gives the founders' colours, as `#rrggbb`, for the formats with colours (grey if there are too few).
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
    let tree = TimedTree::new(tree);
    export_sheet(&Sheet::of_tree(&tree), format, lengths, colours)
}

/// Refuses branch lengths that the cells of an observed lineage do not have, or that would make its file too long.
///
/// # Errors
/// Names the lengths and the allowed values.
pub fn check_sheet(sheet: &Sheet<'_>, format: Format, lengths: BranchLengths) -> Result<(), InputError> {
    let is_fine = lengths != BranchLengths::Time;
    let allowed = "minutes, generation or none: observed cells have no time in τ";
    InputError::require(is_fine, "--branch-lengths", "branch_lengths", lengths.name(), allowed)?;
    if format == Format::LineageTree { check_rows(sheet, lengths) } else { Ok(()) }
}

/// Warns of time points that are later than births by a minute or more, since formats with whole minutes give every cell one of its own.
pub fn time_doubt(sheet: &Sheet<'_>, format: Format, lengths: BranchLengths) -> Option<String> {
    let is_whole = matches!(format, Format::Ctc | Format::LineageTree);
    let late = if is_whole { tables::latest_start(sheet, lengths) } else { 0 };
    (late > 0).then(|| {
        format!("time points are whole minutes, one at least for each cell: cells that live shorter delay their descendants, by up to {late} min")
    })
}

/// As [`export`], of the cells of any lineage.
pub fn export_sheet(sheet: &Sheet<'_>, format: Format, lengths: BranchLengths, colours: &[&str]) -> Exported {
    Exported::File(match format {
        Format::Newick => newick::plain(sheet, lengths),
        Format::Nhx => newick::nhx(sheet, lengths),
        Format::Nexus => newick::nexus(sheet, lengths),
        Format::Csv => tables::cells_csv(sheet),
        Format::LineageTree => tables::lineage_tree_csv(sheet, lengths),
        Format::GraphMl => graphml::graphml(sheet, lengths),
        Format::Itol => return Exported::Folder(itol::itol(sheet, lengths, colours)),
        Format::Geff => return Exported::Binary(geff::geff(sheet, lengths != BranchLengths::Generation)),
        Format::Ctc => tables::ctc(sheet, lengths),
    })
}
