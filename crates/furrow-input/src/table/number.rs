//! Numbers in tables, with decimal points or commas and with thousands apart.

/// A comma and a point, which may be the decimal sign of a number or set its thousands apart.
const SIGNS: [char; 2] = [',', '.'];

/// Other separators of thousands: blanks, also non-breaking and thin ones, and Swiss apostrophes, the last as Windows-1252 has it.
const BLANKS: [char; 7] = [' ', '\u{a0}', '\u{202f}', '\u{2009}', '\'', '’', '\u{92}'];

/// How the numbers of a column are written. Numbers of it that can be read in one way only show it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Numbers {
    /// Whether commas separate columns: then a number has one only in quotes, and points are decimal signs.
    commas_separate: bool,
    /// Whether a point before three digits may set thousands apart: semicolons separate columns, or some column has decimal commas.
    doubts_points: bool,
    seen: Seen,
}

/// What numbers show of how they are written.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Seen {
    /// Whether a comma, and whether a point, is a decimal sign.
    decimal: [bool; 2],
    /// Whether it sets thousands apart.
    thousands: [bool; 2],
    /// Whether there is a number such as 1.450, which may be 1450.
    doubtful_point: bool,
    /// Whether there is a whole number without signs, such as 980.
    whole: bool,
}

/// The signs in a number.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Shape {
    decimal: Option<char>,
    thousands: Option<char>,
    /// Whether the decimal sign may as well set thousands apart, as in 1,017.
    doubtful: bool,
}

/// How the numbers of each column of a table are written. Dates and names of other columns do not say how its volumes are.
#[derive(Clone, Debug, Default)]
pub(super) struct Columns {
    separator: u8,
    seen: Vec<Seen>,
}

impl Columns {
    /// No column seen yet, of a table with this separator.
    pub(super) fn of(separator: u8) -> Columns {
        Columns { separator, seen: Vec::new() }
    }

    /// Notes how a field of a column is written.
    pub(super) fn note(&mut self, column: usize, field: &[u8]) {
        let Some(shape) = shape(&super::text(field)) else { return };
        if self.seen.len() <= column {
            self.seen.resize(column + 1, Seen::default());
        }
        self.seen[column].note(shape);
    }

    /// Lets columns of one quantity show each other how their numbers are written.
    pub(super) fn share(&mut self, columns: &[usize]) {
        let of = |column: &usize| self.seen.get(*column).copied().unwrap_or_default();
        let all = columns.iter().map(of).fold(Seen::default(), Seen::with);
        for column in columns {
            if let Some(seen) = self.seen.get_mut(*column) {
                *seen = all;
            }
        }
    }

    /// The numbers of a column.
    pub(super) fn numbers(&self, column: usize) -> Numbers {
        Numbers {
            commas_separate: self.separator == b',',
            doubts_points: self.separator == b';' || self.seen.iter().any(|seen| seen.decimal[0]),
            seen: self.seen.get(column).copied().unwrap_or_default(),
        }
    }
}

impl Seen {
    fn note(&mut self, shape: Shape) {
        if shape.doubtful {
            self.doubtful_point |= shape.decimal == Some('.');
            return;
        }
        for (k, sign) in SIGNS.into_iter().enumerate() {
            self.decimal[k] |= shape.decimal == Some(sign);
            self.thousands[k] |= shape.thousands == Some(sign);
        }
        self.whole |= shape.decimal.is_none() && shape.thousands.is_none();
    }

    fn with(self, other: Seen) -> Seen {
        let both = |of: fn(&Seen) -> [bool; 2]| [0, 1].map(|k| of(&self)[k] || of(&other)[k]);
        Seen {
            decimal: both(|seen| seen.decimal),
            thousands: both(|seen| seen.thousands),
            doubtful_point: self.doubtful_point || other.doubtful_point,
            whole: self.whole || other.whole,
        }
    }

    /// Whether a sign sets thousands apart in some numbers, and whether it is decimal in some.
    fn of(&self, sign: Option<char>) -> [bool; 2] {
        let has = |seen: [bool; 2]| SIGNS.into_iter().zip(seen).any(|(known, seen)| seen && sign == Some(known));
        [has(self.thousands), has(self.decimal)]
    }
}

