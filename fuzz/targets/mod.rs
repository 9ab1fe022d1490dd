//! Checks of every reader: one function per reader takes any bytes and panics if the reader misbehaves. The fuzzers call them
//! with random bytes, `tests/project/hostile_corpus.rs` with the files in `fuzz/corpus`.

// Each fuzzer is a separate program that calls one of these.
#![allow(dead_code)]

pub mod config;
pub mod constants;
pub mod contours;
pub mod cue;
pub mod lineage;
pub mod sweep;
pub mod targets;
pub mod tree_json;
pub mod volumes;

use std::sync::OnceLock;

use furrow_lineage::Lineage;

/// The file name in errors.
pub const FILE: &str = "given.file";

/// The bytes as text, if they are UTF-8: other files never reach a reader.
pub fn text(data: &[u8]) -> Option<&str> {
    std::str::from_utf8(data).ok()
}

/// An error starts with the file, has a message, and is short for any input.
pub fn says_where(error: &impl ToString) {
    let said = error.to_string();
    assert!(said.starts_with(FILE) && said.len() > FILE.len() + 2, "does not begin with the file: {said}");
    assert!(said.len() < 4000, "an error of {} bytes: {}…", said.len(), said.chars().take(200).collect::<String>());
    assert!(!said.chars().any(|c| c.is_control() && c != '\n' && c != '\t'), "control characters: {said:?}");
}

/// The built-in lineage, read once.
pub fn built_in() -> &'static Lineage {
    static LINEAGE: OnceLock<Lineage> = OnceLock::new();
    LINEAGE.get_or_init(|| Lineage::c_elegans().expect("the built-in lineage"))
}
