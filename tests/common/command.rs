//! The command, run in a folder.

use std::ffi::OsStr;
use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use serde_json::Value;

/// The folder in which tests run: the package's folder.
pub const HERE: &str = ".";

/// The cache of tests that are not about solving; they share it, also with the next run.
pub const CACHE: &str = concat!(env!("CARGO_TARGET_TMPDIR"), "/cache");

/// The command in a folder, not yet started.
pub fn command(folder: impl AsRef<Path>, arguments: &[impl AsRef<OsStr>]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_furrow"));
    command.args(arguments).current_dir(folder);
    command
}

/// Runs the command in a folder.
pub fn furrow(folder: impl AsRef<Path>, arguments: &[impl AsRef<OsStr>]) -> Output {
    command(folder, arguments).output().unwrap()
}

/// Runs a command that must succeed, and returns its output.
pub fn answer(folder: impl AsRef<Path>, arguments: &[&str]) -> String {
    let output = furrow(folder, arguments);
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

/// Runs a command that must succeed, and returns its answer with `--json`, which is added.
pub fn json(folder: impl AsRef<Path>, arguments: &[&str]) -> Value {
    serde_json::from_str(&answer(folder, &[arguments, &["--json"]].concat())).unwrap()
}

/// The names of a folder's entries, sorted.
pub fn names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap());
    let mut names: Vec<String> = entries.collect();
    names.sort();
    names
}
