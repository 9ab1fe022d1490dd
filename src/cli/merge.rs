//! `furrow merge`: the parts of a sweep put together.

use super::context::Globals;
use super::error::CliError;
use super::messages;
use super::output::{print_as, writable_folder};
use clap::Args;
use furrow_analysis::sweep_files::{SWEEP_FILES, merge};
use furrow_input::InputError;
use serde_json::json;
use std::path::{Path, PathBuf};

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  furrow merge part-1 part-2 --out whole
  furrow merge part-1 part-2 --out whole --json")]
pub struct MergeArgs {
    /// Folders of all parts, written by furrow sweep --shard
    #[arg(value_name = "DIR", required = true)]
    parts: Vec<PathBuf>,
    /// Output folder
    #[arg(help_heading = "Output", long, value_name = "DIR")]
    out: PathBuf,
}

pub fn run(args: &MergeArgs, globals: &Globals) -> Result<(), CliError> {
    messages::set_level(globals);
    // The merged files would overwrite the part.
    let same = |a: &Path, b: &Path| a == b || a.canonicalize().is_ok_and(|a| b.canonicalize().is_ok_and(|b| a == b));
    for part in &args.parts {
        let allowed = "another folder than those of the parts";
        InputError::require(!same(part, &args.out), "--out", "out", format!("{part:?}"), allowed)?;
    }
    writable_folder("--out", args.out.as_path(), &SWEEP_FILES)?;
    let table = merge(&args.parts)?;
    table.write(&args.out)?;
    let (points, parts, out) = (table.rows.len(), args.parts.len(), args.out.display().to_string());
    // As of a sweep without anything new to solve.
    let document = json!({ "points": points, "solved": 0, "reused": points, "parts": parts, "out": out });
    print_as(globals.json, &document, || format!("{points} points of {parts} parts; files in {out}\n"))
}
