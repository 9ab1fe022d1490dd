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
    /// What the system said.
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

/// Several files of one folder, and of folders in it, that are written together: none of them is in place before all of them are on the disk, so
/// that a full one leaves either all the files of a run or, untouched, what was there.
///
/// ```
/// use furrow::io::files::FileSet;
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
    /// Each under its temporary name, which goes when this is dropped, and where it belongs. Files are closed: there may be
    /// many thousands.
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

    /// Gives all files their names after moving those of these `names` that are there already into a new folder beside
    /// them, `earlier-1` or the next number that is free: gives that folder.
    ///
    /// # Errors
    /// As [`commit`](Self::commit).
    pub fn commit_keeping<N: AsRef<Path>>(self, names: &[N]) -> Result<PathBuf, WriteError> {
        let mut number = 1;
        let aside = loop {
            let aside = self.folder.join(format!("earlier-{number}"));
            match fs::create_dir(&aside) {
                Ok(()) => break aside,
                Err(error) if error.kind() == io::ErrorKind::AlreadyExists => number += 1,
                Err(error) => return Err(WriteError::at(&aside)(error)),
            }
        };
        let folder = self.folder.clone();
        let mut moved: Vec<(PathBuf, PathBuf)> = Vec::new();
        let pairs = names.iter().map(|name| (folder.join(name), aside.join(name)));
        let done = move_aside(&folder, pairs, &mut moved).and_then(|()| self.commit());
        if let Err(error) = done {
            // As it was before, as far as the system lets it.
            for (path, kept) in moved.iter().rev() {
                let _ = fs::create_dir_all(folder_of(path)).and_then(|()| fs::rename(kept, path));
                let _ = fs::remove_dir(folder_of(kept));
            }
            let _ = fs::remove_dir(&aside);
            return Err(error);
        }
        Ok(aside)
    }

    /// Gives all files their names, in the order in which they were staged.
    ///
    /// # Errors
    /// [`WriteError`]. What commonly hinders a rename, a folder of that name, is looked for before the first. Where one fails
    /// nevertheless, those before it are taken back, and what they replaced is put in its place again (on file systems that
    /// have hard links).
    pub fn commit(self) -> Result<(), WriteError> {
        for (_, path) in &self.staged {
            can_be_a_file(path).map_err(WriteError::at(path))?;
            fs::create_dir_all(folder_of(path)).map_err(WriteError::at(path))?;
        }
        let mut placed: Vec<Placed> = Vec::with_capacity(self.staged.len());
        for (file, path) in self.staged {
            let before = Before::of(&path);
            if let Err(failed) = file.persist(&path) {
                placed.into_iter().rev().for_each(Placed::take_back);
                return Err(WriteError::at(&path)(failed.error));
            }
            placed.push(Placed { path, before });
        }
        Ok(())
    }
}

/// Moves the files that are there to where they are kept, and notes each in `moved`.
fn move_aside(
    folder: &Path,
    pairs: impl Iterator<Item = (PathBuf, PathBuf)>,
    moved: &mut Vec<(PathBuf, PathBuf)>,
) -> Result<(), WriteError> {
    for (path, kept) in pairs {
        if fs::symlink_metadata(&path).is_ok_and(|there| !there.is_dir()) {
            fs::create_dir_all(folder_of(&kept)).map_err(WriteError::at(&kept))?;
            fs::rename(&path, &kept).map_err(WriteError::at(&path))?;
            if folder_of(&path) != folder {
                // A folder of its own that is empty now goes; one in which other files are stays.
                let _ = fs::remove_dir(folder_of(&path));
            }
            moved.push((path, kept));
        }
    }
    Ok(())
}

/// A file that has its name, and what had it before.
struct Placed {
    path: PathBuf,
    before: Before,
}

/// What had the name of a file.
enum Before {
    Nothing,
    /// A file, which has this second name until the new one is certain to stay.
    File(TempPath),
    /// A file on a system without hard links, which is lost with its name.
    Lost,
}

impl Before {
    fn of(path: &Path) -> Before {
        if fs::symlink_metadata(path).is_err() {
            return Before::Nothing;
        }
        let link = tempfile::Builder::new()
            .prefix(".furrow-")
            .suffix(".tmp")
            .make_in(folder_of(path), |name| fs::hard_link(path, name));
        link.map_or(Before::Lost, |link| Before::File(link.into_temp_path()))
    }
}

impl Placed {
    fn take_back(self) {
        match self.before {
            Before::Nothing => drop(fs::remove_file(&self.path)),
            Before::File(link) => drop(link.persist(&self.path)),
            Before::Lost => {}
        }
    }
}

/// Whether files of these names can be written into a folder, which need not exist yet. Nothing is left behind: folders made
/// to find out are removed again.
///
/// # Errors
/// What the system says, as [`WriteError`] of the folder or the file.
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

/// Whether a file can have this name: no folder has it, nor a device or a pipe, which a rename would put a file in the place of,
/// and the system takes it.
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

#[cfg(test)]
mod tests {
    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap());
        let mut names: Vec<String> = entries.collect();
        names.sort();
        names
    }

    /// The third of four renames fails: its temporary file is gone, as where somebody empties the folder.
    fn failing(folder: &Path) -> FileSet {
        let mut files = FileSet::new(folder);
        for name in ["a", "b", "c", "d"] {
            files.stage(name, b"new").unwrap();
        }
        fs::remove_file(&files.staged[2].0).unwrap();
        files
    }

    #[test]
    fn a_rename_that_fails_takes_back_those_before_it() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path();
        fs::write(path.join("a"), b"old").unwrap();
        let error = failing(path).commit().unwrap_err();
        assert!(error.path.ends_with('c'), "{error}");
        assert_eq!(names(path), ["a"]);
        assert_eq!(fs::read(path.join("a")).unwrap(), b"old");
    }

    #[test]
    fn what_was_moved_aside_comes_back_where_the_new_files_do_not_come() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path();
        fs::create_dir(path.join("sub")).unwrap();
        for name in ["a", "sub/x"] {
            fs::write(path.join(name), b"old").unwrap();
        }
        failing(path).commit_keeping(&["a", "b", "sub/x"]).unwrap_err();
        assert_eq!(names(path), ["a", "sub"]);
        assert_eq!(fs::read(path.join("sub/x")).unwrap(), b"old");
    }
}
