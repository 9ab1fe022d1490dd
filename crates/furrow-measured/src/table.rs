//! Rows of CSV tables with their lines, and errors that name the place.

use std::io::{BufRead, BufReader, Read, Take};

use csv::ByteRecord;
use furrow_input::InputError;

use crate::tracked::foreign;

/// Most bytes read of a table, so that an endless one ends.
const LONGEST: u64 = 1 << 30;

/// A table that is being read row by row.
pub(crate) struct Table<'f, R: Read> {
    reader: csv::Reader<BufReader<Take<R>>>,
    record: ByteRecord,
    file: &'f str,
}

impl<'f, R: Read> Table<'f, R> {
    /// Opens a table. The most frequent of comma, semicolon and tab in its first line that is not empty separates its columns.
    ///
    /// # Errors
    /// A file that cannot be read, or is not in UTF-8.
    pub(crate) fn open(from: R, file: &'f str) -> Result<Table<'f, R>, InputError> {
        let mut buffered = BufReader::with_capacity(1 << 16, from.take(LONGEST));
        let unreadable = |e: std::io::Error| InputError::Unreadable { file: file.to_owned(), reason: e.to_string() };
        // Some programs write a byte-order mark before UTF-8.
        if buffered.fill_buf().map_err(unreadable)?.starts_with(b"\xef\xbb\xbf") {
            buffered.consume(3);
        }
        let first = buffered.fill_buf().map_err(unreadable)?;
        foreign::refuse(file, first)?;
        if first.starts_with(b"\xff\xfe") || first.starts_with(b"\xfe\xff") {
            return Err(malformed(file, 1, "this is UTF-16; it must be saved as UTF-8"));
        }
        if first.contains(&0) {
            return Err(malformed(file, 1, "this is no text: it has a byte 0"));
        }
        // Text in a comment says nothing of the columns.
        let says = |line: &&[u8]| !line.starts_with(b"#") && !line.trim_ascii().is_empty();
        let line = first.split(|byte| *byte == b'\n').find(says).unwrap_or_default();
        let delimiter = [b',', b';', b'\t'].into_iter().max_by_key(|d| line.iter().filter(|b| *b == d).count());
        let mut builder = csv::ReaderBuilder::new();
        builder.delimiter(delimiter.unwrap_or(b',')).flexible(true).has_headers(false);
        Ok(Table { reader: builder.from_reader(buffered), record: ByteRecord::new(), file })
    }

    /// The names of the columns, and their line: the first row that is no comment, or one that `is_header` accepts although it looks
    /// like one.
    ///
    /// # Errors
    /// A table without such a row, and as [`next`](Self::next).
    pub(crate) fn header(&mut self, is_header: impl Fn(&[String]) -> bool) -> Result<(usize, Vec<String>), InputError> {
        while let Some((line, row)) = self.next()? {
            let header = names(row);
            if !is_comment(row) || is_header(&header) {
                return Ok((line as usize, header));
            }
        }
        Err(malformed(self.file, 1, "the table is empty; its first line must name its columns"))
    }

    /// The next row that is no comment, and its line; `None` at the end.
    ///
    /// # Errors
    /// As [`next`](Self::next).
    pub(crate) fn next_row(&mut self) -> Result<Option<(u64, &ByteRecord)>, InputError> {
        while self.advance()? {
            if !is_comment(&self.record) {
                return Ok(Some(self.here()));
            }
        }
        Ok(None)
    }

    /// The next row and its line; `None` at the end.
    ///
    /// # Errors
    /// A row that cannot be read, or a table longer than [`LONGEST`].
    pub(crate) fn next(&mut self) -> Result<Option<(u64, &ByteRecord)>, InputError> {
        Ok(self.advance()?.then(|| self.here()))
    }

    fn here(&self) -> (u64, &ByteRecord) {
        (self.record.position().map_or(0, csv::Position::line), &self.record)
    }

    /// Reads the next row, if there is one.
    fn advance(&mut self) -> Result<bool, InputError> {
        let more = self.reader.read_byte_record(&mut self.record).map_err(|error| {
            let line = error.position().map_or(0, csv::Position::line) as usize;
            malformed(self.file, line.max(1), error.to_string())
        })?;
        if !more && self.reader.position().byte() >= LONGEST {
            let reason = format!("it is longer than {} MB, the most that is read of a table", LONGEST >> 20);
            return Err(InputError::Unreadable { file: self.file.to_owned(), reason });
        }
        Ok(more)
    }
}

/// Whether a row is a comment.
fn is_comment(row: &ByteRecord) -> bool {
    row.get(0).is_some_and(|field| field.starts_with(b"#"))
}

/// The names of the columns, without blanks around them.
pub(crate) fn names(header: &ByteRecord) -> Vec<String> {
    header.iter().map(|name| String::from_utf8_lossy(name).trim().to_owned()).collect()
}

/// The first few names of columns, for an error.
pub(crate) fn listed(header: &[String]) -> String {
    let shown: Vec<String> = header.iter().take(8).map(|name| format!("{name:?}")).collect();
    let more = header.len().saturating_sub(shown.len());
    shown.join(", ") + &if more > 0 { format!(" and {more} more") } else { String::new() }
}

/// A finite number.
pub(crate) fn number(text: &[u8]) -> Option<f64> {
    std::str::from_utf8(text).ok()?.parse().ok().filter(|number: &f64| number.is_finite())
}

/// The error at a line of a table.
pub(crate) fn malformed(file: &str, line: usize, message: impl Into<String>) -> InputError {
    InputError::Malformed { file: file.to_owned(), line, column: 1, message: message.into() }
}
