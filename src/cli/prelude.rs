//! What most commands import.

pub use super::cell::positive;
pub use super::context::Context;
pub use super::error::CliError;
pub use super::number::number;
pub use super::output::print_as;
pub use super::picture::PlotArgs;
pub use clap::Args;
pub use furrow_input::InputError;
pub use serde::Serialize;
pub use std::fmt::Write;
pub use std::path::PathBuf;
