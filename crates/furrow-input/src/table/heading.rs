//! The headings of a table's columns, and the units in them.

use std::collections::HashSet;

use super::{columns_listed, malformed};
use crate::InputError;

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

/// The name in a heading, and the unit behind it in brackets, after a comma or a stroke, or a sign for per cent: Volume (µm³), Volume / µm³.
///
/// ```
/// use furrow_input::table::split_unit;
///
/// assert_eq!(split_unit("Lifetime [min]"), ("Lifetime", Some("min")));
/// assert_eq!(split_unit("lifetime_min"), ("lifetime_min", None));
/// // R writes points in place of blanks and brackets.
/// assert_eq!(split_unit("Volume..um3."), ("Volume", Some("um3")));
/// assert_eq!(split_unit("dose %"), ("dose", Some("%")));
/// ```
pub fn split_unit(heading: &str) -> (&str, Option<&str>) {
    let heading = heading.trim();
    let in_brackets =
        [('(', ')'), ('[', ']')].into_iter().find_map(|(open, close)| heading.strip_suffix(close)?.rsplit_once(open));
    let of_r = || heading.strip_suffix('.').and_then(|heading| heading.split_once(".."));
    let percent = || heading.strip_suffix(" %").map(|name| (name, "%"));
    let strokes = || heading.rsplit_once(" / ").or_else(|| heading.rsplit_once(", "));
    let found = in_brackets.or_else(strokes).or_else(percent).or_else(of_r);
    found.map_or((heading, None), |(name, unit)| (name.trim(), Some(unit.trim())))
}

/// A name of a column in lower case and with underscores, without a number sign, a full stop or a colon behind it.
fn unified_name(name: &str) -> String {
    name.trim_end_matches([' ', '#', '.', ':']).to_lowercase().replace([' ', '-'], "_")
}

/// The name that pandas and R give to another column of this name, as `cell.1`.
fn repeated_name(name: &str) -> Option<&str> {
    let (first, number) = name.rsplit_once('.')?;
    (!number.is_empty() && number.bytes().all(|byte| byte.is_ascii_digit())).then_some(first)
}

/// Whether a heading is empty, or what pandas calls an empty one.
pub(super) fn is_unnamed(name: &str) -> bool {
    name.is_empty()
        || name.strip_prefix("Unnamed: ").is_some_and(|number| number.starts_with(|c: char| c.is_ascii_digit()))
}

/// A column of a quantity, with the unit in its heading.
pub type QuantityColumn<'u, K> = (usize, Option<&'u NamedUnit<K>>);

/// The names of a table's columns. No two are alike but for case, blanks and hyphens, unless they are empty or of cells.
#[derive(Clone, Debug)]
pub struct Header<'f> {
    /// The names, as written.
    pub names: Vec<String>,
    /// Their line.
    pub line: usize,
    /// The names in lower case and with underscores.
    unified: Vec<String>,
    file: &'f str,
}

