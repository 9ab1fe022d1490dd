//! Newick, out and in: the tree as nearly every other program reads it.

mod read;

pub use read::{MOST_NODES, Newick, NewickNode};

use std::fmt::Write;

use super::exchange::BranchLengths;
use crate::lineage::{CellId, Tree};

/// The tree in plain Newick: names on inner nodes, a cell's branch length is its division time `t_end` in τ (for a cell
/// that came to rest, the time at which it was found at rest; absent where no division was computed, as for most of the
/// cells that cannot divide). A cell just above the threshold of division takes thousands of τ. The anterior daughter comes
/// first.
pub fn newick(tree: &Tree) -> String {
    format!("{}\n", newick_with(tree, |cell, out| push_length(out, BranchLengths::Time.of(tree, cell))))
}

/// The tree up to its semicolon, with what `after_name` writes behind the name of each cell.
pub(super) fn newick_with(tree: &Tree, mut after_name: impl FnMut(CellId, &mut String)) -> String {
    let mut out = String::with_capacity(40 * tree.len());
    let daughters = |cell| tree.daughters(cell).into_iter().flatten();
    nested(tree.first(), daughters, &mut out, |cell, out| {
        push_name(out, &tree.cell(cell).name);
        after_name(cell, out);
    });
    out.push(';');
    out
}

/// Writes the brackets and commas of a tree, and has each node written by `node`. It keeps an own stack: a lineage may be deeper
/// than the call stack.
fn nested<Id: Copy, Daughters: DoubleEndedIterator<Item = Id>>(
    root: Id,
    daughters: impl Fn(Id) -> Daughters,
    out: &mut String,
    mut node: impl FnMut(Id, &mut String),
) {
    enum Step<Id> {
        Enter(Id),
        Comma,
        Leave(Id),
    }
    let mut steps = vec![Step::Enter(root)];
    while let Some(step) = steps.pop() {
        match step {
            Step::Enter(id) => {
                let before = steps.len();
                steps.push(Step::Leave(id));
                // From the last to the first, which is then taken first.
                for daughter in daughters(id).rev() {
                    if steps.len() > before + 1 {
                        steps.push(Step::Comma);
                    }
                    steps.push(Step::Enter(daughter));
                }
                if steps.len() > before + 1 {
                    out.push('(');
                } else {
                    steps.truncate(before);
                    node(id, out);
                }
            }
            Step::Comma => out.push(','),
            Step::Leave(id) => {
                out.push(')');
                node(id, out);
            }
        }
    }
}

/// Appends a name, in quotes where readers would take it for something else: they turn underscores of unquoted names into
/// blanks, and reserve punctuation. Quotes are doubled inside quotes.
pub(super) fn push_name(out: &mut String, name: &str) {
    if name.chars().all(|c| c.is_ascii_alphanumeric() || c == '.' || c == '-') {
        out.push_str(name);
    } else {
        out.push('\'');
        out.push_str(&name.replace('\'', "''"));
        out.push('\'');
    }
}

/// Appends a branch length, if there is one.
pub(super) fn push_length(out: &mut String, length: Option<f64>) {
    if let Some(length) = length {
        let _ = write!(out, ":{length}");
    }
}
