//! Columns and rows of a sweep, as CSV and as JSON lines.

use super::points::AxisValue;
use super::sweep::{Kind, Sweep};
use furrow_input::csv_field;
use serde::Serialize;
use serde_json::{Map, Value};

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
    /// The columns of its table: the axes, then the results.
    pub fn columns(&self) -> Vec<String> {
        let axes = self.axes.0.iter().map(|axis| axis.name.clone());
        axes.chain(self.result_columns()).collect()
    }

    /// The columns after the axes' columns.
    pub(crate) fn result_columns(&self) -> Vec<String> {
        let fixed: &[&str] = match self.kind {
            Kind::Division if self.replicates == 1 => &["outcome", "chi", "u_furrow", "t_end", "chi_signed"],
            Kind::Division => &["symmetric", "asymmetric", "failed", "chi_mean", "chi_sd"],
            Kind::Pitchfork => &["xi_s", "criticality", "coefficient", "H"],
            Kind::Critical => &["r0_c", "kind"],
            Kind::Tree => &["cells"],
        };
        let mut columns: Vec<String> = fixed.iter().map(|name| (*name).to_owned()).collect();
        if self.has_neck_offsets() {
            columns.push("neck_offset".to_owned());
        }
        for founder in self.lineage.founders.iter().filter(|_| self.kind == Kind::Tree) {
            let counts = ["min", "mean", "max", "full_doublings", "terminal", "chi", "r0", "chi_signed"];
            columns.extend(counts.map(|count| format!("{}_{count}", founder.name)));
        }
        columns
    }

    /// Whether its rows have the distance of the neck from the axis: single divisions without axial symmetry.
    pub(crate) fn has_neck_offsets(&self) -> bool {
        self.kind == Kind::Division && self.replicates == 1 && self.settings.numerics.modes > 0
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

/// Records as CSV under a header: lists in the header's order, or objects with its names, where missing fields stay empty.
///
/// # Errors
/// A record cannot be serialised.
pub fn records_csv<T: Serialize>(
    header: &str,
    records: impl IntoIterator<Item = T>,
) -> Result<Vec<u8>, serde_json::Error> {
    let records = records.into_iter().map(serde_json::to_value).collect::<Result<Vec<Value>, serde_json::Error>>()?;
    Ok(values_csv(header, records).into_bytes())
}

/// The same of records that are serialised.
pub(crate) fn values_csv(header: &str, records: Vec<Value>) -> String {
    let cell = |record: &Value, k, name| record.get(name).or_else(|| record.get(k)).cloned().unwrap_or_default();
    let cells = |record| header.split(',').enumerate().map(|(k, name)| cell(&record, k, name)).collect::<Vec<Value>>();
    cells_csv(header.split(','), records.into_iter().map(cells))
}

/// The rows as JSON, one a line, their fields in the order of the columns.
pub fn json_lines(columns: &[String], rows: &[Row]) -> String {
    let line = |Row { index, cells, why }: &Row| {
        let mut fields = Map::from_iter([("index".to_owned(), Value::from(*index))]);
        fields.extend(columns.iter().cloned().zip(cells.iter().cloned()));
        fields.extend(why.iter().map(|why| ("why".to_owned(), why.as_str().into())));
        format!("{}\n", Value::Object(fields))
    };
    rows.iter().map(line).collect()
}

/// Reads a line that [`json_lines`] wrote; `None` if it cannot have written this.
pub fn read_line(columns: &[String], line: &str) -> Option<Row> {
    let mut fields: Map<String, Value> = serde_json::from_str(line).ok()?;
    let index = usize::try_from(fields.remove("index")?.as_u64()?).ok()?;
    let why = fields.remove("why").map(|why| why.as_str().map(str::to_owned).ok_or(())).transpose().ok()?;
    let cells = columns.iter().map(|name| fields.remove(name)).collect::<Option<Vec<Value>>>()?;
    fields.is_empty().then_some(Row { index, cells, why })
}

/// Rows of a sweep as CSV.
pub fn csv_text(columns: &[String], rows: &[Row]) -> String {
    cells_csv(columns.iter().map(String::as_str), rows.iter().map(|row| &row.cells[..]))
}

/// Cells below the names of their columns, as CSV.
fn cells_csv<'a, R: AsRef<[Value]>>(
    columns: impl Iterator<Item = &'a str>,
    rows: impl IntoIterator<Item = R>,
) -> String {
    let names = columns.map(|name| csv_field(name).into_owned()).collect::<Vec<_>>();
    let cells = rows.into_iter().map(|cells| cells.as_ref().iter().map(csv_cell).collect());
    csv_of(std::iter::once(names).chain(cells))
}

/// Records of text as CSV.
pub(crate) fn csv_of<R: IntoIterator<Item = String>>(records: impl IntoIterator<Item = R>) -> String {
    let mut writer = csv::WriterBuilder::new().flexible(true).from_writer(Vec::new());
    // Writing to memory, with records of any length, cannot fail.
    records.into_iter().for_each(|record| drop(writer.write_record(record.into_iter().map(String::into_bytes))));
    String::from_utf8_lossy(&writer.into_inner().unwrap_or_default()).into_owned()
}

/// Numbers with the fewest digits that read back as the same number; text that a spreadsheet would take for a formula with an
/// apostrophe before it.
fn csv_cell(cell: &Value) -> String {
    match cell {
        Value::Null => String::new(),
        Value::String(text) => csv_field(text).into_owned(),
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
        let text = json_lines(&columns, &rows);
        let read: Vec<Row> = text.lines().map(|line| read_line(&columns, line).unwrap()).collect();
        assert_eq!(read, rows);
        assert!(read_line(&columns[..2], text.lines().next().unwrap()).is_none());
        let csv = csv_text(&columns, &rows);
        assert_eq!(csv, "r0,cue,chi\n0.1,\"none, or \"\"x\"\"\",\n3,a,0.3333333333333333\n");
    }
}
