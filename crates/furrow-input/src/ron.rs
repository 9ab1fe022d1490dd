//! Reads RON, with errors that name line, column, field, value and the expected text.

use ::ron::error::{Error, Position, SpannedError};
use serde::de::DeserializeOwned;

use super::place::{field_at, holder_at};
use super::{InputError, did_you_mean, shown};

/// Reads `text` as RON; errors call it `file`. Optional fields are written without `Some`. A byte order mark at the
/// beginning is skipped.
///
/// # Errors
/// Names file, line, column, field, value and the expected text.
pub fn parse_ron<T: DeserializeOwned>(text: &str, file: &str) -> Result<T, InputError> {
    let text = without_mark(text);
    let options = ::ron::Options::default().with_default_extension(::ron::extensions::Extensions::IMPLICIT_SOME);
    options.from_str(text).map_err(|error| malformed(text, file, &error))
}

/// [`parse_ron`] of a whole file of a `kind`, such as "a lineage file", which begins with `name` and a parenthesis or with the
/// parenthesis alone. Any other file is reported as another kind rather than as malformed.
///
/// # Errors
/// See [`parse_ron`].
pub fn parse_document<T: DeserializeOwned>(text: &str, file: &str, kind: &str, name: &str) -> Result<T, InputError> {
    parse_ron(text, file).map_err(|error| {
        let start = beginning(without_mark(text));
        let behind = start.strip_prefix(name).unwrap_or(start).trim_start();
        if behind.starts_with('(') {
            return error;
        }
        let line = start.lines().next().map(|line| format!("it begins with {}", shown(line.trim_end())));
        let found = line.unwrap_or("it is empty".to_owned());
        let reason = format!("{found}, and {kind} is RON that begins with {name}(");
        InputError::other_file(file, kind, reason)
    })
}

fn without_mark(text: &str) -> &str {
    text.strip_prefix('\u{feff}').unwrap_or(text)
}

/// The text after leading blanks, comments and RON's attributes.
fn beginning(text: &str) -> &str {
    let mut rest = text.trim_start();
    loop {
        let end = match rest {
            _ if rest.starts_with("//") => rest.find('\n'),
            _ if rest.starts_with("/*") => rest.find("*/").map(|end| end + 2),
            _ if rest.starts_with("#![") => rest.find(']').map(|end| end + 1),
            _ => return rest,
        };
        rest = end.map_or("", |end| rest[end..].trim_start());
    }
}

/// The byte at a line and column, both from 1; columns are characters.
fn byte_at(text: &str, position: Position) -> usize {
    let start = match position.line {
        0 | 1 => 0,
        line => text.match_indices('\n').nth(line - 2).map_or(text.len(), |(at, _)| at + 1),
    };
    text[start..].char_indices().nth(position.col.saturating_sub(1)).map_or(text.len(), |(at, _)| start + at)
}

/// The parser's error with the field, its value and the expected text.
fn malformed(text: &str, file: &str, error: &SpannedError) -> InputError {
    // The parser stops before a value it has not read, and after one it has read.
    let (position, field, said) = match expected(&error.code) {
        Some(wanted) => {
            let at = byte_at(text, error.span.end);
            let found = found(&text[at..]);
            let said = match digits_before(text, at) {
                // An integer was read up to its decimal point.
                whole if !whole.is_empty() && found.starts_with('.') => {
                    format!("expected a whole number, found {whole}{found}")
                }
                _ => format!("expected {wanted}, found {found}"),
            };
            (error.span.end, field_at(text, at), said)
        }
        None => {
            let at = byte_at(text, error.span.start);
            // A missing field, or an error of several fields together, belongs to their parent.
            let whole = matches!(error.code, Error::MissingStructField { .. } | Error::Message(_));
            let field = if whole { holder_at(text, at) } else { field_at(text, at) };
            (error.span.start, field, said(&error.code))
        }
    };
    let message = if field.is_empty() { said } else { format!("{field}: {said}") };
    InputError::Malformed { file: file.to_owned(), line: position.line, column: position.col, message }
}

/// The digits that end at byte `at`.
fn digits_before(text: &str, at: usize) -> &str {
    let before = &text[..at];
    &before[before.trim_end_matches(|c: char| c.is_ascii_digit()).len()..]
}

/// The value at the start of a text.
fn found(text: &str) -> String {
    let end = match text.chars().next() {
        None => return "the end of the file".to_owned(),
        Some('"') => text[1..].find('"').map_or(text.len(), |end| end + 2),
        Some(c) if c.is_alphanumeric() || "+-._".contains(c) => {
            text.find(|c: char| !(c.is_alphanumeric() || "+-._".contains(c))).unwrap_or(text.len())
        }
        Some(c) => c.len_utf8(),
    };
    let value = text[..end].lines().next().unwrap_or("");
    match value.char_indices().nth(60) {
        Some((cut, _)) => format!("{}…", &value[..cut]),
        None => value.to_owned(),
    }
}

/// The text that the parser expected, if its error gives nothing else.
fn expected(error: &Error) -> Option<&'static str> {
    Some(match error {
        Error::ExpectedFloat => "a number",
        Error::ExpectedInteger => "a whole number",
        Error::ExpectedBoolean => "true or false",
        Error::ExpectedString => "text in double quotes",
        Error::ExpectedChar => "a character in single quotes",
        Error::ExpectedArray => "a list in brackets [ ]",
        Error::ExpectedArrayEnd => "a comma or the closing ]",
        Error::ExpectedMap => "entries in braces { }",
        Error::ExpectedMapEnd => "a comma or the closing }",
        Error::ExpectedMapColon => "a colon",
        Error::ExpectedComma => "a comma or the closing bracket",
        Error::ExpectedStructLike | Error::ExpectedNamedStructLike(_) => "parentheses ( )",
        Error::ExpectedStructLikeEnd | Error::ExpectedOptionEnd => "a comma or the closing )",
        Error::ExpectedIdentifier => "a name without quotes",
        Error::ExpectedUnit => "()",
        Error::ExpectedStringEnd => "the closing quote of the text",
        Error::TrailingCharacters => "the end of the file",
        Error::Eof => "more",
        _ => return None,
    })
}

/// Other errors of the parser.
fn said(error: &Error) -> String {
    let one_of = |kind: &str, found: &str, expected: &[&str]| {
        let names = match expected {
            [] => "none is known".to_owned(),
            _ => format!("must be one of {}", expected.join(", ")),
        };
        format!("unknown {kind} {}: {names}{}", shown(found), did_you_mean(found, expected.iter().copied()))
    };
    match error {
        Error::NoSuchStructField { expected, found, .. } => one_of("field", found, expected),
        Error::NoSuchEnumVariant { expected, found, .. } => one_of("name", found, expected),
        Error::MissingStructField { field, .. } => format!("the field {field:?} is missing"),
        Error::DuplicateStructField { field, .. } => format!("the field {field:?} is given twice"),
        Error::ExpectedDifferentStructName { expected, found } => {
            format!("expected {expected}( or a parenthesis alone, found {}", shown(found))
        }
        Error::InvalidValueForType { expected, found } => format!("expected {expected}, found {found}"),
        Error::SuggestRawIdentifier(word) | Error::InvalidIdentifier(word) => {
            format!("expected the name of a field, found {word}")
        }
        Error::IntegerOutOfBounds => "the whole number is negative or too large".to_owned(),
        Error::ExceededRecursionLimit => "brackets are nested too deeply".to_owned(),
        other => other.to_string(),
    }
}
