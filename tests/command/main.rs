//! The command line: help, output, pictures and errors.

#[path = "../common/mod.rs"]
mod common;

mod cli;
mod cli_branches;
mod cli_steady;
mod configuration;
mod explore;
mod help;
mod inputs;
mod outputs;
mod page;
mod pictures;
mod refusals;
