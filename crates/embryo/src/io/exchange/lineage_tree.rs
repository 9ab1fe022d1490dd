//! The numeric CSV of the Python package LineageTree.

use std::fmt::Write;

use super::ends;
use crate::lineage::Tree;

/// One row a cell, without a heading: `id, time, z, y, x, pred, lin`, which is what `read_from_csv` of LineageTree takes apart.
/// `id` counts the cells from 0 in the order of `tree.json`, `time` is the generation, `pred` the mother's `id` (−1 for
/// the first cell), `lin` the founder's place in the lineage. Cells have no place in space, and stand where a drawing of the tree has
/// them: x counts the ends of the tree from the anterior one, a mother standing midway between her daughters, and y is the
/// generation. The reader numbers cells anew, and z holds the `id` by which they are known again.
pub(super) fn lineage_tree_csv(tree: &Tree) -> String {
    let across = across(tree);
    let mut out = String::with_capacity(40 * tree.len());
    for id in tree.cells() {
        let cell = tree.cell(id);
        let (k, time) = (id.index(), cell.generation);
        let mother = tree.mother(id).map_or("-1".to_owned(), |mother| mother.index().to_string());
        let _ = writeln!(out, "{k},{time},{k},{time},{},{mother},{}", across[k], cell.founder);
    }
    out
}

/// Where each cell stands from anterior to posterior, in ends of the tree.
fn across(tree: &Tree) -> Vec<f64> {
    let mut across = vec![0.0; tree.len()];
    for (place, end) in ends(tree).into_iter().enumerate() {
        across[end.index()] = place as f64;
    }
    // In breadth-first order from behind, daughters come before their mothers.
    for id in tree.cells().rev() {
        if let Some([anterior, posterior]) = tree.daughters(id) {
            across[id.index()] = 0.5 * (across[anterior.index()] + across[posterior.index()]);
        }
    }
    across
}
