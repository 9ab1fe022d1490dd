//! Files in a zip archive, stored or deflated.

use std::io::Read;
use std::path::Path;

use flate2::{Crc, read::DeflateDecoder};
use furrow_input::{InputError, open_file};

/// Most bytes that are read of an archive, and unpacked of it.
pub(super) const LONGEST: u64 = 1 << 29;

/// Bytes that are unpacked of an archive however short it is, and most beyond them for each of its bytes: text is packed to a
/// tenth.
const SMALL: u64 = 1 << 26;
const TIGHTEST: u64 = 100;

/// Lengths of the end record, of an entry of the directory, and of the header before a file, without their names.
const END: usize = 22;
const ENTRY: usize = 46;
const HEADER: usize = 30;

/// The files of an archive for which `wanted` gives a key by their name, with the name and the content of each.
///
/// # Errors
/// A file that cannot be read, is no archive, is damaged, encrypted or packed by other methods, or is too long.
pub(super) fn files<K>(
    path: &Path,
    wanted: impl Fn(&str) -> Option<K>,
) -> Result<Vec<(K, String, Vec<u8>)>, InputError> {
    let file = path.display().to_string();
    let unreadable = |reason: String| InputError::Unreadable { file: file.clone(), reason };
    let mut bytes = Vec::new();
    open_file(path)?.take(LONGEST + 1).read_to_end(&mut bytes).map_err(|e| unreadable(e.to_string()))?;
    if bytes.len() as u64 > LONGEST {
        return Err(unreadable(format!("it is longer than {} MB, the most that is read of an archive", LONGEST >> 20)));
    }
    let damaged = || InputError::other_file(&file, "a zip archive", "its directory is damaged");
    // The end record comes last, before a comment of at most 65,535 bytes.
    let from = bytes.len().saturating_sub(END + 0xffff);
    let end = (from..=bytes.len().saturating_sub(END)).rev().find(|at| bytes[*at..].starts_with(b"PK\x05\x06"));
    let end = end.ok_or_else(damaged)?;
    let count = number(&bytes, end + 10, 2).ok_or_else(damaged)?;
    let mut at = number(&bytes, end + 16, 4).ok_or_else(damaged)?;
    let (mut out, mut unpacked) = (Vec::new(), 0);
    for _ in 0..count {
        let field = |offset: usize, length: usize| number(&bytes, at + offset, length).ok_or_else(damaged);
        let name = bytes.get(at + ENTRY..at + ENTRY + field(28, 2)?).ok_or_else(damaged)?;
        let name = String::from_utf8_lossy(name).into_owned();
        if !bytes[at..].starts_with(b"PK\x01\x02") {
            return Err(damaged());
        }
        if let Some(key) = wanted(&name) {
            let entry = Entry {
                encrypted: field(8, 2)? & 1 != 0,
                method: field(10, 2)?,
                checksum: field(16, 4)? as u32,
                packed: field(20, 4)?,
                length: field(24, 4)?,
                header: field(42, 4)?,
            };
            unpacked += entry.length as u64;
            let most = LONGEST.min(SMALL.max(TIGHTEST * bytes.len() as u64));
            if unpacked > most {
                let reason = format!("its files are longer than {} MB, the most that is unpacked of it", most >> 20);
                return Err(unreadable(reason));
            }
            let content = unpack(&bytes, &entry)
                .map_err(|why| InputError::other_file(format!("{file}/{name}"), "a file that can be unpacked", why))?;
            out.push((key, name, content));
        }
        at += ENTRY + field(28, 2)? + field(30, 2)? + field(32, 2)?;
    }
    Ok(out)
}

/// The names of the files in an archive.
///
/// # Errors
/// As [`files`].
pub(super) fn names(path: &Path) -> Result<Vec<String>, InputError> {
    let names = std::cell::RefCell::new(Vec::new());
    files(path, |name| {
        names.borrow_mut().push(name.to_owned());
        None::<()>
    })?;
    Ok(names.into_inner())
}

/// A file's entry in the directory.
struct Entry {
    encrypted: bool,
    method: usize,
    checksum: u32,
    packed: usize,
    length: usize,
    header: usize,
}

fn unpack(bytes: &[u8], entry: &Entry) -> Result<Vec<u8>, String> {
    if entry.encrypted {
        return Err("it is encrypted".to_owned());
    }
    let header = bytes.get(entry.header..).filter(|header| header.starts_with(b"PK\x03\x04"));
    let lengths = header.and_then(|header| Some(number(header, 26, 2)? + number(header, 28, 2)?));
    let packed = lengths.and_then(|lengths| bytes.get(entry.header + HEADER + lengths..)?.get(..entry.packed));
    let packed = packed.ok_or("the archive ends before it does")?;
    let mut out = Vec::new();
    match entry.method {
        0 => out.extend(packed),
        8 => {
            // One byte more than announced: the file is longer.
            let mut decoder = DeflateDecoder::new(packed).take(entry.length as u64 + 1);
            decoder.read_to_end(&mut out).map_err(|e| e.to_string())?;
        }
        method => return Err(format!("it is packed by method {method}; stored (0) and deflated (8) files are read")),
    }
    let mut crc = Crc::new();
    crc.update(&out);
    if out.len() != entry.length || crc.sum() != entry.checksum {
        return Err("its length or its checksum is wrong".to_owned());
    }
    Ok(out)
}

/// The little-endian number of some bytes.
fn number(bytes: &[u8], at: usize, length: usize) -> Option<usize> {
    let bytes = bytes.get(at..at.checked_add(length)?)?;
    Some(bytes.iter().rev().fold(0, |number, byte| number << 8 | usize::from(*byte)))
}
