//! The store: records kept in the cache folder, for the next run and for other processes now.
//!
//! # Why a log of its own
//! The store holds some hundreds to some hundred thousand small records of equal size, is read whole at the start, and
//! must be written by several processes at once. Embedded databases such as redb, sled or fjall let one process in and
//! lock out the rest; SQLite and LMDB share, at the price of a C library. What is needed here is less than either: one
//! append-only file for each version of the solver, `<kind>/<solver>.v1.log`, of 256-byte slots that each carry a
//! checksum, under advisory locks of the standard library. What it withstands:
//!
//! - *Several processes.* An append takes the exclusive lock, reads what others have appended, and drops the record if
//!   its key is among them. Claims (`<kind>/claims/`) keep two processes from solving the same task.
//! - *A kill at any moment.* Locks and claims vanish with their process. A record is in the page cache when it counts as
//!   committed; a torn one is a partial slot at the end, overwritten by the next. (A power cut may cost the last seconds.)
//! - *A full disk.* The first failed write is reported, and the run goes on without storing.
//! - *Damage.* A slot whose checksum fails is skipped and counted; its task is solved again. Slots stand at
//!   multiples of their size, so damage never spreads to the next.
//! - *Other versions.* Each solver and each layout has a file of its own; foreign files are left alone.

mod claims;
mod log;
mod slot;
pub mod upkeep;

use std::{
    collections::BTreeSet,
    fs, io,
    path::{Path, PathBuf},
    sync::{Arc, Mutex, MutexGuard, PoisonError, RwLock, RwLockReadGuard},
    time::Duration,
};

pub use claims::Claim;
pub use slot::PAYLOAD;
pub use upkeep::{CacheReport, DamagedEntry};

use self::log::{Log, Slots};
use super::{
    key::{Key, KeyMap, SolverVersion},
    task::Record,
};

/// Records in a cache folder.
///
/// # Examples
/// What one run has solved, the next one finds:
///
/// ```
/// use furrow::batch::{Memo, Quantisation, SchedulerOptions, SolverVersion, Store, replicates};
/// use furrow::cell::Cell;
/// use furrow::division::DivisionInput;
/// let folder = tempfile::tempdir()?;
/// let input = DivisionInput::new(Cell::new(3.0));
/// let mut solved = Vec::new();
/// for _ in 0..2 {
///     let store = Store::open(folder.path(), SolverVersion::current())?;
///     let memo = Memo::new(Quantisation::DEFAULT).with_store(store);
///     solved.push(replicates(&input, 1, &memo, &SchedulerOptions::default())?.summary.solved);
/// }
/// assert_eq!(solved, [1, 0]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct Store<R> {
    /// The folder of the logs, inside the cache folder.
    folder: PathBuf,
    path: PathBuf,
    /// Apart from the file, so that no look-up waits for a disk.
    entries: RwLock<KeyMap<Arc<R>>>,
    inner: Mutex<Inner>,
    patience: Duration,
}

#[derive(Debug, Default)]
struct Inner {
    /// Open once the file exists.
    log: Option<Log>,
    damaged: BTreeSet<u64>,
    /// Set by the first failure to write; nothing is written after it.
    broken: bool,
    committed: usize,
    duplicates: usize,
    warnings: Vec<StoreWarning>,
}

/// Why a store cannot be used.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum StoreError {
    /// The cache folder is something else.
    #[error("the cache {folder} is not a folder")]
    NotAFolder {
        /// The path given.
        folder: PathBuf,
    },
    /// Reading, locking or clearing failed.
    #[error("{path}: {source}")]
    Io {
        /// The file or folder.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
}

/// What the user of a store should know; nothing is lost by it but work.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum StoreWarning {
    /// Entries were passed over.
    #[error("{} in {} ignored, and solved again when needed", damaged_entries(*.entries), .file.display())]
    Damaged {
        /// How many.
        entries: usize,
        /// The file they are in.
        file: PathBuf,
    },
    /// The store could not be read or written.
    #[error("cannot {} the store in {} ({reason}); going on without storing", .access.verb(), .folder.display())]
    GivenUp {
        /// What failed.
        access: Access,
        /// Folder of the store.
        folder: PathBuf,
        /// What the system said.
        reason: String,
    },
}

fn damaged_entries(number: usize) -> String {
    format!("{number} damaged {}", if number == 1 { "entry" } else { "entries" })
}

/// What a store does with its files.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Access {
    /// It reads them.
    Read,
    /// It appends to them, or claims a key.
    Write,
}

impl Access {
    fn verb(self) -> &'static str {
        match self {
            Access::Read => "read",
            Access::Write => "write",
        }
    }
}

/// Whether this process is to solve a task.
#[derive(Debug)]
pub enum Claimed<R> {
    /// It is. (Without a claim where claims cannot be made; the worst that follows is double work.)
    Yours(Option<Claim>),
    /// Another process has solved it meanwhile.
    Stored(Arc<R>),
    /// Another process is at it; ask again soon.
    Busy,
}

impl<R: Record> Store<R> {
    /// Opens the store of a solver in a cache folder and reads it. A folder that does not exist is created with the
    /// first write.
    ///
    /// # Errors
    /// [`StoreError`] if the path is not a folder or what is there cannot be read. Damaged entries are no error.
    pub fn open(cache: &Path, solver: SolverVersion) -> Result<Store<R>, StoreError> {
        if cache.exists() && !cache.is_dir() {
            return Err(StoreError::NotAFolder { folder: cache.to_owned() });
        }
        let folder = cache.join(R::FOLDER);
        let path = folder.join(upkeep::file_name(solver));
        let io_error = |source| StoreError::Io { path: path.clone(), source };
        let log = Log::open(&path).map_err(io_error)?;
        let store = Store {
            folder,
            path: path.clone(),
            entries: RwLock::default(),
            inner: Mutex::new(Inner { log, ..Inner::default() }),
            patience: Duration::from_secs(30),
        };
        {
            let mut inner = store.lock();
            store.refresh(&mut inner).map_err(io_error)?;
            let damaged = inner.damaged.len();
            if damaged > 0 {
                inner.warnings.push(StoreWarning::Damaged { entries: damaged, file: path.clone() });
            }
        }
        Ok(store)
    }

