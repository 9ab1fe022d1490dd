//! Inspecting, repairing and clearing the database of a cache folder.

use std::path::{Path, PathBuf};

use rusqlite::{Connection, config::DbConfig, types::Value};
use serde::Serialize;

use super::{
    StoreError,
    row::WIDTH,
    sqlite::{FILE, connect, create_table, decoded, failed, file_in, write},
};
use crate::batch::SOLVER_VERSION;

/// The contents of a cache folder.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct CacheReport {
    /// The cache folder.
    pub folder: PathBuf,
    /// Valid entries that this version of furrow uses.
    pub entries: usize,
    /// Valid entries of other versions of the solver, which are kept but not used.
    pub other_versions: usize,
    /// Size of the database and its log, in bytes.
    pub bytes: u64,
    /// Descriptions of damaged entries and of other damage to the file.
    pub corrupt: usize,
    /// Number of damaged entries.
    pub damaged: Vec<String>,
}

/// A report, and the valid rows that it counts.
type Contents = (CacheReport, Vec<Vec<Value>>);

/// Checks every entry of a cache folder. A folder that does not exist counts as empty.
///
/// # Errors
/// [`StoreError`] if the path is not a folder, or its database is from a newer version of furrow.
pub fn verify(cache: &Path) -> Result<CacheReport, StoreError> {
    contents(cache).map(|(report, _)| report)
}

/// Removes damaged entries from a cache folder and reports what was found. Valid entries are kept.
///
/// # Errors
/// As [`verify`], and if the database cannot be written.
pub fn repair(cache: &Path) -> Result<CacheReport, StoreError> {
    let (report, rows) = contents(cache)?;
    if report.corrupt > 0 {
        rewrite(&file_in(cache)?, &rows)?;
    }
    Ok(report)
}

/// Removes all entries of every version from a cache folder and reports its previous contents. Processes that use the folder
/// continue.
///
/// # Errors
/// As [`repair`].
pub fn clear(cache: &Path) -> Result<CacheReport, StoreError> {
    let report = verify(cache)?;
    let file = file_in(cache)?;
    if file.exists() {
        rewrite(&file, &[])?;
    }
    Ok(report)
}

fn contents(cache: &Path) -> Result<Contents, StoreError> {
    let file = file_in(cache)?;
    let mut contents = Contents::default();
    let damaged = match connect(&file) {
        Ok(None) => Ok(()),
        Ok(Some(connection)) => read(&connection, &mut contents),
        Err(StoreError::Sqlite { source, .. }) => Err(source),
        Err(error) => return Err(error),
    };
    let (report, _) = &mut contents;
    report.damaged.extend(damaged.err().map(|error| error.to_string()));
    report.folder = cache.to_owned();
    let log = cache.join(format!("{FILE}-wal"));
    report.bytes = [file, log].iter().filter_map(|file| file.metadata().ok()).map(|file| file.len()).sum();
    report.corrupt = report.damaged.len();
    Ok(contents)
}

/// Reads as many rows as can be read.
fn read(connection: &Connection, contents: &mut Contents) -> rusqlite::Result<()> {
    let (report, rows) = contents;
    let mut statement = connection.prepare("SELECT * FROM division")?;
    let mut found = statement.query(())?;
    while let Some(row) = found.next()? {
        if decoded(row)?.is_none() {
            let key = row.get_ref("key")?.as_blob().unwrap_or_default();
            report.damaged.push(format!("row {}", key.iter().map(|byte| format!("{byte:02x}")).collect::<String>()));
            continue;
        }
        let entry = (0..WIDTH).map(|place| row.get(place)).collect::<Result<Vec<Value>, _>>()?;
        let current = row.get_ref("solver")?.as_i64() == Ok(SOLVER_VERSION.into());
        *(if current { &mut report.entries } else { &mut report.other_versions }) += 1;
        rows.push(entry);
    }
    let mut statement = connection.prepare("PRAGMA integrity_check(20)")?;
    let problems = statement.query_map((), |row| row.get::<_, String>(0))?.collect::<Result<Vec<_>, _>>()?;
    report.damaged.extend(problems.into_iter().filter(|problem| problem != "ok"));
    Ok(())
}

/// Replaces the rows of a database by `rows`.
fn rewrite(file: &Path, rows: &[Vec<Value>]) -> Result<(), StoreError> {
    let failed = failed(file);
    let mended = connect(file).and_then(|connection| {
        let Some(connection) = connection else { return Ok(()) };
        write(&connection, "DELETE FROM division; DROP TABLE IF EXISTS radius", rows).map_err(failed)?;
        connection.execute_batch("VACUUM").map_err(failed)
    });
    match mended {
        // The file cannot be repaired, so it is cleared.
        Err(StoreError::Sqlite { source, .. })
            if source.sqlite_error_code() != Some(rusqlite::ErrorCode::DatabaseBusy) =>
        {
            let connection = Connection::open(file).map_err(failed)?;
            let reset = |on| connection.set_db_config(DbConfig::SQLITE_DBCONFIG_RESET_DATABASE, on).map_err(failed);
            reset(true)?;
            connection.execute_batch("VACUUM").map_err(failed)?;
            reset(false)?;
            create_table(&connection).and_then(|()| write(&connection, "", rows)).map_err(failed)
        }
        result => result,
    }
}
