//! Checks of every reader: one function per reader takes any bytes and panics if the reader misbehaves. The fuzzers call them
//! with random bytes, `tests/project/hostile_corpus.rs` with the files in `tests/fuzz/corpus`.

pub mod boundary_value;
pub mod config;
pub mod constants;
pub mod contours;
pub mod cue;
pub mod law;
pub mod lineage;
pub mod sweep;
pub mod targets;
pub mod tree_json;
pub mod volumes;

use std::fmt::Debug;
use std::sync::OnceLock;

use furrow_lineage::Lineage;
use serde::{Serialize, de::DeserializeOwned};

/// A check of one reader.
type Check = fn(&[u8]);

/// All checks by name.
pub const TARGETS: [(&str, Check); 11] = [
    ("boundary_value", boundary_value::check),
    ("config", config::check),
    ("constants", constants::check),
    ("contours", contours::check),
    ("cue", cue::check),
    ("law", law::check),
    ("lineage", lineage::check),
    ("sweep", sweep::check),
    ("targets", targets::check),
    ("tree_json", tree_json::check),
    ("volumes", volumes::check),
];

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

/// The value that was read; `None`, after a check of the error, if reading failed.
pub fn accepted<T>(read: Result<T, impl ToString>) -> Option<T> {
    read.map_err(|error| says_where(&error)).ok()
}

/// A value survives writing and reading as JSON.
pub fn survives_json<T: Serialize + DeserializeOwned + PartialEq + Debug>(value: &T) {
    let written = serde_json::to_string(value).expect("it is written");
    assert_eq!(serde_json::from_str::<T>(&written).expect("what is written is read"), *value, "{written}");
}

/// The built-in lineage, read once.
pub fn built_in() -> &'static Lineage {
    static LINEAGE: OnceLock<Lineage> = OnceLock::new();
    LINEAGE.get_or_init(|| Lineage::c_elegans().expect("the built-in lineage"))
}
