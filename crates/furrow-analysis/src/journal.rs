//! Finished rows of a sweep or a sample under way, from which an interrupted one resumes.
//!
//! The first line of the file holds the definition of the sweep, every further line one row, appended as soon as it is solved.
//! A kill in mid-write leaves a torn last line, which is dropped.

use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::sync::{Mutex, PoisonError};

use super::table::{Row, json_lines, read_line};
use furrow_formats::files::WriteError;
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Name of the file in the folder of a sweep; it goes when the sweep is complete.
pub(crate) const JOURNAL: &str = "results.partial.jsonl";

/// The finished rows of an unfinished sweep.
#[derive(Debug)]
pub struct Journal {
    path: PathBuf,
    columns: Vec<String>,
    /// The rows that an interrupted run finished, by index.
    pub rows: BTreeMap<usize, Row>,
    /// The file, locked and positioned at its end; or the reason why a row could not be written. After that no row is written.
    file: Mutex<io::Result<File>>,
}

impl Journal {
    /// Opens the journal of a folder, or creates one. A journal of another sweep is refused: its rows would be lost.
    ///
    /// # Errors
    /// [`WriteError`], also where another run holds the journal, or another sweep filled it.
    pub fn open(folder: &Path, definition: &Value, columns: Vec<String>) -> Result<Journal, WriteError> {
        Journal::open_file(&folder.join(JOURNAL), definition, columns)
    }

    /// The same with a file of another name.
    ///
    /// # Errors
    /// As [`open`](Self::open).
    pub fn open_file(path: &Path, definition: &Value, columns: Vec<String>) -> Result<Journal, WriteError> {
        let (path, folder) = (path.to_owned(), path.parent().unwrap_or(Path::new("")));
        let failed = |source: io::Error| WriteError { path: path.display().to_string(), source };
        // The folder of a name alone is the working folder, and has no name.
        let named = !folder.as_os_str().is_empty();
        if named {
            fs::create_dir_all(folder).map_err(failed)?;
        }
        let (mut file, text) = lock_and_read(&path).map_err(failed)?;
        let head = whole_lines(&text).next().map(serde_json::from_slice::<Value>);
        if head.is_some_and(|head| !head.is_ok_and(|head| same_sweep(&head, definition))) {
            return Err(failed(io::Error::other(
                "holds finished rows of another run; write to another place, or remove the file",
            )));
        }
        let mut valid = whole_lines(&text).next().map_or(0, <[u8]>::len);
        let mut rows = BTreeMap::new();
        for line in whole_lines(&text).skip(1) {
            let row = str::from_utf8(line).ok().and_then(|line| read_line(&columns, line));
            let Some(row) = row else { break };
            valid += line.len();
            rows.insert(row.index, row);
        }
        let prepare = |file: &mut File| -> io::Result<()> {
            file.set_len(valid as u64)?;
            file.seek(SeekFrom::End(0))?;
            if valid == 0 { file.write_all(format!("{definition}\n").as_bytes()) } else { Ok(()) }
        };
        prepare(&mut file).map_err(failed)?;
        Ok(Journal { path, columns, rows, file: Mutex::new(Ok(file)) })
    }

    /// Appends a finished row. After the first failure it appends no further rows, and [`finish`](Self::finish) reports the failure.
    pub fn append(&self, row: &Row) {
        let mut file = self.file.lock().unwrap_or_else(PoisonError::into_inner);
        let Ok(open) = file.as_mut() else { return };
        if let Err(error) = open.write_all(json_lines(&self.columns, std::slice::from_ref(row)).as_bytes()) {
            *file = Err(error);
        }
    }

    /// Removes the file, once the results are written.
    ///
    /// # Errors
    /// Why it cannot be removed, or why rows could not be appended.
    pub fn finish(self) -> Result<(), WriteError> {
        // Closed before it is removed, which some systems insist on.
        let closed = self.file.into_inner().unwrap_or_else(PoisonError::into_inner).map(drop);
        let done = closed.and(fs::remove_file(&self.path));
        done.map_err(|source| WriteError { path: self.path.display().to_string(), source })
    }
}

fn lock_and_read(path: &Path) -> io::Result<(File, Vec<u8>)> {
    let mut file = OpenOptions::new().read(true).write(true).create(true).truncate(false).open(path)?;
    match file.try_lock() {
        Err(TryLockError::WouldBlock) => return Err(io::Error::other("another run is writing it")),
        // File systems without locks are no reason to refuse a sweep.
        Err(TryLockError::Error(_)) | Ok(()) => {}
    }
    let mut text = Vec::new();
    file.read_to_end(&mut text)?;
    Ok((file, text))
}

/// Whether two definitions are of one sweep, whichever build of the program wrote them.
fn same_sweep(a: &Value, b: &Value) -> bool {
    let plain = |definition: &Value| {
        let mut definition = definition.clone();
        definition.as_object_mut().map(|fields| fields.remove("provenance"));
        definition
    };
    plain(a) == plain(b)
}

/// The lines that end with a line break.
fn whole_lines(text: &[u8]) -> impl Iterator<Item = &[u8]> {
    text.split_inclusive(|byte| *byte == b'\n').filter(|line| line.ends_with(b"\n"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn torn_lines_are_dropped_and_another_sweep_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let at = folder.path();
        let columns = vec!["r0".to_owned()];
        let open = |definition: Value| Journal::open(at, &definition, columns.clone());
        let row = |index: usize| Row { index, cells: vec![0.1.into()], why: None };
        let journal = open(json!({"a": 1})).unwrap();
        (0..3).for_each(|index| journal.append(&row(index)));
        assert!(open(json!({"a": 1})).unwrap_err().to_string().contains("another run"));
        drop(journal);
        let path = at.join(JOURNAL);
        let whole = fs::read(&path).unwrap();
        for cut in 0..whole.len() {
            fs::write(&path, &whole[..cut]).unwrap();
            let journal = open(json!({"a": 1})).unwrap();
            let rows = journal.rows.len();
            let lines = whole[..cut].iter().filter(|byte| **byte == b'\n').count();
            assert_eq!(rows, lines.saturating_sub(1));
            (rows..3).for_each(|index| journal.append(&row(index)));
            drop(journal);
            assert_eq!(fs::read(&path).unwrap(), whole, "cut at {cut}");
        }
        assert!(open(json!({"a": 2})).unwrap_err().to_string().contains("another run; write"));
        open(json!({"a": 1, "provenance": 1})).unwrap().finish().unwrap();
        assert!(!path.exists());
    }
}
