//! Files: configuration in, trees and run records out.

pub mod config;
pub mod earlier;
pub mod files;
pub mod frames;
pub mod newick;
pub mod provenance;
pub mod scenarios_csv;
pub mod tree_json;

pub use config::{Settings, parse_cue};
pub use files::write_atomically;
pub use newick::newick;
pub use provenance::Provenance;
pub use scenarios_csv::scenarios_csv;
pub use tree_json::{FounderRow, TreeFileError, founder_rows};
