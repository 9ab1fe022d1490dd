//! Input that users write, with errors that name file, field, value, the allowed values.
//!
//! | file | contents |
//! |---|---|
//! | `ron`, `place` | RON documents; the field that an error is about |
//! | `csv_text` | text in CSV files that spreadsheets may open |
//! | `map` | maps by name without a name that is given twice |
//! | `file` | text files of bounded length |
//! | `foreign` | files of other kinds, which errors name |
//! | `names` | names in messages: quoted, shortened, listed, the nearest known one |
//! | `table` | rows of CSV tables |

mod csv_text;
mod file;
pub mod foreign;
mod map;
mod names;
mod place;
mod ron;
pub mod table;

pub use csv_text::{csv_field, csv_value};
pub use file::{LONGEST, open_file, read_older_text_up_to, read_text, read_text_up_to};
pub use map::{unique_entries, unique_map};
pub use names::{did_you_mean, forbidden, listed, printable, printable_lines, rounded_number, shown, shown_number};
pub use place::json_field_at;
pub use ron::{parse_document, parse_ron};

/// Bad input by the user (exit code 2).
#[derive(Debug, thiserror::Error)]
pub enum InputError {
    /// A file cannot be read.
    #[error("{file}: cannot be read: {reason}")]
    Unreadable {
        /// The file.
        file: String,
        /// The system's error.
        reason: String,
    },
    /// A file is of another kind than expected.
    #[error("{file}: is not {wanted}: {reason}")]
    OtherFile {
        /// The file.
        file: String,
        /// The expected kind.
        wanted: String,
        /// Evidence that it is not of this kind.
        reason: String,
    },
    /// A file does not follow its format.
    #[error("{file}:{line}:{column}: {}", printable(message))]
    Malformed {
        /// The file.
        file: String,
        /// Line, from 1.
        line: usize,
        /// Column, from 1.
        column: usize,
        /// The error.
        message: String,
    },
    /// A value is outside the allowed values.
    #[error("{source_name}: {} = {}: must be {}", printable(field), printable(value), printable(allowed))]
    NotAllowed {
        /// The file or option of the value.
        source_name: String,
        /// The field.
        field: String,
        /// Its value.
        value: String,
        /// The allowed values.
        allowed: String,
    },
    /// The founders of a lineage, or the cells of a tree, do not form one tree.
    #[error("{file}: {message}")]
    Founders {
        /// The file.
        file: String,
        /// The error, with the founders' names.
        message: String,
    },
}

/// A number with more characters is written with an exponent in errors.
const LONGEST_NUMBER: usize = 25;

impl InputError {
    /// The error for a file that the system cannot read.
    pub fn unreadable(file: &std::path::Path, reason: impl ToString) -> Self {
        InputError::Unreadable { file: file.display().to_string(), reason: reason.to_string() }
    }

    /// The error for a file that is of another kind than `wanted`.
    pub fn other_file(file: impl ToString, wanted: &str, reason: impl ToString) -> Self {
        InputError::OtherFile { file: file.to_string(), wanted: wanted.to_owned(), reason: reason.to_string() }
    }

    /// The error for `field = value` from `source_name` (a file or an option).
    pub fn not_allowed(
        source_name: impl Into<String>,
        field: impl Into<String>,
        value: impl ToString,
        allowed: impl Into<String>,
    ) -> Self {
        let value = value.to_string();
        // A huge or tiny number has hundreds of digits.
        let number = if value.len() > LONGEST_NUMBER { value.parse().ok() } else { None };
        InputError::NotAllowed {
            source_name: source_name.into(),
            field: field.into(),
            value: number.map_or(value, shown_number),
            allowed: allowed.into(),
        }
    }

    /// Checks `field = value` from `source_name`.
    ///
    /// # Errors
    /// [`InputError::NotAllowed`] unless it holds.
    pub fn require(
        holds: bool,
        source_name: impl Into<String>,
        field: impl Into<String>,
        value: impl ToString,
        allowed: impl Into<String>,
    ) -> Result<(), Self> {
        if holds { Ok(()) } else { Err(InputError::not_allowed(source_name, field, value, allowed)) }
    }
}
