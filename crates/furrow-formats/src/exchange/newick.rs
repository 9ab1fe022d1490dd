//! Newick, plain and with comments on its cells: NHX, and Nexus as FigTree reads it.

use std::fmt::Write;
use std::iter::successors;

use super::column::{BranchLengths, COLUMNS};
use furrow_lineage::{CellId, Side, Tree};

/// The tree in plain Newick: names on inner nodes, a cell's branch length is its division time `t_end` in τ (for a cell
/// that came to rest, the time at which it was found at rest; absent where no division was computed, as for most of the
/// cells that cannot divide). A cell just above the threshold of division takes thousands of τ. The anterior daughter comes
/// first.
pub fn newick(tree: &Tree) -> String {
    plain(tree, BranchLengths::Time)
}

/// The tree in plain Newick with any branch lengths.
pub(super) fn plain(tree: &Tree, lengths: BranchLengths) -> String {
    let text = nested(tree, |cell, out| push_length(out, lengths.of(tree, cell)));
    format!("{text}\n")
}

/// Newick with `[&&NHX:key=value:…]` behind the branch length of each cell.
pub(super) fn nhx(tree: &Tree, lengths: BranchLengths) -> String {
    let text = nested(tree, |cell, out| {
        push_length(out, lengths.of(tree, cell));
        push_comment(out, tree, cell, "[&&NHX:", ':');
    });
    format!("{text}\n")
}

/// A Nexus file with the leaves as taxa and one rooted tree. `[&key=value,…]` stands between the name of a cell and its
/// branch length, where FigTree and BEAST put what they say of a node.
pub(super) fn nexus(tree: &Tree, lengths: BranchLengths) -> String {
    let leaves: Vec<CellId> = tree.leaves().collect();
    let mut out = format!("#NEXUS\nBEGIN TAXA;\n  DIMENSIONS NTAX={};\n  TAXLABELS", leaves.len());
    for leaf in leaves {
        out.push_str("\n    ");
        push_name(&mut out, &tree.cell(leaf).name);
    }
    out.push_str("\n  ;\nEND;\nBEGIN TREES;\n  TREE ");
    push_name(&mut out, &tree.lineage.name);
    out.push_str(" = [&R] ");
    out += &nested(tree, |cell, out| {
        push_comment(out, tree, cell, "[&", ',');
        push_length(out, lengths.of(tree, cell));
    });
    out.push_str("\nEND;\n");
    out
}

/// The tree up to its semicolon, with what `after_name` writes behind the name of each cell.
fn nested(tree: &Tree, mut after_name: impl FnMut(CellId, &mut String)) -> String {
    let is_anterior = |cell: &CellId| tree.side(*cell) == Some(Side::Anterior);
    let mut out = String::with_capacity(40 * tree.len());
    for cell in tree.post_order() {
        if tree.daughter_count(cell) == 0 {
            // One bracket for each cell whose anterior descendants begin with this one.
            let above = successors(Some(cell), |cell| tree.mother(*cell));
            above.take_while(is_anterior).for_each(|_| out.push('('));
        }
        push_name(&mut out, &tree.cell(cell).name);
        after_name(cell, &mut out);
        out.push(match tree.side(cell) {
            Some(Side::Anterior) => ',',
            Some(Side::Posterior) => ')',
            None => ';',
        });
    }
    out
}

/// Appends a name, in quotes where readers would take it for something else: they turn underscores of unquoted names into
/// blanks, and reserve punctuation. Quotes are doubled inside quotes.
fn push_name(out: &mut String, name: &str) {
    if name.chars().all(|c| c.is_ascii_alphanumeric() || c == '.' || c == '-') {
        out.push_str(name);
    } else {
        out.push('\'');
        out.push_str(&name.replace('\'', "''"));
        out.push('\'');
    }
}

fn push_length(out: &mut String, length: Option<f64>) {
    if let Some(length) = length {
        let _ = write!(out, ":{length}");
    }
}

/// Appends the columns of a cell as a comment.
fn push_comment(out: &mut String, tree: &Tree, cell: CellId, opening: &str, between: char) {
    out.push_str(opening);
    let known =
        COLUMNS.iter().filter(|column| column.note).filter_map(|column| Some((column.name, (column.of)(tree, cell)?)));
    for (k, (name, value)) in known.enumerate() {
        if k > 0 {
            out.push(between);
        }
        let _ = write!(out, "{name}={}", without_reserved(&value));
    }
    out.push(']');
}

/// A value without the characters that comments reserve: neither form can escape them.
fn without_reserved(value: &str) -> String {
    value.chars().map(|c| if c.is_whitespace() || "[]{}()=:;,'\"".contains(c) { '_' } else { c }).collect()
}

#[cfg(test)]
mod tests {
    use super::push_name;

    #[test]
    fn names_with_reserved_characters_are_quoted() {
        for (name, written) in
            [("AB.p-1", "AB.p-1"), ("Q_1", "'Q_1'"), ("a b", "'a b'"), ("it's", "'it''s'"), ("(µ)", "'(µ)'")]
        {
            let mut out = String::new();
            push_name(&mut out, name);
            assert_eq!(out, written);
        }
    }
}
