//! `furrow merge`: merges the parts of a sweep, or of a sample of a posterior.

use super::context::Globals;
use super::error::CliError;
use super::output::{print_as, writable_file, writable_folder};
use clap::Args;
use furrow_analysis::hypotheses::{MergedSample, merge_parts};
use furrow_analysis::sweep_files::{SWEEP_FILES, merge};
use furrow_formats::write_atomically;
use furrow_input::InputError;
use serde_json::json;
use std::path::{Path, PathBuf};

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  furrow merge part-1 part-2 --out whole
  furrow merge part-1 part-2 --out whole --json
  furrow merge part-1.csv part-2.csv --out posterior.csv")]
pub struct MergeArgs {
    /// Folders of all parts, written by furrow sweep --shard, or tables (.csv) of all parts, written by furrow test --shard
    #[arg(value_name = "PART", required = true)]
    parts: Vec<PathBuf>,
    /// Output folder, or table (.csv)
    #[arg(help_heading = "Output", long, value_name = "OUT")]
    out: PathBuf,
}

pub fn run(args: &MergeArgs, globals: &Globals) -> Result<(), CliError> {
    // The merged files would overwrite the part.
    let same = |a: &Path, b: &Path| a == b || a.canonicalize().is_ok_and(|a| b.canonicalize().is_ok_and(|b| a == b));
    for part in &args.parts {
        let allowed = "another folder than those of the parts";
        InputError::require(!same(part, &args.out), "--out", "out", format!("{part:?}"), allowed)?;
    }
    if args.parts.iter().any(|part| part.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("csv"))) {
        return merge_samples(args, globals);
    }
    writable_folder("--out", args.out.as_path(), &SWEEP_FILES)?;
    let table = merge(&args.parts)?;
    table.write(&args.out)?;
    let (points, parts, out) = (table.rows.len(), args.parts.len(), args.out.display().to_string());
    // The counts are the same as for a sweep without new divisions.
    let document = json!({ "points": points, "solved": 0, "reused": points, "parts": parts, "out": out });
    print_as(globals.json, &document, || format!("{points} points of {parts} parts; files in {out}\n"))
}

/// Merges the parts of a sample into one table.
fn merge_samples(args: &MergeArgs, globals: &Globals) -> Result<(), CliError> {
    writable_file("--out", args.out.as_path())?;
    let MergedSample { csv, points, parts, log_evidence } = merge_parts(&args.parts)?;
    write_atomically(&args.out, csv.as_bytes())?;
    let out = args.out.display().to_string();
    let document = json!({ "points": points, "parts": parts, "log_evidence": log_evidence, "out": out });
    print_as(globals.json, &document, || {
        let of = |(name, log): (&String, &f64)| {
            format!("log evidence {log:.2}{}{name}\n", if name.is_empty() { "" } else { " of " })
        };
        format!("{points} points of {parts} parts in {out}\n") + &log_evidence.iter().map(of).collect::<String>()
    })
}
