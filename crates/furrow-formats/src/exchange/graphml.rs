//! GraphML: the tree as a directed graph, for programs about graphs.

use std::fmt::Write;

use super::column::{BranchLengths, COLUMNS, Kind};
use furrow_lineage::Tree;

/// A directed graph with an edge from each mother to each of her daughters. Nodes are called as the cells, and have all
/// columns as data; edges have a `length` where the branch to the daughter has one.
pub(super) fn graphml(tree: &Tree, lengths: BranchLengths) -> String {
    let mut out = String::with_capacity(600 * tree.len());
    out.push_str(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<graphml xmlns=\"http://graphml.graphdrawing.org/xmlns\">\n",
    );
    for column in &COLUMNS {
        let kind = match column.kind {
            Kind::Text => "string",
            Kind::Count => "int",
            Kind::Number => "double",
        };
        let name = column.name;
        let _ = writeln!(out, "<key id=\"{name}\" for=\"node\" attr.name=\"{name}\" attr.type=\"{kind}\"/>");
    }
    out.push_str("<key id=\"length\" for=\"edge\" attr.name=\"length\" attr.type=\"double\"/>\n");
    let _ = writeln!(out, "<graph id=\"{}\" edgedefault=\"directed\">", escape(&tree.lineage.name));
    for id in tree.cells() {
        let _ = write!(out, "<node id=\"{}\">", escape(&tree.cell(id).name));
        for column in &COLUMNS {
            if let Some(value) = (column.of)(tree, id) {
                let _ = write!(out, "<data key=\"{}\">{}</data>", column.name, escape(&value));
            }
        }
        out.push_str("</node>\n");
    }
    for id in tree.cells() {
        let Some(mother) = tree.mother(id) else { continue };
        let [mother, daughter] = [mother, id].map(|id| escape(&tree.cell(id).name));
        let _ = write!(out, "<edge source=\"{mother}\" target=\"{daughter}\">");
        if let Some(length) = lengths.of(tree, id) {
            let _ = write!(out, "<data key=\"length\">{length}</data>");
        }
        out.push_str("</edge>\n");
    }
    out.push_str("</graph>\n</graphml>\n");
    out
}

/// Text with the characters that XML reserves replaced, and those that it has no place for left out: why a cell is undecided
/// may have been written by any program.
fn escape(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\t' | '\n' | '\r' => {
                let _ = write!(out, "&#{};", c as u32);
            }
            c if furrow_input::forbidden(c.encode_utf8(&mut [0; 4])).is_some() => {}
            c => out.push(c),
        }
    }
    out
}
