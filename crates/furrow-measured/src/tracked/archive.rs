//! Files in a zip archive, stored or deflated.

use std::fs::File;
use std::io::Read;
use std::path::Path;

use furrow_input::{InputError, open_file};
use zip::ZipArchive;
use zip::result::ZipError;

/// Most bytes that are read of an archive, and unpacked of it.
pub(super) const LONGEST: u64 = 1 << 29;

/// Bytes that are unpacked of an archive however short it is, and most beyond them for each of its bytes: text is packed to a
/// tenth.
const SMALL: u64 = 1 << 26;
const TIGHTEST: u64 = 100;

/// The files of an archive for which `wanted` gives a key by their name, with the name and the content of each.
///
/// # Errors
/// A file that cannot be read, is no archive, is damaged, encrypted or packed by other methods, or is too long.
pub(super) fn files<K>(
    path: &Path,
    wanted: impl Fn(&str) -> Option<K>,
) -> Result<Vec<(K, String, Vec<u8>)>, InputError> {
    let (mut archive, length) = opened(path)?;
    let most = LONGEST.min(SMALL.max(TIGHTEST * length));
    let (mut out, mut left) = (Vec::new(), most);
    for (index, name) in names_in(&archive).into_iter().enumerate() {
        let Some(key) = wanted(&name) else { continue };
        let file = format!("{}/{name}", path.display());
        let refused = |why: String| InputError::other_file(&file, "a file that can be unpacked", why);
        let mut entry = archive.by_index(index).map_err(|error| refused(described(error)))?;
        let length = entry.size();
        left = left.checked_sub(length).ok_or_else(|| {
            let reason = format!("its files are longer than {} MB, the most that is unpacked of it", most >> 20);
            InputError::unreadable(path, reason)
        })?;
        let mut content = Vec::new();
        // One byte more than announced: the file is longer.
        let read = (&mut entry).take(length + 1).read_to_end(&mut content);
        read.map_err(|error| refused(described(error.downcast().unwrap_or_else(ZipError::Io))))?;
        if content.len() as u64 != length {
            return Err(refused(WRONG.to_owned()));
        }
        out.push((key, name, content));
    }
    Ok(out)
}

/// The names of the files in an archive.
///
/// # Errors
/// A file that cannot be read, is no archive or is too long.
pub(super) fn names(path: &Path) -> Result<Vec<String>, InputError> {
    Ok(names_in(&opened(path)?.0))
}

fn names_in(archive: &ZipArchive<File>) -> Vec<String> {
    archive.file_names_raw().map(|name| String::from_utf8_lossy(name).into_owned()).collect()
}

/// An archive, and its length.
fn opened(path: &Path) -> Result<(ZipArchive<File>, u64), InputError> {
    let file = open_file(path)?;
    let length = file.metadata().map_err(|e| InputError::unreadable(path, e))?.len();
    if length > LONGEST {
        let reason = format!("it is longer than {} MB, the most that is read of an archive", LONGEST >> 20);
        return Err(InputError::unreadable(path, reason));
    }
    let damaged = || InputError::other_file(path.display(), "a zip archive", "its directory is damaged");
    let archive = ZipArchive::new(file).ok().filter(|archive| !archive.has_duplicate_names());
    Ok((archive.ok_or_else(damaged)?, length))
}

const WRONG: &str = "its length or its checksum is wrong";

/// Why a file cannot be unpacked.
fn described(error: ZipError) -> String {
    match error {
        ZipError::UnsupportedArchive(ZipError::PASSWORD_REQUIRED) => "it is encrypted".to_owned(),
        ZipError::CompressionMethodNotSupported(method) => {
            format!("it is packed by method {method}; stored (0) and deflated (8) files are read")
        }
        ZipError::Io(error) if error.to_string() == "Invalid checksum" => WRONG.to_owned(),
        ZipError::Io(error) if error.kind() == std::io::ErrorKind::UnexpectedEof => {
            "the archive ends before it does".to_owned()
        }
        ZipError::Io(error) => error.to_string(),
        other => other.to_string(),
    }
}
