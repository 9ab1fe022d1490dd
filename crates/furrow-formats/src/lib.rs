//! Files of lineage trees and of dividing cells.
//!
//! | file | contents |
//! |---|---|
//! | [`tree_json`] | `tree.json`: writing it, reading it with checks, the founders' table in it |
//! | [`exchange`] | Newick, NHX, NEXUS, GraphML, iTOL, CSV |
//! | [`frames`] | the shapes of one division: contours as CSV, surfaces as PLY or glTF |
//! | `film` | the surfaces of one division without axial symmetry as PLY or glTF |
//! | [`surface`] | the surface of a cell as a grid, with or without an axis of symmetry, and as triangles |
//! | [`files`] | files that are written whole or not at all |
//! | `temporary` | names of temporary files, and removal of stale ones |
//! | [`provenance`] | the version of the program that wrote a file |

pub mod exchange;
pub mod files;
#[cfg(not(target_family = "wasm"))]
pub mod film;
pub mod frames;
pub mod provenance;
pub mod surface;
mod temporary;
pub mod tree_json;

pub use exchange::newick;
pub use files::write_atomically;
pub use provenance::Provenance;
pub use tree_json::{FounderRow, TREE_SCHEMA, TreeFileError, founder_rows, read_tree, tree_from_json, tree_to_json};
