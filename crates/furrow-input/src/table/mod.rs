//! Rows of CSV tables with their lines, and errors that name the place.
//!
//! | file | contents |
//! |---|---|
//! | `heading` | the names of columns, and the units in them |
//! | `number` | numbers with decimal points or commas |
//! | `bounded` | a source that ends where a row or the table is too long |
//! | `survey` | how the first megabyte of a table writes numbers and names rows |

mod bounded;
mod heading;
mod number;
mod survey;

use std::borrow::Cow;
use std::io::{Chain, Cursor, Read};

use csv::ByteRecord;

use crate::file::{UTF16, is_utf16};
use crate::{InputError, foreign, shown};
use bounded::{Bounded, Uniform};
use heading::is_unnamed;
use number::is_number;
use survey::Survey;

pub use heading::{Header, NamedUnit, QuantityColumn, TIMES, split_unit, unit_of, unit_word, units_listed};
pub use number::{Numbers, number};

/// Bytes at the start of a table that decide how it is written.
const HEAD: u64 = 1 << 20;

/// A table that is being read row by row.
pub struct Table<'f, R: Read> {
    reader: csv::Reader<Bounded<Chain<Cursor<Vec<u8>>, R>>>,
    record: ByteRecord,
    /// The line on which the row begins.
    line: u64,
    file: &'f str,
    separator: u8,
    heading: Heading,
    survey: Survey,
}

/// The names of a table's columns.
#[derive(Default)]
struct Heading {
    names: Vec<String>,
    /// Columns at the left without a name, as pandas and R write numbers of rows.
    index: usize,
    /// Columns up to the last one with a name.
    named: usize,
    /// Columns are found by their names, so that a second heading is an error.
    is_only: bool,
}

/// A row that is neither a comment nor empty.
#[derive(Clone, Copy)]
pub struct Row<'t> {
    /// Its line.
    pub line: u64,
    record: &'t ByteRecord,
    heading: &'t Heading,
    survey: &'t Survey,
}

impl<'t> Row<'t> {
    /// The text in a column, without blanks around it; empty if the row is shorter.
    pub fn text(&self, column: usize) -> &'t [u8] {
        self.record.get(column).unwrap_or_default().trim_ascii()
    }

    /// The number in a column.
    ///
    /// # Errors
    /// As [`Numbers::read`].
    pub fn number(&self, column: usize) -> Result<f64, String> {
        self.numbers(column).read(self.text(column))
    }

    /// How the numbers of a column are written.
    pub fn numbers(&self, column: usize) -> Numbers {
        self.survey.columns.numbers(column)
    }

    /// The name of a column.
    pub fn name(&self, column: usize) -> &'t str {
        self.heading.names.get(column).map_or("", String::as_str)
    }

    /// Number of fields, including fields without a name.
    pub fn len(&self) -> usize {
        self.record.len()
    }

    /// Whether there is no field.
    pub fn is_empty(&self) -> bool {
        self.record.is_empty()
    }

    /// Whether it has at least two fields, and the same number as the heading.
    fn is_full(&self) -> bool {
        self.len() >= 2 && self.len() == self.heading.names.len()
    }

    /// Whether the row is a second, different heading: a field repeats its column's name, and no field is a number.
    fn is_other_heading(&self) -> bool {
        let names = &self.heading.names;
        let is_name = |(field, name): (&[u8], &String)| text(field.trim_ascii()).eq_ignore_ascii_case(name);
        let filled = || self.record.iter().zip(names).filter(|(field, _)| !field.trim_ascii().is_empty());
        let same = filled().filter(|pair| is_name(*pair)).count();
        (1..filled().count()).contains(&same) && !self.record.iter().any(is_number)
    }

    /// The column for which a row cannot be used, and why: the first with a value but without a name, since fields may have been cut at a
    /// decimal comma; or the first of all if the row may be a comment or data.
    pub fn surplus(&self) -> Option<(usize, String)> {
        let Heading { names, index, named, .. } = self.heading;
        if is_comment(self.record) {
            let why = "begins with # and has as many fields as the heading: a comment, or data if # is left out";
            return Some((0, format!("line {} {why}", self.line)));
        }
        let unnamed =
            |column: &usize| names.get(*column).is_none_or(String::is_empty) && !self.text(*column).is_empty();
        let column = (*index..self.len()).find(unnamed)?;
        let fields = (0..self.len()).rev().find(|column| !self.text(*column).is_empty()).map_or(0, |last| last + 1);
        let line = self.line;
        Some((
            column,
            match fields > *named {
                true => format!("line {line} has {fields} fields, the heading {named}"),
                false => format!("line {line} has a value in column {}, which has no name", column + 1),
            },
        ))
    }
}

