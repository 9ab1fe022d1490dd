//! Writing files whole or not at all.

use std::io::{self, Write};
use std::path::Path;

/// A file that could not be written.
#[derive(Debug, thiserror::Error)]
#[error("{path}: cannot be written: {source}")]
pub struct WriteError {
    /// The file.
    pub path: String,
    /// What the system said.
    pub source: io::Error,
}

/// Writes `content` to a temporary name beside `path`, then renames: a reader never sees half a file, and a failure
/// leaves what was there. Folders are made as needed.
pub fn write_atomically(path: &Path, content: &[u8]) -> Result<(), WriteError> {
    let attempt = || -> io::Result<()> {
        let folder = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
        std::fs::create_dir_all(folder)?;
        let mut builder = tempfile::Builder::new();
        builder.prefix(".furrow-").suffix(".tmp");
        #[cfg(unix)]
        {
            use std::os::unix::fs::PermissionsExt;
            // The umask applies, as to any file made in the ordinary way.
            builder.permissions(std::fs::Permissions::from_mode(0o666));
        }
        let mut file = builder.tempfile_in(folder)?;
        file.write_all(content)?;
        file.persist(path)?;
        Ok(())
    };
    attempt().map_err(|source| WriteError { path: path.display().to_string(), source })
}
