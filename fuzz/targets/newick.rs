//! Newick, NHX, and the tree of a Nexus file.

use furrow::io::Newick;

use super::{FILE, says_where, text};

/// A tree that is read is what it is when it is written and read again.
pub fn check(data: &[u8]) {
    let Some(text) = text(data) else { return };
    let tree = match Newick::parse(text, FILE) {
        Ok(tree) => tree,
        Err(error) => return says_where(&error),
    };
    let nodes = tree.nodes();
    assert!(!nodes.is_empty());
    assert_eq!(
        tree.daughters().iter().map(Vec::len).sum::<usize>(),
        nodes.len() - 1,
        "each node but the root has a mother"
    );
    assert!(tree.leaves().count() >= 1);
    for node in nodes {
        assert!(node.length.is_none_or(|length| length.is_finite() && length >= 0.0));
        let _ = node.notes();
    }
    // Control characters have no way to be written.
    if nodes.iter().any(|node| node.name.chars().any(char::is_control)) {
        return;
    }
    let written = tree.to_text();
    let again = Newick::parse(&written, FILE).unwrap_or_else(|error| panic!("{error}: {written:?}"));
    assert_eq!(again, tree, "{written:?}");
}
