//! `tree.json` and its exports.

use furrow_formats::exchange::{BranchLengths, Exported, Format, export};
use furrow_formats::{tree_from_json, tree_to_json};
use furrow_lineage::Tree;

use super::text;

/// A valid tree survives writing and reading, and is exported to every format.
pub fn check(data: &[u8]) {
    let Some(text) = text(data) else { return };
    let tree = match tree_from_json(text) {
        Ok(tree) => tree,
        Err(error) => {
            let said = error.to_string();
            assert!(!said.is_empty() && said.len() < 4000, "an error of {} bytes", said.len());
            return;
        }
    };
    let written = tree_to_json(&tree).expect("a tree is written");
    let again = tree_from_json(&written).unwrap_or_else(|error| panic!("{error}: {written}"));
    assert_eq!(tree_to_json(&again).expect("a tree is written"), written);
    let names = |tree: &Tree| -> Vec<String> { tree.cells().map(|id| tree.cell(id).name.clone()).collect() };
    assert_eq!(names(&again), names(&tree));
    // One kind of length per format: the kinds differ in numbers only.
    for (k, format) in Format::ALL.into_iter().enumerate() {
        let lengths = BranchLengths::NAMED[k % 4].1;
        match export(&tree, format, lengths, &["#000000"]) {
            Exported::File(text) => assert!(!text.is_empty()),
            Exported::Folder(files) => assert!(files.iter().all(|(name, _)| !name.is_empty())),
            Exported::Binary(files) => assert!(files.iter().all(|(name, _)| !name.is_empty())),
        }
    }
}