impl Numbers {
    /// A finite number.
    ///
    /// # Errors
    /// The text is not a number, or can be read in two ways; the error gives the reason.
    pub fn read(self, text: &[u8]) -> Result<f64, String> {
        let text = super::text(text);
        // Word processors write a minus sign of their own.
        let text = text.trim().replacen('\u{2212}', "-", 1);
        let text = text.as_str();
        let found = finite(text);
        if found.is_ok() && (self.commas_separate || !text.contains('.')) {
            return found;
        }
        let Some(shape) = shape(text) else { return found };
        match shape {
            Shape { decimal: Some(','), doubtful, .. }
                if self.commas_separate && !(doubtful && self.is_decimal(Some(',')) == Some(false)) =>
            {
                let where_read = "a decimal comma is read where semicolons or tabs separate columns";
                found.map_err(|why| format!("{why}: decimals need a point, as in 12.5 ({where_read})"))
            }
            Shape { thousands: Some('.'), .. } if self.commas_separate => found,
            Shape { doubtful: false, decimal, thousands } => finite(&plain(text, decimal, thousands)),
            Shape { decimal: sign, .. } => match self.is_decimal(sign) {
                Some(true) => finite(&plain(text, sign, None)),
                Some(false) => finite(&plain(text, None, sign)),
                None => {
                    let [small, large] = [plain(text, sign, None), plain(text, None, sign)];
                    Err(format!("may be {small} or {large}: no other number of its column says which"))
                }
            },
        }
    }

    /// Whether a sign that could be either is the decimal sign rather than one between thousands; `None` if it is not known.
    fn is_decimal(self, sign: Option<char>) -> Option<bool> {
        let is_doubtful = self.doubts_points || self.seen.doubtful_point && self.seen.whole;
        match self.seen.of(sign) {
            [false, true] => Some(true),
            [true, false] => Some(false),
            [true, true] => None,
            // Where commas separate columns, points are decimal signs.
            [false, false] if sign == Some(',') => self.commas_separate.then_some(false),
            [false, false] => (!is_doubtful).then_some(true),
        }
    }
}

/// Whether a text is a number in some way of writing.
pub(super) fn is_number(text: &[u8]) -> bool {
    shape(&super::text(text)).is_some()
}

/// A finite number with a point, as programs write it; `None` for other text.
pub fn number(text: &[u8]) -> Option<f64> {
    std::str::from_utf8(text).ok().and_then(|text| finite(text).ok())
}

fn finite(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(number) if number.is_finite() => Ok(number),
        Ok(_) => Err("not a finite number".to_owned()),
        Err(_) if text.is_empty() => Err("empty".to_owned()),
        Err(_) if text.strip_suffix('%').is_some_and(|number| number.trim_end().parse::<f64>().is_ok()) => {
            Err("not a number: write per cent as a fraction, 59% as 0.59".to_owned())
        }
        Err(_) => Err("not a number".to_owned()),
    }
}

/// The text with a decimal point, and without what sets thousands apart.
fn plain(text: &str, decimal: Option<char>, thousands: Option<char>) -> String {
    let kept = text.chars().filter(|c| Some(*c) != thousands);
    kept.map(|c| if Some(c) == decimal { '.' } else { c }).collect()
}

