//! Finds the files of embryos by paths, folders and patterns.

use std::collections::HashMap;
use std::fs;
use std::io::Read;
use std::path::{Path, PathBuf};

use furrow_input::table::Table;
use furrow_input::{InputError, foreign, listed, open_file};

use super::{container, embryo_of, located, located_file, spot_tables, track_tables};
use crate::lifetime_table::Columns;
use crate::volumes::{ReadOptions, Volumes};

/// A table or an embryo that was followed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct EmbryoFile {
    /// The file or folder.
    pub path: PathBuf,
    /// The embryo: the file's name without its extension, with the name of the folder before it where other files have the same.
    pub name: String,
}

/// What tables a command reads beside embryos that were followed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TableKind {
    /// Of volumes, divisions or χ.
    Volumes,
    /// Of lifetimes.
    Lifetimes,
}

/// A file that is not read.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LeftOut {
    /// The file or folder.
    pub path: PathBuf,
    /// The file and why it is not read.
    pub why: String,
}

/// Most files of a folder or a pattern.
const MOST: usize = 10_000;

/// Most files that an error names.
const MOST_NAMED: usize = 3;

/// Bytes at the start of a table from which its kind is known.
const HEAD: u64 = 1 << 16;

/// Finds the files of embryos. A folder is an embryo itself, or holds embryos and tables of this kind; a name with `*` finds the files
/// that fit it. The second list has the files of folders that are neither, and those that are given a second time.
///
/// # Errors
/// A folder without embryos and tables, a pattern that no file fits, or a path that cannot be read.
pub fn embryo_files(paths: &[PathBuf], tables: TableKind) -> Result<(Vec<EmbryoFile>, Vec<LeftOut>), InputError> {
    let (mut found, mut left_out) = (Vec::new(), Vec::new());
    for path in paths {
        if path.is_dir() {
            in_folder(path, tables, &mut found, &mut left_out)?;
        } else if path.exists() {
            found.push(path.clone());
        } else {
            fitting(path, &mut found)?;
        }
    }
    Ok((named(once(found, &mut left_out)), left_out))
}

/// The files without those that are there a second time, under the same or another path.
fn once(found: Vec<PathBuf>, left_out: &mut Vec<LeftOut>) -> Vec<PathBuf> {
    let mut known: HashMap<PathBuf, PathBuf> = HashMap::new();
    let mut kept = Vec::with_capacity(found.len());
    for path in found {
        // The reader says why a file cannot be read.
        let own = fs::canonicalize(&path).unwrap_or_else(|_| path.clone());
        if let Some(first) = known.get(&own) {
            let why = format!("{}: is the same file as {}, which is read once", path.display(), first.display());
            left_out.push(LeftOut { path, why });
            continue;
        }
        known.insert(own, path.clone());
        kept.push(path);
    }
    kept
}

/// The files with their embryos' names.
fn named(paths: Vec<PathBuf>) -> Vec<EmbryoFile> {
    let own = |path: &PathBuf| super::name_of(path);
    let names: Vec<String> = paths.iter().map(own).collect();
    let name = |(k, path): (usize, PathBuf)| {
        let is_alone = names.iter().filter(|name| **name == names[k]).count() == 1;
        let folder = path.parent().and_then(Path::file_name).filter(|_| !is_alone);
        let name = folder.map_or(names[k].clone(), |folder| format!("{}/{}", folder.to_string_lossy(), names[k]));
        EmbryoFile { path, name }
    };
    paths.into_iter().enumerate().map(name).collect()
}

/// The embryo that a folder is, or the embryos and tables in it.
fn in_folder(
    folder: &Path,
    tables: TableKind,
    found: &mut Vec<PathBuf>,
    left_out: &mut Vec<LeftOut>,
) -> Result<(), InputError> {
    let reason = match located(folder) {
        Ok(_) => {
            found.push(folder.to_owned());
            return Ok(());
        }
        Err(error) => error,
    };
    let (before, mut others) = (found.len(), Vec::new());
    for path in entries(folder)? {
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        if name.starts_with('.') || belongs_to_another(&path) {
            continue;
        }
        match why_left_out(&path, tables) {
            None => found.push(path),
            Some(why) => others.push(LeftOut { path, why }),
        }
    }
    // Files of a known format that cannot be read come first.
    others.sort_by_cached_key(|LeftOut { path, .. }| path.is_dir() || matches!(located_file(path), Ok(None)));
    if found.len() == before {
        // Several GEFFs in a container.
        found.extend(container::geffs_in(folder)?);
    }
    if found.len() == before {
        let is_known = others.is_empty() || foreign::folder(folder).is_some();
        return Err(if is_known { reason } else { nothing_in(folder, tables, &others) });
    }
    left_out.extend(others);
    Ok(())
}

