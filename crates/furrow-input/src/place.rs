//! The field at a byte of a RON or JSON file, such as `founders[2].r0`.

/// An open bracket.
struct Level<'a> {
    /// The bracket.
    bracket: char,
    /// Commas so far.
    index: usize,
    /// The key of the current value: a field's name, or the text of a map's key in its quotes.
    key: Option<&'a str>,
}

/// The field at byte `at`, empty outside all brackets. The text before `at` must be well formed.
pub fn field_at(text: &str, at: usize) -> String {
    written(&levels_at(&text[..at]), false)
}

/// The parent of the field at byte `at`, if that is one of several in parentheses.
pub fn holder_at(text: &str, at: usize) -> String {
    let mut levels = levels_at(&text[..at]);
    if let Some(last) = levels.last_mut().filter(|level| level.bracket == '(') {
        last.key = None;
    }
    written(&levels, false)
}

/// The field of a JSON document at byte `at`, or the object around it; of the first eight levels.
pub fn json_field_at(text: &str, at: usize, of_object: bool) -> String {
    let end = (0..=at.min(text.len())).rev().find(|end| text.is_char_boundary(*end)).unwrap_or(0);
    let mut levels = levels_at(&text[..end]);
    if let Some(last) = levels.last_mut().filter(|_| of_object) {
        last.key = None;
    }
    levels.truncate(8);
    written(&levels, true)
}

/// The open brackets at the end of a text.
fn levels_at(text: &str) -> Vec<Level<'_>> {
    let mut levels: Vec<Level<'_>> = Vec::new();
    // The last word or string, which is a key if a colon follows.
    let mut word = "";
    let mut rest = text;
    while let Some(c) = rest.chars().next() {
        let length = match c {
            '"' => closing_quote(rest),
            '/' if rest.starts_with("//") => rest.find('\n').unwrap_or(rest.len()),
            '/' if rest.starts_with("/*") => rest.find("*/").map_or(rest.len(), |end| end + 2),
            '\'' => character(rest),
            _ if c.is_alphanumeric() || c == '_' => {
                rest.find(|c: char| !(c.is_alphanumeric() || c == '_')).unwrap_or(rest.len())
            }
            _ => c.len_utf8(),
        };
        match (c, levels.last_mut()) {
            ('(' | '[' | '{', _) => levels.push(Level { bracket: c, index: 0, key: None }),
            (')' | ']' | '}', _) => drop(levels.pop()),
            (',', Some(level)) => (level.index, level.key) = (level.index + 1, None),
            (':', Some(level)) => level.key = Some(std::mem::take(&mut word)),
            _ if c == '"' || c.is_alphanumeric() || c == '_' => word = &rest[..length],
            _ => {}
        }
        rest = &rest[length..];
    }
    levels
}

/// The path of the open brackets. In JSON all keys are in quotes.
fn written(levels: &[Level<'_>], json: bool) -> String {
    let mut out = String::new();
    for level in levels {
        match level.key {
            Some(key) if key.starts_with('"') && !json => out.extend(["[", key, "]"]),
            Some(key) => {
                let key = key.strip_prefix('"').and_then(|key| key.strip_suffix('"')).unwrap_or(key);
                out.extend([if out.is_empty() { "" } else { "." }, key]);
            }
            None if level.bracket == '[' => out.push_str(&format!("[{}]", level.index)),
            None => {}
        }
    }
    out
}

/// Length in bytes of the string at the start of the text.
fn closing_quote(text: &str) -> usize {
    let mut escaped = false;
    let end = text.bytes().skip(1).position(|byte| {
        let ends = byte == b'"' && !escaped;
        escaped = byte == b'\\' && !escaped;
        ends
    });
    end.map_or(text.len(), |end| end + 2)
}

/// Length in bytes of the quoted character at the start of the text.
fn character(text: &str) -> usize {
    let mut chars = text.char_indices().skip(1);
    if chars.next().is_some_and(|(_, c)| c == '\\') {
        chars.next();
    }
    chars.find(|(_, c)| *c == '\'').map_or(text.len(), |(at, _)| at + 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_field_of_every_place() {
        let text = r#"Lineage( // a (comment
            name: "x, [y] \" (", /* ( */ naming: ('(', 'p'),
            cues: {"a b": kappa(u0: 1)},
            founders: [(name: "A"), (name: "B", letters: [('l', 'r')], r0: 7)],
        )"#;
        for (word, field) in [
            ("x, [y]", "name"),
            ("'p'", "naming"),
            ("1)}", "cues[\"a b\"].u0"),
            ("\"A\"", "founders[0].name"),
            ("'l'", "founders[1].letters[0]"),
            ("7)]", "founders[1].r0"),
            ("Lineage", ""),
        ] {
            let at = text.find(word).unwrap();
            // Within a string it is the string's place.
            let at = if word.starts_with('x') { at - 1 } else { at };
            assert_eq!(field_at(text, at), field, "{word}");
        }
        assert_eq!(holder_at(text, text.find("7)]").unwrap()), "founders[1]");
        assert_eq!(holder_at(text, text.find("'l'").unwrap()), "founders[1].letters[0]");
    }

    #[test]
    fn the_field_of_every_place_in_json() {
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
            assert_eq!(json_field_at(text, text.find(found).unwrap(), of_object), path, "{found}");
        }
        assert_eq!(json_field_at(&"[".repeat(100), 100, false), "[0]".repeat(8));
        assert_eq!(json_field_at("\"\\", 2, true), "");
    }
}
