//! Writing files whole or not at all, one or several together.

use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::time::SystemTime;

use tempfile::{NamedTempFile, TempPath};

use crate::temporary::{self, remove_stale};

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
    file.persist(path).map(drop).map_err(|e| WriteError::at(path)(e.error))?;
    remove_stale(folder_of(path));
    Ok(())
}

/// Several files of one folder, and of folders in it, that are written together. They are renamed only when all are on the disk,
/// so that a full disk leaves the old files intact.
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
    /// Files that must not change before they are replaced, as they were.
    before: Vec<(PathBuf, Option<Identity>)>,
}

/// Distinguishes a file from another run's file at the same path.
type Identity = (u64, Option<SystemTime>, Option<u64>);

/// The identity of the file at a path; `None` if there is no file.
fn identity(path: &Path) -> Option<Identity> {
    let there = fs::metadata(path).ok()?;
    #[cfg(unix)]
    let inode = Some(std::os::unix::fs::MetadataExt::ino(&there));
    #[cfg(not(unix))]
    let inode = None;
    Some((there.len(), there.modified().ok(), inode))
}

impl FileSet {
    /// A set without files as yet. The folder is made with the first.
    pub fn new(folder: &Path) -> FileSet {
        FileSet { folder: folder.to_owned(), staged: Vec::new(), before: Vec::new() }
    }

    /// The set of a run that begins now: if another run writes one of the files `names` before this one does, the commit fails,
    /// and the other run's files stay.
    pub fn begin<'a>(folder: &Path, names: impl IntoIterator<Item = &'a str>) -> FileSet {
        let before = names.into_iter().map(|name| folder.join(name)).map(|path| (path.clone(), identity(&path)));
        FileSet { before: before.collect(), ..FileSet::new(folder) }
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
    /// [`WriteError`]. A folder in the place of a file, and files that another run has written, are found before the first
    /// rename.
    pub fn commit(self) -> Result<(), WriteError> {
        // Other runs that write into the folder wait, so that nothing changes between the check and the last rename.
        let _lock = locked(&self.folder);
        for (path, before) in &self.before {
            if identity(path) != *before {
                return Err(WriteError::at(path)(io::Error::other(OVERTAKEN)));
            }
        }
        for (_, path) in &self.staged {
            can_be_a_file(path).map_err(WriteError::at(path))?;
            fs::create_dir_all(folder_of(path)).map_err(WriteError::at(path))?;
        }
        for (file, path) in self.staged {
            file.persist(&path).map_err(|failed| WriteError::at(&path)(failed.error))?;
        }
        remove_stale(&self.folder);
        Ok(())
    }
}

/// Why a run must not replace files that changed while it ran.
const OVERTAKEN: &str =
    "another run wrote it while this one ran, and its files were kept; choose another folder and run again";

/// The folder, locked until the value is dropped; `None` where folders cannot be locked.
fn locked(folder: &Path) -> Option<File> {
    let folder = File::open(folder).ok()?;
    folder.lock().ok()?;
    Some(folder)
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

/// Whether a file can have this name: the name is free or belongs to a regular file. A rename would replace a device or a pipe.
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
    let prefix = temporary::prefix();
    let mut builder = tempfile::Builder::new();
    builder.prefix(&prefix).suffix(temporary::SUFFIX);
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
    use std::time::Duration;

    #[test]
    fn of_two_runs_into_one_folder_the_second_says_that_it_came_too_late() {
        let folder = tempfile::tempdir().unwrap();
        let names = ["tree.json", "tree.nwk"];
        let [mut first, mut second] = [FileSet::begin(folder.path(), names), FileSet::begin(folder.path(), names)];
        for (set, text) in [(&mut first, b"1"), (&mut second, b"2")] {
            names.iter().for_each(|name| set.stage(name, text).unwrap());
        }
        first.commit().unwrap();
        let said = second.commit().unwrap_err().to_string();
        assert!(said.contains("tree.json") && said.contains("another run wrote it"), "{said}");
        for name in names {
            assert_eq!(fs::read(folder.path().join(name)).unwrap(), b"1");
        }
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 2);
        // A run that begins after the first may replace its files.
        let mut third = FileSet::begin(folder.path(), names);
        third.stage("tree.json", b"3").unwrap();
        third.commit().unwrap();
        assert_eq!(fs::read(folder.path().join("tree.json")).unwrap(), b"3");
    }

    /// Of many runs that end at once exactly one wins, and its files are all there.
    #[test]
    fn of_many_runs_at_once_one_is_kept_whole() {
        let folder = tempfile::tempdir().unwrap();
        let names = ["a", "b", "c"];
        let sets: Vec<FileSet> = (0..8)
            .map(|k: u8| {
                let mut set = FileSet::begin(folder.path(), names);
                names.iter().for_each(|name| set.stage(name, &[k]).unwrap());
                set
            })
            .collect();
        let runs: Vec<_> = sets.into_iter().map(|set| std::thread::spawn(move || set.commit().is_ok())).collect();
        let won = runs.into_iter().map(|run| run.join().unwrap()).filter(|won| *won).count();
        let content = names.map(|name| fs::read(folder.path().join(name)).unwrap());
        assert!(won == 1 && content[0] == content[1] && content[1] == content[2], "{won} {content:?}");
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn temporary_files_of_killed_runs_are_removed_and_others_are_not() {
        let folder = tempfile::tempdir().unwrap();
        let mut dead = std::process::Command::new("true").spawn().unwrap();
        dead.wait().unwrap();
        let own = temporary::prefix();
        let of_dead = own.replace(&format!("-{}-", std::process::id()), &format!("-{}-", dead.id()));
        assert_ne!(own, of_dead);
        let kept = [format!("{own}x.tmp"), ".furrow-notes.txt".to_owned(), ".furrow-0-1-new.tmp".to_owned()];
        let gone = [format!("{of_dead}x.tmp"), ".furrow-0-1-old.tmp".to_owned(), ".furrow-Ab12Cd.tmp".to_owned()];
        for name in kept.iter().chain(&gone) {
            File::create(folder.path().join(name)).unwrap();
        }
        // Of another machine, or of an older version, and of two days ago.
        for name in &gone[1..] {
            let file = File::options().write(true).open(folder.path().join(name)).unwrap();
            file.set_modified(SystemTime::now() - Duration::from_secs(48 * 3600)).unwrap();
        }
        write_atomically(&folder.path().join("a.csv"), b"1").unwrap();
        let left: Vec<String> = fs::read_dir(folder.path())
            .unwrap()
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect();
        assert!(kept.iter().all(|name| left.contains(name)) && left.len() == kept.len() + 1, "{left:?}");
    }
}
