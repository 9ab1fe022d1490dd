//! A source with uniform line ends that ends in an error where a row or the whole is too long: no line and no quoted text fills the
//! memory.

use std::io::{self, Read};

/// Most bytes of a table.
const LONGEST: u64 = 1 << 30;
/// Most bytes of a row.
const LONGEST_ROW: u64 = 1 << 24;

/// Makes text uniform: a line ends with a line feed, and where blanks separate columns there is one between two of them.
pub(super) struct Uniform {
    blanks_separate: bool,
    /// The last byte as it was read, and as it was kept.
    last: [u8; 2],
    /// Whether the number of quotes is odd so far.
    odd_quotes: bool,
}

impl Uniform {
    pub(super) fn new(blanks_separate: bool) -> Uniform {
        Uniform { blanks_separate, last: [b'\n'; 2], odd_quotes: false }
    }

    /// The bytes that are kept of those that follow, moved to the front.
    fn make(&mut self, bytes: &mut [u8]) -> usize {
        if !self.blanks_separate && self.last[0] != b'\r' && !bytes.contains(&b'\r') {
            self.odd_quotes ^= bytes.iter().filter(|byte| **byte == b'"').count() % 2 == 1;
            self.last = bytes.last().map_or(self.last, |last| [*last; 2]);
            return bytes.len();
        }
        let mut kept = 0;
        for at in 0..bytes.len() {
            let (read, byte) = (bytes[at], if bytes[at] == b'\r' { b'\n' } else { bytes[at] });
            let [before, shown] = self.last;
            self.odd_quotes ^= byte == b'"';
            let is_repeated = self.blanks_separate && byte == b' ' && !self.odd_quotes && b" \n".contains(&shown);
            self.last[0] = read;
            if !(is_repeated || read == b'\n' && before == b'\r') {
                (bytes[kept], self.last[1]) = (byte, byte);
                kept += 1;
            }
        }
        kept
    }

    /// The whole text.
    pub(super) fn all(mut self, bytes: &mut Vec<u8>) {
        let kept = self.make(bytes);
        bytes.truncate(kept);
    }
}

/// A source with its limits.
pub(super) struct Bounded<R> {
    from: R,
    uniform: Uniform,
    left: u64,
    left_of_row: u64,
    /// Bytes that were given on.
    given: u64,
}

impl<R: Read> Bounded<R> {
    pub(super) fn new(from: R, uniform: Uniform) -> Bounded<R> {
        Bounded { from, uniform, left: LONGEST, left_of_row: LONGEST_ROW, given: 0 }
    }

    /// Whether a quote is open at the end: quotes come in pairs.
    pub(super) fn has_open_quote(&self) -> bool {
        self.uniform.odd_quotes
    }

    /// Whether no byte behind this one was given on.
    pub(super) fn ends_at(&self, byte: u64) -> bool {
        self.given == byte
    }

    /// Whether the last byte that was given on ends a line.
    pub(super) fn ends_with_line(&self) -> bool {
        self.uniform.last[1] == b'\n'
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
        loop {
            let read = self.from.read(buffer)?;
            let left = |left: u64| left.checked_sub(read as u64);
            let (Some(all), Some(row)) = (left(self.left), left(self.left_of_row)) else {
                let of_row = left(self.left).is_some();
                return if of_row { too_long("a row", LONGEST_ROW) } else { too_long("the table", LONGEST) };
            };
            (self.left, self.left_of_row) = (all, row);
            let kept = self.uniform.make(&mut buffer[..read]);
            if kept > 0 {
                self.given += kept as u64;
                return Ok(kept);
            }
            if read > 0 {
                continue;
            }
            // So that the line of the last row is counted, too.
            let ends = self.uniform.last[1] == b'\n' || self.has_open_quote() || buffer.is_empty();
            if !ends {
                (buffer[0], self.uniform.last[1]) = (b'\n', b'\n');
            }
            self.given += u64::from(!ends);
            return Ok(usize::from(!ends));
        }
    }
}