impl<'f, R: Read> Table<'f, R> {
    /// Opens a table. The separator of columns is the one that Excel names in a line `sep=`; otherwise the most frequent of comma, semicolon
    /// and tab in the first line with text, or a blank if that line has none of them. Commas in a line of numbers with decimal commas do
    /// not count.
    ///
    /// # Errors
    /// A file that cannot be read, is not text, or is of [another kind](foreign).
    pub fn open(mut from: R, file: &'f str) -> Result<Table<'f, R>, InputError> {
        let mut head = Vec::new();
        let unreadable = |e: std::io::Error| InputError::Unreadable { file: file.to_owned(), reason: e.to_string() };
        let is_whole = from.by_ref().take(HEAD).read_to_end(&mut head).map_err(unreadable)? < HEAD as usize;
        // Some programs write a byte-order mark before UTF-8.
        if head.starts_with(b"\xef\xbb\xbf") {
            head.drain(..3);
        }
        foreign::refuse(file, &head, "a table (CSV)")?;
        if is_utf16(&head) {
            return Err(malformed(file, 1, UTF16));
        }
        if let Some(at) = head.iter().position(|byte| *byte == 0) {
            let line = 1 + head[..at].iter().filter(|byte| **byte == b'\n').count();
            return Err(malformed(file, line, "this is no text: it has a byte 0"));
        }
        // A line end is not cut.
        if head.ends_with(b"\r") {
            from.by_ref().take(1).read_to_end(&mut head).map_err(unreadable)?;
        }
        Uniform::new(false).all(&mut head);
        // Comments are ignored when the separator of columns is determined.
        let says = |line: &&[u8]| !line.starts_with(b"#") && !line.trim_ascii().is_empty();
        let mut lines = head.split(|byte| *byte == b'\n').filter(says);
        let separator = separator([lines.next(), lines.next()].map(Option::unwrap_or_default));
        let uniform = || Uniform::new(separator == b' ');
        uniform().all(&mut head);
        let survey = Survey::of(separator, &head, is_whole);
        let reader = reader(separator).from_reader(Bounded::new(Cursor::new(head).chain(from), uniform()));
        Ok(Table { reader, record: ByteRecord::new(), line: 0, file, separator, heading: Heading::default(), survey })
    }

    /// How the numbers of a column are written.
    pub fn numbers(&self, column: usize) -> Numbers {
        self.survey.columns.numbers(column)
    }

    /// Lets columns of one quantity show each other how their numbers are written.
    pub fn share(&mut self, columns: impl IntoIterator<Item = usize>) {
        self.survey.columns.share(&columns.into_iter().collect::<Vec<_>>());
    }

    /// The names of the columns, and their line: the first row that is neither empty nor a comment, or one that `is_header` accepts
    /// although it looks like one. Names such as `Unnamed: 0`, which pandas gives to columns
    /// without a name, are empty here.
    ///
    /// # Errors
    /// A table without such a row, and as [`next`](Self::next).
    pub fn header(&mut self, is_header: impl Fn(&[String]) -> bool) -> Result<(usize, Vec<String>), InputError> {
        while self.advance()? {
            let mut header = names(&self.record);
            if is_comment(&self.record) {
                // NumPy writes a heading as a comment.
                header[0] = header[0].trim_start_matches(['#', ' ']).to_owned();
            }
            if !is_empty(&self.record) && (!is_comment(&self.record) || is_header(&header)) {
                let (line, _) = self.here();
                header.iter_mut().filter(|name| is_unnamed(name)).for_each(String::clear);
                if self.survey.has_row_names {
                    header.insert(0, String::new());
                }
                self.name_columns(header.clone());
                return Ok((line as usize, header));
            }
        }
        Err(malformed(self.file, 1, "the table is empty; its first line must name its columns"))
    }

    /// As [`header`](Self::header), for columns that are found by their names.
    ///
    /// # Errors
    /// As [`header`](Self::header), and two columns with names that are alike.
    pub fn columns(&mut self, is_header: impl Fn(&[String]) -> bool) -> Result<Header<'f>, InputError> {
        let (line, names) = self.header(&is_header)?;
        self.heading.is_only = true;
        Header::new(self.file, line, names, |name| is_header(&[String::new(), name.to_owned()]))
    }

