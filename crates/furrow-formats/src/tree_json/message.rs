//! Errors in a JSON document, with the path of the field and in words that users know.

use furrow_input::{json_field_at, printable};

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
    let mut path = String::new();
    // The parser refuses a number out of range before it knows the number's field.
    if error.is_data() || message == "number out of range" {
        // Columns are bytes.
        let before: usize = text.split_inclusive('\n').take(line.saturating_sub(1)).map(str::len).sum();
        // The message is about a field of the object that it is in, or about the value of one.
        let begins = ["missing field", "unknown field", "duplicate field"];
        let of_object = begins.iter().any(|begin| message.starts_with(begin));
        path = json_field_at(text, before + column.saturating_sub(1), of_object);
    }
    let between = if path.is_empty() { "" } else { ": " };
    let message = format!("{}{between}{}", short(&path), short(&in_our_words(message)));
    TreeFileError::Malformed { line, column, message }
}

fn in_our_words(message: &str) -> String {
    let Some((before, expected)) = message.rsplit_once("expected ") else { return message.to_owned() };
    match WORDS.iter().find(|(word, _)| *word == expected) {
        Some((_, ours)) => format!("{before}expected {ours}"),
        None if expected.starts_with("struct ") => format!("{before}expected an object in braces {{ }}"),
        None => message.to_owned(),
    }
}

/// A message of bounded length without control characters: parsers quote their input.
fn short(message: &str) -> String {
    let mut characters: Vec<char> = message.chars().collect();
    let half = LONGEST_MESSAGE / 2;
    if characters.len() > LONGEST_MESSAGE {
        characters.splice(half..characters.len() - half, ['…']);
    }
    printable(&characters.into_iter().collect::<String>()).into_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn messages_are_short_and_free_of_control_characters() {
        let long = short(&format!("a\u{1b}[2J{}z", "x".repeat(1000)));
        assert!(long.starts_with("a\\u{1b}[2Jxx") && long.contains('…') && long.ends_with("xz"), "{long}");
        assert_eq!(long.chars().count(), LONGEST_MESSAGE + 1 + "\\u{1b}".len() - 1);
        assert_eq!(
            in_our_words("invalid type: string \"expected f64\", expected f64"),
            "invalid type: string \"expected f64\", expected a number"
        );
    }
}
