//! The cells of a tree as CSV: with all columns, and as the Python package LineageTree reads them.

use std::fmt::Write;

use super::column::{BranchLengths, Kind};
use super::sheet::Sheet;
use furrow_input::csv_field;

/// One row a cell, mothers before daughters: its name, then all columns; a missing value is an empty field. A name that
/// a spreadsheet would take for a formula has an apostrophe before it.
pub(super) fn cells_csv(sheet: &Sheet<'_>) -> String {
    let mut writer = csv::WriterBuilder::new().from_writer(Vec::with_capacity(200 * sheet.len()));
    // Writing to memory does not fail.
    let _ = writer.write_record(["name"].into_iter().chain(sheet.columns.iter().map(|column| column.name)));
    for (id, cell) in sheet.cells.iter().enumerate() {
        let _ = writer.write_field(&*csv_field(cell.name));
        for column in &sheet.columns {
            let value = (column.of)(id).unwrap_or_default();
            // A negative number is no formula.
            let field = if column.kind == Kind::Text { csv_field(&value) } else { value.as_str().into() };
            let _ = writer.write_field(&*field);
        }
        let _ = writer.write_record(None::<&[u8]>);
    }
    String::from_utf8(writer.into_inner().unwrap_or_default()).unwrap_or_default()
}

/// Rows without a heading: `id, time, z, y, x, pred, lin`, as `read_from_csv` of LineageTree expects. `id` counts the rows from 0,
/// `pred` is the `id` of the row before (−1 for the first), `lin` the founder's place in the lineage. The places come from a
/// drawing of the tree: x counts the leaves from the anterior one, a mother midway between her daughters, and y is the
/// generation. LineageTree numbers rows anew; z keeps the cell's place in `tree.json`.
///
/// Without a clock, and with lengths by generation, a cell is one row, and `time` is its generation. With a clock it is a row for
/// each minute of its life, from the first birth, 0, to the last division in the tree.
pub(super) fn lineage_tree_csv(sheet: &Sheet<'_>, lengths: BranchLengths) -> String {
    let x = drawn_at(sheet);
    let spans = spans(sheet, lengths);
    let mut out = String::with_capacity(40 * sheet.len());
    // The last row of each cell.
    let mut last_row = vec![0; sheet.len()];
    let mut row = 0;
    for (k, cell) in sheet.cells.iter().enumerate() {
        let mut before = cell.mother.map_or("-1".to_owned(), |mother| last_row[mother].to_string());
        let [from, to] = spans[k];
        for time in from..to {
            let _ = writeln!(out, "{row},{time},{k},{},{},{before},{}", cell.generation, x[k], cell.founder);
            before = row.to_string();
            last_row[k] = row;
            row += 1;
        }
    }
    out
}

/// Where cells are drawn: the leaves at 0, 1, …, a mother midway between her daughters.
fn drawn_at(sheet: &Sheet<'_>) -> Vec<f64> {
    let mut x = vec![0.0; sheet.len()];
    for (place, leaf) in sheet.leaves().enumerate() {
        x[leaf] = place as f64;
    }
    // Mothers come before their daughters.
    for (id, cell) in sheet.cells.iter().enumerate().rev() {
        match cell.daughters {
            [Some(first), Some(second)] => x[id] = 0.5 * (x[first] + x[second]),
            [Some(one), None] | [None, Some(one)] => x[id] = x[one],
            [None, None] => {}
        }
    }
    x
}

/// For each cell its first time point, and the one after its last.
fn spans(sheet: &Sheet<'_>, lengths: BranchLengths) -> Vec<[u64; 2]> {
    let times: Option<Vec<(f64, Option<f64>)>> = sheet.cells.iter().map(|cell| cell.times).collect();
    let Some(times) = times.filter(|_| lengths != BranchLengths::Generation) else {
        return sheet.cells.iter().map(|cell| u64::from(cell.generation)).map(|time| [time, time + 1]).collect();
    };
    let first = times.iter().map(|(birth, _)| *birth).fold(f64::INFINITY, f64::min);
    let minute = |min: f64| (min - first).round() as u64;
    let ends = times.iter().map(|(birth, division)| division.unwrap_or(*birth));
    let last = ends.map(minute).max().unwrap_or(0);
    let mut spans: Vec<[u64; 2]> = Vec::with_capacity(sheet.len());
    for (cell, (birth, division)) in sheet.cells.iter().zip(times) {
        // A daughter follows her mother's last row, also where rounding puts both into one minute.
        let from = cell.mother.map_or_else(|| minute(birth), |mother| spans[mother][1]);
        let seen = cell.last.map_or(last, |last| minute(last) + 1);
        let to = division.map_or(seen, minute);
        spans.push([from, to.max(from + 1)]);
    }
    spans
}

/// The number of minutes by which cells start late at most, because every cell has a time point of its own.
pub(super) fn latest_start(sheet: &Sheet<'_>, lengths: BranchLengths) -> u64 {
    let births = || sheet.cells.iter().filter_map(|cell| Some(cell.times?.0));
    let first = births().fold(f64::INFINITY, f64::min);
    let is_minutes = lengths != BranchLengths::Generation && births().count() == sheet.len();
    let late = births()
        .zip(spans(sheet, lengths))
        .map(|(birth, [from, _])| from.saturating_sub((birth - first).round() as u64));
    if is_minutes { late.max().unwrap_or(0) } else { 0 }
}

/// A line per cell, `label first last mother`, as `res_track.txt` of the Cell Tracking Challenge. Labels count the cells from 1; the
/// first cell has mother 0.
pub(super) fn ctc(sheet: &Sheet<'_>, lengths: BranchLengths) -> String {
    let mut out = String::with_capacity(24 * sheet.len());
    for ((id, cell), [from, to]) in sheet.cells.iter().enumerate().zip(spans(sheet, lengths)) {
        let mother = cell.mother.map_or(0, |mother| mother + 1);
        let _ = writeln!(out, "{} {from} {} {mother}", id + 1, to - 1);
    }
    out
}

/// Rows that [`lineage_tree_csv`] would write.
pub(super) fn lineage_tree_rows(sheet: &Sheet<'_>, lengths: BranchLengths) -> u64 {
    spans(sheet, lengths).iter().map(|[from, to]| to - from).sum()
}
