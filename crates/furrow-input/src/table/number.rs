//! Numbers in tables, with decimal points or commas and with thousands apart.

/// A comma and a point, which may be the decimal sign of a number or set its thousands apart.
const SIGNS: [char; 2] = [',', '.'];

/// Other separators of thousands: blanks, also non-breaking ones, and the Swiss apostrophe.
const BLANKS: [char; 4] = [' ', '\u{a0}', '\u{202f}', '\''];

/// How the numbers of a table are written. Numbers that can be read in one way only show it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Numbers {
    /// Whether commas separate columns, so that no number has one.
    commas_separate: bool,
    /// Whether a comma, and whether a point, is a decimal sign somewhere.
    decimal: [bool; 2],
    /// Whether it sets thousands apart somewhere.
    thousands: [bool; 2],
    /// Whether a point before three digits may set thousands apart: semicolons separate columns, as where commas are decimal signs, or
    /// a column has whole numbers besides.
    has_doubtful_points: bool,
}

/// The signs in a number.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Shape {
    decimal: Option<char>,
    thousands: Option<char>,
    /// Whether the decimal sign may as well set thousands apart, as in 1,017.
    doubtful: bool,
}

impl Numbers {
    /// The numbers of a table with this separator of columns, which begins with `head`.
    pub(super) fn of(separator: u8, head: &[u8]) -> Numbers {
        let mut found = Numbers { commas_separate: separator == b',', ..Numbers::default() };
        if !found.commas_separate {
            let fields = head.split(|byte| [separator, b'\n', b'\r', b'"'].contains(byte));
            for shape in fields.filter_map(|field| shape(&super::text(field))).filter(|shape| !shape.doubtful) {
                for (k, sign) in SIGNS.into_iter().enumerate() {
                    found.decimal[k] |= shape.decimal == Some(sign);
                    found.thousands[k] |= shape.thousands == Some(sign);
                }
            }
            found.has_doubtful_points = separator == b';' || has_points_beside_whole_numbers(separator, head);
        }
        found
    }

    /// A finite number.
    ///
    /// # Errors
    /// The text is not a number, or can be read in two ways; the error gives the reason.
    pub fn read(self, text: &[u8]) -> Result<f64, String> {
        let text = super::text(text);
        let text = text.trim();
        let found = finite(text);
        if found.is_ok() && (self.commas_separate || !text.contains('.')) {
            return found;
        }
        let Some(shape) = shape(text) else { return found };
        if self.commas_separate {
            return found.map_err(|why| match shape {
                Shape { decimal: Some(','), .. } | Shape { thousands: Some(','), .. } => format!(
                    "{why}: decimals need a point, as in 12.5 (a decimal comma is read where semicolons or tabs separate columns)"
                ),
                _ => why,
            });
        }
        match shape {
            Shape { doubtful: false, decimal, thousands } => finite(&plain(text, decimal, thousands)),
            Shape { decimal: sign, .. } if self.is_decimal(sign) => finite(&plain(text, sign, None)),
            Shape { decimal: sign, .. } if self.sets_thousands_apart(sign) => finite(&plain(text, None, sign)),
            Shape { decimal: sign, .. } => {
                let [small, large] = [plain(text, sign, None), plain(text, None, sign)];
                Err(format!("may be {small} or {large}: no other number of the table says which"))
            }
        }
    }

    fn has(seen: [bool; 2], sign: Option<char>) -> bool {
        SIGNS.into_iter().zip(seen).any(|(known, seen)| seen && sign == Some(known))
    }

    /// Whether a sign that could be either is the decimal sign. A point is, unless the table has decimal commas or doubtful points.
    fn is_decimal(self, sign: Option<char>) -> bool {
        let [comma, _] = self.decimal;
        let seen = Self::has(self.decimal, sign) || sign == Some('.') && !comma && !self.has_doubtful_points;
        seen && !Self::has(self.thousands, sign)
    }

    fn sets_thousands_apart(self, sign: Option<char>) -> bool {
        Self::has(self.thousands, sign) && !Self::has(self.decimal, sign)
    }
}

/// Whether a column has a number such as 1.450, which may be 1450, beside a whole one such as 980.
fn has_points_beside_whole_numbers(separator: u8, head: &[u8]) -> bool {
    let mut columns: Vec<[bool; 2]> = Vec::new();
    for line in head.split(|byte| *byte == b'\n') {
        for (k, field) in line.split(|byte| *byte == separator).enumerate() {
            let Some(Shape { decimal, thousands, doubtful }) = shape(super::text(field).trim_matches(['"', '\r']))
            else {
                continue;
            };
            columns.resize(columns.len().max(k + 1), [false; 2]);
            columns[k][0] |= doubtful && decimal == Some('.');
            columns[k][1] |= decimal.is_none() && thousands.is_none();
        }
    }
    columns.contains(&[true; 2])
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

    fn read(table: &str, text: &str) -> Result<f64, String> {
        Numbers::of(b';', table.as_bytes()).read(text.as_bytes())
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

    /// Three digits behind a sign may be thousands or decimals: other numbers of the table decide.
    #[test]
    fn a_number_that_can_be_read_in_two_ways_is_read_as_the_others_of_its_table() {
        assert_eq!(read("AB;15,6\nP1;1,017\n", "1,017"), Ok(1.017));
        assert_eq!(read("AB;1,017.5\nP1;1,017\n", "1,017"), Ok(1017.0));
        assert_eq!(read("AB;1.017,5\nP1;1.017\n", "1.017"), Ok(1017.0));
        assert_eq!(read("AB;12.5\nP1;1.017\n", "1.017"), Ok(1.017));
        assert_eq!(read("\"AB\";\"15,6\"\n\"P1\";\"1,017\"\n", "1,017"), Ok(1.017));
        let tabs = |table: &str| Numbers::of(b'\t', table.as_bytes()).read(b"1.017");
        assert_eq!(tabs("P1\t1.017\n"), Ok(1.017));
        assert_eq!(tabs("1\tAB\t1.234\n2\tP1\t1.017\n"), Ok(1.017));
        assert_eq!(tabs("AB\t0.98\nP1\t1.017\nP2\t1\n"), Ok(1.017));
        let refusal = Err("may be 1.017 or 1017: no other number of the table says which".to_owned());
        assert_eq!(tabs("AB\t980\nP1\t1.017\n"), refusal);
        assert_eq!(read("AB;1.450\nP1;1.017\n", "1.017"), refusal);
        assert_eq!(read("AB;1,017\nP1;2,345\n", "1,017"), refusal);
        assert_eq!(read("AB;15,6\nP1;1.017\n", "1.017"), refusal);
        assert_eq!(read("AB;15,6\nP1;1,017.5\n", "1,017"), refusal);
    }

    #[test]
    fn a_comma_is_refused_where_commas_separate_columns() {
        let numbers = Numbers::of(b',', b"AB,\"15,6\"\n");
        for text in ["15,6", "1,017", "1,017.3"] {
            assert!(
                numbers.read(text.as_bytes()).unwrap_err().starts_with("not a number: decimals need a point"),
                "{text}"
            );
        }
        assert_eq!(numbers.read(b" 15.6 "), Ok(15.6));
        assert_eq!(numbers.read(b"1.234.567"), Err("not a number".to_owned()));
        assert_eq!(numbers.read(b"1e999"), Err("not a finite number".to_owned()));
    }
}
