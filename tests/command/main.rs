//! The command as users meet it: its help, its answers and pictures, and what it refuses.

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