/// The signs of a number. Other text has no shape.
fn shape(text: &str) -> Option<Shape> {
    // A number of a person is short.
    const LONGEST: usize = 64;
    let text = Some(text.trim()).filter(|text| text.len() <= LONGEST)?;
    let unsigned = text.strip_prefix(['+', '-']).unwrap_or(text);
    let (mantissa, exponent) = unsigned.split_once(['e', 'E']).map_or((unsigned, None), |(m, e)| (m, Some(e)));
    let is_whole = |text: &str| !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit());
    if exponent.is_some_and(|exponent| !is_whole(exponent.strip_prefix(['+', '-']).unwrap_or(exponent))) {
        return None;
    }
    let apart = |c: char| SIGNS.contains(&c) || BLANKS.contains(&c);
    let signs: Vec<char> = mantissa.chars().filter(|c| apart(*c)).collect();
    let parts: Vec<&str> = mantissa.split(apart).collect();
    let Some((last, before)) = signs.split_last() else { return is_whole(mantissa).then(Shape::default) };
    let are_groups = |parts: &[&str]| {
        let [first, others @ ..] = parts else { return false };
        (1..=3).contains(&first.len()) && others.iter().all(|part| part.len() == 3)
    };
    let whole = &parts[..parts.len() - 1];
    if !parts.iter().all(|part| part.is_empty() || is_whole(part)) || parts.concat().is_empty() {
        return None;
    }
    let sets_apart = |sign: char, signs: &[char], parts: &[&str]| {
        (signs.iter().all(|other| *other == sign) && are_groups(parts)).then_some(Some(sign))
    };
    match before {
        [] if SIGNS.contains(last) => {
            let doubtful = exponent.is_none() && are_groups(&parts) && !parts[0].starts_with('0');
            Some(Shape { decimal: Some(*last), thousands: None, doubtful })
        }
        [.., other] if other != last && SIGNS.contains(last) => {
            let thousands = sets_apart(*other, before, whole)?;
            Some(Shape { decimal: Some(*last), thousands, doubtful: false })
        }
        _ => Some(Shape { decimal: None, thousands: sets_apart(*last, &signs, &parts)?, doubtful: false }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Reads a text in the last column of a table with this separator.
    fn read_in(separator: char, table: &str, text: &str) -> Result<f64, String> {
        let (mut columns, mut last) = (Columns::of(separator as u8), 0);
        for line in table.lines() {
            for (k, field) in line.split(separator).enumerate() {
                columns.note(k, field.trim_matches('"').as_bytes());
                last = k;
            }
        }
        columns.numbers(last).read(text.as_bytes())
    }

    fn read(table: &str, text: &str) -> Result<f64, String> {
        read_in(';', table, text)
    }

    #[test]
    fn numbers_that_can_be_read_in_one_way_are() {
        for (text, number) in [
            ("15,6", 15.6),
            ("-0,189", -0.189),
            ("0,5", 0.5),
            (",5", 0.5),
            ("1.017,3", 1017.3),
            ("1,017.3", 1017.3),
            ("1.234.567", 1_234_567.0),
            ("1,234,567", 1_234_567.0),
            ("1\u{a0}017,3", 1017.3),
            ("1'017.5", 1017.5),
            ("14’596.5", 14_596.5),
            ("14\u{2009}596", 14_596.0),
            ("10 000", 10_000.0),
            ("1017,300", 1017.3),
            ("1,5E+03", 1500.0),
            ("12.5", 12.5),
            ("1e-3", 0.001),
            ("7", 7.0),
            ("0.017", 0.017),
        ] {
            assert_eq!(read("", text), Ok(number), "{text}");
        }
        for text in ["", "x", ",", "1,2,3", "1.01,7.3", "1,017,30", "12 5", "1..2", "inf", "NaN", "1,5e", "1e2,5"] {
            assert!(read("", text).is_err(), "{text}");
        }
    }

    /// Three digits behind a sign may be thousands or decimals: other numbers of the column decide, and no dates or names beside it.
    #[test]
    fn a_number_that_can_be_read_in_two_ways_is_read_as_the_others_of_its_column() {
        assert_eq!(read("AB;15,6\nP1;1,017\n", "1,017"), Ok(1.017));
        assert_eq!(read("AB;1,017.5\nP1;1,017\n", "1,017"), Ok(1017.0));
        assert_eq!(read("AB;1.017,5\nP1;1.017\n", "1.017"), Ok(1017.0));
        assert_eq!(read("AB;12.5\nP1;1.017\n", "1.017"), Ok(1.017));
        assert_eq!(read("\"AB\";\"15,6\"\n\"P1\";\"1,017\"\n", "1,017"), Ok(1.017));
        let tabs = |table: &str| read_in('\t', table, "1.017");
        assert_eq!(tabs("P1\t1.017\n"), Ok(1.017));
        assert_eq!(tabs("1\tAB\t1.234\n2\tP1\t1.017\n"), Ok(1.017));
        assert_eq!(tabs("AB\t0.98\nP1\t1.017\nP2\t1\n"), Ok(1.017));
        let refusal = Err("may be 1.017 or 1017: no other number of its column says which".to_owned());
        assert_eq!(read("12.03;1.1;1.450\n13.03;1.2;1.017\n", "1.017"), refusal);
        assert_eq!(tabs("0,5\t1.450\n0,7\t1.017\n"), refusal);
        assert_eq!(tabs("AB\t980\nP1\t1.017\n"), refusal);
        assert_eq!(read("AB;1.450\nP1;1.017\n", "1.017"), refusal);
        assert_eq!(read("AB;1,017\nP1;2,345\n", "1,017"), refusal);
        assert_eq!(read("AB;15,6\nP1;1.017\n", "1.017"), refusal);
        assert_eq!(read("AB;15,6\nP1;1,017.5\n", "1,017"), refusal);
    }

    #[test]
    fn where_commas_separate_columns_a_comma_in_a_number_sets_thousands_apart() {
        let numbers = Columns::of(b',').numbers(0);
        assert_eq!(numbers.read(b"14,596"), Ok(14_596.0));
        assert_eq!(numbers.read(b"1,014,596.5"), Ok(1_014_596.5));
        assert_eq!(numbers.read(b"1'017.5"), Ok(1017.5));
        assert_eq!(numbers.read(b" 15.6 "), Ok(15.6));
        for text in ["15,6", "0,596", "1.017,3"] {
            let why = numbers.read(text.as_bytes()).unwrap_err();
            assert!(why.starts_with("not a number: decimals need a point"), "{text}: {why}");
        }
        let mut decimal = Columns::of(b',');
        decimal.note(0, b"15,6");
        assert!(decimal.numbers(0).read(b"1,017").unwrap_err().starts_with("not a number: decimals need a point"));
        assert_eq!(numbers.read(b"1.234.567"), Err("not a number".to_owned()));
        assert_eq!(numbers.read(b"1e999"), Err("not a finite number".to_owned()));
    }
}
