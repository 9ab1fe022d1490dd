//! Looking after a cache folder: what is in it, whether it is whole, and emptying it.

use std::{
    collections::{BTreeSet, HashSet},
    fs, io,
    path::{Path, PathBuf},
};

use serde::Serialize;

use super::{
    StoreError, claims,
    log::Log,
    slot::{LAYOUT, SLOT},
};
use crate::batch::{Record, SolverVersion};

/// Folder of the claims inside that of the logs.
pub(super) const CLAIMS: &str = "claims";

/// File of a solver's records.
pub(super) fn file_name(solver: SolverVersion) -> String {
    format!("{:016x}.{}", solver.number(), suffix())
}

fn suffix() -> String {
    format!("v{LAYOUT}.log")
}

/// What a cache folder holds.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct CacheReport {
    /// The cache folder.
    pub folder: PathBuf,
    /// Whole entries that this version of furrow uses.
    pub entries: usize,
    /// Whole entries of other versions; kept, not used.
    pub other_versions: usize,
    /// Size of all entries stored, in bytes.
    pub bytes: u64,
    /// Damaged entries, of any version.
    pub corrupt: usize,
    /// Where they are.
    pub damaged: Vec<DamagedEntry>,
    /// Entries that say again what an earlier one says.
    pub duplicates: usize,
}

/// A damaged entry.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct DamagedEntry {
    /// Its file.
    pub file: PathBuf,
    /// Where in the file it starts, in bytes.
    pub offset: u64,
}

/// Reads and checks every entry of a kind in a cache folder. A folder that does not exist holds none.
///
/// # Errors
/// [`StoreError`] if the folder or a file in it cannot be read.
pub fn verify<R: Record>(cache: &Path, solver: SolverVersion) -> Result<CacheReport, StoreError> {
    let mut report = CacheReport { folder: cache.to_owned(), ..CacheReport::default() };
    for path in logs::<R>(cache)? {
        let io_error = |source| StoreError::Io { path: path.clone(), source };
        let Some(mut log) = Log::open(&path).map_err(io_error)? else { continue };
        let slots = log.refresh::<R>().map_err(io_error)?;
        report.bytes += log.bytes().map_err(io_error)?;
        let distinct = slots.records.iter().map(|(key, _)| key).collect::<HashSet<_>>().len();
        report.duplicates += slots.records.len() - distinct;
        if path.file_name().is_some_and(|name| *name == *file_name(solver)) {
            report.entries += distinct;
        } else {
            report.other_versions += distinct;
        }
        let places = slots.damaged.into_iter();
        report.damaged.extend(places.map(|place| DamagedEntry { file: path.clone(), offset: place * SLOT as u64 }));
    }
    report.corrupt = report.damaged.len();
    Ok(report)
}

/// Gives up the damaged entries of a kind in a cache folder, so that they are not reported again, and says what was found. Whole
/// entries are not touched.
///
/// # Errors
/// [`StoreError`] if a file cannot be read or written.
pub fn repair<R: Record>(cache: &Path, solver: SolverVersion) -> Result<CacheReport, StoreError> {
    let report = verify::<R>(cache, solver)?;
    let files: BTreeSet<&PathBuf> = report.damaged.iter().map(|entry| &entry.file).collect();
    for path in files {
        let io_error = |source| StoreError::Io { path: path.clone(), source };
        if let Some(mut log) = Log::open(path).map_err(io_error)? {
            log.repair::<R>().map_err(io_error)?;
        }
    }
    Ok(report)
}

/// Empties a cache folder of all entries of a kind, of every version, and says what was in it. Other files are not touched, and
/// processes at work on the folder go on.
///
/// # Errors
/// [`StoreError`] if a file cannot be read or emptied.
pub fn clear<R: Record>(cache: &Path, solver: SolverVersion) -> Result<CacheReport, StoreError> {
    let report = verify::<R>(cache, solver)?;
    for path in logs::<R>(cache)? {
        let io_error = |source| StoreError::Io { path: path.clone(), source };
        // Emptied, not removed: a process that has it open would go on writing to a file that nobody else sees.
        if let Some(mut log) = Log::open(&path).map_err(io_error)? {
            log.clear().map_err(io_error)?;
        }
    }
    let folder = cache.join(R::FOLDER).join(CLAIMS);
    claims::sweep(&folder).map_err(|source| StoreError::Io { path: folder, source })?;
    Ok(report)
}

/// The logs of this layout in a cache folder, of all solvers, in the order of their names.
fn logs<R: Record>(cache: &Path) -> Result<Vec<PathBuf>, StoreError> {
    if cache.exists() && !cache.is_dir() {
        return Err(StoreError::NotAFolder { folder: cache.to_owned() });
    }
    let folder = cache.join(R::FOLDER);
    let list = || -> io::Result<Vec<PathBuf>> {
        let mut paths = Vec::new();
        for entry in fs::read_dir(&folder)? {
            let path = entry?.path();
            let name = path.file_name().unwrap_or_default().to_string_lossy();
            if name.ends_with(&format!(".{}", suffix())) {
                paths.push(path);
            }
        }
        paths.sort();
        Ok(paths)
    };
    match list() {
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(Vec::new()),
        result => result.map_err(|source| StoreError::Io { path: folder.clone(), source }),
    }
}
