//! `furrow export`: a tree for other programs.

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use serde::Serialize;

use super::Globals;
use super::context::start_logs;
use super::error::CliError;
use super::output::{answer, print_json, writable_file, writable_folder};
use crate::input::InputError;
use crate::io::exchange::{BranchLengths, Exported, Format, ITOL_FILES, export};
use crate::io::files::FileSet;
use crate::io::{TREE_SCHEMA, write_atomically};
use crate::lineage::Tree;
use crate::report::founder_colours;

/// Writes a grown tree in the formats of other programs
///
/// newick, nhx and nexus are trees with names on inner nodes, the last two with what is known of each cell beside them; csv
/// has the cells one a row; lineagetree is the numeric CSV of the Python package of that name; graphml is a graph; itol is a
/// folder of a tree and its annotations for the page of that name.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  furrow export furrow-out/tree.json --to nexus --out tree.nex
  furrow export furrow-out/tree.json --to newick --branch-lengths generation
  furrow export furrow-out/tree.json --to itol --out itol
  furrow export --schema")]
pub struct ExportArgs {
    /// The tree.json of a grown tree
    #[arg(value_name = "TREE.json", required_unless_present = "schema")]
    tree: Option<PathBuf>,
    /// Format
    #[arg(help_heading = "Output", long, value_name = "FORMAT", required_unless_present = "schema")]
    to: Option<FormatName>,
    /// File to write, of itol the folder; without it the export goes to stdout
    #[arg(help_heading = "Output", long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// What branches are as long as: time from birth to division in τ (default), one per generation, or no lengths. Cells just
    /// above the threshold of division take thousands of τ, beside which all else is too short to be seen
    #[arg(help_heading = "Output", long, value_name = "LENGTHS")]
    branch_lengths: Option<Lengths>,
    /// Prints the JSON Schema of tree.json in place of an export
    #[arg(help_heading = "Output", long, conflicts_with_all = ["tree", "to", "out", "branch_lengths"])]
    schema: bool,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum FormatName {
    Newick,
    Nhx,
    Nexus,
    Itol,
    Csv,
    #[value(name = "lineagetree")]
    LineageTree,
    #[value(name = "graphml")]
    GraphMl,
}

impl From<FormatName> for Format {
    fn from(name: FormatName) -> Format {
        match name {
            FormatName::Newick => Format::Newick,
            FormatName::Nhx => Format::Nhx,
            FormatName::Nexus => Format::Nexus,
            FormatName::Itol => Format::Itol,
            FormatName::Csv => Format::Csv,
            FormatName::LineageTree => Format::LineageTree,
            FormatName::GraphMl => Format::GraphMl,
        }
    }
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum Lengths {
    Time,
    Generation,
    None,
}

impl Lengths {
    fn name(self) -> &'static str {
        match self {
            Lengths::Time => "time",
            Lengths::Generation => "generation",
            Lengths::None => "none",
        }
    }
}

impl From<Lengths> for BranchLengths {
    fn from(lengths: Lengths) -> BranchLengths {
        match lengths {
            Lengths::Time => BranchLengths::Time,
            Lengths::Generation => BranchLengths::Generation,
            Lengths::None => BranchLengths::None,
        }
    }
}

/// What `--json` prints.
#[derive(Serialize)]
struct Answer<'a> {
    format: &'static str,
    cells: usize,
    ends: usize,
    out: String,
    files: Vec<&'a str>,
}

pub fn run(args: &ExportArgs, globals: &Globals) -> Result<(), CliError> {
    start_logs(globals);
    let (Some(file), Some(name)) = (&args.tree, args.to) else { return answer(TREE_SCHEMA) };
    let format = Format::from(name);
    check(args, format, globals)?;
    let tree = Tree::read(file)?;
    let lengths = args.branch_lengths.map_or(BranchLengths::default(), BranchLengths::from);
    let exported = export(&tree, format, lengths, &founder_colours(&tree.lineage));
    let (out, files) = match (&exported, &args.out) {
        (Exported::File(text), None) => return answer(text),
        (Exported::File(text), Some(out)) => {
            write_atomically(out, text.as_bytes())?;
            (out, vec![])
        }
        (Exported::Folder(files), out) => {
            let out = out.as_ref().ok_or_else(needs_folder)?;
            let mut set = FileSet::new(out);
            for (name, text) in files {
                set.stage(name, text.as_bytes())?;
            }
            set.commit()?;
            (out, files.iter().map(|(name, _)| *name).collect())
        }
    };
    respond(&tree, format, out, files, globals.json)
}

/// What does not go together is refused before the tree is read.
fn check(args: &ExportArgs, format: Format, globals: &Globals) -> Result<(), InputError> {
    if let Some(lengths) = args.branch_lengths.filter(|_| !format.has_lengths()) {
        let why = match format {
            Format::Csv => "it has a column for each",
            _ => "its time points are generations",
        };
        let allowed = format!("left out with --to {}: {why}", format.name());
        return Err(InputError::not_allowed("--branch-lengths", "branch_lengths", lengths.name(), allowed));
    }
    match (&args.out, format) {
        (None, Format::Itol) => Err(needs_folder()),
        (None, _) if globals.json => {
            let allowed = "given with --json, since without it the export itself goes to stdout";
            Err(InputError::not_allowed("--out", "out", "(not given)", allowed))
        }
        (None, _) => Ok(()),
        (Some(folder), Format::Itol) => writable_folder("--out", "out", folder, &ITOL_FILES),
        (Some(file), _) => writable_file("--out", "out", file),
    }
}

fn needs_folder() -> InputError {
    InputError::not_allowed("--out", "out", "(not given)", "a folder for the files of itol")
}

fn respond(tree: &Tree, format: Format, out: &Path, files: Vec<&str>, json: bool) -> Result<(), CliError> {
    let ends = tree.cells().filter(|id| tree.daughter_count(*id) == 0).count();
    let document = Answer { format: format.name(), cells: tree.len(), ends, out: out.display().to_string(), files };
    if json {
        return print_json(&document);
    }
    let files = if document.files.is_empty() { String::new() } else { format!(": {}", document.files.join(", ")) };
    answer(&format!(
        "{} cells, {ends} of them ends of branches, as {} in {}{files}\n",
        document.cells, document.format, document.out
    ))
}
