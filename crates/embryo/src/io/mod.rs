//! Files: trees, studies and run records out, and in again.

pub mod exchange;
pub mod files;
pub mod frames;
pub mod provenance;
pub mod scenarios_csv;
pub mod sweep_files;
pub mod tree_json;

pub use exchange::newick;
pub use files::write_atomically;
pub use provenance::Provenance;
pub use scenarios_csv::scenarios_csv;
pub use tree_json::{FounderRow, TREE_SCHEMA, TreeFileError, founder_rows};

pub use crate::settings::{Settings, parse_cue};
