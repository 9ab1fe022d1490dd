//! The table of mutants, `mutants.ron`: small errors in the model, each with the test that must fail. The program
//! `mutations` runs them.

use std::fs;
use std::path::{Path, PathBuf};

use serde::Deserialize;

/// One small error in the model.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Mutant {
    /// A short name.
    pub name: String,
    /// What it does to the model.
    pub means: String,
    /// Changes of source files that make this error.
    pub edits: Vec<Edit>,
    /// The file in `crates/furrow-verification/tests/`, without its extension, and the test that must fail.
    pub killed_by: (String, String),
}

/// A replacement of one piece of text in a file.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Edit {
    /// The file, relative to the root of the repository.
    pub file: String,
    /// The old text, which must occur exactly once.
    pub old: String,
    /// The new text.
    pub new: String,
}

/// The root of the repository.
pub fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// The mutants of the repository at `root`.
///
/// # Errors
/// The file cannot be read or parsed.
pub fn table(root: &Path) -> Result<Vec<Mutant>, String> {
    let path = root.join("crates/furrow-verification/mutants.ron");
    let text = fs::read_to_string(&path).map_err(|e| format!("{}: {e}", path.display()))?;
    ron::from_str(&text).map_err(|e| format!("{}: {e}", path.display()))
}

impl Edit {
    /// The text of the file after the change.
    ///
    /// # Errors
    /// The file cannot be read, or the old text does not occur exactly once.
    pub fn applied(&self, root: &Path) -> Result<String, String> {
        let text = fs::read_to_string(root.join(&self.file)).map_err(|e| format!("{}: {e}", self.file))?;
        match text.matches(&self.old).count() {
            1 if self.old != self.new => Ok(text.replacen(&self.old, &self.new, 1)),
            1 => Err(format!("{}: `{}` is replaced by itself", self.file, self.old)),
            count => Err(format!("{}: `{}` occurs {count} times, not once", self.file, self.old)),
        }
    }
}