    /// Names the columns, where the heading was read by [`next`](Self::next).
    pub fn name_columns(&mut self, names: Vec<String>) {
        let index = names.iter().take_while(|name| name.is_empty()).count();
        let named = names.iter().rposition(|name| !name.is_empty()).map_or(0, |last| last + 1);
        self.heading = Heading { names, index, named, is_only: false };
    }

    /// The next row that is neither empty nor a comment; `None` at the end. A row that begins with `#` but has as many fields as the
    /// heading may be data: the caller asks whether a row can be used ([`Row::surplus`]).
    ///
    /// # Errors
    /// As [`next`](Self::next), for a row that cannot be read.
    pub fn next_row(&mut self) -> Result<Option<Row<'_>>, InputError> {
        while self.advance()? {
            let is_comment = is_comment(&self.record) && !self.row().is_full();
            if self.heading.is_only && self.row().is_other_heading() {
                let why = "another heading: each table needs a file of its own";
                return Err(malformed(self.file, self.line as usize, why));
            }
            if !is_comment && !is_empty(&self.record) {
                return Ok(Some(self.row()));
            }
        }
        Ok(None)
    }

    /// The next row and its line; `None` at the end. Once columns have names, empty rows are passed over.
    ///
    /// # Errors
    /// A row that cannot be read or is longer than the heading, or a table that is too long.
    #[expect(clippy::should_implement_trait, reason = "a row borrows from the table")]
    pub fn next(&mut self) -> Result<Option<(u64, &ByteRecord)>, InputError> {
        let has_names = !self.heading.names.is_empty();
        while self.advance()? {
            if has_names && is_empty(&self.record) {
                continue;
            }
            if let Some((_, why)) = self.row().surplus().filter(|_| has_names) {
                return Err(malformed(self.file, self.here().0 as usize, why));
            }
            return Ok(Some(self.here()));
        }
        Ok(None)
    }

    fn here(&self) -> (u64, &ByteRecord) {
        (self.line, &self.record)
    }

    /// The line of the row that was read last. The reader reports the first of the empty lines before it.
    fn line_read(&self) -> u64 {
        let within = self.record.as_slice().iter().filter(|byte| **byte == b'\n').count() as u64;
        let (source, at) = (self.reader.get_ref(), self.reader.position());
        // The line end of the last row may be in a quote that is not closed.
        let is_cut = source.ends_at(at.byte()) && source.has_open_quote();
        let is_cut = is_cut && (self.record.as_slice().ends_with(b"\n") || !source.ends_with_line());
        (at.line() + u64::from(is_cut)).saturating_sub(1 + within)
    }

    fn row(&self) -> Row<'_> {
        let (line, record) = self.here();
        Row { line, record, heading: &self.heading, survey: &self.survey }
    }

    /// Reads the next row, if there is one.
    fn advance(&mut self) -> Result<bool, InputError> {
        self.reader.get_mut().begin_row();
        let before = self.here().0;
        let spans_lines = self.record.as_slice().contains(&b'\n');
        let more = self.reader.read_byte_record(&mut self.record).map_err(|error| {
            let line = error.position().map_or_else(|| self.reader.position().line(), csv::Position::line);
            match error.kind() {
                csv::ErrorKind::Io(error) => malformed(self.file, line.max(1) as usize, error.to_string()),
                _ => malformed(self.file, line.max(1) as usize, error.to_string()),
            }
        })?;
        self.line = self.line_read();
        if !more && spans_lines && self.reader.get_ref().has_open_quote() {
            return Err(malformed(self.file, before.max(1) as usize, "a quote that opens in this row is not closed"));
        }
        if more && let Some(row) = self.quoted_row() {
            let found = format!(
                "a quoted text of this row ends on another line and has what may be a row, {}",
                shown(&text(row))
            );
            let why = match self.reader.get_ref().has_open_quote() {
                true => format!("a quote that opens in this row is not closed: {found}"),
                false => format!("{found}: close the quotation mark, or leave it out"),
            };
            return Err(malformed(self.file, self.here().0.max(1) as usize, why));
        }
        Ok(more)
    }

    /// A line in a quoted text that has as many fields as the heading, and a number among them: two quotation marks that are no
    /// quotes hide the rows between them.
    fn quoted_row(&self) -> Option<&[u8]> {
        let columns = self.heading.named.max(2);
        let is_row = |line: &&[u8]| {
            let fields = || line.split(|byte| *byte == self.separator);
            fields().count() >= columns && fields().any(is_number)
        };
        let lines = self
            .record
            .iter()
            .filter(|field| field.contains(&b'\n'))
            .flat_map(|field| field.split(|byte| *byte == b'\n'));
        lines.map(<[u8]>::trim_ascii).find(|line| !self.heading.names.is_empty() && is_row(line))
    }
}

