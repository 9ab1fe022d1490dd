//! Newick: the tree as other programs read it.

use std::fmt::Write;

use crate::lineage::{CellId, Tree};

/// The tree in plain Newick: names on inner nodes, a cell's branch length is its division time `t_end` in τ (for a cell
/// that came to rest, the time at which it was found at rest; absent where no division was computed, as for most of the
/// cells that cannot divide). A cell just above the threshold of division takes thousands of τ. The anterior daughter comes
/// first.
pub fn newick(tree: &Tree) -> String {
    enum Step {
        Enter(CellId),
        Text(char),
        Leave(CellId),
    }
    let mut out = String::with_capacity(40 * tree.len());
    // An own stack: a lineage may be deeper than the call stack.
    let mut steps = vec![Step::Enter(tree.first())];
    while let Some(step) = steps.pop() {
        match step {
            Step::Enter(node) => match tree.daughters(node) {
                Some([anterior, posterior]) => {
                    out.push('(');
                    steps.push(Step::Leave(node));
                    steps.push(Step::Text(')'));
                    steps.push(Step::Enter(posterior));
                    steps.push(Step::Text(','));
                    steps.push(Step::Enter(anterior));
                }
                None => label(tree, node, &mut out),
            },
            Step::Text(c) => out.push(c),
            Step::Leave(node) => label(tree, node, &mut out),
        }
    }
    out.push_str(";\n");
    out
}

fn label(tree: &Tree, node: CellId, out: &mut String) {
    let cell = tree.cell(node);
    // Readers turn underscores of unquoted names into blanks, and reserve punctuation. Quotes are doubled inside quotes.
    if cell.name.chars().all(|c| c.is_ascii_alphanumeric() || c == '.' || c == '-') {
        out.push_str(&cell.name);
    } else {
        out.push('\'');
        out.push_str(&cell.name.replace('\'', "''"));
        out.push('\'');
    }
    if let Some(t_end) = cell.fate.t_end() {
        let _ = write!(out, ":{t_end}");
    }
}
