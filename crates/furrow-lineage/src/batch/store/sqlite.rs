//! Reading and writing the database.

use std::collections::HashSet;
use std::io;
use std::mem::ManuallyDrop;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use rusqlite::{Connection, ErrorCode, OpenFlags, params_from_iter, types::Value};

use super::StoreWarning;
use super::row::{COLUMNS, WIDTH, decode, encode, in_range};
use crate::batch::{Key, SOLVER_VERSION};
use furrow_mechanics::critical::Archive;
use furrow_mechanics::division::{Division, DivisionInput};

/// Name of the database in the cache folder.
pub const FILE: &str = "furrow.sqlite";

/// Version of the table, the database's `user_version`.
const SCHEMA: i64 = 6;

/// Longest wait for a lock of another process. A running process holds it for milliseconds.
const PATIENCE: Duration = Duration::from_secs(5);

/// Solved divisions in a cache folder.
///
/// # Examples
/// A run reuses the divisions that an earlier run has solved:
///
/// ```
/// use furrow_lineage::batch::{Memo, Quantisation, SchedulerOptions, Store, replicates};
/// use furrow_cell::Cell;
/// use furrow_mechanics::division::DivisionInput;
/// let folder = tempfile::tempdir()?;
/// let input = DivisionInput::new(Cell::new(3.0));
/// let mut solved = Vec::new();
/// for _ in 0..2 {
///     let memo = Memo::new(Quantisation::DEFAULT).with_store(Store::open(folder.path())?);
///     solved.push(replicates(&input, 1, &memo, &SchedulerOptions::default())?.summary.solved);
/// }
/// assert_eq!(solved, [1, 0]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct Store {
    file: PathBuf,
    solver: u32,
    /// The process that opened it: a connection must not be used in a forked one.
    process: u32,
    /// Rows to be written. The thread that gets the connection writes all of them in one transaction.
    pending: Mutex<Vec<Vec<Value>>>,
    inner: Mutex<Inner>,
}

#[derive(Debug, Default)]
struct Inner {
    /// Reads the file without locks or log, until the first missing row. A row with a matching checksum is valid even
    /// if the file changes meanwhile. It is never closed, because that would release the locks of this process's other connections.
    snapshot: Option<ManuallyDrop<Connection>>,
    /// Open once the file exists and the snapshot does not suffice.
    connection: Option<Connection>,
    unreadable: bool,
    unwritable: bool,
    damaged: HashSet<Key>,
    /// Damaged rows that have not been reported yet.
    unnamed: usize,
    warnings: Vec<StoreWarning>,
    /// The last of them that says that the store is no longer used.
    given_up: Option<StoreWarning>,
}

/// The reason why a store cannot be used.
#[expect(missing_docs, reason = "the messages say what the fields are")]
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum StoreError {
    /// The cache folder is not a folder.
    #[error("the cache {folder} is not a folder")]
    NotAFolder { folder: PathBuf },
    /// The table is from a newer version of furrow.
    #[error("{file} is from a newer version of furrow (schema {schema}, known here: {SCHEMA}); it is left alone")]
    Newer { file: PathBuf, schema: i64 },
    /// SQLite could not read or write.
    #[error("{file}: {source}")]
    Sqlite { file: PathBuf, source: rusqlite::Error },
    /// The file could not be created.
    #[error("{file}: {source}")]
    Io { file: PathBuf, source: io::Error },
}

impl Store {
    /// The store in a cache folder. The file is opened at the first look-up; the file and its folder are created at the first
    /// commit.
    ///
    /// # Errors
    /// [`StoreError::NotAFolder`]. All other problems are warnings of the run.
    pub fn open(cache: &Path) -> Result<Store, StoreError> {
        Store::of_solver(cache, SOLVER_VERSION)
    }

    pub(super) fn of_solver(cache: &Path, solver: u32) -> Result<Store, StoreError> {
        let (file, process) = (file_in(cache)?, std::process::id());
        Ok(Store { file, solver, process, pending: Mutex::default(), inner: Mutex::default() })
    }

    /// Looks a division up.
    pub fn get(&self, key: &Key) -> Option<Division> {
        let mut inner = self.lock()?;
        if inner.unreadable {
            return None;
        }
        self.read(&mut inner, key).unwrap_or_else(|error| {
            inner.unreadable = true;
            self.give_up(&mut inner, "read", &error);
            None
        })
    }

