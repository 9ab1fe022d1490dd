//! What users write: reading RON, and errors that name file, field, value and what is allowed.

use serde::de::DeserializeOwned;
use std::path::Path;

/// Bad input by the user (exit code 2).
#[derive(Debug, thiserror::Error)]
pub enum InputError {
    /// A file cannot be read.
    #[error("{file}: cannot be read: {reason}")]
    Unreadable {
        /// The file.
        file: String,
        /// What the system said.
        reason: String,
    },
    /// A file is not what its format demands.
    #[error("{file}:{line}:{column}: {message}")]
    Malformed {
        /// The file.
        file: String,
        /// Line, from 1.
        line: usize,
        /// Column, from 1.
        column: usize,
        /// What is wrong.
        message: String,
    },
    /// A value is outside what is allowed.
    #[error("{source_name}: {field} = {value}: must be {allowed}")]
    NotAllowed {
        /// The file or the option the value came from.
        source_name: String,
        /// The field.
        field: String,
        /// Its value.
        value: String,
        /// What is allowed.
        allowed: String,
    },
    /// The founders of a lineage do not form one tree.
    #[error("{file}: {message}")]
    Founders {
        /// The file.
        file: String,
        /// What is wrong, naming the founders.
        message: String,
    },
}

impl InputError {
    /// The error for `field = value` from `source_name` (a file or an option).
    pub fn not_allowed(
        source_name: impl Into<String>,
        field: impl Into<String>,
        value: impl ToString,
        allowed: impl Into<String>,
    ) -> Self {
        InputError::NotAllowed {
            source_name: source_name.into(),
            field: field.into(),
            value: value.to_string(),
            allowed: allowed.into(),
        }
    }
}

/// Reads a whole text file.
pub fn read_text(path: &Path) -> Result<String, InputError> {
    std::fs::read_to_string(path)
        .map_err(|e| InputError::Unreadable { file: path.display().to_string(), reason: e.to_string() })
}

/// Reads `text` as RON; `file` is what errors call it. Optional fields are written without `Some`.
pub fn parse_ron<T: DeserializeOwned>(text: &str, file: &str) -> Result<T, InputError> {
    ron::Options::default().with_default_extension(ron::extensions::Extensions::IMPLICIT_SOME).from_str(text).map_err(
        |e| InputError::Malformed {
            file: file.to_owned(),
            line: e.span.start.line,
            column: e.span.start.col,
            message: e.code.to_string(),
        },
    )
}

/// What a user wrote, in quotes, as far as it helps to see it.
pub fn shown(written: &str) -> String {
    const MOST: usize = 60;
    match written.char_indices().nth(MOST) {
        Some((end, _)) => format!("{:?}…", &written[..end]),
        None => format!("{written:?}"),
    }
}

/// "; did you mean …?" where one of `known` is near to what was written, else nothing.
pub fn did_you_mean<'a>(written: &str, known: impl IntoIterator<Item = &'a str>) -> String {
    let written = written.to_lowercase();
    known
        .into_iter()
        .map(|name| (strsim::damerau_levenshtein(&written, &name.to_lowercase()), name))
        // A slip or two, fewer in short words.
        .filter(|(distance, name)| *distance <= 2 && 2 * *distance < name.chars().count().max(2))
        .min_by_key(|(distance, _)| *distance)
        .map_or(String::new(), |(_, name)| format!("; did you mean {name}?"))
}
