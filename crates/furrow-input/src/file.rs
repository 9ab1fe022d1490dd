//! Reading files of any kind that a path may name, in bounded time and memory.

use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

use super::InputError;
use super::table::text;

/// The longest file that is read, in bytes: 64 MB. What users write is far shorter; a longer one is some other file, or one
/// that never ends.
pub const LONGEST: u64 = 64 << 20;

/// Opens a file for reading; a folder is an error.
///
/// # Errors
/// Names the file and why it cannot be read.
pub fn open_file(path: &Path) -> Result<File, InputError> {
    let opened = File::open(path).and_then(|opened| match opened.metadata()?.is_dir() {
        true => Err(io::Error::other("it is a folder, not a file")),
        false => Ok(opened),
    });
    opened.map_err(|e| InputError::Unreadable { file: path.display().to_string(), reason: e.to_string() })
}

/// Reads a whole text file in UTF-8, at most [`LONGEST`] bytes of it. It may be a pipe.
///
/// # Errors
/// Names the file and why it cannot be read.
pub fn read_text(path: &Path) -> Result<String, InputError> {
    read_text_up_to(path, LONGEST)
}

/// [`read_text`] with another limit, in bytes: for what programs write and users do not.
///
/// # Errors
/// As [`read_text`].
pub fn read_text_up_to(path: &Path, longest: u64) -> Result<String, InputError> {
    let text = String::from_utf8(read_bytes_up_to(path, longest)?);
    text.map_err(|error| not_utf8(path, error.as_bytes(), error.utf8_error().valid_up_to()))
}

/// [`read_text_up_to`] of a file that an older program may have written: text that is not UTF-8 is read as Latin-1.
///
/// # Errors
/// As [`read_text`], but for text in another encoding than these.
pub fn read_older_text_up_to(path: &Path, longest: u64) -> Result<String, InputError> {
    let bytes = read_bytes_up_to(path, longest)?;
    if is_utf16(&bytes) { Err(not_utf8(path, &bytes, 0)) } else { Ok(text(&bytes).into_owned()) }
}

fn read_bytes_up_to(path: &Path, longest: u64) -> Result<Vec<u8>, InputError> {
    let file = path.display().to_string();
    let unreadable = |reason: String| InputError::Unreadable { file: file.clone(), reason };
    let too_long = |size: &str| {
        let most = longest as f64 / f64::from(1 << 20);
        unreadable(format!("{size}longer than {most} MB, the most that is read of a file"))
    };
    let mut opened = open_file(path)?;
    // The length of a pipe or a device is 0 here; they are read up to the limit and no further.
    let length = opened.metadata().map_err(|e| unreadable(e.to_string()))?.len();
    if length > longest {
        return Err(too_long(&format!("it has {} MB, which is ", length >> 20)));
    }
    let mut bytes = Vec::new();
    (&mut opened).take(longest + 1).read_to_end(&mut bytes).map_err(|e| unreadable(e.to_string()))?;
    if bytes.len() as u64 > longest {
        return Err(too_long("it is "));
    }
    Ok(bytes)
}

/// Whether text begins with the mark of UTF-16.
pub(crate) fn is_utf16(bytes: &[u8]) -> bool {
    matches!(bytes, [0xff, 0xfe, ..] | [0xfe, 0xff, ..])
}

/// Why UTF-16 is refused.
pub(crate) const UTF16: &str = "this is UTF-16; it must be saved as UTF-8";

/// The error for text in another encoding; `valid` bytes of it are UTF-8.
fn not_utf8(path: &Path, bytes: &[u8], valid: usize) -> InputError {
    let before = String::from_utf8_lossy(&bytes[..valid]);
    let line = 1 + before.matches('\n').count();
    let column = 1 + before.chars().rev().take_while(|c| *c != '\n').count();
    let message = if is_utf16(bytes) {
        UTF16.to_owned()
    } else {
        format!("byte 0x{:02x} is not UTF-8, as text must be", bytes[valid])
    };
    InputError::Malformed { file: path.display().to_string(), line, column, message }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_are_read_up_to_the_limit_and_no_further() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("text");
        std::fs::write(&path, "12345678").unwrap();
        assert_eq!(read_text_up_to(&path, 8).unwrap(), "12345678");
        let said = read_text_up_to(&path, 7).unwrap_err().to_string();
        assert!(said.starts_with(&format!("{}: cannot be read: it has 0 MB, which is longer than", path.display())));
    }

    #[test]
    fn other_encodings_name_the_place() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("text");
        for (bytes, expected) in [
            (&b"first\nG\xf6ttingen"[..], ":2:2: byte 0xf6 is not UTF-8, as text must be"),
            (b"\xff\xfeL\0", ":1:1: this is UTF-16; it must be saved as UTF-8"),
        ] {
            std::fs::write(&path, bytes).unwrap();
            assert_eq!(read_text(&path).unwrap_err().to_string(), format!("{}{expected}", path.display()));
        }
    }
}
