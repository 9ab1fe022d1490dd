//! Sets of constants as a table: one row a set, columns by the names of parameters, and their weights.

use super::table::csv_of;
use furrow_cell::{Cell, Parameter};
use furrow_input::table::{Row, Table, malformed, text as text_of};
use furrow_input::{InputError, did_you_mean, shown};

/// A set of constants with its share of the whole.
#[derive(Clone, Debug, PartialEq)]
pub struct Constants {
    /// Parameters and their values.
    pub values: Vec<(Parameter, f64)>,
    /// Its weight; 1 if the table has no weights.
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
/// Names the line, the column, its value and the allowed values.
pub fn read_constants(text: &str, file: &str) -> Result<Vec<Constants>, InputError> {
    let mut table = Table::open(text.as_bytes(), file)?;
    let (_, columns) = table.header(|_| false)?;
    let known: Vec<&str> = Parameter::ALL.iter().map(|parameter| parameter.name()).chain([WEIGHT]).collect();
    // Columns without a name have no values either.
    for (k, name) in columns.iter().enumerate().filter(|(_, name)| !name.is_empty()) {
        let parameter = name.parse::<Parameter>().ok();
        let is_known = *name == WEIGHT || parameter.is_some_and(|p| Parameter::ALL.contains(&p));
        let allowed = format!("one of {}{}", known.join(", "), did_you_mean(name, known.iter().copied()));
        InputError::require(is_known, file, format!("column {}", k + 1), shown(name), allowed)?;
        // A parameter has two names where one of them is short.
        let same = |other: &String| other == name || parameter.is_some() && other.parse().ok() == parameter;
        let new = !columns[..k].iter().any(same);
        InputError::require(new, file, format!("column {}", k + 1), shown(name), "named once")?;
    }
    let mut out = Vec::new();
    while let Some(row) = table.next_row()? {
        if let Some((_, why)) = row.surplus() {
            return Err(malformed(file, row.line as usize, why));
        }
        out.push(constants(&columns, row).map_err(|(column, allowed)| {
            let value = text_of(row.text(column));
            InputError::not_allowed(format!("{file}:{}", row.line), &columns[column], shown(&value), allowed)
        })?);
    }
    InputError::require(!out.is_empty(), file, "rows", "(none)", "at least one set of constants")?;
    let all = out.iter().map(|set| set.weight).sum::<f64>();
    InputError::require(all > 0.0, file, WEIGHT, "0 in every row", "above 0 in some row")?;
    let allowed = "small enough that their sum is a finite number; only their ratios count";
    InputError::require(all.is_finite(), file, WEIGHT, "too large in all rows together", allowed)?;
    Ok(out)
}

/// Reads one set. An error is the column and the allowed values there.
fn constants(columns: &[String], row: Row<'_>) -> Result<Constants, (usize, String)> {
    let mut out = Constants { values: Vec::new(), weight: 1.0 };
    for (k, name) in columns.iter().enumerate().filter(|(_, name)| !name.is_empty()) {
        let value = row.numbers.read(row.text(k)).map_err(|why| (k, format!("a number ({why})")))?;
        match name.parse::<Parameter>() {
            Ok(parameter) => {
                parameter.validate(value).map_err(|allowed| (k, allowed.to_owned()))?;
                out.values.push((parameter, value));
            }
            Err(_) if value >= 0.0 => out.weight = value,
            Err(_) => return Err((k, "a finite number, 0 or above".to_owned())),
        }
    }
    Ok(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn written_values_are_read_back() {
        let set = |aspect: f64, weight: f64| Constants {
            values: vec![(Parameter::Aspect, aspect), (Parameter::P0, 0.1 + 0.2)],
            weight,
        };
        let sets = [set(1.5, 0.25), set(1.0 / 3.0, 0.75)];
        assert_eq!(read_constants(&write_constants(&sets), "c.csv").unwrap(), sets);
    }

    #[test]
    fn tables_of_other_programs_are_read() {
        let plain = read_constants("aspect,weight\n1.5,1\n2,3\n", "c.csv").unwrap();
        for text in [
            "Unnamed: 0,aspect,weight\n0,1.5,1\n1,2,3\n",
            "aspect;weight;\n1,5;1;\n;;\n2;3;\n",
            "# by hand\naspect\tweight\n1,5\t1\n2\t3\n",
        ] {
            assert_eq!(read_constants(text, "c.csv").unwrap(), plain, "{text}");
        }
    }

    #[test]
    fn errors_name_the_fault() {
        let complaint = |text: &str| read_constants(text, "c.csv").unwrap_err().to_string();
        assert!(complaint("aspect,gian\n1,2\n").ends_with("; did you mean gain?"));
        assert_eq!(complaint("aspect,p0\n1.5\n"), "c.csv:2: p0 = \"\": must be a number (empty)");
        assert_eq!(complaint("aspect,p0\n1,5,2\n"), "c.csv:2:1: line 2 has 3 fields, the heading 2");
        assert!(
            complaint("aspect,weight\n1,1e308\n2,1e308\n")
                .starts_with("c.csv: weight = too large in all rows together")
        );
        assert_eq!(complaint("aspect\n-1\n"), "c.csv:2: aspect = \"-1\": must be a finite number above 0");
        assert_eq!(complaint("gain,p0,g\n1,1,1\n"), "c.csv: column 3 = \"g\": must be named once");
        assert_eq!(complaint("aspect\n"), "c.csv: rows = (none): must be at least one set of constants");
    }
}
