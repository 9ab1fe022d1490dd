//! `furrow export`: a tree, or an observed embryo, for other programs.

use super::cell::{load_lineage, one_of};
use super::context::Globals;
use super::embryos::{MatchArgs, files_of, matched_text};
use super::error::CliError;
use super::messages;
use super::output::{number, print, print_as, writable_file, writable_folder};
use clap::Args;
use furrow_analysis::observed::{Observed, ObservedLineage, ObservedOptions, SULSTON1983};
use furrow_formats::exchange::{
    BranchLengths, Exported, Format, ITOL_FILES, Sheet, TimedTree, check_sheet, check_tree, export_sheet, time_doubt,
};
use furrow_formats::{TREE_SCHEMA, read_tree};
use furrow_input::InputError;
use furrow_measured::names::Names;
use furrow_measured::tracked::TableKind;
use furrow_report::founder_colours;
use serde_json::json;
use std::path::{Path, PathBuf};

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  furrow export furrow-out/tree.json --to nexus --out tree.nex
  furrow export furrow-out/tree.json --to itol --out itol
  furrow export sulston1983 --to newick --subtree MS
  furrow export --schema")]
pub struct ExportArgs {
    /// A tree.json written by furrow tree, or an observed embryo: one tracked by another program, or a table of lifetimes;
    /// sulston1983 is the embryonic lineage of C. elegans
    #[arg(value_name = "TREE.json|EMBRYO", required_unless_present = "schema")]
    tree: Option<PathBuf>,
    /// Format
    #[arg(help_heading = "Output", long, value_name = "FORMAT", required_unless_present = "schema",
        value_parser = one_of(Format::ALL.map(|format| (format.name(), format))))]
    to: Option<Format>,
    /// Output file, or for itol and geff a folder; default stdout
    #[arg(help_heading = "Output", long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Branch lengths: the duration of the division in τ (default), one per generation, minutes from birth to division by the
    /// lineage's clock, or none. Cells just above the threshold of division take thousands of τ and dwarf all other branches.
    /// The time points of lineagetree, geff and ctc are minutes if there is a clock, otherwise generations
    #[arg(help_heading = "Output", long, value_name = "LENGTHS", value_parser = one_of(BranchLengths::NAMED))]
    branch_lengths: Option<BranchLengths>,
    /// Exports this cell and its descendants
    #[arg(help_heading = "Output", long, value_name = "CELL", conflicts_with = "schema")]
    subtree: Option<String>,
    #[command(flatten)]
    observed: ObservedArgs,
    /// Prints the JSON Schema of tree.json
    #[arg(help_heading = "Output", long, conflicts_with_all = ["tree", "to", "out", "branch_lengths"])]
    schema: bool,
}

// Options for reading an observed embryo.
#[derive(Debug, Args)]
#[command(next_help_heading = "Observed embryos")]
struct ObservedArgs {
    /// Lineage with the founders of the cells; default the built-in C. elegans founders
    #[arg(long, value_name = "LINEAGE.ron")]
    lineage: Option<PathBuf>,
    /// Tables of cell volumes, as for compare volumes, in addition to a table of lifetimes
    #[arg(long, value_name = "FILE")]
    volumes: Vec<PathBuf>,
    /// Minutes per frame; without this option time points are frames if the file counts frames
    #[arg(long, value_name = "MIN", value_parser = number)]
    frame_minutes: Option<f64>,
    /// Edge of a voxel in µm, for sizes in pixels
    #[arg(long, value_name = "UM", value_parser = number)]
    voxel: Option<f64>,
    #[command(flatten)]
    matching: MatchArgs,
}

pub fn run(args: &ExportArgs, globals: &Globals) -> Result<(), CliError> {
    let (Some(file), Some(format)) = (&args.tree, args.to) else { return print(TREE_SCHEMA) };
    check(args, format, globals)?;
    if is_observed(file) {
        let lineage = load_lineage(args.observed.lineage.as_deref())?;
        let names = args.observed.matching.names(&lineage)?;
        let observed = args.observed.read(file, names.clone())?;
        let founders: Vec<&str> = lineage.founders.iter().map(|founder| founder.name.as_str()).collect();
        // Time points come from the recording.
        let lengths = args.branch_lengths.unwrap_or(BranchLengths::Minutes);
        let sheet = observed.sheet(&founders, &names);
        check_sheet(&sheet, format, lengths)?;
        return write(args, format, lengths, sheet, &founder_colours(&lineage), globals);
    }
    args.observed.refuse_for_trees()?;
    let tree = read_tree(file)?;
    let lengths = args.branch_lengths.unwrap_or_default();
    check_tree(&tree, format, lengths)?;
    let timed = TimedTree::new(&tree);
    write(args, format, lengths, Sheet::of_tree(&timed), &founder_colours(&tree.lineage), globals)
}

