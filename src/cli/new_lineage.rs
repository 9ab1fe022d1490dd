//! `furrow new-lineage`: a lineage file to begin with.

use super::context::Globals;
use super::error::CliError;
use super::output::print_as;
use clap::Args;
use furrow_formats::write_atomically;
use furrow_input::InputError;
use furrow_lineage::TEMPLATE;
use serde_json::json;
use std::path::PathBuf;

#[derive(Debug, Args)]
pub struct NewLineageArgs {
    /// Output file; an existing file is not overwritten
    #[arg(value_name = "FILE.ron")]
    file: PathBuf,
}

pub fn run(args: &NewLineageArgs, globals: &Globals) -> Result<(), CliError> {
    let (new, name) = (args.file.symlink_metadata().is_err(), format!("{:?}", args.file.display().to_string()));
    InputError::require(new, "new-lineage", "FILE.ron", name, "a file that does not exist yet")?;
    write_atomically(&args.file, TEMPLATE.as_bytes())?;
    let file = args.file.display();
    print_as(globals.json, &json!({ "out": file.to_string(), "bytes": TEMPLATE.len() }), || {
        format!("{file} written; change it, then: furrow tree {file}\n")
    })
}