    /// Changes how long a busy claim is respected. The default, 30 s, is far longer than a task takes: it is for a
    /// process that was stopped while solving.
    pub fn with_patience(mut self, patience: Duration) -> Store<R> {
        self.patience = patience;
        self
    }

    /// How long a busy claim is respected.
    pub fn patience(&self) -> Duration {
        self.patience
    }

    /// A record read or committed so far. Touches no file.
    pub fn get(&self, key: &Key) -> Option<Arc<R>> {
        self.known().get(key).map(Arc::clone)
    }

    /// Records read or committed so far.
    pub fn len(&self) -> usize {
        self.known().len()
    }

    /// Whether no record is known.
    pub fn is_empty(&self) -> bool {
        self.known().is_empty()
    }

    /// Damaged entries met so far.
    pub fn damaged(&self) -> usize {
        self.lock().damaged.len()
    }

    /// Entries this store has appended.
    pub fn committed(&self) -> usize {
        self.lock().committed
    }

    /// Records that were not appended because another process had appended them first: work done twice.
    pub fn duplicates(&self) -> usize {
        self.lock().duplicates
    }

    /// What the user should know, once.
    pub fn take_warnings(&self) -> Vec<StoreWarning> {
        std::mem::take(&mut self.lock().warnings)
    }

    /// Asks to solve a task, after a look at what other processes have committed.
    pub fn claim(&self, key: &Key) -> Claimed<R> {
        if let Some(record) = self.get(key) {
            return Claimed::Stored(record);
        }
        // First the claim, then the look: what was committed before the claim was free is seen.
        let claim = if self.lock().broken { Ok(Some(None)) } else { self.try_claim(key).map(|claim| claim.map(Some)) };
        let mut inner = self.lock();
        if let Err(error) = self.refresh(&mut inner) {
            self.give_up(&mut inner, Access::Read, &error);
        }
        drop(inner);
        if let Some(record) = self.get(key) {
            return Claimed::Stored(record);
        }
        match claim {
            Ok(Some(claim)) => Claimed::Yours(claim),
            Ok(None) => Claimed::Busy,
            Err(error) => {
                self.give_up(&mut self.lock(), Access::Write, &error);
                Claimed::Yours(None)
            }
        }
    }

    fn try_claim(&self, key: &Key) -> io::Result<Option<Claim>> {
        let folder = self.folder.join(upkeep::CLAIMS);
        match claims::claim(&folder, key) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => {
                fs::create_dir_all(&folder)?;
                claims::claim(&folder, key)
            }
            result => result,
        }
    }

    /// Appends a record. When this returns, no kill of any process can lose it, unless a warning says that the store
    /// could not be written.
    pub fn commit(&self, key: &Key, record: &Arc<R>) {
        let mut inner = self.lock();
        if !inner.broken
            && let Err(error) = self.append(&mut inner, key, record)
        {
            self.give_up(&mut inner, Access::Write, &error);
        }
        self.add([(*key, Arc::clone(record))]);
    }

    fn append(&self, inner: &mut Inner, key: &Key, record: &R) -> io::Result<()> {
        let log = match &mut inner.log {
            Some(log) => log,
            None => {
                fs::create_dir_all(&self.folder)?;
                inner.log.insert(Log::create(&self.path)?)
            }
        };
        let mut known = false;
        let slots = log.append(key, record, |slots| {
            known = self.known().contains_key(key) || slots.records.iter().any(|(other, _)| other == key);
            known
        })?;
        if known {
            inner.duplicates += 1;
        } else {
            inner.committed += 1;
        }
        self.take_in(inner, slots);
        Ok(())
    }

    fn refresh(&self, inner: &mut Inner) -> io::Result<()> {
        if inner.log.is_none() {
            inner.log = Log::open(&self.path)?;
        }
        if let Some(log) = &mut inner.log {
            let slots = log.refresh()?;
            self.take_in(inner, slots);
        }
        Ok(())
    }

    fn take_in(&self, inner: &mut Inner, slots: Slots<R>) {
        inner.damaged.extend(slots.damaged);
        self.add(slots.records.into_iter().map(|(key, record)| (key, Arc::new(record))));
    }

    /// Adds what is not known yet; of two records of a key the first is kept.
    fn add(&self, records: impl IntoIterator<Item = (Key, Arc<R>)>) {
        let mut entries = self.entries.write().unwrap_or_else(PoisonError::into_inner);
        for (key, record) in records {
            entries.entry(key).or_insert(record);
        }
    }

    fn known(&self) -> RwLockReadGuard<'_, KeyMap<Arc<R>>> {
        self.entries.read().unwrap_or_else(PoisonError::into_inner)
    }

    fn give_up(&self, inner: &mut Inner, access: Access, error: &io::Error) {
        if !inner.broken {
            inner.broken = true;
            let (folder, reason) = (self.folder.clone(), error.to_string());
            inner.warnings.push(StoreWarning::GivenUp { access, folder, reason });
        }
    }

    fn lock(&self) -> MutexGuard<'_, Inner> {
        // Nothing inside panics; were it to, the entries would still be whole ones.
        self.inner.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests;
