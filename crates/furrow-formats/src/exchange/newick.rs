//! Newick, plain and with comments on its cells: NHX, and Nexus as FigTree reads it.

use super::column::{BranchLengths, TimedTree};
use super::sheet::Sheet;
use furrow_lineage::Tree;

/// The tree in plain Newick: names on inner nodes, a cell's branch length is its division time `t_end` in τ (for a cell
/// that came to rest, the time at which it was found at rest; absent where no division was computed, as for most of the
/// cells that cannot divide). A cell just above the threshold of division takes thousands of τ. The anterior daughter comes
/// first.
pub fn newick(tree: &Tree) -> String {
    plain(&Sheet::of_tree(&TimedTree::new(tree)), BranchLengths::Time)
}

/// The tree in plain Newick with any branch lengths; a line for each first cell.
pub(super) fn plain(sheet: &Sheet<'_>, lengths: BranchLengths) -> String {
    sheet.roots().map(|root| nested(sheet, root, |cell| length(sheet, cell, lengths)) + "\n").collect()
}

/// Newick with `[&&NHX:key=value:…]` behind the branch length of each cell.
pub(super) fn nhx(sheet: &Sheet<'_>, lengths: BranchLengths) -> String {
    let after = |cell: usize| length(sheet, cell, lengths) + &comment(sheet, cell, "&&NHX:", ":");
    sheet.roots().map(|root| nested(sheet, root, after) + "\n").collect()
}

/// A Nexus file with the leaves as taxa and a rooted tree for each first cell. `[&key=value,…]` is between the name of a cell and its
/// branch length, where FigTree and BEAST put annotations of a node.
pub(super) fn nexus(sheet: &Sheet<'_>, lengths: BranchLengths) -> String {
    let labels: Vec<String> = sheet.leaves().map(|leaf| format!("\n    {}", quoted(sheet.cells[leaf].name))).collect();
    let (count, labels, name) = (labels.len(), labels.concat(), quoted(sheet.name));
    let after = |cell: usize| comment(sheet, cell, "&", ",") + &length(sheet, cell, lengths);
    let trees: String =
        sheet.roots().map(|root| format!("  TREE {name} = [&R] {}\n", nested(sheet, root, after))).collect();
    format!(
        "#NEXUS\nBEGIN TAXA;\n  DIMENSIONS NTAX={count};\n  TAXLABELS{labels}\n  ;\nEND;\nBEGIN TREES;\n{trees}END;\n"
    )
}

/// The tree below a cell up to its semicolon, with what `after_name` gives behind the name of each cell.
fn nested(sheet: &Sheet<'_>, root: usize, after_name: impl Fn(usize) -> String) -> String {
    /// A part of the text that is still to be written.
    enum Part {
        Cell(usize),
        Name(usize),
        Text(char),
    }
    let mut out = String::with_capacity(40 * sheet.len());
    let mut left = vec![Part::Text(';'), Part::Cell(root)];
    while let Some(part) = left.pop() {
        match part {
            Part::Text(text) => out.push(text),
            Part::Name(cell) => {
                out.push_str(&quoted(sheet.cells[cell].name));
                out.push_str(&after_name(cell));
            }
            Part::Cell(cell) => {
                left.push(Part::Name(cell));
                if sheet.is_leaf(cell) {
                    continue;
                }
                out.push('(');
                left.push(Part::Text(')'));
                for (k, daughter) in
                    sheet.cells[cell].daughters.into_iter().flatten().enumerate().collect::<Vec<_>>().into_iter().rev()
                {
                    left.push(Part::Cell(daughter));
                    if k > 0 {
                        left.push(Part::Text(','));
                    }
                }
            }
        }
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

fn length(sheet: &Sheet<'_>, cell: usize, lengths: BranchLengths) -> String {
    sheet.length(cell, lengths).map_or(String::new(), |length| format!(":{length}"))
}

/// The columns of a cell as a comment, without the characters that comments reserve: neither form can escape them.
fn comment(sheet: &Sheet<'_>, cell: usize, opening: &str, between: &str) -> String {
    let plain = |c: char| if c.is_whitespace() || "[]{}()=:;,'\"".contains(c) { '_' } else { c };
    let noted = sheet.columns.iter().filter(|column| column.note).filter_map(|column| {
        let value: String = (column.of)(cell)?.chars().map(plain).collect();
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