/// A reader of rows of any length.
fn reader(separator: u8) -> csv::ReaderBuilder {
    let mut builder = csv::ReaderBuilder::new();
    builder.delimiter(separator).flexible(true).has_headers(false);
    builder
}

/// What separates the columns of the first two lines with text.
fn separator([line, next]: [&[u8]; 2]) -> u8 {
    if let Some(named) = line.strip_prefix(b"sep=").and_then(<[u8]>::first) {
        return *named;
    }
    let decimal_commas = |separator: &u8| {
        let fields = || line.split(|byte| byte == separator);
        fields().count() > 1 && fields().all(is_number)
    };
    let outside_quotes = |separator: u8| count_outside_quotes(line, separator);
    // Commas of a heading may come before units, and commas of numbers before decimals: then another character separates both lines.
    let beside_commas = |separator: &u8| {
        let [there, next_there] = [line, next].map(|line| count_outside_quotes(line, *separator));
        let differ = outside_quotes(b',') != count_outside_quotes(next, b',');
        let mut fields = next.split(|byte| byte == separator);
        there > 0 && there == next_there && (differ || fields.any(|field| field.contains(&b',') && is_number(field)))
    };
    let found = [b';', b'\t'].into_iter().find(|separator| decimal_commas(separator) || beside_commas(separator));
    found.unwrap_or_else(|| {
        let most = [b'\t', b';', b','].into_iter().max_by_key(|separator| outside_quotes(*separator)).unwrap_or(b',');
        // R and btrack write blanks.
        if outside_quotes(most) == 0 && outside_quotes(b' ') > 0 { b' ' } else { most }
    })
}

fn count_outside_quotes(line: &[u8], separator: u8) -> usize {
    let mut quoted = false;
    line.iter()
        .filter(|byte| {
            quoted ^= **byte == b'"';
            **byte == separator && !quoted
        })
        .count()
}

/// Whether a row is a comment, or the line by which Excel names the separator.
fn is_comment(row: &ByteRecord) -> bool {
    row.get(0).is_some_and(|field| field.starts_with(b"#") || field == b"sep=")
}

/// Whether a row has no value.
fn is_empty(row: &ByteRecord) -> bool {
    row.iter().all(|field| field.trim_ascii().is_empty())
}

/// Text in UTF-8, and any other as if in Latin-1, as older programs write it.
pub fn text(bytes: &[u8]) -> Cow<'_, str> {
    match std::str::from_utf8(bytes) {
        Ok(text) => Cow::Borrowed(text),
        Err(_) => bytes.iter().map(|byte| char::from(*byte)).collect::<String>().into(),
    }
}

/// The names of the columns, without blanks around them.
pub fn names(header: &ByteRecord) -> Vec<String> {
    header.iter().map(|name| text(name).trim().to_owned()).collect()
}

/// The first few names of columns, for an error.
pub fn columns_listed(header: &[String]) -> String {
    let shown: Vec<String> = header.iter().take(8).map(|name| format!("{name:?}")).collect();
    let more = header.len().saturating_sub(shown.len());
    shown.join(", ") + &if more > 0 { format!(" and {more} more") } else { String::new() }
}

/// The error at a line of a table.
pub fn malformed(file: &str, line: usize, message: impl Into<String>) -> InputError {
    InputError::Malformed { file: file.to_owned(), line, column: 1, message: message.into() }
}
