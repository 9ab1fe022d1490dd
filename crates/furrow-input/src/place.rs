//! The field at a byte of a RON file, such as `founders[2].r0`.

/// An open bracket.
struct Level {
    /// The bracket.
    bracket: char,
    /// Commas so far.
    index: usize,
    /// The key of the current value: a field's name, or the text of a map's key.
    key: Option<String>,
}

/// The field at byte `at`, empty outside all brackets. The text before `at` must be well formed.
pub fn field_at(text: &str, at: usize) -> String {
    written(&levels_at(&text[..at]))
}

/// The parent of the field at byte `at`, if that is one of several in parentheses.
pub fn holder_at(text: &str, at: usize) -> String {
    let mut levels = levels_at(&text[..at]);
    if let Some(last) = levels.last_mut().filter(|level| level.bracket == '(') {
        last.key = None;
    }
    written(&levels)
}

/// The open brackets at the end of a text.
fn levels_at(text: &str) -> Vec<Level> {
    let mut levels: Vec<Level> = Vec::new();
    // The last word or string, which is a key if a colon follows.
    let mut word = String::new();
    let mut rest = text;
    while let Some(c) = rest.chars().next() {
        let length = match c {
            '"' => {
                let end = closing_quote(rest);
                word = format!("[{}]", &rest[..end]);
                end
            }
            '/' if rest.starts_with("//") => rest.find('\n').unwrap_or(rest.len()),
            '/' if rest.starts_with("/*") => rest.find("*/").map_or(rest.len(), |end| end + 2),
            '\'' => character(rest),
            _ if c.is_alphanumeric() || c == '_' => {
                let end = rest.find(|c: char| !(c.is_alphanumeric() || c == '_')).unwrap_or(rest.len());
                word = rest[..end].to_owned();
                end
            }
            _ => {
                punctuation(c, &mut levels, &mut word);
                c.len_utf8()
            }
        };
        rest = &rest[length..];
    }
    levels
}

fn punctuation(c: char, levels: &mut Vec<Level>, word: &mut String) {
    match c {
        '(' | '[' | '{' => levels.push(Level { bracket: c, index: 0, key: None }),
        ')' | ']' | '}' => {
            levels.pop();
        }
        ',' => {
            if let Some(level) = levels.last_mut() {
                level.index += 1;
                level.key = None;
            }
        }
        ':' => {
            if let Some(level) = levels.last_mut() {
                level.key = Some(std::mem::take(word));
            }
        }
        _ => {}
    }
}

/// The path of the open brackets.
fn written(levels: &[Level]) -> String {
    let mut out = String::new();
    for level in levels {
        match &level.key {
            Some(key) => {
                if !out.is_empty() && !key.starts_with('[') {
                    out.push('.');
                }
                out.push_str(key);
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
}
