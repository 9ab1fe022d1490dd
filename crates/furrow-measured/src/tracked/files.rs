//! Finds the files of embryos by paths, folders and patterns.

use std::fs;
use std::path::{Path, PathBuf};

use furrow_input::{InputError, listed};

use super::{container, embryo_of, located, located_file, spot_tables};

/// A table or an embryo that was followed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct EmbryoFile {
    /// The file or folder.
    pub path: PathBuf,
    /// The embryo: the file's name without its extension, with the name of the folder before it where other files have the same.
    pub name: String,
}

/// Files of a folder that are no embryos.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LeftOut {
    /// The folder.
    pub folder: PathBuf,
    /// The names of the files.
    pub files: Vec<String>,
}

/// Most files of a folder or a pattern.
const MOST: usize = 10_000;

/// Finds the files of embryos. A folder is an embryo itself, or holds embryos; a name with `*` finds the files that fit it. The second
/// list has the files of folders that are no embryos.
///
/// # Errors
/// A folder without embryos, a pattern that no file fits, or a path that cannot be read.
pub fn embryo_files(paths: &[PathBuf]) -> Result<(Vec<EmbryoFile>, Vec<LeftOut>), InputError> {
    let (mut found, mut left_out) = (Vec::new(), Vec::new());
    for path in paths {
        if path.is_dir() {
            in_folder(path, &mut found, &mut left_out)?;
        } else if path.exists() {
            found.push(path.clone());
        } else {
            fitting(path, &mut found)?;
        }
    }
    Ok((named(found), left_out))
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

/// The embryo that a folder is, or those in it.
fn in_folder(folder: &Path, found: &mut Vec<PathBuf>, left_out: &mut Vec<LeftOut>) -> Result<(), InputError> {
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
        if name.starts_with('.') {
            continue;
        }
        match path.is_dir() {
            true if located(&path).is_ok() => found.push(path),
            true => others.push(name),
            false if spot_tables::is_of_links(&path) => {}
            false => match located_file(&path) {
                Ok(Some(_)) => found.push(path),
                _ => others.push(name),
            },
        }
    }
    if found.len() == before {
        // Several GEFFs in a container.
        found.extend(container::geffs_in(folder)?);
    }
    if found.len() == before {
        return Err(reason);
    }
    if !others.is_empty() {
        left_out.push(LeftOut { folder: folder.to_owned(), files: others });
    }
    Ok(())
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
        matches(&name, &own) && !spot_tables::is_of_links(path)
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
