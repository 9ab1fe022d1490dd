//! Standard output and error, output files, and numeric options. The command fails if stdout cannot be written; messages that cannot
//! be written to stderr are lost.

use super::error::CliError;
pub use furrow_analysis::json::{filled, merged};
pub use furrow_analysis::table::records_csv;
use furrow_formats::files::{WriteError, check_file, check_folder};
use furrow_input::{InputError, printable_lines};
use serde::Serialize;
use std::io::{self, Write};
use std::path::Path;

/// A document as indented JSON, with a final newline.
pub fn to_json(document: &impl Serialize) -> Result<String, CliError> {
    Ok(format!("{}\n", serde_json::to_string_pretty(document)?))
}

/// Prints a document as JSON, or as text.
pub fn print_as(json: bool, document: &impl Serialize, text: impl FnOnce() -> String) -> Result<(), CliError> {
    print(&if json { to_json(document)? } else { text() })
}

/// Writes text or JSON to stdout. Table entries and file names may contain terminal control characters; these are escaped as
/// in JSON, which leaves some of them unescaped.
pub fn print(text: &str) -> Result<(), CliError> {
    let controls = |c: char| c.is_control() && !matches!(c, '\n' | '\t');
    let escape = |c: char| if controls(c) { format!("\\u{:04x}", u32::from(c)) } else { c.to_string() };
    let escaped = text.contains(controls).then(|| text.chars().map(escape).collect::<String>());
    let mut stdout = io::stdout().lock();
    stdout.write_all(escaped.as_deref().unwrap_or(text).as_bytes())?;
    stdout.flush()?;
    Ok(())
}

/// Writes a message to stderr. `eprintln!` would panic if stderr is full or closed, before the run has written its files.
pub fn eprint(text: &str) {
    write_error(&format!("furrow: {}\n", printable_lines(text)));
}

/// Writes to stderr in one call, so that lines of several threads do not mix.
pub fn write_error(text: &str) {
    let _ = io::stderr().lock().write_all(text.as_bytes());
}

/// Prints the output of clap: help and version go to stdout; usage errors count as invalid input.
pub fn print_usage(error: &clap::Error) -> Result<(), CliError> {
    let printed = error.print().and_then(|()| io::stdout().flush());
    if error.use_stderr() { Err(CliError::Usage) } else { Ok(printed?) }
}

/// Endings of the names of files.
const FILES: [&str; 13] = ["csv", "tsv", "txt", "json", "svg", "pdf", "png", "gif", "html", "obj", "stl", "ply", "glb"];

/// Whether a path that is no folder yet has the name of a file: no folder of this name should be made.
pub fn named_as_file(path: &Path) -> bool {
    let ending = path.extension().and_then(|name| name.to_str()).unwrap_or_default().to_ascii_lowercase();
    FILES.contains(&ending.as_str()) && !path.is_dir()
}

/// Checks that these files can be written into the folder of an option, before the computation.
pub fn writable_folder<'a>(
    option: &str,
    folder: impl Into<Option<&'a Path>>,
    names: &[&str],
) -> Result<(), InputError> {
    let Some(folder) = folder.into() else { return Ok(()) };
    let allowed = "a folder; this is the name of a file";
    InputError::require(
        !named_as_file(folder),
        option,
        option.trim_start_matches('-'),
        format!("{folder:?}"),
        allowed,
    )?;
    check_folder(folder, names).map_err(|error| not_writable(option, folder, "a folder that can be written to", &error))
}

/// Checks that the file of an option can be written, before the computation.
pub fn writable_file<'a>(option: &str, file: impl Into<Option<&'a Path>>) -> Result<(), InputError> {
    let Some(file) = file.into() else { return Ok(()) };
    check_file(file).map_err(|error| not_writable(option, file, "a file that can be written", &error))
}

/// The error for an option's file or folder that cannot be written.
pub fn not_writable(option: &str, given: &Path, allowed: &str, error: &WriteError) -> InputError {
    // The file is named in addition only if it is within the given folder.
    let within = if Path::new(&error.path) == given { String::new() } else { format!("{}: ", error.path) };
    let allowed = format!("{allowed} ({within}{})", error.source);
    InputError::not_allowed(option, option.trim_start_matches('-'), format!("{given:?}"), allowed)
}

/// Parses the number of an option.
///
/// # Errors
/// Gives the allowed values; clap adds the option and the value.
pub fn number(text: &str) -> Result<f64, String> {
    let finite = text.trim().parse().ok().filter(|number: &f64| number.is_finite());
    finite.ok_or_else(|| "must be a finite number, as 0.87 or 1e-3".to_owned())
}

/// Parses the seed of random numbers.
pub fn seed(text: &str) -> Result<u64, String> {
    text.trim().parse().map_err(|_| format!("must be a whole number from 0 to {}", u64::MAX))
}

/// Requires that all replicates have seeds: S, S+1, and so on.
pub fn check_seeds(seed: u64, replicates: u32) -> Result<(), InputError> {
    let largest = u64::MAX - u64::from(replicates.saturating_sub(1));
    let allowed = || format!("at most {largest} with --replicates {replicates}, which take the seeds S, S+1, ...");
    InputError::require(seed <= largest, "--seed", "seed", seed, allowed())
}

/// A number with a given number of digits, or a dash.
pub fn or_dash(value: Option<f64>, digits: usize) -> String {
    value.map_or("-".to_owned(), |value| format!("{value:.digits$}"))
}
