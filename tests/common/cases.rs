//! Cases in text files: input lines, marked with `> `, followed by the expected output, in which `[..]` matches anything.

use std::path::Path;

/// Runs every case of a file in `tests` and compares the output with the expected one.
///
/// With `UPDATE_CASES=1` it rewrites the cases that differ instead. Read the difference before you commit it.
pub fn check_cases(file: &str, mut run: impl FnMut(&str) -> String) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests").join(file);
    let text = std::fs::read_to_string(&path).unwrap();
    let mut checked = Vec::new();
    for case in text.trim_end().split("\n\n") {
        let head: Vec<&str> = case.lines().take_while(|line| line.starts_with(['>', '#'])).collect();
        let input: Vec<&str> = head.iter().filter_map(|line| line.strip_prefix("> ")).collect();
        let found = head.join("\n") + "\n" + &run(&input.join("\n"));
        checked.push(if is_like(&found, case) { case.to_owned() } else { found });
    }
    if std::env::var_os("UPDATE_CASES").is_some() {
        std::fs::write(&path, checked.join("\n\n") + "\n").unwrap();
        return;
    }
    for (found, expected) in checked.iter().zip(text.trim_end().split("\n\n")) {
        assert_eq!(found, expected, "a case of {file}");
    }
}

/// Whether a text matches a pattern in which `[..]` matches anything.
fn is_like(found: &str, pattern: &str) -> bool {
    let mut parts = pattern.split("[..]");
    let Some(mut rest) = parts.next().and_then(|first| found.strip_prefix(first)) else { return false };
    let mut parts = parts.peekable();
    while let Some(part) = parts.next() {
        let place = if parts.peek().is_some() {
            rest.find(part)
        } else {
            rest.ends_with(part).then(|| rest.len() - part.len())
        };
        let Some(place) = place else { return false };
        rest = &rest[place + part.len()..];
    }
    rest.is_empty()
}
