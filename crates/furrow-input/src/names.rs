//! Names in messages: shown as far as it helps, listed as far as it helps, and the nearest one to a misspelt one.

use std::borrow::Cow;

/// What a user wrote, in quotes, as far as it helps to see it.
pub fn shown(written: &str) -> String {
    const MOST: usize = 60;
    match written.char_indices().nth(MOST) {
        Some((end, _)) => format!("{:?}…", &written[..end]),
        None => format!("{written:?}"),
    }
}

/// A text without control characters, which a terminal would obey: messages quote what stands in files.
///
/// ```
/// use furrow_input::printable;
///
/// assert_eq!(printable("founder A\u{1b}[2J"), "founder A\\u{1b}[2J");
/// ```
pub fn printable(text: &str) -> Cow<'_, str> {
    if !text.contains(char::is_control) {
        return Cow::Borrowed(text);
    }
    let mut out = String::with_capacity(text.len() + 8);
    for c in text.chars() {
        match c.is_control() {
            true => out.extend(c.escape_default()),
            false => out.push(c),
        }
    }
    Cow::Owned(out)
}

/// A number in a message: as it is written in files, or with an exponent where that takes fewer digits than anybody counts.
///
/// ```
/// use furrow_input::shown_number;
///
/// assert_eq!(shown_number(5.4), "5.4");
/// assert_eq!(shown_number(1e300), "1e300");
/// assert_eq!(shown_number(-2.5e-20), "-2.5e-20");
/// ```
pub fn shown_number(number: f64) -> String {
    match number == 0.0 || !number.is_finite() || (1e-6..1e15).contains(&number.abs()) {
        true => number.to_string(),
        false => format!("{number:e}"),
    }
}

/// Names joined by `between`; of very many the first ones, and how many more there are.
///
/// ```
/// use furrow_input::listed;
///
/// assert_eq!(listed(["A", "B"], ", "), "A, B");
/// let many: Vec<String> = (0..1000).map(|k| k.to_string()).collect();
/// assert_eq!(listed(many.iter().map(String::as_str), ", "), "0, 1, 2, 3, 4, 5, 6, 7, 8, 9, … (990 more)");
/// ```
pub fn listed<'a>(names: impl IntoIterator<Item = &'a str>, between: &str) -> String {
    // A list a little longer than what is shown of a long one is shown whole.
    const WHOLE: usize = 16;
    const PART: usize = 10;
    const LONGEST_NAME: usize = 60;
    let mut first = Vec::new();
    let mut count = 0;
    for name in names {
        count += 1;
        if first.len() < WHOLE {
            first.push(match name.char_indices().nth(LONGEST_NAME) {
                Some((end, _)) => format!("{}…", &name[..end]),
                None => name.to_owned(),
            });
        }
    }
    if count > WHOLE {
        first.truncate(PART);
        first.push(format!("… ({} more)", count - PART));
    }
    first.join(between)
}

/// "; did you mean …?" where one of `known` is near to what was written, else nothing.
pub fn did_you_mean<'a>(written: &str, known: impl IntoIterator<Item = &'a str>) -> String {
    // What is written by hand is short, and of very many names the first ones must do: the time this takes is bounded.
    const LONGEST_NAME: usize = 64;
    const MOST_NAMES: usize = 20_000;
    const SLIPS: usize = 2;
    let length = written.chars().take(LONGEST_NAME + 1).count();
    if length > LONGEST_NAME {
        return String::new();
    }
    let written = written.to_lowercase();
    known
        .into_iter()
        // Names of quite another length are many slips away. A character has at most four bytes.
        .filter(|name| name.len() <= 4 * LONGEST_NAME && name.chars().count().abs_diff(length) <= SLIPS)
        .take(MOST_NAMES)
        .map(|name| (strsim::damerau_levenshtein(&written, &name.to_lowercase()), name))
        // A slip or two, fewer in short words.
        .filter(|(distance, name)| *distance <= SLIPS && 2 * *distance < name.chars().count().max(2))
        .min_by_key(|(distance, _)| *distance)
        .map_or(String::new(), |(_, name)| format!("; did you mean {name}?"))
}

/// The first character that drawings and pages cannot hold: a control character, or one that XML 1.0 has no place for.
///
/// ```
/// use furrow_input::forbidden;
///
/// assert_eq!(forbidden("C. elegans, Größe 5 µm"), None);
/// assert_eq!(forbidden("C.\u{1}elegans"), Some('\u{1}'));
/// ```
pub fn forbidden(text: &str) -> Option<char> {
    text.chars().find(|c| c.is_control() || matches!(c, '\u{fffe}' | '\u{ffff}'))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_name_is_told_and_a_far_one_is_not() {
        assert_eq!(did_you_mean("intervls", ["stages", "intervals"]), "; did you mean intervals?");
        assert_eq!(did_you_mean("radius", ["stages", "intervals"]), "");
    }

    /// However many names there are and however long they are, few of them are compared.
    #[test]
    fn the_names_compared_are_bounded() {
        let taken = std::cell::Cell::new(0_usize);
        let names = std::iter::repeat_with(|| {
            taken.set(taken.get() + 1);
            "Q123456"
        });
        did_you_mean("P654321", names.take(10_000_000));
        assert!(taken.get() <= 20_000, "{}", taken.get());
        assert_eq!(did_you_mean(&"a".repeat(1 << 20), ["a"]), "");
    }
}
