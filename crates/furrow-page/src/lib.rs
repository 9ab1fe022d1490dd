//! The solver as the report calls it inside a browser.
//!
//! Compiled for wasm32-unknown-unknown by `build.sh` beside this crate; the result, `furrow.wasm.txt`, is kept in the
//! repository, so that whoever builds `furrow` needs no second target. Nothing is computed here that the library does not
//! compute: this crate turns JSON into its inputs and its results into JSON and plain numbers.
//!
//! | file | what it says |
//! |---|---|
//! | [`abi`] | functions that a page calls, and how bytes go in and out |
//! | [`division`] | one division, and what its films are drawn from |
//! | [`tree`] | a founder tree grown anew |
//! | [`edge`] | the curve of pitchforks on the phase diagram |
//! | [`answer`] | what all of them answer with |

pub mod abi;
pub mod answer;
pub mod division;
pub mod edge;
pub mod tree;
