//! Newick, NHX and Nexus: brackets, names and lengths, read by an independent parser.

use crate::common::stand_in::{fake, grown};
use furrow_formats::exchange::{BranchLengths, Exported, Format, Sheet, TimedTree, export};
use furrow_formats::newick;
use furrow_lineage::{Lineage, Tree};

/// One node of a Newick text.
#[derive(Default)]
struct Node {
    name: String,
    /// Open brackets around it.
    depth: u32,
    /// The rest after its name: comment and length.
    rest: String,
}

/// The nodes of a text in its order; brackets must be balanced, and a semicolon must end it.
fn nodes(text: &str) -> Vec<Node> {
    let mut characters = text.strip_suffix(";").unwrap().chars().peekable();
    let (mut nodes, mut depth, mut comment) = (Vec::new(), 0_u32, false);
    let mut node = Node::default();
    while let Some(c) = characters.next() {
        match c {
            '(' if !comment => depth += 1,
            ',' | ')' if !comment => {
                nodes.push(std::mem::take(&mut node));
                depth -= u32::from(c == ')');
            }
            '\'' if !comment => loop {
                match characters.next().unwrap() {
                    '\'' if characters.next_if_eq(&'\'').is_none() => break,
                    c => node.name.push(c),
                }
            },
            '[' | ']' => {
                comment = c == '[';
                node.rest.push(c);
            }
            c if comment || c == ':' || !node.rest.is_empty() => node.rest.push(c),
            c => node.name.push(c),
        }
        node.depth = depth;
    }
    assert!(depth == 0 && !comment, "{text}");
    nodes.push(node);
    nodes
}

/// The founders of C. elegans, grown by the simulated solver.
fn tree() -> Tree {
    grown(&Lineage::c_elegans().unwrap(), &|_| None, fake)
}

#[test]
fn every_cell_stands_at_its_depth_with_its_length_and_columns() {
    let tree = tree();
    assert!(tree.len() > 200);
    assert_eq!(Exported::File(newick(&tree)), export(&tree, Format::Newick, BranchLengths::Time, &[]));
    let timed = TimedTree::new(&tree);
    let sheet = Sheet::of_tree(&timed);
    for (_, lengths) in BranchLengths::NAMED {
        for format in [Format::Newick, Format::Nhx, Format::Nexus] {
            let Exported::File(text) = export(&tree, format, lengths, &[]) else { panic!("{format:?} is one file") };
            let text = match format {
                Format::Nexus => {
                    let line = text.lines().find(|line| line.trim_start().starts_with("TREE ")).unwrap();
                    line.split_once(" = [&R] ").unwrap().1
                }
                _ => text.trim_end(),
            };
            let nodes = nodes(text);
            assert_eq!(nodes.len(), tree.len());
            for id in tree.cells() {
                let cell = tree.cell(id);
                let node = nodes.iter().find(|node| node.name == cell.name).unwrap();
                assert_eq!(node.depth, cell.generation, "{}", cell.name);
                let length = sheet.length(id.index(), lengths).map_or(String::new(), |length| format!(":{length}"));
                let known = timed.columns().iter().filter(|column| column.note);
                let notes: Vec<String> =
                    known.filter_map(|column| Some(format!("{}={}", column.name, (column.of)(&timed, id)?))).collect();
                let expected = match format {
                    Format::Nhx => format!("{length}[&&NHX:{}]", notes.join(":")),
                    Format::Nexus => format!("[&{}]{length}", notes.join(",")),
                    _ => length,
                };
                assert_eq!(node.rest, expected, "{}", cell.name);
            }
        }
    }
}
