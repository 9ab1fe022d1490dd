//! What most commands import.

pub use super::cell::{one_of, positive};
pub use super::context::{Context, Globals, start_logs, warn_of_store};
pub use super::error::CliError;
pub(in crate::cli) use super::interrupt::{self, write_deferred};
pub use super::output::{csv_of, filled, merged, number, print, print_as, to_json, writable_file, writable_folder};
pub use super::picture::{Picture, PlotArgs};
pub use super::progress::ProgressLine;
pub use clap::Args;
pub use furrow_analysis::{Range, read_constants, tree_settings};
pub use furrow_cell::{Cell, Cue, Parameter, settings::Settings};
pub use furrow_figures::plot;
pub use furrow_formats::files::{FileSet, WriteError};
pub use furrow_formats::write_atomically;
pub use furrow_input::{InputError, open_file, parse_document, read_text};
pub use furrow_lineage::{Lineage, Tree, TreeSettings, Units};
pub use serde_json::{Value, json};
pub use std::fmt::Write;
pub use std::path::{Path, PathBuf};
pub use std::time::Instant;
