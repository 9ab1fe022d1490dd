//! Names in messages: shortened, listed, and the closest match of a misspelt one.

use std::borrow::Cow;

/// A user's text in quotes, shortened if it is long.
pub fn shown(written: &str) -> String {
    const MOST: usize = 60;
    match written.char_indices().nth(MOST) {
        Some((end, _)) => format!("{:?}…", &written[..end]),
        None => format!("{written:?}"),
    }
}

/// Escapes control characters and those that XML excludes, so that quoted file contents neither control a terminal nor break a picture.
///
/// ```
/// use furrow_input::printable;
///
/// assert_eq!(printable("founder A\u{1b}[2J"), "founder A\\u{1b}[2J");
/// ```
pub fn printable(text: &str) -> Cow<'_, str> {
    escaped(text, is_forbidden)
}

/// Several lines for a terminal: as [`printable`], but lines and tabs stay.
pub fn printable_lines(text: &str) -> Cow<'_, str> {
    escaped(text, |c| is_forbidden(c) && !matches!(c, '\n' | '\t'))
}

/// Whether a character is a control character or one that XML 1.0 excludes.
fn is_forbidden(c: char) -> bool {
    c.is_control() || matches!(c, '\u{fffe}' | '\u{ffff}')
}

fn escaped(text: &str, escapes: impl Fn(char) -> bool) -> Cow<'_, str> {
    if !text.contains(&escapes) {
        return Cow::Borrowed(text);
    }
    let mut out = String::with_capacity(text.len() + 8);
    for c in text.chars() {
        match escapes(c) {
            true => out.extend(c.escape_default()),
            false => out.push(c),
        }
    }
    Cow::Owned(out)
}

/// A number in a message: as files have it, or with an exponent if it has very many digits.
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

/// A computed number in a message, rounded to a number of digits: later digits are noise to its reader.
///
/// ```
/// use furrow_input::rounded_number;
///
/// assert_eq!(rounded_number(5.399999998509884, 7), "5.4");
/// assert_eq!(rounded_number(628675793.6022962, 5), "6.2868e8");
/// assert_eq!(rounded_number(11723.33, 5), "11723");
/// assert_eq!(rounded_number(f64::NAN, 5), "NaN");
/// ```
pub fn rounded_number(number: f64, digits: usize) -> String {
    let rounded = format!("{number:.*e}", digits.saturating_sub(1)).parse().unwrap_or(number);
    match rounded == 0.0 || !rounded.is_finite() || (1e-6..1e7).contains(&rounded.abs()) {
        true => rounded.to_string(),
        false => format!("{rounded:e}"),
    }
}

/// Names joined by `between`. Of very many it lists the first and counts the others.
///
/// ```
/// use furrow_input::listed;
///
/// assert_eq!(listed(["A", "B"], ", "), "A, B");
/// let many: Vec<String> = (0..1000).map(|k| k.to_string()).collect();
/// assert_eq!(listed(many.iter().map(String::as_str), ", "), "0, 1, 2, 3, 4, 5, 6, 7, 8, 9, … (990 more)");
/// ```
pub fn listed<'a>(names: impl IntoIterator<Item = &'a str>, between: &str) -> String {
    // A list only a little longer than the limit is shown whole.
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

/// "; did you mean …?" if one of `known` is close to the text, otherwise empty.
pub fn did_you_mean<'a>(written: &str, known: impl IntoIterator<Item = &'a str>) -> String {
    // Bounds the time: hand-written names are short, and the first of very many names suffice.
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
        // Names of very different length need many edits. A character has at most four bytes.
        .filter(|name| name.len() <= 4 * LONGEST_NAME && name.chars().count().abs_diff(length) <= SLIPS)
        .take(MOST_NAMES)
        .map(|name| (strsim::damerau_levenshtein(&written, &name.to_lowercase()), name))
        // One or two edits, fewer in short words.
        .filter(|(distance, name)| *distance <= SLIPS && 2 * *distance < name.chars().count().max(2))
        .min_by_key(|(distance, _)| *distance)
        .map_or(String::new(), |(_, name)| format!("; did you mean {name}?"))
}

/// The first character that SVG and HTML cannot contain: a control character or one that XML 1.0 excludes.
///
/// ```
/// use furrow_input::forbidden;
///
/// assert_eq!(forbidden("C. elegans, Größe 5 µm"), None);
/// assert_eq!(forbidden("C.\u{1}elegans"), Some('\u{1}'));
/// ```
pub fn forbidden(text: &str) -> Option<char> {
    text.chars().find(|c| is_forbidden(*c))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_name_is_suggested_and_a_far_one_is_not() {
        assert_eq!(did_you_mean("intervls", ["stages", "intervals"]), "; did you mean intervals?");
        assert_eq!(did_you_mean("radius", ["stages", "intervals"]), "");
    }

    /// Only few and short names are compared.
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
