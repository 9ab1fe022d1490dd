//! `furrow completions` and `furrow man`.

use super::error::CliError;
use super::output::{print, writable_folder};
use crate::io::files::FileSet;
use clap::Args;
use std::path::PathBuf;

/// Prints a completion script for a shell
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  furrow completions bash
  furrow completions zsh")]
pub struct CompletionsArgs {
    /// The shell
    #[arg(value_name = "SHELL")]
    shell: clap_complete::Shell,
}

/// Prints the manual page, or writes the pages of all commands into a folder
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  furrow man
  furrow man --out pages")]
pub struct ManArgs {
    /// Output folder, one page per command
    #[arg(help_heading = "Output", long, value_name = "DIR")]
    out: Option<PathBuf>,
}

pub fn completions(args: &CompletionsArgs, command: &mut clap::Command) -> Result<(), CliError> {
    let mut script = vec![];
    clap_complete::generate(args.shell, command, "furrow", &mut script);
    print(&String::from_utf8_lossy(&script))
}

pub fn man(args: &ManArgs, mut command: clap::Command) -> Result<(), CliError> {
    let page = |command: clap::Command| -> Result<Vec<u8>, CliError> {
        let mut page = vec![];
        clap_mangen::Man::new(command).render(&mut page)?;
        Ok(page)
    };
    command.build();
    let Some(folder) = &args.out else {
        return print(&String::from_utf8_lossy(&page(command)?));
    };
    writable_folder("--out", folder.as_path(), &[])?;
    let mut files = FileSet::new(folder);
    for sub in command.get_subcommands().filter(|sub| sub.get_name() != "help") {
        let name = format!("furrow-{}", sub.get_name());
        files.stage(&format!("{name}.1"), &page(sub.clone().display_name(name))?)?;
    }
    files.stage("furrow.1", &page(command)?)?;
    Ok(files.commit()?)
}
