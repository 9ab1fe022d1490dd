//! The table of mutants: small errors put into the model, each with the test that must see it. It is
//! `crates/furrow-verification/mutants.ron` of the whole; `tests/mutations/run.rs` there tries them.

use std::fs;
use std::path::{Path, PathBuf};

use serde::Deserialize;

/// One error.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Mutant {
    /// Its name, in few words.
    pub name: String,
    /// What it does to the model.
    pub means: String,
    /// Changes of sources that make it.
    pub edits: Vec<Edit>,
    /// The file in `crates/verification/tests/` and the test in it that must fail.
    pub killed_by: (String, String),
}

/// A text that stands once in a file, and what takes its place.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Edit {
    /// The file, from the root of the tree.
    pub file: String,
    /// What stands there.
    pub old: String,
    /// What is put there.
    pub new: String,
}

/// The root of the tree that this crate is part of.
pub fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// The table of a tree.
///
/// # Errors
/// The file cannot be read, or is no such table.
pub fn table(root: &Path) -> Result<Vec<Mutant>, String> {
    let path = root.join("crates/furrow-verification/mutants.ron");
    let text = fs::read_to_string(&path).map_err(|e| format!("{}: {e}", path.display()))?;
    ron::from_str(&text).map_err(|e| format!("{}: {e}", path.display()))
}

impl Edit {
    /// The file of a tree with the change made.
    ///
    /// # Errors
    /// The old text does not stand there, or more than once.
    pub fn applied(&self, root: &Path) -> Result<String, String> {
        let text = fs::read_to_string(root.join(&self.file)).map_err(|e| format!("{}: {e}", self.file))?;
        match text.matches(&self.old).count() {
            1 if self.old != self.new => Ok(text.replacen(&self.old, &self.new, 1)),
            1 => Err(format!("{}: `{}` is changed into itself", self.file, self.old)),
            count => Err(format!("{}: `{}` stands there {count} times and must stand there once", self.file, self.old)),
        }
    }
}
