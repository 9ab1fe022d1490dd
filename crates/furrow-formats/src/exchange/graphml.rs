//! GraphML: the tree as a directed graph, for programs about graphs.

use std::fmt::Write;

use super::column::{BranchLengths, Kind};
use super::sheet::{Sheet, SheetColumn};

/// A directed graph with an edge from each mother to each of her daughters. Nodes are called as the cells, and have all
/// columns as data; edges have a `length` where the branch to the daughter has one.
pub(super) fn graphml(sheet: &Sheet<'_>, lengths: BranchLengths) -> String {
    let keys = sheet.columns.iter().map(|SheetColumn { name, kind, .. }| {
        let kind = match kind {
            Kind::Text => "string",
            Kind::Count => "int",
            Kind::Number => "double",
        };
        format!("<key id=\"{name}\" for=\"node\" attr.name=\"{name}\" attr.type=\"{kind}\"/>\n")
    });
    let name = |cell: usize| escape(sheet.cells[cell].name);
    let nodes = (0..sheet.len()).map(|id| {
        let known = sheet.columns.iter().filter_map(|column| Some((column.name, escape(&(column.of)(id)?))));
        let data: String = known.map(|(key, value)| format!("<data key=\"{key}\">{value}</data>")).collect();
        format!("<node id=\"{}\">{data}</node>\n", name(id))
    });
    let edges = (0..sheet.len()).filter_map(|id| {
        let (mother, daughter) = (name(sheet.cells[id].mother?), name(id));
        let length = sheet.length(id, lengths).map(|length| format!("<data key=\"length\">{length}</data>"));
        Some(format!("<edge source=\"{mother}\" target=\"{daughter}\">{}</edge>\n", length.unwrap_or_default()))
    });
    format!(
        r#"<?xml version="1.0" encoding="UTF-8"?>
<graphml xmlns="http://graphml.graphdrawing.org/xmlns">
{}<key id="length" for="edge" attr.name="length" attr.type="double"/>
<graph id="{}" edgedefault="directed">
{}{}</graph>
</graphml>
"#,
        keys.collect::<String>(),
        escape(sheet.name),
        nodes.collect::<String>(),
        edges.collect::<String>()
    )
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
