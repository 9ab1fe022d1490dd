//! Sets of constants as a table: one row a set, columns by the names of parameters, and their weights.

use super::table::csv_of;
use furrow_cell::{Cell, Parameter};
use furrow_input::{InputError, did_you_mean, shown};

/// A set of constants with its share of the whole.
#[derive(Clone, Debug, PartialEq)]
pub struct Constants {
    /// Parameters and their values.
    pub values: Vec<(Parameter, f64)>,
    /// Its weight; 1 where the table has none.
    pub weight: f64,
}

impl Constants {
    /// A cell with these constants.
    pub fn of(&self, cell: &Cell) -> Cell {
        furrow_mechanics::calibration::with_values(cell, &self.values)
    }
}

/// The name of the column of weights.
const WEIGHT: &str = "weight";

/// The table as text; numbers with all their digits, so that reading gives the same numbers.
pub fn write_constants(sets: &[Constants]) -> String {
    let Some(first) = sets.first() else { return String::new() };
    let head = first.values.iter().map(|(parameter, _)| parameter.to_string()).chain([WEIGHT.to_owned()]).collect();
    let row = |set: &Constants| -> Vec<String> {
        set.values.iter().map(|(_, value)| *value).chain([set.weight]).map(|number| number.to_string()).collect()
    };
    csv_of(std::iter::once(head).chain(sets.iter().map(row)))
}

/// Reads a table; errors name it `file`. Lines that begin with `#` are passed over.
///
/// # Errors
/// Names the line, the column, its value and what is allowed.
pub fn read_constants(text: &str, file: &str) -> Result<Vec<Constants>, InputError> {
    let mut lines = text.lines().enumerate().filter(|(_, line)| !line.trim().is_empty() && !line.starts_with('#'));
    let Some((_, head)) = lines.next() else {
        return Err(InputError::not_allowed(file, "first line", "(none)", "names of parameters, as aspect,p0,w,gain"));
    };
    let columns: Vec<&str> = head.split(',').map(str::trim).collect();
    let known: Vec<&str> = Parameter::ALL.iter().map(|parameter| parameter.name()).chain([WEIGHT]).collect();
    for (k, name) in columns.iter().enumerate() {
        let parameter = name.parse::<Parameter>().ok();
        let is_known = *name == WEIGHT || parameter.is_some_and(|p| Parameter::ALL.contains(&p));
        let allowed = format!("one of {}{}", known.join(", "), did_you_mean(name, known.iter().copied()));
        InputError::require(is_known, file, format!("column {}", k + 1), shown(name), allowed)?;
        // A parameter has two names where one of them is short.
        let same = |other: &&str| other == name || parameter.is_some() && other.parse().ok() == parameter;
        let new = !columns[..k].iter().any(same);
        InputError::require(new, file, format!("column {}", k + 1), shown(name), "named once")?;
    }
    let one = |(number, line): (usize, &str)| {
        row(&columns, line).map_err(|(column, value, allowed)| {
            InputError::not_allowed(format!("{file}:{}", number + 1), column, shown(&value), allowed)
        })
    };
    let out: Vec<Constants> = lines.map(one).collect::<Result<_, _>>()?;
    InputError::require(!out.is_empty(), file, "rows", "(none)", "at least one set of constants")?;
    let weighted = out.iter().map(|set| set.weight).sum::<f64>() > 0.0;
    InputError::require(weighted, file, WEIGHT, "0 in every row", "above 0 in some row")?;
    Ok(out)
}

/// One set; or the column, its value and what is allowed.
fn row(columns: &[&str], line: &str) -> Result<Constants, (String, String, String)> {
    let fields: Vec<&str> = line.split(',').map(str::trim).collect();
    if fields.len() != columns.len() {
        let allowed = format!("{} numbers, one for each column", columns.len());
        return Err(("row".to_owned(), line.to_owned(), allowed));
    }
    let mut out = Constants { values: Vec::new(), weight: 1.0 };
    for (name, field) in columns.iter().zip(fields) {
        let wrong = |allowed: &str| ((*name).to_owned(), field.to_owned(), allowed.to_owned());
        let value: f64 = field.parse().map_err(|_| wrong("a number"))?;
        match name.parse::<Parameter>() {
            Ok(parameter) => {
                parameter.validate(value).map_err(wrong)?;
                out.values.push((parameter, value));
            }
            Err(_) if value.is_finite() && value >= 0.0 => out.weight = value,
            Err(_) => return Err(wrong("a finite number, 0 or above")),
        }
    }
    Ok(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_is_read() {
        let set = |aspect: f64, weight: f64| Constants {
            values: vec![(Parameter::Aspect, aspect), (Parameter::P0, 0.1 + 0.2)],
            weight,
        };
        let sets = [set(1.5, 0.25), set(1.0 / 3.0, 0.75)];
        assert_eq!(read_constants(&write_constants(&sets), "c.csv").unwrap(), sets);
    }

    #[test]
    fn what_is_wrong_is_named() {
        let complaint = |text: &str| read_constants(text, "c.csv").unwrap_err().to_string();
        assert!(complaint("aspect,gian\n1,2\n").ends_with("; did you mean gain?"));
        assert_eq!(complaint("aspect,p0\n1.5\n"), "c.csv:2: row = \"1.5\": must be 2 numbers, one for each column");
        assert_eq!(complaint("aspect\n-1\n"), "c.csv:2: aspect = \"-1\": must be a finite number above 0");
        assert_eq!(complaint("gain,p0,g\n1,1,1\n"), "c.csv: column 3 = \"g\": must be named once");
        assert_eq!(complaint("aspect\n"), "c.csv: rows = (none): must be at least one set of constants");
    }
}
