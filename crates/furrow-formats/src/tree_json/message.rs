//! Errors in a JSON document, with the path of the field and in words that users know.

use serde::Deserialize;

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

/// The error of the parser for a text that is no `T`, with the path of the field where the text is JSON.
pub(super) fn malformed<'a, T: Deserialize<'a>>(text: &'a str, error: &serde_json::Error) -> TreeFileError {
    let (line, column) = (error.line(), error.column());
    let whole = error.to_string();
    let message = whole.strip_suffix(&format!(" at line {line} column {column}")).unwrap_or(&whole);
    // Numbers are found to be out of range while they are read, before it is known what they are for.
    let in_field = error.is_data() || message == "number out of range";
    let again = serde_path_to_error::deserialize::<_, T>(&mut serde_json::Deserializer::from_str(text));
    let path = again.err().filter(|_| in_field).map(|error| error.path().to_string()).filter(|path| path != ".");
    let path = path.map_or(String::new(), |path| printable(&path) + ": ");
    TreeFileError::Malformed { line, column, message: format!("{path}{}", printable(&in_our_words(message))) }
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

#[cfg(test)]
mod tests {
    use super::*;

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
