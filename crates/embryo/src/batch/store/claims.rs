//! Claims: who solves what, among processes.
//!
//! A claim is an advisory lock on an empty file named after the key. The system drops it with its process, so a dead
//! process claims nothing. Claims only save work: should two processes hold one for the same key, the log takes the
//! first result and drops the second.

use std::{
    fs::{self, File, OpenOptions, TryLockError},
    io,
    path::{Path, PathBuf},
};

use crate::batch::Key;

/// A held claim; given up when dropped.
#[derive(Debug)]
pub struct Claim {
    path: PathBuf,
    /// Open as long as the claim is held: closing it unlocks.
    _file: File,
}

impl Drop for Claim {
    fn drop(&mut self) {
        // A file left behind is an unlocked one and claims nothing.
        let _ = fs::remove_file(&self.path);
    }
}

/// Claims a key; `None` if it is claimed already.
pub fn claim(folder: &Path, key: &Key) -> io::Result<Option<Claim>> {
    let path = folder.join(format!("{:016x}.claim", key.prefix()));
    let file = OpenOptions::new().write(true).create(true).truncate(false).open(&path)?;
    match file.try_lock() {
        Ok(()) => Ok(Some(Claim { path, _file: file })),
        Err(TryLockError::WouldBlock) => Ok(None),
        Err(TryLockError::Error(error)) => Err(error),
    }
}

/// Removes the files that dead processes left behind.
pub fn sweep(folder: &Path) -> io::Result<()> {
    let entries = match fs::read_dir(folder) {
        Ok(entries) => entries,
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(()),
        Err(error) => return Err(error),
    };
    for entry in entries {
        let path = entry?.path();
        if path.extension().is_some_and(|extension| extension == "claim")
            && let Ok(file) = OpenOptions::new().write(true).open(&path)
            && file.try_lock().is_ok()
        {
            // Gone already if its holder was quicker.
            let _ = fs::remove_file(&path);
        }
    }
    Ok(())
}
