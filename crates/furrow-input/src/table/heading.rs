//! The headings of a table's columns, and the units in them.

use std::collections::HashSet;

/// A unit, how it is written (as [`unit_word`] gives it), and how much of the table's first unit of its kind it is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NamedUnit<K> {
    /// What kind of unit it is.
    pub kind: K,
    /// Its size.
    pub size: f64,
    /// How it is written.
    pub words: &'static [&'static str],
}

/// Units of time, in minutes.
pub const TIMES: [NamedUnit<()>; 3] = [
    NamedUnit { kind: (), size: 1.0, words: &["min", "mins", "minute", "minutes"] },
    NamedUnit { kind: (), size: 1.0 / 60.0, words: &["s", "sec", "secs", "second", "seconds"] },
    NamedUnit { kind: (), size: 60.0, words: &["h", "hr", "hrs", "hour", "hours"] },
];

/// A unit of a list by a text.
pub fn unit_of<'u, K>(text: &str, units: &'u [NamedUnit<K>]) -> Option<&'u NamedUnit<K>> {
    let word = unit_word(text);
    units.iter().find(|unit| unit.words.contains(&word.as_str()))
}

/// How the units of a list are written, for an error.
pub fn units_listed<K>(units: &[NamedUnit<K>]) -> String {
    units.iter().filter_map(|unit| unit.words.first().copied()).collect::<Vec<_>>().join(", ")
}

/// A unit in small letters and digits: micro as u, exponents without a sign.
///
/// ```
/// use furrow_input::table::unit_word;
///
/// assert_eq!(["µm³", "\u{3bc}m^3", "um**3", " Um3 "].map(unit_word), ["um3"; 4]);
/// ```
pub fn unit_word(text: &str) -> String {
    let plain = |c: char| match c {
        'µ' | 'μ' => 'u',
        '²' => '2',
        '³' => '3',
        c => c,
    };
    text.chars()
        .filter(|c| !matches!(c, '^' | '*' | '.' | '_') && !c.is_whitespace())
        .map(plain)
        .collect::<String>()
        .to_lowercase()
}

/// The name in a heading, and the unit behind it in brackets, after a comma or a stroke: Volume (µm³), Volume / µm³.
///
/// ```
/// use furrow_input::table::split_unit;
///
/// assert_eq!(split_unit("Lifetime [min]"), ("Lifetime", Some("min")));
/// assert_eq!(split_unit("lifetime_min"), ("lifetime_min", None));
/// ```
pub fn split_unit(heading: &str) -> (&str, Option<&str>) {
    let heading = heading.trim();
    let in_brackets =
        [('(', ')'), ('[', ']')].into_iter().find_map(|(open, close)| heading.strip_suffix(close)?.rsplit_once(open));
    let found = in_brackets.or_else(|| heading.rsplit_once(" / ")).or_else(|| heading.rsplit_once(", "));
    found.map_or((heading, None), |(name, unit)| (name.trim(), Some(unit.trim())))
}

/// A name of a column in lower case and with underscores.
fn unified_name(name: &str) -> String {
    name.to_lowercase().replace([' ', '-'], "_")
}

/// Whether a heading is empty, or what pandas calls an empty one.
pub(super) fn is_unnamed(name: &str) -> bool {
    name.is_empty()
        || name.strip_prefix("Unnamed: ").is_some_and(|number| number.starts_with(|c: char| c.is_ascii_digit()))
}

/// Names of columns in lower case and with underscores; no two may be alike, unless they are empty.
///
/// # Errors
/// Names two columns that are alike.
pub fn unified(header: &[String]) -> Result<Vec<String>, String> {
    let lower: Vec<String> = header.iter().map(|name| unified_name(name)).collect();
    let mut seen = HashSet::new();
    for (column, name) in lower.iter().enumerate() {
        if !name.is_empty() && !seen.insert(name) {
            return Err(format!(
                "two columns are called {:?}, the second of them column {}",
                header[column],
                column + 1
            ));
        }
    }
    Ok(lower)
}

/// A column of a quantity, with the unit in its heading.
pub type QuantityColumn<'u, K> = (usize, Option<&'u NamedUnit<K>>);

/// The columns of a quantity, with the unit where their headings give one: `lifetime`, `lifetime_min`, `Lifetime (min)`.
///
/// # Errors
/// A unit in brackets that is not in the list.
pub fn quantity<'u, K>(
    header: &[String],
    name: &str,
    units: &'u [NamedUnit<K>],
) -> Result<Vec<QuantityColumn<'u, K>>, String> {
    let mut found = Vec::new();
    for (column, heading) in header.iter().enumerate() {
        let (base, written) = split_unit(heading);
        let base = unified_name(base);
        match (base.strip_prefix(name), written) {
            (Some(""), None) => found.push((column, None)),
            (Some(""), Some(written)) => {
                let unit = unit_of(written, units).ok_or_else(|| {
                    format!("the unit of column {}, {heading:?}, must be one of {}", column + 1, units_listed(units))
                })?;
                found.push((column, Some(unit)));
            }
            (Some(rest), None) => {
                // A number behind a name is no unit, though fractions have the unit 1.
                let word = rest.strip_prefix("_in").unwrap_or(rest).strip_prefix('_');
                let word = word.filter(|word| !word.starts_with(|c: char| c.is_ascii_digit()));
                found.extend(word.and_then(|word| unit_of(word, units)).map(|unit| (column, Some(unit))));
            }
            _ => {}
        }
    }
    Ok(found)
}

/// The only column of a quantity among the columns found, if there is one.
///
/// # Errors
/// Two columns, by their headings.
pub fn only<T: Copy>(header: &[String], what: &str, found: &[(usize, T)]) -> Result<Option<(usize, T)>, String> {
    let quoted = |(column, _): &(usize, T)| header.get(*column).map_or(String::new(), |name| format!("{name:?}"));
    match found {
        [] => Ok(None),
        [one] => Ok(Some(*one)),
        [first, second, ..] => Err(format!(
            "columns {} and {}, {} and {}, both have the {what}: leave one of them out, or rename it",
            first.0 + 1,
            second.0 + 1,
            quoted(first),
            quoted(second)
        )),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn headings_give_their_units_in_many_ways() {
        let times = |name: &str| {
            let found = quantity(&["cell".to_owned(), name.to_owned()], "lifetime", &TIMES);
            found.map(|found| {
                found.into_iter().map(|(column, unit)| (column, unit.map(|unit| unit.size))).collect::<Vec<_>>()
            })
        };
        for name in [
            "lifetime_min",
            "Lifetime (min)",
            "lifetime [Minutes]",
            "LIFETIME / min",
            "lifetime, min",
            "lifetime in min",
        ] {
            assert_eq!(times(name), Ok(vec![(1, Some(1.0))]), "{name}");
        }
        assert_eq!(times("Lifetime (h)"), Ok(vec![(1, Some(60.0))]));
        assert_eq!(times("lifetime"), Ok(vec![(1, None)]));
        assert_eq!(times("lifetime_rank"), Ok(vec![]));
        let why = "the unit of column 2, \"Lifetime (frames)\", must be one of min, s, h";
        assert_eq!(times("Lifetime (frames)"), Err(why.to_owned()));
    }
}
