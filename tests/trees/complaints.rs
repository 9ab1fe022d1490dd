//! Error messages for invalid lineage files and trees.

use crate::common::cases::check_cases;
use crate::common::stand_in::small_tree_file;
use furrow_formats::tree_from_json;
use furrow_lineage::Lineage;
use serde_json::Value;

/// A document with one value changed or added, as a case says: where, as a JSON pointer, and what.
pub fn changed(document: &Value, case: &str) -> Value {
    let mut changed = document.clone();
    let (place, value) = case.split_once(' ').unwrap();
    let (above, field) = place.rsplit_once('/').unwrap();
    let inside = changed.pointer_mut(above).unwrap();
    let there = match field.parse::<usize>() {
        Ok(index) => &mut inside[index],
        Err(_) => &mut inside[field],
    };
    *there = serde_json::from_str(value).unwrap();
    changed
}

#[test]
fn lineages() {
    check_cases("trees/complaints/lineage.txt", |text| Lineage::parse(text, "my.ron").unwrap_err().to_string());
}

#[test]
fn trees() {
    let tree: Value = serde_json::from_str(&small_tree_file()).unwrap();
    check_cases("trees/complaints/tree.txt", |case| {
        tree_from_json(&changed(&tree, case).to_string()).unwrap_err().to_string()
    });
}
