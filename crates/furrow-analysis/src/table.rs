//! Columns and rows of a sweep, as CSV and as JSON lines.

use serde::Serialize;
use serde::ser::{SerializeMap, Serializer};
use serde_json::{Map, Value};

use super::points::AxisValue;
use super::sweep::{Kind, Sweep};

/// The outcome of a point that could not be computed.
pub const UNDECIDED: &str = "undecided";

/// One row: a point and its results.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// Number of the point.
    pub index: usize,
    /// One value per column: a number, a word, or null.
    pub cells: Vec<Value>,
    /// Why it was not, or not entirely, computed.
    pub why: Option<String>,
}

impl Sweep {
    /// The columns of its table: the axes, then what is computed.
    pub fn columns(&self) -> Vec<String> {
        let axes = self.axes.0.iter().map(|axis| axis.name.clone());
        axes.chain(self.result_columns()).collect()
    }

    /// The columns after those of the axes.
    pub fn result_columns(&self) -> Vec<String> {
        let fixed: &[&str] = match self.kind {
            Kind::Division if self.replicates == 1 => &["outcome", "chi", "u_furrow", "t_end"],
            Kind::Division => &["symmetric", "asymmetric", "failed", "chi_mean", "chi_sd"],
            Kind::Pitchfork => &["xi_s", "criticality", "coefficient", "H"],
            Kind::Critical => &["r0_c", "kind"],
            Kind::Tree => &["cells"],
        };
        let mut columns: Vec<String> = fixed.iter().map(|name| (*name).to_owned()).collect();
        if self.kind == Kind::Tree {
            for founder in &self.lineage.founders {
                let counts = ["min", "mean", "max", "full_doublings", "terminal", "chi"];
                columns.extend(counts.map(|count| format!("{}_{count}", founder.name)));
            }
        }
        columns
    }

    /// The row of a point with these results.
    pub(super) fn row(&self, index: usize, results: Vec<Value>, why: Option<String>) -> Row {
        let axis = |value: &AxisValue| match value {
            AxisValue::Number(number) => Value::from(*number),
            AxisValue::Text(text) => Value::from(text.as_str()),
        };
        let cells = self.axes.values(index).into_iter().map(axis).chain(results).collect();
        Row { index, cells, why }
    }
}

/// A row as a JSON object, its fields in the order of the columns.
struct Line<'a> {
    columns: &'a [String],
    row: &'a Row,
}

impl Serialize for Line<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(None)?;
        map.serialize_entry("index", &self.row.index)?;
        for (name, cell) in self.columns.iter().zip(&self.row.cells) {
            map.serialize_entry(name, cell)?;
        }
        if let Some(why) = &self.row.why {
            map.serialize_entry("why", why)?;
        }
        map.end()
    }
}

/// The rows as JSON, one a line.
///
/// # Errors
/// A row without a JSON form.
pub fn json_lines(columns: &[String], rows: &[Row]) -> Result<Vec<u8>, serde_json::Error> {
    let mut out = Vec::new();
    for row in rows {
        serde_json::to_writer(&mut out, &Line { columns, row })?;
        out.push(b'\n');
    }
    Ok(out)
}

/// Reads a line that [`json_lines`] wrote; `None` if it cannot have written this.
pub fn read_line(columns: &[String], line: &str) -> Option<Row> {
    let mut fields: Map<String, Value> = serde_json::from_str(line).ok()?;
    let index = usize::try_from(fields.remove("index")?.as_u64()?).ok()?;
    let why = match fields.remove("why") {
        Some(Value::String(why)) => Some(why),
        Some(_) => return None,
        None => None,
    };
    let cells = columns.iter().map(|name| fields.remove(name)).collect::<Option<Vec<Value>>>()?;
    fields.is_empty().then_some(Row { index, cells, why })
}

/// The rows as CSV with a header. Missing values are empty fields.
///
/// # Errors
/// [`csv::Error`] if rows have different lengths.
pub fn csv_text(columns: &[String], rows: &[Row]) -> Result<Vec<u8>, csv::Error> {
    let cells = rows.iter().map(|row| row.cells.iter().map(csv_cell).collect());
    Ok(csv_of(std::iter::once(columns.to_vec()).chain(cells))?.into_bytes())
}

/// Records of text as CSV.
///
/// # Errors
/// [`csv::Error`] if records have different lengths.
pub fn csv_of<R: IntoIterator<Item = String>>(records: impl IntoIterator<Item = R>) -> Result<String, csv::Error> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    for record in records {
        writer.write_record(record.into_iter().map(String::into_bytes))?;
    }
    let bytes = writer.into_inner().map_err(|error| csv::Error::from(error.into_error()))?;
    Ok(String::from_utf8_lossy(&bytes).into_owned())
}

/// Numbers with the fewest digits that read back as the same number.
fn csv_cell(cell: &Value) -> String {
    match cell {
        Value::Null => String::new(),
        Value::String(text) => text.clone(),
        Value::Number(number) if number.is_f64() => number.as_f64().unwrap_or(f64::NAN).to_string(),
        other => other.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_read_as_they_were_written() {
        let columns = ["r0", "cue", "chi"].map(str::to_owned);
        let rows = [
            Row { index: 0, cells: vec![0.1.into(), "none, or \"x\"".into(), Value::Null], why: Some("lost".into()) },
            Row { index: 7, cells: vec![3.0.into(), "a".into(), (1.0 / 3.0).into()], why: None },
        ];
        let text = String::from_utf8(json_lines(&columns, &rows).unwrap()).unwrap();
        let read: Vec<Row> = text.lines().map(|line| read_line(&columns, line).unwrap()).collect();
        assert_eq!(read, rows);
        assert!(read_line(&columns[..2], text.lines().next().unwrap()).is_none());
        let csv = String::from_utf8(csv_text(&columns, &rows).unwrap()).unwrap();
        assert_eq!(csv, "r0,cue,chi\n0.1,\"none, or \"\"x\"\"\",\n3,a,0.3333333333333333\n");
    }
}
