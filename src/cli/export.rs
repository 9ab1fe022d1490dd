//! `furrow export`: a tree for other programs.

use super::cell::one_of;
use super::context::Globals;
use super::error::CliError;
use super::messages;
use super::output::{print, print_as, writable_file, writable_folder};
use clap::Args;
use furrow_formats::exchange::{BranchLengths, Exported, Format, ITOL_FILES, check_tree, export};
use furrow_formats::{TREE_SCHEMA, read_tree};
use furrow_input::InputError;
use furrow_report::founder_colours;
use serde_json::json;
use std::path::PathBuf;

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  furrow export furrow-out/tree.json --to nexus --out tree.nex
  furrow export furrow-out/tree.json --to newick --branch-lengths generation
  furrow export furrow-out/tree.json --to itol --out itol
  furrow export --schema")]
pub struct ExportArgs {
    /// The tree.json that furrow tree wrote
    #[arg(value_name = "TREE.json", required_unless_present = "schema")]
    tree: Option<PathBuf>,
    /// Format
    #[arg(help_heading = "Output", long, value_name = "FORMAT", required_unless_present = "schema",
        value_parser = one_of(Format::ALL.map(|format| (format.name(), format))))]
    to: Option<Format>,
    /// Output file, or for itol and geff a folder; default stdout
    #[arg(help_heading = "Output", long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Branch lengths: the time a division takes in τ (default), one per generation, minutes from birth to division by the
    /// lineage's clock, or none. Cells just above the threshold of division take thousands of τ and dwarf all other branches.
    /// The time points of lineagetree, geff and ctc are minutes if there is a clock, or generations
    #[arg(help_heading = "Output", long, value_name = "LENGTHS", value_parser = one_of(BranchLengths::NAMED))]
    branch_lengths: Option<BranchLengths>,
    /// Prints the JSON Schema of tree.json
    #[arg(help_heading = "Output", long, conflicts_with_all = ["tree", "to", "out", "branch_lengths"])]
    schema: bool,
}

pub fn run(args: &ExportArgs, globals: &Globals) -> Result<(), CliError> {
    messages::set_level(globals);
    let (Some(file), Some(format)) = (&args.tree, args.to) else { return print(TREE_SCHEMA) };
    check(args, format, globals)?;
    let tree = read_tree(file)?;
    let lengths = args.branch_lengths.unwrap_or_default();
    check_tree(&tree, format, lengths)?;
    let exported = export(&tree, format, lengths, &founder_colours(&tree.lineage));
    let out = match (&exported, &args.out) {
        (Exported::File(text), None) => return print(text),
        (_, out) => out.as_ref().ok_or_else(|| needs_folder(format))?,
    };
    exported.write(out)?;
    let files = match &exported {
        Exported::Folder(files) => files.iter().map(|(name, _)| *name).collect(),
        Exported::File(_) | Exported::Binary(_) => vec![],
    };
    let (format, cells, out) = (format.name(), tree.len(), out.display().to_string());
    let ends = tree.cells().filter(|id| tree.daughter_count(*id) == 0).count();
    let document = json!({ "format": format, "cells": cells, "ends": ends, "out": out, "files": files });
    print_as(globals.json, &document, || {
        let files = if files.is_empty() { String::new() } else { format!(": {}", files.join(", ")) };
        format!("{cells} cells, {ends} of them ends of branches, as {format} in {out}{files}\n")
    })
}

/// Refuses conflicting options before the tree is read.
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
            // Its arrays would hide those that are written.
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
