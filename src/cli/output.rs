//! The two streams of the command, and its files. An answer that cannot be written is an error; what cannot be said on stderr is lost, and
//! the exit code tells.

use super::error::CliError;
use super::interrupt;
use crate::input::InputError;
use crate::io::files::{WriteError, check_file, check_folder};
use crate::io::write_atomically;
use crate::study::Row;
use crate::study::table::csv_text;
use serde::Serialize;
use serde_json::Value;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// Writes records as CSV: of each the fields of these names, which `--json` has under the same, empty where it has none.
pub fn csv_rows<T: Serialize>(file: &Path, columns: &[&str], records: &[T]) -> Result<(), CliError> {
    write_atomically(file, &csv_of(columns, records)?)?;
    Ok(())
}

/// Records as CSV, as [`csv_rows`] writes them.
pub fn csv_of<T: Serialize>(columns: &[&str], records: &[T]) -> Result<Vec<u8>, CliError> {
    let names: Vec<String> = columns.iter().map(|name| (*name).to_owned()).collect();
    let mut rows = Vec::with_capacity(records.len());
    for (index, record) in records.iter().enumerate() {
        let record = serde_json::to_value(record)?;
        let cell = |name: &&str| match record.get(*name) {
            Some(Value::Bool(yes)) => Value::from(yes.to_string()),
            cell => cell.cloned().unwrap_or(Value::Null),
        };
        rows.push(Row { index, cells: columns.iter().map(cell).collect(), why: None });
    }
    Ok(csv_text(&names, &rows)?)
}

/// Writes the answer to stdout.
pub fn answer(text: &str) -> Result<(), CliError> {
    let mut stdout = io::stdout().lock();
    stdout.write_all(text.as_bytes())?;
    stdout.flush()?;
    Ok(())
}

/// Prints the answer: one JSON document, or text.
pub fn print<T: Serialize>(json: bool, document: &T, text: impl FnOnce() -> String) -> Result<(), CliError> {
    if json { print_json(document) } else { answer(&text()) }
}

/// Prints a JSON document.
pub fn print_json<T: Serialize>(document: &T) -> Result<(), CliError> {
    answer(&format!("{}\n", serde_json::to_string_pretty(document)?))
}

/// Says something on stderr. `eprintln!` would end the program where stderr is full or closed, and with it the run whose
/// files are still to be written.
pub fn say(text: &str) {
    let _ = Stderr.write_all(format!("furrow: {text}\n").as_bytes());
}

/// Stderr as a place for logs, to which writing always succeeds.
pub struct Stderr;

impl Write for Stderr {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        // The whole at once, so that lines of several threads do not mix.
        let _ = io::stderr().lock().write_all(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// Prints what the reader of the arguments has to say: help and version are answers, complaints are bad input.
pub fn explain(said: &clap::Error) -> Result<(), CliError> {
    let printed = said.print().and_then(|()| io::stdout().flush());
    if said.use_stderr() { Err(CliError::Usage) } else { Ok(printed?) }
}

/// Refuses a folder that files of these names cannot be written into, before the work that they are to keep.
pub fn writable_folder(option: &str, field: &str, folder: &Path, names: &[&str]) -> Result<(), InputError> {
    check_folder(folder, names)
        .map_err(|error| refused(option, field, folder, "a folder that can be written to", &error))
}

/// Refuses a file that cannot be written, before the work that it is to keep.
pub fn writable_file(option: &str, field: &str, file: &Path) -> Result<(), InputError> {
    check_file(file).map_err(|error| refused(option, field, file, "a file that can be written", &error))
}

/// The file of an option and its kind, which its name tells: refused if it is of no kind, or cannot be written.
pub fn file_of_kind<K>(
    option: &str,
    field: &str,
    file: &Path,
    kind: Option<K>,
    allowed: &str,
) -> Result<(PathBuf, K), InputError> {
    let kind = kind.ok_or_else(|| InputError::not_allowed(option, field, format!("{file:?}"), allowed))?;
    writable_file(option, field, file)?;
    Ok((file.to_owned(), kind))
}

/// Writes a picture or a movie whole; an interruption waits for it.
pub fn write_unbroken(file: &Path, bytes: &[u8]) -> Result<(), CliError> {
    interrupt::unbroken(|| write_atomically(file, bytes))?;
    Ok(())
}

fn refused(option: &str, field: &str, given: &Path, allowed: &str, error: &WriteError) -> InputError {
    // Named only if it is not what the user named: a file in that folder.
    let within = if Path::new(&error.path) == given { String::new() } else { format!("{}: ", error.path) };
    InputError::not_allowed(option, field, format!("{given:?}"), format!("{allowed} ({within}{})", error.source))
}
