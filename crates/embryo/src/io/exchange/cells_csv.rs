//! The cells of a tree as CSV.

use super::COLUMNS;
use crate::lineage::Tree;

/// One row a cell, mothers before daughters: its name, then all columns; what is not there is an empty field.
pub(super) fn cells_csv(tree: &Tree) -> String {
    let mut writer = csv::WriterBuilder::new().from_writer(Vec::with_capacity(200 * tree.len()));
    // Writing to memory does not fail.
    let _ = writer.write_record(["name"].into_iter().chain(COLUMNS.iter().map(|column| column.name)));
    for id in tree.cells() {
        let _ = writer.write_field(&tree.cell(id).name);
        for column in &COLUMNS {
            let _ = writer.write_field((column.of)(tree, id).map_or(String::new(), |value| value.to_string()));
        }
        let _ = writer.write_record(None::<&[u8]>);
    }
    String::from_utf8(writer.into_inner().unwrap_or_default()).unwrap_or_default()
}
