//! A source that ends in an error where a row or the whole is too long: no line and no quoted text fills the memory.

use std::io::{self, Read};

/// Most bytes of a table.
const LONGEST: u64 = 1 << 30;
/// Most bytes of a row.
const LONGEST_ROW: u64 = 1 << 24;

/// A source with its limits.
pub(super) struct Bounded<R> {
    from: R,
    left: u64,
    left_of_row: u64,
    /// Whether the number of quotes is odd so far.
    odd_quotes: bool,
}

impl<R: Read> Bounded<R> {
    pub(super) fn new(from: R) -> Bounded<R> {
        Bounded { from, left: LONGEST, left_of_row: LONGEST_ROW, odd_quotes: false }
    }

    /// Whether a quote is open at the end: quotes come in pairs.
    pub(super) fn has_open_quote(&self) -> bool {
        self.odd_quotes
    }

    /// From here on another row is read.
    pub(super) fn begin_row(&mut self) {
        self.left_of_row = LONGEST_ROW;
    }
}

impl<R: Read> Read for Bounded<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let too_long =
            |what: &str, most: u64| Err(io::Error::other(format!("{what} is longer than {} MB", most >> 20)));
        let read = self.from.read(buffer)?;
        let left = |left: u64| left.checked_sub(read as u64);
        let (Some(all), Some(row)) = (left(self.left), left(self.left_of_row)) else {
            let of_row = left(self.left).is_some();
            return if of_row { too_long("a row", LONGEST_ROW) } else { too_long("the table", LONGEST) };
        };
        (self.left, self.left_of_row) = (all, row);
        self.odd_quotes ^= buffer[..read].iter().filter(|byte| **byte == b'"').count() % 2 == 1;
        Ok(read)
    }
}
