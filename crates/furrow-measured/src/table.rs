//! What tables of all kinds have in common: how they are opened, their rows and numbers, and where something is wrong.

use std::io::{BufRead, BufReader, Read, Take};

use csv::ByteRecord;
use furrow_input::InputError;

/// Most bytes that are read of a table: an endless one is left.
const LONGEST: u64 = 1 << 30;

/// A table, its columns divided by whatever is most frequent in its first line: commas, semicolons or tabs.
///
/// # Errors
/// A file that cannot be read, or is not in UTF-8.
pub(crate) fn open<R: Read>(from: R, file: &str) -> Result<csv::Reader<BufReader<Take<R>>>, InputError> {
    let mut buffered = BufReader::with_capacity(1 << 16, from.take(LONGEST));
    let unreadable = |e: std::io::Error| InputError::Unreadable { file: file.to_owned(), reason: e.to_string() };
    // What some programs write before UTF-8.
    if buffered.fill_buf().map_err(unreadable)?.starts_with(b"\xef\xbb\xbf") {
        buffered.consume(3);
    }
    let first = buffered.fill_buf().map_err(unreadable)?;
    if first.starts_with(b"\xff\xfe") || first.starts_with(b"\xfe\xff") {
        return Err(malformed(file, 1, "this is UTF-16; it must be saved as UTF-8"));
    }
    if first.contains(&0) {
        return Err(malformed(file, 1, "this is no text: it has a byte 0"));
    }
    let line = first.split(|byte| *byte == b'\n').next().unwrap_or_default();
    let delimiter = [b',', b';', b'\t'].into_iter().max_by_key(|d| line.iter().filter(|b| *b == d).count());
    Ok(csv::ReaderBuilder::new()
        .delimiter(delimiter.unwrap_or(b','))
        .flexible(true)
        .has_headers(false)
        .from_reader(buffered))
}

/// Refuses a table of which not all was read.
pub(crate) fn whole<R: Read>(reader: &csv::Reader<R>, file: &str) -> Result<(), InputError> {
    if reader.position().byte() < LONGEST {
        return Ok(());
    }
    let reason = format!("it is longer than {} MB, the most that is read of a table", LONGEST >> 20);
    Err(InputError::Unreadable { file: file.to_owned(), reason })
}

/// The next row, if there is one.
pub(crate) fn next<R: Read>(
    reader: &mut csv::Reader<R>,
    record: &mut ByteRecord,
    file: &str,
) -> Result<bool, InputError> {
    reader.read_byte_record(record).map_err(|error| {
        let line = error.position().map_or(0, csv::Position::line) as usize;
        malformed(file, line.max(1), &error.to_string())
    })
}

/// A finite number.
pub(crate) fn number(text: &[u8]) -> Option<f64> {
    std::str::from_utf8(text).ok()?.parse().ok().filter(|number: &f64| number.is_finite())
}

/// The error at a line of a table.
pub(crate) fn malformed(file: &str, line: usize, message: &str) -> InputError {
    InputError::Malformed { file: file.to_owned(), line, column: 1, message: message.to_owned() }
}
