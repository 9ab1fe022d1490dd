//! Newick, plain and with comments on its cells: NHX, and Nexus as FigTree reads it.

use std::iter::successors;

use super::column::{BranchLengths, TimedTree};
use furrow_lineage::{CellId, Side, Tree};

/// The tree in plain Newick: names on inner nodes, a cell's branch length is its division time `t_end` in τ (for a cell
/// that came to rest, the time at which it was found at rest; absent where no division was computed, as for most of the
/// cells that cannot divide). A cell just above the threshold of division takes thousands of τ. The anterior daughter comes
/// first.
pub fn newick(tree: &Tree) -> String {
    plain(&TimedTree::new(tree), BranchLengths::Time)
}

/// The tree in plain Newick with any branch lengths.
pub(super) fn plain(tree: &TimedTree<'_>, lengths: BranchLengths) -> String {
    nested(tree, |cell| length(tree, cell, lengths)) + "\n"
}

/// Newick with `[&&NHX:key=value:…]` behind the branch length of each cell.
pub(super) fn nhx(tree: &TimedTree<'_>, lengths: BranchLengths) -> String {
    nested(tree, |cell| length(tree, cell, lengths) + &comment(tree, cell, "&&NHX:", ":")) + "\n"
}

/// A Nexus file with the leaves as taxa and one rooted tree. `[&key=value,…]` is between the name of a cell and its
/// branch length, where FigTree and BEAST put annotations of a node.
pub(super) fn nexus(tree: &TimedTree<'_>, lengths: BranchLengths) -> String {
    let labels: Vec<String> = tree.leaves().map(|leaf| format!("\n    {}", quoted(&tree.cell(leaf).name))).collect();
    let (count, labels, name) = (labels.len(), labels.concat(), quoted(&tree.lineage.name));
    let nested = nested(tree, |cell| comment(tree, cell, "&", ",") + &length(tree, cell, lengths));
    format!(
        "#NEXUS\nBEGIN TAXA;\n  DIMENSIONS NTAX={count};\n  TAXLABELS{labels}\n  ;\nEND;\nBEGIN TREES;\n  TREE {name} = [&R] \
         {nested}\nEND;\n"
    )
}

/// The tree up to its semicolon, with what `after_name` gives behind the name of each cell.
fn nested(tree: &Tree, after_name: impl Fn(CellId) -> String) -> String {
    let is_anterior = |cell: &CellId| tree.side(*cell) == Some(Side::Anterior);
    let mut out = String::with_capacity(40 * tree.len());
    for cell in tree.post_order() {
        if tree.daughter_count(cell) == 0 {
            // Opens one bracket for each cell above with this leaf as its first descendant.
            let above = successors(Some(cell), |cell| tree.mother(*cell));
            above.take_while(is_anterior).for_each(|_| out.push('('));
        }
        out.push_str(&quoted(&tree.cell(cell).name));
        out.push_str(&after_name(cell));
        out.push(match tree.side(cell) {
            Some(Side::Anterior) => ',',
            Some(Side::Posterior) => ')',
            None => ';',
        });
    }
    out
}

/// A name, in quotes where readers would take it for something else: they turn underscores of unquoted names into blanks, and
/// reserve punctuation. Quotes are doubled inside quotes.
fn quoted(name: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || c == '.';
    match name.starts_with(|c: char| c.is_ascii_alphanumeric()) && name.chars().all(plain) {
        true => name.to_owned(),
        false => format!("'{}'", name.replace('\'', "''")),
    }
}

fn length(tree: &TimedTree<'_>, cell: CellId, lengths: BranchLengths) -> String {
    lengths.of(tree, cell).map_or(String::new(), |length| format!(":{length}"))
}

/// The columns of a cell as a comment, without the characters that comments reserve: neither form can escape them.
fn comment(tree: &TimedTree<'_>, cell: CellId, opening: &str, between: &str) -> String {
    let plain = |c: char| if c.is_whitespace() || "[]{}()=:;,'\"".contains(c) { '_' } else { c };
    let noted = tree.columns().iter().filter(|column| column.note).filter_map(|column| {
        let value: String = (column.of)(tree, cell)?.chars().map(plain).collect();
        Some(format!("{}={value}", column.name))
    });
    format!("[{opening}{}]", noted.collect::<Vec<_>>().join(between))
}

#[cfg(test)]
mod tests {
    use super::quoted;

    #[test]
    fn names_with_reserved_characters_are_quoted() {
        for (name, written) in [
            ("AB.p1", "AB.p1"),
            ("-x", "'-x'"),
            ("", "''"),
            ("Q_1", "'Q_1'"),
            ("a b", "'a b'"),
            ("it's", "'it''s'"),
            ("(µ)", "'(µ)'"),
        ] {
            assert_eq!(quoted(name), written);
        }
    }
}