    /// Writes a division. After this returns, killing a process cannot lose the division, unless a warning reports that the store
    /// could not be written.
    pub fn commit(&self, key: &Key, input: &DivisionInput, division: &Division) {
        if !in_range(division) {
            return;
        }
        let row = encode(key, self.solver, input, division);
        unpoisoned(&self.pending).push(row);
        let Some(mut inner) = self.lock() else { return };
        let rows = std::mem::take(&mut *unpoisoned(&self.pending));
        if rows.is_empty() || inner.unreadable || inner.unwritable {
            return;
        }
        if let Err(error) = self.write(&mut inner, &rows) {
            self.give_up(&mut inner, "write", &error);
        }
    }

    /// Number of rows with a wrong checksum so far.
    pub fn damaged(&self) -> usize {
        self.lock().map_or(0, |inner| inner.damaged.len())
    }

    /// Why the store is no longer read or written, if it is not: also where [`take_warnings`](Self::take_warnings) has said so.
    pub fn given_up(&self) -> Option<StoreWarning> {
        self.lock()?.given_up.clone()
    }

    /// The warnings since the last call.
    pub fn take_warnings(&self) -> Vec<StoreWarning> {
        let Some(mut inner) = self.lock() else { return Vec::new() };
        let mut warnings = std::mem::take(&mut inner.warnings);
        let entries = std::mem::take(&mut inner.unnamed);
        if entries > 0 {
            warnings.push(StoreWarning::Damaged { entries, file: self.file.clone() });
        }
        warnings
    }

    fn read(&self, inner: &mut Inner, key: &Key) -> Result<Option<Division>, StoreError> {
        if inner.connection.is_none() {
            if inner.snapshot.is_none() && self.file.exists() {
                inner.snapshot = immutable(&self.file).ok().map(ManuallyDrop::new);
            }
            let found = inner.snapshot.as_ref().map(|snapshot| self.find(snapshot, key));
            if let Some(Ok(Some(Some(division)))) = found {
                return Ok(Some(division));
            }
            inner.snapshot = None;
            inner.connection = connect(&self.file)?;
        }
        let Some(connection) = &inner.connection else { return Ok(None) };
        let found = self.find(connection, key).map_err(failed(&self.file))?;
        if found == Some(None) && inner.damaged.insert(*key) {
            inner.unnamed += 1;
        }
        Ok(found.flatten())
    }

    /// The row, if it exists, and its division, unless the row is damaged.
    fn find(&self, connection: &Connection, key: &Key) -> rusqlite::Result<Option<Option<Division>>> {
        let mut statement = connection.prepare_cached("SELECT * FROM division WHERE key = ?1 AND solver = ?2")?;
        let mut rows = statement.query((key.as_bytes(), self.solver))?;
        rows.next()?.map(decoded).transpose()
    }

    fn write(&self, inner: &mut Inner, rows: &[Vec<Value>]) -> Result<(), StoreError> {
        let Some(connection) = self.for_writing(inner)? else { return Ok(()) };
        write(connection, "", rows).map_err(failed(&self.file))
    }

    /// The connection for writing. Creates the file if necessary.
    fn for_writing<'c>(&self, inner: &'c mut Inner) -> Result<Option<&'c Connection>, StoreError> {
        if inner.connection.is_none() {
            if !self.file.exists() {
                create(&self.file)?;
            }
            inner.connection = connect(&self.file)?;
        }
        Ok(inner.connection.as_ref())
    }

    fn give_up(&self, inner: &mut Inner, access: &'static str, error: &StoreError) {
        let reason = match error {
            StoreError::Sqlite { source, .. } => match source.sqlite_error_code() {
                // `Unknown` means that the table is missing or different.
                Some(ErrorCode::DatabaseCorrupt | ErrorCode::NotADatabase | ErrorCode::Unknown) => {
                    format!("{source}: `furrow cache verify --repair` mends it")
                }
                _ => source.to_string(),
            },
            StoreError::Io { source, .. } => source.to_string(),
            other => other.to_string(),
        };
        inner.unwritable = true;
        let warning = StoreWarning::GivenUp { access, file: self.file.clone(), reason };
        inner.given_up = Some(warning.clone());
        inner.warnings.push(warning);
    }

    /// `None` in a process that was forked from the one that opened the store.
    fn lock(&self) -> Option<MutexGuard<'_, Inner>> {
        (self.process == std::process::id()).then(|| unpoisoned(&self.inner))
    }
}

