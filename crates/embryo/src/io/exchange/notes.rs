//! Newick whose cells say more than their names: NHX, and Nexus with comments as FigTree reads them.

use std::fmt::Write;

use super::super::newick::{newick_with, push_length, push_name};
use super::{BranchLengths, COLUMNS, ends};
use crate::lineage::{CellId, Tree};

/// Newick with `[&&NHX:key=value:…]` behind the branch length of each cell.
pub(super) fn nhx(tree: &Tree, lengths: BranchLengths) -> String {
    let text = newick_with(tree, |cell, out| {
        push_length(out, lengths.of(tree, cell));
        push_notes(out, tree, cell, "[&&NHX:", ':');
    });
    format!("{text}\n")
}

/// A Nexus file with the ends of the tree as taxa and one rooted tree. `[&key=value,…]` stands between the name of a cell and
/// its branch length, where FigTree and BEAST put what they say of a node.
pub(super) fn nexus(tree: &Tree, lengths: BranchLengths) -> String {
    let ends = ends(tree);
    let mut out = format!("#NEXUS\nBEGIN TAXA;\n  DIMENSIONS NTAX={};\n  TAXLABELS", ends.len());
    for end in ends {
        out.push_str("\n    ");
        push_name(&mut out, &tree.cell(end).name);
    }
    out.push_str("\n  ;\nEND;\nBEGIN TREES;\n  TREE ");
    push_name(&mut out, &tree.lineage.name);
    out.push_str(" = [&R] ");
    out += &newick_with(tree, |cell, out| {
        push_notes(out, tree, cell, "[&", ',');
        push_length(out, lengths.of(tree, cell));
    });
    out.push_str("\nEND;\n");
    out
}

/// What is known of a cell, as a comment.
fn push_notes(out: &mut String, tree: &Tree, cell: CellId, opening: &str, between: char) {
    out.push_str(opening);
    let known =
        COLUMNS.iter().filter(|column| column.note).filter_map(|column| Some((column.name, (column.of)(tree, cell)?)));
    for (k, (name, value)) in known.enumerate() {
        if k > 0 {
            out.push(between);
        }
        let _ = write!(out, "{name}={}", plain(&value.to_string()));
    }
    out.push(']');
}

/// A value without the characters that comments reserve. Neither form has a way to write them: a name with one is changed.
fn plain(value: &str) -> String {
    value.chars().map(|c| if c.is_whitespace() || "[]{}()=:;,'\"".contains(c) { '_' } else { c }).collect()
}
