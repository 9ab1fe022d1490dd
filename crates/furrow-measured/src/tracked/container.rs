//! The GEFF inside a folder, such as a Zarr container with images.

use std::fs;
use std::path::{Path, PathBuf};

use furrow_input::{InputError, foreign};

use super::zarr;

/// Folders below a container that may be a GEFF, as `tracks.geff` or `tables/tracks.geff`, and most folders looked at.
const DEEPEST: usize = 2;
const MOST: usize = 1000;

/// The GEFF that a folder is or holds.
///
/// # Errors
/// It holds no GEFF or several.
pub(super) fn geff_in(folder: &Path) -> Result<PathBuf, InputError> {
    if is_group(folder) && zarr::attributes(folder).is_ok_and(|attributes| !attributes["geff"].is_null()) {
        return Ok(folder.to_owned());
    }
    let found = geffs_in(folder)?;
    let wanted = "an embryo that was followed";
    match &found[..] {
        [one] => Ok(one.clone()),
        // The group itself reports its missing parts.
        [] if folder.join("nodes").is_dir() => Ok(folder.to_owned()),
        [] => {
            let neither = "it is a folder with neither nuclei of AceTree (nuclei/t001-nuclei) nor a GEFF, which is a Zarr group \
                           with \"geff\" in its attributes";
            let reason = foreign::folder(folder).unwrap_or_else(|| neither.to_owned());
            Err(InputError::other_file(folder.display(), wanted, reason))
        }
        several => {
            let names: Vec<String> = several.iter().map(|path| path.display().to_string()).collect();
            let reason = format!("it holds {} GEFFs; one of them must be given: {}", several.len(), names.join(", "));
            Err(InputError::other_file(folder.display(), wanted, reason))
        }
    }
}

/// The GEFFs in a folder.
///
/// # Errors
/// A folder that cannot be read.
pub(super) fn geffs_in(folder: &Path) -> Result<Vec<PathBuf>, InputError> {
    let (mut found, mut looked_at) = (Vec::new(), 0);
    look(folder, DEEPEST, &mut looked_at, &mut found)?;
    found.sort();
    Ok(found)
}

/// Whether a folder is a group of Zarr.
fn is_group(folder: &Path) -> bool {
    folder.join("zarr.json").is_file() || folder.join(".zgroup").is_file()
}

/// Collects the GEFFs below a folder.
fn look(folder: &Path, depth: usize, looked_at: &mut usize, found: &mut Vec<PathBuf>) -> Result<(), InputError> {
    for entry in fs::read_dir(folder).map_err(|e| InputError::unreadable(folder, e))? {
        let path = entry.map_err(|e| InputError::unreadable(folder, e))?.path();
        *looked_at += usize::from(path.is_dir());
        if *looked_at > MOST {
            return Ok(());
        }
        let is_geff = || zarr::attributes(&path).is_ok_and(|attributes| !attributes["geff"].is_null());
        if !path.is_dir() {
            continue;
        }
        if is_group(&path) && is_geff() {
            found.push(path);
        } else if depth > 1 {
            look(&path, depth - 1, looked_at, found)?;
        }
    }
    Ok(())
}