/// Critical radii, in a second table: JSON texts of the search and its result, and a checksum.
impl Archive for Store {
    fn get(&self, search: &str) -> Option<String> {
        let mut inner = self.lock()?;
        if inner.unreadable || !self.file.exists() {
            return None;
        }
        if inner.connection.is_none() {
            inner.connection = connect(&self.file).ok()?;
        }
        let select = "SELECT found, checksum FROM radius WHERE search = ?1 AND solver = ?2";
        // The table does not exist before the first radius is stored.
        let mut statement = inner.connection.as_ref()?.prepare_cached(select).ok()?;
        let row = statement.query_row((search, self.solver), |row| Ok((row.get(0)?, row.get(1)?)));
        let (found, sum): (String, i64) = row.ok()?;
        (sum == sum_of(search, &found)).then_some(found)
    }

    fn put(&self, search: &str, found: &str) {
        let Some(mut inner) = self.lock() else { return };
        if inner.unreadable || inner.unwritable {
            return;
        }
        let row = (search, self.solver, found, sum_of(search, found));
        let kept = self.for_writing(&mut inner).and_then(|connection| {
            let Some(connection) = connection else { return Ok(()) };
            let kept = || {
                connection.execute_batch(RADIUS_TABLE)?;
                connection.execute("REPLACE INTO radius VALUES (?1, ?2, ?3, ?4)", row)
            };
            kept().map(drop).map_err(failed(&self.file))
        });
        if let Err(error) = kept {
            self.give_up(&mut inner, "write", &error);
        }
    }
}

const RADIUS_TABLE: &str =
    "CREATE TABLE IF NOT EXISTS radius (search, solver, found, checksum, PRIMARY KEY (search, solver)) WITHOUT ROWID";

fn sum_of(search: &str, found: &str) -> i64 {
    let hash = blake3::hash([search, found].join("\n").as_bytes());
    i64::from_le_bytes(std::array::from_fn(|k| hash.as_bytes()[k]))
}

impl Drop for Store {
    fn drop(&mut self) {
        if self.process != std::process::id() {
            // Closing it here would remove the log that the parent writes to.
            let inner = self.inner.get_mut().unwrap_or_else(PoisonError::into_inner);
            std::mem::forget(inner.connection.take());
        }
    }
}

/// Converts an error of SQLite.
pub(super) fn failed(file: &Path) -> impl Fn(rusqlite::Error) -> StoreError + Copy + '_ {
    |source| StoreError::Sqlite { file: file.to_owned(), source }
}

fn unpoisoned<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    // No code panics while it holds a lock, and the rows would be valid even then.
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// The database in a cache folder.
pub(super) fn file_in(cache: &Path) -> Result<PathBuf, StoreError> {
    if cache.exists() && !cache.is_dir() {
        return Err(StoreError::NotAFolder { folder: cache.to_owned() });
    }
    Ok(cache.join(FILE))
}

/// Opens a database; `None` if there is no file.
pub(super) fn connect(file: &Path) -> Result<Option<Connection>, StoreError> {
    if !file.exists() {
        return Ok(None);
    }
    let flags = OpenFlags::SQLITE_OPEN_READ_WRITE | OpenFlags::SQLITE_OPEN_NO_MUTEX;
    let connection = Connection::open_with_flags(file, flags).map_err(failed(file))?;
    connection.busy_timeout(PATIENCE).map_err(failed(file))?;
    match checked(&connection, file) {
        // A read-only folder cannot hold the log of a database, and its database does not change.
        Err(StoreError::Sqlite { source, .. })
            if matches!(source.sqlite_error_code(), Some(ErrorCode::CannotOpen | ErrorCode::ReadOnly)) =>
        {
            immutable(file).map(Some)
        }
        result => result.map(|()| Some(connection)),
    }
}

