//! `furrow cache`: inspects, verifies and clears the cache of solved divisions.

use super::context::{Globals, cache_folder};
use super::error::CliError;
use super::output::print_as;
use clap::{Args, Subcommand};
use furrow_input::InputError;
use furrow_lineage::batch::store::maintenance;
use std::fmt::Write;

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  furrow cache stat
  furrow cache verify --repair
  furrow cache clear --cache cache")]
pub struct CacheArgs {
    #[command(subcommand)]
    action: Action,
}

#[derive(Clone, Copy, Debug, Subcommand)]
enum Action {
    /// Counts the entries
    Stat,
    /// Checks every entry and lists the damaged ones (exit code 1 if there are any)
    Verify {
        /// Removes the damaged entries (exit code 0)
        #[arg(long)]
        repair: bool,
    },
    /// Removes all entries, of every version
    Clear,
}

pub fn run(args: &CacheArgs, globals: &Globals) -> Result<(), CliError> {
    let allowed = "left out: this command is about the cache";
    InputError::require(!globals.no_cache, "--no-cache", "cache", "--no-cache", allowed)?;
    let folder = cache_folder(globals)?;
    let report = match args.action {
        Action::Verify { repair: true } => maintenance::repair(&folder)?,
        Action::Stat | Action::Verify { repair: false } => maintenance::verify(&folder)?,
        Action::Clear => maintenance::clear(&folder)?,
    };
    print_as(globals.json, &report, || {
        let maintenance::CacheReport { folder, entries, other_versions, bytes, corrupt, .. } = &report;
        let (done, folder) = (if matches!(args.action, Action::Clear) { "cleared " } else { "" }, folder.display());
        let mut text = format!(
            "{done}{folder}: {entries} entries, {other_versions} of other versions, {bytes} bytes, {corrupt} corrupt\n"
        );
        if matches!(args.action, Action::Verify { .. }) {
            for damaged in &report.damaged {
                let _ = writeln!(text, "corrupt: {damaged}");
            }
        }
        text
    })?;
    match args.action {
        Action::Verify { repair: false } if report.corrupt > 0 => Err(CliError::CorruptCache(report.corrupt)),
        _ => Ok(()),
    }
}