impl<'f> Header<'f> {
    /// The header on a line of a file. Names are compared without regard to case unless `is_exact` holds, as for names of cells.
    ///
    /// # Errors
    /// Two columns with names that are alike.
    pub(super) fn new(
        file: &'f str,
        line: usize,
        names: Vec<String>,
        is_exact: impl Fn(&str) -> bool,
    ) -> Result<Header<'f>, InputError> {
        let unified: Vec<String> = names.iter().map(|name| unified_name(name)).collect();
        let header = Header { names, line, unified, file };
        let mut seen: HashSet<&str> = HashSet::new();
        let named = header.unified.iter().zip(&header.names).enumerate().filter(|(_, (name, _))| !name.is_empty());
        let mut again = named.filter_map(|(column, (name, written))| {
            if is_exact(written) {
                return (!seen.insert(written)).then_some((column, written.as_str()));
            }
            let of_first = repeated_name(name).is_some_and(|first| seen.contains(first));
            let first = if of_first { repeated_name(written).unwrap_or(written) } else { written.as_str() };
            (of_first || !seen.insert(name)).then_some((column, first))
        });
        match again.next() {
            None => Ok(header),
            Some((column, name)) => {
                let why = format!("two columns are called {name:?}, the second of them column {}", column + 1);
                Err(header.refused(why))
            }
        }
    }

    /// The error at the header.
    pub fn refused(&self, why: impl Into<String>) -> InputError {
        malformed(self.file, self.line, why)
    }

    /// The error for columns that must be there and are `None`; `table` says which columns such a table has.
    pub fn missing(&self, columns: &[(&str, Option<usize>)], table: &str) -> InputError {
        let missing = columns.iter().filter(|(_, at)| at.is_none()).map(|(name, _)| *name).collect::<Vec<_>>();
        let here = columns_listed(&self.names);
        self.refused(format!("no column is called {}; {table}; the columns here are {here}", missing.join(" or ")))
    }

    /// The first column with one of these names.
    pub fn find(&self, names: &[&str]) -> Option<usize> {
        self.unified.iter().position(|name| names.contains(&name.as_str()))
    }

    /// As [`find`](Self::find), where a heading may have a unit in brackets.
    pub fn find_with_unit(&self, names: &[&str]) -> Option<usize> {
        let is_one = |heading: &String| names.contains(&unified_name(split_unit(heading).0).as_str());
        self.find(names).or_else(|| self.names.iter().position(is_one))
    }

    /// The columns with these names, as users write them.
    ///
    /// # Errors
    /// A name that no column has.
    pub fn named(&self, names: &[String]) -> Result<Vec<usize>, InputError> {
        let at = |name: &String| {
            let found = self.find(&[&unified_name(name)]);
            found.ok_or_else(|| {
                self.refused(format!(
                    "no column is called {name}; the columns here are {}",
                    columns_listed(&self.names)
                ))
            })
        };
        names.iter().map(at).collect()
    }

    /// The only column with a name that fits `what`, if there is one.
    ///
    /// # Errors
    /// As [`only`](Self::only).
    pub fn find_only(&self, what: &str, fits: impl Fn(&str) -> bool) -> Result<Option<usize>, InputError> {
        let fitting = self.unified.iter().enumerate().filter(|(_, name)| fits(name));
        let found: Vec<(usize, ())> = fitting.map(|(column, _)| (column, ())).collect();
        Ok(self.only(what, &found)?.map(|(column, ())| column))
    }

    /// The unit in the heading of a column, in brackets, after a comma or a stroke.
    ///
    /// # Errors
    /// A unit that is not in the list.
    pub fn unit<'u, K>(
        &self,
        column: usize,
        units: &'u [NamedUnit<K>],
    ) -> Result<Option<&'u NamedUnit<K>>, InputError> {
        let heading = &self.names[column];
        let Some(written) = split_unit(heading).1 else { return Ok(None) };
        unit_of(written, units).map(Some).ok_or_else(|| {
            let allowed = units_listed(units);
            self.refused(format!("the unit of column {}, {heading:?}, must be one of {allowed}", column + 1))
        })
    }

    /// The columns of a quantity, with the unit where their headings give one: `lifetime`, `lifetime_min`, `Lifetime (min)`.
    ///
    /// # Errors
    /// A unit in brackets that is not in the list.
    pub fn quantity<'u, K>(
        &self,
        name: &str,
        units: &'u [NamedUnit<K>],
    ) -> Result<Vec<QuantityColumn<'u, K>>, InputError> {
        let mut found = Vec::new();
        for (column, heading) in self.names.iter().enumerate() {
            let (base, written) = split_unit(heading);
            let base = unified_name(base);
            match (base.strip_prefix(name), written) {
                (Some(""), _) => found.push((column, self.unit(column, units)?)),
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
    pub fn only<T: Copy>(&self, what: &str, found: &[(usize, T)]) -> Result<Option<(usize, T)>, InputError> {
        match found {
            [] => Ok(None),
            [one] => Ok(Some(*one)),
            [(first, _), (second, _), ..] => Err(self.refused(format!(
                "columns {} and {}, {:?} and {:?}, both have the {what}: leave one of them out, or rename it",
                first + 1,
                second + 1,
                self.names[*first],
                self.names[*second]
            ))),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn headings_give_their_units_in_many_ways() {
        let times = |name: &str| -> Result<Vec<(usize, Option<f64>)>, InputError> {
            let header = Header::new("t.csv", 1, vec!["cell".to_owned(), name.to_owned()], |_| false)?;
            let found = header.quantity("lifetime", &TIMES)?;
            Ok(found.into_iter().map(|(column, unit)| (column, unit.map(|unit| unit.size))).collect::<Vec<_>>())
        };
        for name in [
            "lifetime_min",
            "Lifetime (min)",
            "lifetime [Minutes]",
            "LIFETIME / min",
            "lifetime, min",
            "lifetime in min",
        ] {
            assert_eq!(times(name).unwrap(), [(1, Some(1.0))], "{name}");
        }
        let repeated = ["cell", "x", "cell.1"].map(str::to_owned).to_vec();
        let why = "t.csv:1:1: two columns are called \"cell\", the second of them column 3";
        assert_eq!(Header::new("t.csv", 1, repeated, |_| false).unwrap_err().to_string(), why);
        let twice = ["A7.1", "A7.1"].map(str::to_owned).to_vec();
        let why = "t.csv:1:1: two columns are called \"A7.1\", the second of them column 2";
        assert_eq!(Header::new("t.csv", 1, twice, |_| false).unwrap_err().to_string(), why);
        let others = ["Embryo #", "A7.1", "A7.2"].map(str::to_owned).to_vec();
        assert_eq!(Header::new("t.csv", 1, others, |_| false).unwrap().find(&["embryo"]), Some(0));
        // Names of cells may differ by case or by a number behind a point.
        let cells = ["N", "n", "N.1"].map(str::to_owned).to_vec();
        assert!(
            Header::new("t.csv", 1, cells.clone(), |_| false).is_err()
                && Header::new("t.csv", 1, cells, |_| true).is_ok()
        );
        assert_eq!(times("Lifetime (h)").unwrap(), [(1, Some(60.0))]);
        assert_eq!(times("lifetime").unwrap(), [(1, None)]);
        assert_eq!(times("lifetime_rank").unwrap(), []);
        let why = "t.csv:1:1: the unit of column 2, \"Lifetime (frames)\", must be one of min, s, h";
        assert_eq!(times("Lifetime (frames)").unwrap_err().to_string(), why);
    }
}
