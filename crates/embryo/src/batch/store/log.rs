//! The file of a store: slots of equal size, only ever appended to.
//!
//! Readers hold the shared, writers the exclusive advisory lock of the file, for one read or write at a time. The system
//! drops a lock with its process, so a killed one holds nobody up. What it was writing is a partial slot at the end at
//! most, which was never acknowledged, and which the next writer overwrites.

use std::{
    fs::{File, OpenOptions, TryLockError},
    io::{self, Read, Seek, SeekFrom, Write},
    path::{Path, PathBuf},
    time::{Duration, Instant},
};

use super::slot::{self, Content, SLOT};
use crate::batch::{Key, Record};

/// How long a lock that others hold is waited for. They hold it for microseconds unless they are stopped.
const LOCK_PATIENCE: Duration = Duration::from_secs(2);

/// An open file of slots.
#[derive(Debug)]
pub struct Log {
    path: PathBuf,
    file: File,
    /// Slots read so far.
    read: u64,
}

/// What was read from a file.
#[derive(Debug)]
pub struct Slots<R> {
    /// Whole records, in the order of the file.
    pub records: Vec<(Key, R)>,
    /// Places of damaged slots and of a partial slot at the end.
    pub damaged: Vec<u64>,
}

#[derive(Clone, Copy)]
enum Mode {
    Shared,
    Exclusive,
}

impl Log {
    /// Opens an existing file for reading and, where permitted, writing. `None` if there is none.
    pub fn open(path: &Path) -> io::Result<Option<Log>> {
        let opened = OpenOptions::new().read(true).write(true).open(path).or_else(|error| match error.kind() {
            io::ErrorKind::PermissionDenied | io::ErrorKind::ReadOnlyFilesystem => File::open(path),
            _ => Err(error),
        });
        match opened {
            Ok(file) => Ok(Some(Log { path: path.to_owned(), file, read: 0 })),
            Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(None),
            Err(error) => Err(error),
        }
    }

    /// Opens a file for reading and writing, and creates it first if there is none.
    pub fn create(path: &Path) -> io::Result<Log> {
        let file = OpenOptions::new().read(true).write(true).create(true).truncate(false).open(path)?;
        Ok(Log { path: path.to_owned(), file, read: 0 })
    }

    /// Size of the file in bytes.
    pub fn bytes(&self) -> io::Result<u64> {
        Ok(self.file.metadata()?.len())
    }

    /// Reads what has been appended since the last time.
    pub fn refresh<R: Record>(&mut self) -> io::Result<Slots<R>> {
        let slots = self.slots_in_file()?;
        if slots.whole == self.read && slots.partial.is_none() {
            return Ok(Slots { records: Vec::new(), damaged: Vec::new() });
        }
        self.locked(Mode::Shared, Log::read_new)
    }

    /// Appends a record unless `known` says, given what others have appended meanwhile, that it is there already.
    /// Returns what they have.
    pub fn append<R: Record>(
        &mut self,
        key: &Key,
        record: &R,
        known: impl FnOnce(&Slots<R>) -> bool,
    ) -> io::Result<Slots<R>> {
        let slot = slot::encode(key, record);
        self.locked(Mode::Exclusive, |log| {
            let slots = log.read_new()?;
            if !known(&slots) {
                let end = log.read * SLOT as u64;
                log.file.seek(SeekFrom::Start(end))?;
                if let Err(error) = log.file.write_all(&slot) {
                    // Shrinking needs no space. Should it fail, the next writer overwrites the partial slot.
                    let _ = log.file.set_len(end);
                    return Err(error);
                }
                log.read += 1;
            }
            Ok(slots)
        })
    }

    /// Empties the file.
    pub fn clear(&mut self) -> io::Result<()> {
        self.locked(Mode::Exclusive, |log| {
            log.read = 0;
            log.file.set_len(0)
        })
    }

    /// Gives up the damaged slots of the whole file: each becomes a void one, a partial one at the end is cut off. A kill
    /// between leaves some for the next time. Returns how many there were.
    pub fn repair<R: Record>(&mut self) -> io::Result<usize> {
        self.locked(Mode::Exclusive, |log| {
            log.read = 0;
            let damaged = log.read_new::<R>()?.damaged;
            for &place in &damaged {
                let start = place * SLOT as u64;
                if place < log.read {
                    log.file.seek(SeekFrom::Start(start))?;
                    log.file.write_all(&slot::void())?;
                } else {
                    log.file.set_len(start)?;
                }
            }
            Ok(damaged.len())
        })
    }

    fn slots_in_file(&self) -> io::Result<SlotCount> {
        let bytes = self.bytes()?;
        let whole = bytes / SLOT as u64;
        Ok(SlotCount { whole, partial: (!bytes.is_multiple_of(SLOT as u64)).then_some(whole) })
    }

    /// Reads on to the end; the lock must be held.
    fn read_new<R: Record>(&mut self) -> io::Result<Slots<R>> {
        let SlotCount { whole, partial } = self.slots_in_file()?;
        if whole < self.read {
            // Somebody cleared or cut the file; what was read from it stays true.
            self.read = 0;
        }
        let mut slots = Slots { records: Vec::new(), damaged: partial.into_iter().collect() };
        self.file.seek(SeekFrom::Start(self.read * SLOT as u64))?;
        let mut reader = io::BufReader::with_capacity(1 << 16, &self.file);
        let mut slot = [0; SLOT];
        for place in self.read..whole {
            reader.read_exact(&mut slot)?;
            match slot::read(&slot) {
                Content::Record(key, record) => slots.records.push((key, record)),
                Content::Void => {}
                Content::Damaged => slots.damaged.push(place),
            }
        }
        self.read = whole;
        Ok(slots)
    }

    fn locked<T>(&mut self, mode: Mode, act: impl FnOnce(&mut Log) -> io::Result<T>) -> io::Result<T> {
        let begun = Instant::now();
        let mut pause = Duration::from_micros(20);
        loop {
            let attempt = match mode {
                Mode::Shared => self.file.try_lock_shared(),
                Mode::Exclusive => self.file.try_lock(),
            };
            match attempt {
                Ok(()) => break,
                Err(TryLockError::Error(error)) => return Err(error),
                Err(TryLockError::WouldBlock) if begun.elapsed() < LOCK_PATIENCE => {
                    std::thread::sleep(pause);
                    pause = (2 * pause).min(Duration::from_millis(5));
                }
                Err(TryLockError::WouldBlock) => {
                    let text = format!("{} is locked by a process that does not let go", self.path.display());
                    return Err(io::Error::new(io::ErrorKind::TimedOut, text));
                }
            }
        }
        let result = act(self);
        self.file.unlock()?;
        result
    }
}

struct SlotCount {
    whole: u64,
    /// Place of a partial slot at the end.
    partial: Option<u64>,
}
