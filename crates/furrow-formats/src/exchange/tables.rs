//! The cells of a tree as CSV: with all columns, and as the Python package LineageTree reads them.

use std::fmt::Write;

use super::column::{BranchLengths, Kind, TimedTree};
use furrow_input::csv_field;
use furrow_lineage::{CellTimes, Tree};

/// One row a cell, mothers before daughters: its name, then all columns; a missing value is an empty field. A name that
/// a spreadsheet would take for a formula has an apostrophe before it.
pub(super) fn cells_csv(tree: &TimedTree<'_>) -> String {
    let mut writer = csv::WriterBuilder::new().from_writer(Vec::with_capacity(200 * tree.len()));
    // Writing to memory does not fail.
    let _ = writer.write_record(["name"].into_iter().chain(tree.columns().iter().map(|column| column.name)));
    for id in tree.cells() {
        let _ = writer.write_field(&*csv_field(&tree.cell(id).name));
        for column in tree.columns() {
            let value = (column.of)(tree, id).unwrap_or_default();
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
pub(super) fn lineage_tree_csv(tree: &TimedTree<'_>, lengths: BranchLengths) -> String {
    let x = drawn_at(tree);
    let spans = spans(tree, lengths);
    let mut out = String::with_capacity(40 * tree.len());
    // The last row of each cell.
    let mut last_row = vec![0; tree.len()];
    let mut row = 0;
    for id in tree.cells() {
        let (k, cell) = (id.index(), tree.cell(id));
        let mut before = tree.mother(id).map_or("-1".to_owned(), |mother| last_row[mother.index()].to_string());
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
fn drawn_at(tree: &Tree) -> Vec<f64> {
    let mut x = vec![0.0; tree.len()];
    for (place, leaf) in tree.leaves().enumerate() {
        x[leaf.index()] = place as f64;
    }
    // In breadth-first order from behind, daughters come before their mothers.
    for id in tree.cells().rev() {
        if let Some([anterior, posterior]) = tree.daughters(id) {
            x[id.index()] = 0.5 * (x[anterior.index()] + x[posterior.index()]);
        }
    }
    x
}

/// For each cell its first time point, and the one after its last.
fn spans(tree: &TimedTree<'_>, lengths: BranchLengths) -> Vec<[u64; 2]> {
    let times: Option<Vec<CellTimes>> = tree.cells().map(|id| tree.times(id)).collect();
    let Some(times) = times.filter(|_| lengths != BranchLengths::Generation) else {
        return tree.cells().map(|id| u64::from(tree.cell(id).generation)).map(|time| [time, time + 1]).collect();
    };
    let first = times.iter().map(|cell| cell.birth_min).fold(f64::INFINITY, f64::min);
    let minute = |min: f64| (min - first).round() as u64;
    let last = times.iter().filter_map(|cell| cell.division_min).map(minute).max().unwrap_or(0);
    let mut spans: Vec<[u64; 2]> = Vec::with_capacity(tree.len());
    for id in tree.cells() {
        // A daughter follows her mother's last row, also where rounding puts both into one minute.
        let from = tree.mother(id).map_or(0, |mother| spans[mother.index()][1]);
        let to = times[id.index()].division_min.map_or(last, minute);
        spans.push([from, to.max(from + 1)]);
    }
    spans
}

/// A line per cell, `label first last mother`, as `res_track.txt` of the Cell Tracking Challenge. Labels count the cells from 1; the
/// first cell has mother 0.
pub(super) fn ctc(tree: &TimedTree<'_>, lengths: BranchLengths) -> String {
    let mut out = String::with_capacity(24 * tree.len());
    for (id, [from, to]) in tree.cells().zip(spans(tree, lengths)) {
        let mother = tree.mother(id).map_or(0, |mother| mother.index() + 1);
        let _ = writeln!(out, "{} {from} {} {mother}", id.index() + 1, to - 1);
    }
    out
}

/// Rows that [`lineage_tree_csv`] would write.
pub(super) fn lineage_tree_rows(tree: &TimedTree<'_>, lengths: BranchLengths) -> u64 {
    spans(tree, lengths).iter().map(|[from, to]| to - from).sum()
}
