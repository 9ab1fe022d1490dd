//! The solver as a WebAssembly module for the interactive page.
//!
//! It reads requests as JSON and answers with JSON and plain numbers. `build.sh` compiles it.
//!
//! | file | contents |
//! |---|---|
//! | [`abi`] | the functions that a page calls |
//! | [`division`] | one division and its movie |
//! | [`tree`] | a lineage grown in the page, and a tree as Newick |
//! | [`limits`] | cells that the page refuses |
//! | [`edge`] | the curve of pitchforks on the phase diagram |
//! | [`answer`] | the form of all answers |

pub mod abi;
pub mod answer;
pub mod division;
pub mod edge;
pub mod limits;
pub mod tree;
