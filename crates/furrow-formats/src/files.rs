//! Writing files whole or not at all, one or several together.

use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use tempfile::{NamedTempFile, TempPath};

/// A file that could not be written.
#[derive(Debug, thiserror::Error)]
#[error("{path}: cannot be written: {source}")]
pub struct WriteError {
    /// The file.
    pub path: String,
    /// The error of the system.
    pub source: io::Error,
}

impl WriteError {
    fn at(path: &Path) -> impl FnOnce(io::Error) -> WriteError {
        move |source| WriteError { path: path.display().to_string(), source }
    }
}

/// Writes `content` to a temporary name beside `path`, then renames: a reader never sees half a file, and a failure
/// leaves what was there. Folders are made as needed.
pub fn write_atomically(path: &Path, content: &[u8]) -> Result<(), WriteError> {
    can_be_a_file(path).map_err(WriteError::at(path))?;
    let file = staged(folder_of(path), content).map_err(WriteError::at(path))?;
    file.persist(path).map(drop).map_err(|e| WriteError::at(path)(e.error))
}

/// Several files of one folder, and of folders in it, that are written together: none is renamed before all are on the disk,
/// so that a full disk leaves what was there.
///
/// ```
/// use furrow_formats::files::FileSet;
///
/// let folder = std::env::temp_dir().join(format!("furrow-set-{}", std::process::id()));
/// let mut files = FileSet::new(&folder);
/// files.stage("a.csv", b"1\n")?;
/// files.stage("b.csv", b"2\n")?;
/// assert!(!folder.join("a.csv").exists());
/// files.commit()?;
/// assert_eq!(std::fs::read_to_string(folder.join("b.csv"))?, "2\n");
/// # std::fs::remove_dir_all(&folder)?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct FileSet {
    folder: PathBuf,
    /// Temporary and final path of each. Files are closed: there may be thousands.
    staged: Vec<(TempPath, PathBuf)>,
}

impl FileSet {
    /// A set without files as yet. The folder is made with the first.
    pub fn new(folder: &Path) -> FileSet {
        FileSet { folder: folder.to_owned(), staged: Vec::new() }
    }

    /// Writes the file `name` under a temporary name. `name` may have folders before it, as in `sub/a.csv`, which are made
    /// with the commit.
    ///
    /// # Errors
    /// [`WriteError`]; no temporary file is left once the set is dropped.
    pub fn stage(&mut self, name: &str, content: &[u8]) -> Result<(), WriteError> {
        let path = self.folder.join(name);
        let file = staged(&self.folder, content).map_err(WriteError::at(&path))?;
        self.staged.push((file.into_temp_path(), path));
        Ok(())
    }

    /// Gives all files their names, in the order in which they were staged.
    ///
    /// # Errors
    /// [`WriteError`]. A folder in the place of a file is found before the first rename.
    pub fn commit(self) -> Result<(), WriteError> {
        for (_, path) in &self.staged {
            can_be_a_file(path).map_err(WriteError::at(path))?;
            fs::create_dir_all(folder_of(path)).map_err(WriteError::at(path))?;
        }
        for (file, path) in self.staged {
            file.persist(&path).map_err(|failed| WriteError::at(&path)(failed.error))?;
        }
        Ok(())
    }
}

/// Whether files of these names can be written into a folder, which need not exist yet. Folders that the check creates are
/// removed again.
///
/// # Errors
/// [`WriteError`] of the folder or the file.
pub fn check_folder(folder: &Path, names: &[&str]) -> Result<(), WriteError> {
    let missing: Vec<&Path> =
        folder.ancestors().take_while(|f| !f.as_os_str().is_empty() && fs::symlink_metadata(f).is_err()).collect();
    let probed = staged(folder, b"").map(drop).map_err(WriteError::at(folder));
    for made in missing {
        let _ = fs::remove_dir(made);
    }
    probed?;
    names.iter().map(|name| folder.join(name)).try_for_each(|path| can_be_a_file(&path).map_err(WriteError::at(&path)))
}

/// Whether a file can be written, into a folder that need not exist yet.
///
/// # Errors
/// As [`check_folder`].
pub fn check_file(path: &Path) -> Result<(), WriteError> {
    let Some(_) = path.file_name() else {
        return Err(WriteError::at(path)(io::ErrorKind::IsADirectory.into()));
    };
    can_be_a_file(path).map_err(WriteError::at(path))?;
    check_folder(folder_of(path), &[]).map_err(|error| WriteError { path: path.display().to_string(), ..error })
}

fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// Whether a file can have this name: it is free or that of a regular file. A rename would replace a device or a pipe.
fn can_be_a_file(path: &Path) -> io::Result<()> {
    match fs::metadata(path) {
        Ok(there) if there.is_dir() => Err(io::ErrorKind::IsADirectory.into()),
        Ok(there) if !there.is_file() => Err(io::Error::other("it is a device or a pipe")),
        Err(error) if error.kind() != io::ErrorKind::NotFound => Err(error),
        _ => Ok(()),
    }
}

/// A file with that content under a temporary name in a folder, made as needed.
fn staged(folder: &Path, content: &[u8]) -> io::Result<NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(".furrow-").suffix(".tmp");
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        // The umask applies, as to any file made in the ordinary way.
        builder.permissions(fs::Permissions::from_mode(0o666));
    }
    let make = || fs::create_dir_all(folder).and_then(|()| builder.tempfile_in(folder));
    // Another run that checks a folder beside this one may just have removed one that both have above them.
    let mut file = make().or_else(|e| if e.kind() == io::ErrorKind::NotFound { make() } else { Err(e) })?;
    // To the file itself: errors of its wrapper name the temporary path.
    file.as_file_mut().write_all(content)?;
    Ok(file)
}
