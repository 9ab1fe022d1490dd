//! Errors in a JSON document, with the path of the field and in words that users know.

use std::fmt::Write;

use super::TreeFileError;

/// Longest message, in characters.
const LONGEST_MESSAGE: usize = 300;

/// Words of the parser, and plain ones in their place.
const WORDS: [(&str, &str); 7] = [
    ("f64", "a number"),
    ("u32", "a whole number, 0 to 4294967295"),
    ("u64", "a whole number, 0 or above"),
    ("usize", "a whole number, 0 or above"),
    ("a tuple of size 2", "a list of two"),
    ("internally tagged enum TerminalReason", "null or an object with a reason"),
    ("ident", "null, true or false"),
];

/// The error of the parser for a text, with the path of the field where the text is JSON and the field is wrong.
pub(super) fn malformed(text: &str, error: &serde_json::Error) -> TreeFileError {
    let (line, column) = (error.line(), error.column());
    let whole = error.to_string();
    let message = whole.strip_suffix(&format!(" at line {line} column {column}")).unwrap_or(&whole);
    // Numbers are found to be out of range while they are read, before it is known what they are for.
    let path = match error.is_data() || message == "number out of range" {
        true => path_at(text, offset(text, line, column), names_a_field(message)),
        false => String::new(),
    };
    let path = if path.is_empty() { path } else { format!("{path}: ") };
    TreeFileError::Malformed { line, column, message: format!("{path}{}", printable(&in_our_words(message))) }
}

/// Whether a message is about a field of the object that it is in, and not about the value of one.
fn names_a_field(message: &str) -> bool {
    ["missing field", "unknown field", "duplicate field"].iter().any(|begin| message.starts_with(begin))
}

fn in_our_words(message: &str) -> String {
    let Some((before, expected)) = message.rsplit_once("expected ") else { return message.to_owned() };
    match WORDS.iter().find(|(word, _)| *word == expected) {
        Some((_, ours)) => format!("{before}expected {ours}"),
        None if expected.starts_with("struct ") => format!("{before}expected an object in braces {{ }}"),
        None => message.to_owned(),
    }
}

/// A message of bounded length without control characters: parsers quote what they read.
fn printable(message: &str) -> String {
    let mut out = String::new();
    let length = message.chars().count();
    let (head, tail) = (LONGEST_MESSAGE / 2, LONGEST_MESSAGE / 2);
    for (k, c) in message.chars().enumerate() {
        match c {
            _ if length > LONGEST_MESSAGE && k == head => out.push('…'),
            _ if length > LONGEST_MESSAGE && (head..length - tail).contains(&k) => {}
            c if c.is_control() => out.extend(c.escape_default()),
            c => out.push(c),
        }
    }
    out
}

/// The byte before a line and column as the parser counts them, both from 1, the column in bytes.
fn offset(text: &str, line: usize, column: usize) -> usize {
    let before: usize = text.split_inclusive('\n').take(line.saturating_sub(1)).map(str::len).sum();
    (before + column.saturating_sub(1)).min(text.len())
}

/// An object or list that is open at a place of a document.
enum Open<'a> {
    /// An object, the key that was read last, and whether another is expected.
    Object { key: &'a str, expects_key: bool },
    /// A list, and the place in it.
    List(usize),
}

/// The path of the field that a byte of a document belongs to, as in `cells[3].r0`; of the object around it if `of_object`.
fn path_at(text: &str, end: usize, of_object: bool) -> String {
    let bytes = text.as_bytes();
    let mut open: Vec<Open<'_>> = Vec::new();
    let mut at = 0;
    while at < end {
        match (bytes[at], open.last_mut()) {
            (b'{', _) => open.push(Open::Object { key: "", expects_key: true }),
            (b'[', _) => open.push(Open::List(0)),
            (b'}' | b']', _) => drop(open.pop()),
            (b',', Some(Open::Object { expects_key, .. })) => *expects_key = true,
            (b',', Some(Open::List(place))) => *place += 1,
            (b'"', inside) => {
                let start = at + 1;
                at = start;
                while at < bytes.len() && bytes[at] != b'"' {
                    at += if bytes[at] == b'\\' { 2 } else { 1 };
                }
                if let Some(Open::Object { key, expects_key: expects_key @ true }) = inside {
                    *key = text.get(start..at).unwrap_or("");
                    *expects_key = false;
                }
            }
            _ => {}
        }
        at += 1;
    }
    let shown = open.len().min(8) - usize::from(of_object && !open.is_empty() && open.len() <= 8);
    let mut path = String::new();
    for part in open.iter().take(shown) {
        let _ = match part {
            Open::Object { key, .. } if path.is_empty() => write!(path, "{}", printable(key)),
            Open::Object { key, .. } => write!(path, ".{}", printable(key)),
            Open::List(place) => write!(path, "[{place}]"),
        };
    }
    path
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_are_those_of_the_document() {
        let text = r#"{"a": 1, "b\"]": [{"c": [2, {"d": "{[,"}]}, 3], "e": {"f": null}}"#;
        for (found, of_object, path) in [
            ("1", false, "a"),
            ("1", true, ""),
            ("2", false, "b\\\"][0].c[0]"),
            ("{[,", false, "b\\\"][0].c[1].d"),
            ("{[,", true, "b\\\"][0].c[1]"),
            ("3", false, "b\\\"][1]"),
            ("null", false, "e.f"),
            ("}}", true, "e"),
        ] {
            assert_eq!(path_at(text, text.find(found).unwrap(), of_object), path, "{found}");
        }
        assert_eq!(path_at(&"[".repeat(100), 100, false), "[0]".repeat(8));
        assert_eq!(path_at("\"\\", 2, true), "");
    }

    #[test]
    fn messages_are_short_and_free_of_what_terminals_obey() {
        let long = printable(&format!("a\u{1b}[2J{}z", "x".repeat(1000)));
        assert!(long.starts_with("a\\u{1b}[2Jxx") && long.contains('…') && long.ends_with("xz"), "{long}");
        assert_eq!(long.chars().count(), LONGEST_MESSAGE + 1 + "\\u{1b}".len() - 1);
        assert_eq!(
            in_our_words("invalid type: string \"expected f64\", expected f64"),
            "invalid type: string \"expected f64\", expected a number"
        );
    }
}