/// Opens a database that cannot change, without its log.
fn immutable(file: &Path) -> Result<Connection, StoreError> {
    let flags = OpenFlags::SQLITE_OPEN_READ_ONLY | OpenFlags::SQLITE_OPEN_NO_MUTEX | OpenFlags::SQLITE_OPEN_URI;
    let name = file.to_string_lossy().replace('%', "%25").replace('?', "%3f").replace('#', "%23");
    let connection = Connection::open_with_flags(format!("file:{name}?immutable=1"), flags).map_err(failed(file))?;
    checked(&connection, file).map(|()| connection)
}

/// Rejects a table from a newer version of furrow.
fn checked(connection: &Connection, file: &Path) -> Result<(), StoreError> {
    match connection.pragma_query_value(None, "user_version", |row| row.get(0)).map_err(failed(file))? {
        SCHEMA | 0 => Ok(()),
        1..SCHEMA => set_aside(connection).map_err(failed(file)),
        schema => Err(StoreError::Newer { file: file.to_owned(), schema }),
    }
}

/// Renames the table of an older version, and creates one of this version.
fn set_aside(connection: &Connection) -> rusqlite::Result<()> {
    connection.execute_batch("BEGIN IMMEDIATE")?;
    let replaced = connection.pragma_query_value(None, "user_version", |row| row.get::<_, i64>(0)).and_then(|schema| {
        // Unless another process has done so meanwhile.
        let rename = match schema {
            SCHEMA => String::new(),
            older => format!("ALTER TABLE division RENAME TO division_{older};"),
        };
        connection.execute_batch(&format!("{rename} {}; COMMIT", table()))
    });
    replaced.inspect_err(|_| {
        // The first error is the one to report.
        let _ = connection.execute_batch("ROLLBACK");
    })
}

/// Creates the database and its folder atomically: other processes see either nothing or the complete database.
fn create(file: &Path) -> Result<(), StoreError> {
    let failed = |source| StoreError::Io { file: file.to_owned(), source };
    let folder = file.parent().unwrap_or(Path::new("."));
    std::fs::create_dir_all(folder).map_err(failed)?;
    let new = tempfile::Builder::new().prefix(".furrow-").suffix(".sqlite").tempfile_in(folder).map_err(failed)?;
    let new = new.into_temp_path();
    let made = || -> rusqlite::Result<()> {
        let connection = Connection::open(&new)?;
        create_table(&connection)?;
        connection.close().map_err(|(_, error)| error)
    };
    made().map_err(self::failed(file))?;
    match new.persist_noclobber(file) {
        // Another process has created it first.
        Err(error) if error.error.kind() == io::ErrorKind::AlreadyExists => Ok(()),
        result => result.map_err(|error| failed(error.error)),
    }
}

/// Initialises an empty database.
pub(super) fn create_table(connection: &Connection) -> rusqlite::Result<()> {
    connection.execute_batch(&format!("PRAGMA journal_mode = WAL; BEGIN; {}; COMMIT;", table()))
}

/// The statements that create the table.
fn table() -> String {
    format!(
        "CREATE TABLE IF NOT EXISTS division ({COLUMNS}, PRIMARY KEY (key, solver)) WITHOUT ROWID; \
         PRAGMA user_version = {SCHEMA}"
    )
}

/// The division of a row; `None` if the row is damaged.
pub(super) fn decoded(row: &rusqlite::Row<'_>) -> rusqlite::Result<Option<Division>> {
    let values = (0..WIDTH).map(|place| row.get_ref(place)).collect::<Result<Vec<_>, _>>()?;
    Ok(decode(&values))
}

/// Writes rows in one transaction, after the statement `first`.
pub(super) fn write(connection: &Connection, first: &str, rows: &[Vec<Value>]) -> rusqlite::Result<()> {
    // A power failure may lose the last transactions but does not damage the file.
    connection.execute_batch("PRAGMA synchronous = NORMAL; BEGIN IMMEDIATE")?;
    let places = vec!["?"; WIDTH].join(", ");
    let written = || -> rusqlite::Result<()> {
        connection.execute_batch(first)?;
        let mut statement = connection.prepare_cached(&format!("REPLACE INTO division VALUES ({places})"))?;
        rows.iter().try_for_each(|row| statement.execute(params_from_iter(row)).map(drop))?;
        connection.execute_batch("COMMIT")
    };
    written().inspect_err(|_| {
        // The first error is the one to report.
        let _ = connection.execute_batch("ROLLBACK");
    })
}
