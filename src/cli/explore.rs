//! `furrow explore`: the interactive page.

use super::cell::FirstCellArgs;
use super::context::Context;
use super::error::CliError;
use super::output::{print_as, seed, writable_file};
use super::tree::prepared;
use clap::Args;
use furrow_formats::write_atomically;
use furrow_input::InputError;
use serde_json::json;
use std::path::PathBuf;

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  furrow explore
  furrow explore --r0 3 --epsilon 0.8 --out small.html
  furrow explore lineages/c_elegans.ron --set aspect=1.3 --json")]
pub struct ExploreArgs {
    /// Founders and cues of the page's tree; default the built-in C. elegans founders
    #[arg(value_name = "LINEAGE.ron")]
    lineage: Option<PathBuf>,
    #[command(flatten)]
    cell: FirstCellArgs,
    /// Output file; an existing file is replaced
    #[arg(help_heading = "Output", long, value_name = "FILE.html", default_value = "explore.html")]
    out: PathBuf,
    /// Seed of the noise in the first step of every division
    #[arg(help_heading = "Numerics", long, value_name = "S", default_value_t = 0, value_parser = seed)]
    seed: u64,
}

pub fn run(args: &ExploreArgs, context: &Context) -> Result<(), CliError> {
    let (lineage, settings) = prepared(&args.cell, args.seed, context, args.lineage.as_deref())?;
    context.check_taken(&[&lineage], args.cell.given())?;
    let is_page =
        args.out.extension().is_some_and(|name| ["html", "htm"].iter().any(|page| name.eq_ignore_ascii_case(page)));
    let file = format!("{:?}", args.out.display().to_string());
    InputError::require(is_page, "--out", "file", file, "a file whose name ends in .html or .htm")?;
    writable_file("--out", args.out.as_path())?;
    let page = furrow_report::explorer(&lineage, &settings);
    write_atomically(&args.out, page.as_bytes())?;
    let (out, bytes) = (args.out.display().to_string(), page.len());
    let text = format!("{out} written, {} kB; open it in a browser\n", bytes / 1000);
    print_as(context.json, &json!({ "out": out, "bytes": bytes }), || text)
}
