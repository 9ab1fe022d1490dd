//! The cells of a tree as CSV: with all columns, and as the Python package LineageTree reads them.

use std::fmt::Write;

use super::column::{COLUMNS, Kind};
use furrow_input::csv_field;
use furrow_lineage::Tree;

/// One row a cell, mothers before daughters: its name, then all columns; what is not there is an empty field. A name that
/// a spreadsheet would take for a formula has an apostrophe before it.
pub(super) fn cells_csv(tree: &Tree) -> String {
    let mut writer = csv::WriterBuilder::new().from_writer(Vec::with_capacity(200 * tree.len()));
    // Writing to memory does not fail.
    let _ = writer.write_record(["name"].into_iter().chain(COLUMNS.iter().map(|column| column.name)));
    for id in tree.cells() {
        let _ = writer.write_field(&*csv_field(&tree.cell(id).name));
        for column in &COLUMNS {
            let value = (column.of)(tree, id).unwrap_or_default();
            // A negative number is no formula.
            let field = if column.kind == Kind::Text { csv_field(&value) } else { value.as_str().into() };
            let _ = writer.write_field(&*field);
        }
        let _ = writer.write_record(None::<&[u8]>);
    }
    String::from_utf8(writer.into_inner().unwrap_or_default()).unwrap_or_default()
}

/// One row a cell, without a heading: `id, time, z, y, x, pred, lin`, as `read_from_csv` of LineageTree expects. `id` counts
/// the cells from 0 in the order of `tree.json`, `time` is the generation, `pred` the mother's `id` (−1 for the first cell),
/// `lin` the founder's place in the lineage. The places are those of a drawing of the tree: x counts the leaves from the
/// anterior one, a mother midway between her daughters, and y is the generation. LineageTree numbers cells anew; z keeps the
/// `id`.
pub(super) fn lineage_tree_csv(tree: &Tree) -> String {
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
    let mut out = String::with_capacity(40 * tree.len());
    for id in tree.cells() {
        let cell = tree.cell(id);
        let (k, time) = (id.index(), cell.generation);
        let mother = tree.mother(id).map_or("-1".to_owned(), |mother| mother.index().to_string());
        let _ = writeln!(out, "{k},{time},{k},{time},{},{mother},{}", x[k], cell.founder);
    }
    out
}
