//! Text in CSV files that spreadsheets may open.

use std::borrow::Cow;

/// Whether a spreadsheet would take a text for a formula. Numbers are harmless, and so is a lone sign, which marks a missing number.
fn is_formula(text: &str) -> bool {
    text.starts_with(['=', '+', '-', '@', '\t', '\r']) && text.len() > 1 && text.parse::<f64>().is_err()
}

/// A text as a field of a CSV file: with an apostrophe before it where a spreadsheet would take it for a formula.
///
/// ```
/// use furrow_input::{csv_field, csv_value};
///
/// assert_eq!(csv_field("=cmd|' /C calc'!A0"), "'=cmd|' /C calc'!A0");
/// assert_eq!(csv_field("AB"), "AB");
/// assert_eq!(csv_field("-1.5"), "-1.5");
/// for name in ["AB", "=1", "'=1", "''-a", "'a", "@", "-1"] {
///     assert_eq!(csv_value(&csv_field(name)), name);
/// }
/// ```
pub fn csv_field(text: &str) -> Cow<'_, str> {
    // One with apostrophes of its own gets one more, so that it reads back as it was.
    if is_formula(text.trim_start_matches('\'')) { format!("'{text}").into() } else { text.into() }
}

/// The text that [`csv_field`] wrote as a field.
pub fn csv_value(field: &str) -> &str {
    let escaped = field.strip_prefix('\'').filter(|text| is_formula(text.trim_start_matches('\'')));
    escaped.unwrap_or(field)
}
