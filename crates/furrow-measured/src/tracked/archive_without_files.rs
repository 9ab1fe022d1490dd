//! Archives in WebAssembly, which cannot open files.

use std::path::Path;

use furrow_input::InputError;

/// Most bytes that are read of an archive, and unpacked of it.
pub(super) const LONGEST: u64 = 1 << 29;

/// The files of an archive.
///
/// # Errors
/// Always, since no file can be opened.
pub(super) fn files<K>(
    path: &Path,
    _wanted: impl Fn(&str) -> Option<K>,
) -> Result<Vec<(K, String, Vec<u8>)>, InputError> {
    Err(InputError::unreadable(path, "there are no files here"))
}

/// The names of the files in an archive.
///
/// # Errors
/// Always, since no file can be opened.
pub(super) fn names(path: &Path) -> Result<Vec<String>, InputError> {
    Err(InputError::unreadable(path, "there are no files here"))
}
