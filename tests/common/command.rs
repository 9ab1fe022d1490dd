//! The command, run in a folder.

use std::ffi::OsStr;
use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use serde_json::Value;

/// The folder that tests run in themselves, which is that of the package.
pub const HERE: &str = ".";

/// Where tests that are not about solving keep what they have solved, for each other and for the next run.
pub const CACHE: &str = concat!(env!("CARGO_TARGET_TMPDIR"), "/cache");

/// Makes [`CACHE`] the cache of whatever is run in a folder without an option that names another.
pub fn keep_what_is_solved(folder: &Path) {
    fs::create_dir_all(CACHE).unwrap();
    #[cfg(unix)]
    std::os::unix::fs::symlink(CACHE, folder.join("cache")).unwrap();
    #[cfg(not(unix))]
    fs::create_dir(folder.join("cache")).unwrap();
}

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

/// Runs a command that must succeed, and gives what it prints.
pub fn answer(folder: impl AsRef<Path>, arguments: &[&str]) -> String {
    let output = furrow(folder, arguments);
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

/// Runs a command that must succeed, and gives what it answers with `--json`, which is added.
pub fn json(folder: impl AsRef<Path>, arguments: &[&str]) -> Value {
    serde_json::from_str(&answer(folder, &[arguments, &["--json"]].concat())).unwrap()
}

/// Runs a command that must refuse its input, and gives what it says; it must print nothing else.
pub fn refusal(folder: impl AsRef<Path>, arguments: &[&str]) -> String {
    let output = furrow(folder, arguments);
    let said = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2), "{arguments:?}: {said}");
    assert!(output.stdout.is_empty(), "{arguments:?}");
    said
}

/// Runs the command of a case, which must fail and neither print nor write anything. Gives its exit code and what it says, without
/// empty lines. Lines of the case below the first are the file `input.ron`.
pub fn failed(folder: &Path, case: &str) -> String {
    let (arguments, input) = case.split_once('\n').unwrap_or((case, ""));
    fs::write(folder.join("input.ron"), input).unwrap();
    let before = names(folder);
    let output = furrow(folder, &arguments.split(' ').collect::<Vec<_>>());
    assert!(output.stdout.is_empty(), "{arguments}");
    assert_eq!(names(folder), before, "{arguments}");
    let said = String::from_utf8(output.stderr).unwrap();
    let lines: Vec<&str> = said.lines().filter(|line| !line.trim().is_empty()).collect();
    format!("{}: {}", output.status.code().unwrap(), lines.join("\n"))
}

/// Names of what is in a folder, sorted.
pub fn names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap());
    let mut names: Vec<String> = entries.collect();
    names.sort();
    names
}
