//! `furrow completions`.

use super::error::CliError;
use super::output::print;
use clap::Args;

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

pub fn run(args: &CompletionsArgs, command: &mut clap::Command) -> Result<(), CliError> {
    let mut script = vec![];
    clap_complete::generate(args.shell, command, "furrow", &mut script);
    print(&String::from_utf8_lossy(&script))
}