/// The error for a folder without a readable file.
fn nothing_in(folder: &Path, tables: TableKind, others: &[LeftOut]) -> InputError {
    let mut why: Vec<&str> = others.iter().take(MOST_NAMED).map(|other| other.why.as_str()).collect();
    let more = format!("{} more", others.len().saturating_sub(MOST_NAMED));
    why.extend((others.len() > MOST_NAMED).then_some(more.as_str()));
    let wanted = format!("a folder with an embryo that was followed or a table of {}", tables.name());
    InputError::other_file(folder.display(), &wanted, why.join("; "))
}

/// Whether a file is read with another one, which lies beside it.
fn belongs_to_another(path: &Path) -> bool {
    path.is_file() && (spot_tables::is_of_links(path) || track_tables::is_graph(path))
}

/// Why a file or folder in a folder is not read; `None` for an embryo or a table.
fn why_left_out(path: &Path, tables: TableKind) -> Option<String> {
    let found = if path.is_dir() { located(path) } else { located_file(path) };
    match found {
        Err(error) => Some(error.to_string()),
        Ok(Some(_)) => None,
        Ok(None) => tables.refused(path).err().map(|error| {
            let (file, error) = (path.display().to_string(), error.to_string());
            let error = error.strip_prefix(&format!("{file}:")).unwrap_or(&error).trim_start();
            // The list of layouts behind the reason is left out.
            let error = error.split("; ").next().unwrap_or(error);
            format!("{file}: is neither an embryo that was followed nor a table of {}: {error}", tables.name())
        }),
    }
}

impl TableKind {
    /// The quantity in the tables.
    fn name(self) -> &'static str {
        match self {
            TableKind::Volumes => "volumes",
            TableKind::Lifetimes => "lifetimes",
        }
    }

    /// Tries to read the beginning of a file as such a table.
    ///
    /// # Errors
    /// The file is no such table.
    fn refused(self, path: &Path) -> Result<(), InputError> {
        let (file, mut head) = (path.display().to_string(), Vec::new());
        open_file(path)?.take(HEAD).read_to_end(&mut head).map_err(|e| InputError::unreadable(path, e))?;
        if head.len() as u64 == HEAD {
            let whole_lines = head.iter().rposition(|byte| *byte == b'\n').map_or(head.len(), |end| end + 1);
            head.truncate(whole_lines);
        }
        match self {
            TableKind::Volumes => Volumes::default().read(&*head, &file, &ReadOptions::default()),
            TableKind::Lifetimes => Columns::of(&Table::open(&*head, &file)?.columns(|_| false)?).map(|_| ()),
        }
    }
}

/// The files in a folder, by name.
fn entries(folder: &Path) -> Result<Vec<PathBuf>, InputError> {
    let unreadable = |e: std::io::Error| InputError::unreadable(folder, e);
    let mut paths = Vec::new();
    for entry in fs::read_dir(folder).map_err(unreadable)? {
        paths.push(entry.map_err(unreadable)?.path());
        let count = paths.len();
        InputError::require(count <= MOST, folder.display().to_string(), "files", count, format!("at most {MOST}"))?;
    }
    paths.sort();
    Ok(paths)
}

/// The files that fit a pattern with `*` in its last part.
fn fitting(pattern: &Path, found: &mut Vec<PathBuf>) -> Result<(), InputError> {
    let name = pattern.file_name().map_or(String::new(), |name| name.to_string_lossy().into_owned());
    if !name.contains('*') {
        // The reader says why it cannot be read.
        found.push(pattern.to_owned());
        return Ok(());
    }
    let folder = pattern.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let all = entries(folder)?;
    let fits = |path: &&PathBuf| {
        let own = path.file_name().unwrap_or_default().to_string_lossy();
        matches(&name, &own) && !belongs_to_another(path)
    };
    let before = found.len();
    found.extend(all.iter().filter(fits).cloned());
    let here: Vec<String> = all.iter().map(|path| embryo_of(path)).collect();
    let allowed = || format!("a pattern that a file fits; there are {}", listed(here.iter().map(String::as_str), ", "));
    InputError::require(found.len() > before, pattern.display().to_string(), "files", 0, allowed())
}

/// Whether a name fits a pattern, where `*` fits any letters.
fn matches(pattern: &str, name: &str) -> bool {
    let Some((first, rest)) = pattern.split_once('*') else { return pattern == name };
    let Some(left) = name.strip_prefix(first) else { return false };
    (0..=left.len()).filter(|at| left.is_char_boundary(*at)).any(|at| matches(rest, &left[at..]))
}

#[cfg(test)]
mod tests {
    use super::matches;

    #[test]
    fn a_star_stands_for_any_letters() {
        for (pattern, name, fits) in [
            ("*.csv", "a.csv", true),
            ("e*_spots.csv", "e1_spots.csv", true),
            ("e*.csv", "f.csv", false),
            ("*", "é", true),
        ] {
            assert_eq!(matches(pattern, name), fits, "{pattern} {name}");
        }
    }
}