/// Whether a file is an observed embryo rather than a tree of the model.
fn is_observed(file: &Path) -> bool {
    let extension = file.extension().map(|extension| extension.to_string_lossy().to_lowercase());
    file.as_os_str() == SULSTON1983
        || file.is_dir()
        || extension.is_some_and(|extension| ["csv", "tsv", "txt", "xml", "zip"].contains(&&*extension))
}

impl ObservedArgs {
    /// The embryo of a file.
    fn read(&self, file: &Path, names: Names) -> Result<ObservedLineage, InputError> {
        let (frame_minutes, voxel) = (self.frame_minutes, self.voxel);
        for (option, field, value) in [("--frame-minutes", "frame_minutes", frame_minutes), ("--voxel", "voxel", voxel)]
        {
            let fine = value.is_none_or(|value| (1e-6..=1e6).contains(&value));
            InputError::require(fine, option, field, value.unwrap_or_default(), "a number from 1e-6 to 1e6")?;
        }
        let volumes = files_of(&self.volumes, TableKind::Volumes)?;
        let found = Observed::read(file, &ObservedOptions { volumes, frame_minutes, voxel, names })?;
        for line in matched_text(found.matched.as_slice()).lines() {
            messages::write(messages::Level::Info, format_args!("{line}"));
        }
        messages::warn_of(&found.warnings);
        if let Some(first) = found.skipped.first() {
            messages::warning!("{} values are not used; the first is {first}", found.skipped_count);
        }
        Ok(found.lineage)
    }

    /// Rejects options that do not apply to a tree of the model.
    fn refuse_for_trees(&self) -> Result<(), InputError> {
        let given = [
            ("--lineage", self.lineage.is_some()),
            ("--volumes", !self.volumes.is_empty()),
            ("--frame-minutes", self.frame_minutes.is_some()),
            ("--voxel", self.voxel.is_some()),
            ("--names", self.matching.is_given()),
        ];
        let option = given.into_iter().find(|(_, given)| *given).map(|(option, _)| option);
        let allowed = "left out with a tree of the model: observed embryos are files that end in .csv, .txt, .xml or .zip, and folders";
        option.map_or(Ok(()), |option| Err(InputError::not_allowed(option, &option[2..], "(given)", allowed)))
    }
}

/// Writes the cells to the file, or prints them.
fn write(
    args: &ExportArgs,
    format: Format,
    lengths: BranchLengths,
    sheet: Sheet<'_>,
    colours: &[&str],
    globals: &Globals,
) -> Result<(), CliError> {
    let sheet = match &args.subtree {
        Some(root) => sheet.below(root, "--subtree")?,
        None => sheet,
    };
    messages::warn_of(time_doubt(&sheet, format, lengths));
    let exported = export_sheet(&sheet, format, lengths, colours);
    let out = match (&exported, &args.out) {
        (Exported::File(text), None) => return print(text),
        (_, out) => out.as_ref().ok_or_else(|| needs_folder(format))?,
    };
    exported.write(out)?;
    let files = match &exported {
        Exported::Folder(files) => files.iter().map(|(name, _)| *name).collect(),
        Exported::File(_) | Exported::Binary(_) => vec![],
    };
    let (format, cells, out) = (format.name(), sheet.cells.len(), out.display().to_string());
    let ends = sheet.cells.iter().filter(|cell| cell.daughters == [None, None]).count();
    let document = json!({ "format": format, "cells": cells, "ends": ends, "out": out, "files": files });
    print_as(globals.json, &document, || {
        let files = if files.is_empty() { String::new() } else { format!(": {}", files.join(", ")) };
        format!("{cells} cells, {ends} of them ends of branches, as {format} in {out}{files}\n")
    })
}

/// Rejects conflicting options before the tree is read.
fn check(args: &ExportArgs, format: Format, globals: &Globals) -> Result<(), InputError> {
    if let Some(lengths) = args.branch_lengths {
        format.check_lengths(lengths)?;
    }
    match (&args.out, format) {
        (None, Format::Itol | Format::Geff) => Err(needs_folder(format)),
        (None, _) if globals.json => {
            let allowed = "given with --json, since without it the export itself goes to stdout";
            Err(InputError::not_allowed("--out", "out", "(not given)", allowed))
        }
        (None, _) => Ok(()),
        (Some(folder), Format::Geff) => {
            // Arrays of an earlier export would hide the new ones.
            let other = folder.join("zarr.json");
            let allowed = "a folder without a file zarr.json, which is of Zarr version 3: version 2 is written";
            InputError::require(!other.exists(), "--out", "out", folder.display(), allowed)?;
            writable_folder("--out", folder.as_path(), &[".zattrs"])
        }
        (Some(folder), Format::Itol) => writable_folder("--out", folder.as_path(), &ITOL_FILES),
        (Some(file), _) => writable_file("--out", file.as_path()),
    }
}

fn needs_folder(format: Format) -> InputError {
    let allowed = format!("a folder for the files of {}", format.name());
    InputError::not_allowed("--out", "out", "(not given)", allowed)
}
