//! Files: trees, studies and run records out, and in again.

pub mod exchange;
pub mod files;
pub mod frames;
pub mod provenance;
pub mod tree_json;

pub use exchange::newick;
pub use files::write_atomically;
pub use provenance::Provenance;
pub use tree_json::{FounderRow, TREE_SCHEMA, TreeFileError, founder_rows, read_tree, tree_from_json, tree_to_json};
