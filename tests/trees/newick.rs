//! Newick, out and in: what is written is read back as the same tree, and nothing that is read ends the program.

use crate::common::stand_in::{fake, grown};
use furrow::io::exchange::{BranchLengths, COLUMNS, Exported, Format, export};
use furrow::io::{Newick, NewickNode, newick};
use furrow::lineage::{Lineage, Tree};
use proptest::prelude::*;

/// The founders of C. elegans, grown by the stand-in for the solver.
fn tree() -> Tree {
    grown(&Lineage::c_elegans().unwrap(), &|_| None, fake)
}

fn complaint(text: &str) -> String {
    let said = Newick::parse(text, "x.nwk").unwrap_err().to_string();
    assert!(said.len() < 300 && said.starts_with("x.nwk:"), "{said}");
    said["x.nwk:".len()..].to_owned()
}

/// Trees with any shape, names of any printable characters, any lengths, and comments.
fn trees() -> impl Strategy<Value = Newick> {
    let length = prop::option::of(prop::num::f64::POSITIVE | prop::num::f64::ZERO | prop::num::f64::SUBNORMAL);
    let comments = prop::sample::select(vec!["", "[&a=1]", "[&&NHX:chi=0.5][&b={1,2},c=\"d,e\"]", "[&R[x]]"]);
    let node = ("[ -~äµ_']{0,6}", length, comments, any::<prop::sample::Index>());
    prop::collection::vec(node, 1..60).prop_map(|parts| {
        let mut nodes: Vec<NewickNode> = Vec::new();
        // Where the next node may be put so that nodes stand in the order of the text: below the last one, or those above it.
        let mut path: Vec<usize> = Vec::new();
        for (k, (name, length, comments, place)) in parts.into_iter().enumerate() {
            if k > 0 {
                path.truncate(1 + place.index(path.len()));
            }
            // Told apart by what stands behind the last point.
            let name = if name.is_empty() { name } else { format!("{name}.{k}") };
            nodes.push(NewickNode { name, mother: path.last().copied(), length, comments: comments.to_owned() });
            path.push(k);
        }
        Newick::new(nodes).unwrap()
    })
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(400) })]

    #[test]
    fn what_is_written_is_read_back(tree in trees()) {
        let text = tree.to_text();
        prop_assert_eq!(Newick::parse(&text, "x.nwk").unwrap(), tree, "{}", text);
    }

    /// Texts of the characters that mean something: each is read or refused, and what is read is written and read again.
    #[test]
    fn any_text_is_read_or_refused(text in r"[()\[\],:;'ab1.&= \n\-eN_]{0,60}") {
        if let Ok(tree) = Newick::parse(&text, "x.nwk") {
            prop_assert_eq!(Newick::parse(&tree.to_text(), "x.nwk").unwrap(), tree.clone());
            tree.nodes().iter().for_each(|node| drop(node.notes()));
        }
    }

    #[test]
    fn any_unicode_is_read_or_refused(text in any::<String>()) {
        let _ = Newick::parse(&text, "x.nwk").map(|tree| tree.to_text());
    }

    /// A tree with a character changed, left out or put in.
    #[test]
    fn slips_are_read_or_refused(tree in trees(), at in any::<prop::sample::Index>(), c in any::<char>(), keep in any::<bool>()) {
        let mut characters: Vec<char> = tree.to_text().chars().collect();
        let at = at.index(characters.len());
        if keep { characters.insert(at, c) } else { characters[at] = c }
        let _ = Newick::parse(&characters.into_iter().collect::<String>(), "x.nwk").map(|tree| tree.to_text());
    }
}

/// A tree, the names and lengths of its Newick, and what NHX and Nexus say beside them.
#[test]
fn a_grown_tree_comes_back_from_every_kind_of_newick() {
    let tree = tree();
    assert!(tree.len() > 200);
    assert_eq!(Exported::File(newick(&tree)), export(&tree, Format::Newick, BranchLengths::Time, &[]));
    for lengths in [BranchLengths::Time, BranchLengths::Generation, BranchLengths::None] {
        for format in [Format::Newick, Format::Nhx, Format::Nexus] {
            let Exported::File(text) = export(&tree, format, lengths, &[]) else { panic!("{format:?} is one file") };
            let text = match format {
                Format::Nexus => {
                    let line = text.lines().find(|line| line.trim_start().starts_with("TREE ")).unwrap();
                    line.split_once(" = ").unwrap().1.to_owned()
                }
                _ => text,
            };
            let read = Newick::parse(&text, "x.nwk").unwrap();
            assert_eq!(read.nodes().len(), tree.len());
            let name_of = |node: &NewickNode| node.mother.map(|mother| read.nodes()[mother].name.clone());
            for id in tree.cells() {
                let cell = tree.cell(id);
                let node = read.nodes().iter().find(|node| node.name == cell.name).unwrap();
                assert_eq!(name_of(node), tree.mother(id).map(|mother| tree.cell(mother).name.clone()));
                assert_eq!(node.length, lengths.of(&tree, id), "{}", cell.name);
                let notes: Vec<(&str, String)> = COLUMNS
                    .iter()
                    .filter(|column| column.note && format != Format::Newick)
                    .filter_map(|column| Some((column.name, (column.of)(&tree, id)?.to_string())))
                    .collect();
                let read: Vec<(&str, String)> = node.notes().into_iter().map(|(k, v)| (k, v.to_owned())).collect();
                assert_eq!(read, notes, "{}", cell.name);
            }
        }
    }
}

/// The distance from the first cell is the generation.
#[test]
fn lengths_by_generation_add_up_to_generations() {
    let tree = tree();
    let Exported::File(text) = export(&tree, Format::Newick, BranchLengths::Generation, &[]) else { panic!() };
    let read = Newick::parse(&text, "x.nwk").unwrap();
    let mut distance = vec![0.0; read.nodes().len()];
    for (k, node) in read.nodes().iter().enumerate() {
        distance[k] = node.mother.map_or(0.0, |mother| distance[mother]) + node.length.unwrap_or(0.0);
        let cell = tree.cells().find(|id| tree.cell(*id).name == node.name).unwrap();
        assert_eq!(distance[k], f64::from(tree.cell(cell).generation), "{}", node.name);
    }
}

#[test]
fn what_is_wrong_is_told_with_its_place() {
    for (text, expected) in [
        ("", "1:1: there is no tree: expected one, as in (a,b)c;"),
        (" [nothing] \n", "2:1: there is no tree: expected one, as in (a,b)c;"),
        (";", "1:1: there is no tree before the semicolon: expected one, as in (a,b)c;"),
        ("(a,b", "1:5: the text ends where a comma or the bracket ) that closes the one at 1:1 is expected"),
        ("(a,", "1:4: the text ends where a name or a bracket ( is expected"),
        ("(a,\n(b,c;", "2:5: ';' stands where a comma or the bracket ) that closes the one at 2:1 is expected"),
        ("(a,b))c;", "1:6: ')' stands where the semicolon ; at the end of the tree is expected"),
        ("a,b;", "1:2: ',' stands where the semicolon ; at the end of the tree is expected"),
        ("(a,b)c", "1:7: the text ends where the semicolon ; at the end of the tree is expected"),
        ("(a,b)c;(d,e)f;", "1:8: '(' stands where the end of the text, since one tree is read, is expected"),
        (
            "(a b,c)d;",
            "1:4: 'b' stands where a comma or the bracket ) that closes the one at 1:1 (a name with blanks or punctuation is in single quotes) is expected",
        ),
        ("(a,b(c,d))e;", "1:5: '(' stands where a comma or the bracket ) that closes the one at 1:1 is expected"),
        ("(a:1:2,b)c;", "1:5: ':' stands where a comma or the bracket ) that closes the one at 1:1 is expected"),
        ("(a,'b)c;", "1:4: the single quote that opens here is not closed"),
        ("(a,b[&x=1)c;", "1:5: the bracket [ that opens here is not closed"),
        ("(a,b])c;", "1:5: ']' stands where a name, or a bracket [ before it, is expected"),
        (
            "(a:NaN,b)c;",
            "1:4: branch length of \"a\" = \"NaN\": must be a finite number of at least 0, as 0.87 or 1e-3",
        ),
        (
            "(a:1e999,b)c;",
            "1:4: branch length of \"a\" = \"1e999\": must be a finite number of at least 0, as 0.87 or 1e-3",
        ),
        (
            "(a,b:-0.5)c;",
            "1:6: branch length of \"b\" = \"-0.5\": must be a finite number of at least 0, as 0.87 or 1e-3",
        ),
        ("(a:,b)c;", "1:4: branch length of \"a\" = \"\": must be a finite number of at least 0, as 0.87 or 1e-3"),
        ("(:x,b)c;", "1:3: branch length = \"x\": must be a finite number of at least 0, as 0.87 or 1e-3"),
        ("(a,\n\r\n(b,a)c)d;", "3:4: name \"a\": must be no other cell's; it stands at 1:2 too"),
        ("('a\u{7}',b)c;", "1:2: name \"a\\u{7}\": must be free of control characters, here '\\u{7}'"),
        ("\u{feff}(ä,ä)c;", "1:4: name \"ä\": must be no other cell's; it stands at 1:2 too"),
    ] {
        assert_eq!(complaint(text), expected, "{text:?}");
    }
    let long = format!("({},b c)d;", "x".repeat(1 << 20));
    assert!(complaint(&long).contains("'c' stands where"));
    assert!(complaint(&format!("(a:{},b)c;", "9".repeat(1 << 20))).contains("\"99999"));
}

#[test]
fn what_other_programs_write_is_read() {
    for (text, names) in [
        ("\u{feff}(a,b)c;\r\n", vec!["c", "a", "b"]),
        ("[&R] (a_1:1e-3, 'it''s':2 [a comment] , [&x=1] b :.5)c:1.;", vec!["c", "a 1", "it's", "b"]),
        ("(,(,,),);", vec!["", "", "", "", "", "", ""]),
        ("a;", vec!["a"]),
        ("('(a,b)',c)'';", vec!["", "(a,b)", "c"]),
    ] {
        let tree = Newick::parse(text, "x.nwk").unwrap();
        assert_eq!(tree.nodes().iter().map(|node| node.name.as_str()).collect::<Vec<_>>(), names, "{text}");
    }
    let tree = Newick::parse("(a:1,b[&&NHX:S=x:y])c[&p=1,q={2,3}]:4[&r=\"s,t\"];", "x.nwk").unwrap();
    assert_eq!(tree.nodes()[0].notes(), [("p", "1"), ("q", "{2,3}"), ("r", "s,t")]);
    assert_eq!(tree.nodes()[2].notes(), [("S", "x"), ("y", "")]);
    assert_eq!(tree.nodes()[0].length, Some(4.0));
}

/// A million brackets are a million nodes and no deeper a call; brackets that stay open, and more nodes than are read, are refused.
#[test]
fn deep_and_large_texts_are_read_or_refused() {
    const DEPTH: usize = 1_000_000;
    let deep = format!("{}a{};", "(".repeat(DEPTH), ")".repeat(DEPTH));
    let tree = Newick::parse(&deep, "deep").unwrap();
    assert_eq!((tree.nodes().len(), tree.leaves().count()), (DEPTH + 1, 1));
    assert_eq!(tree.to_text().trim_end(), deep);
    let open = Newick::parse(&"(".repeat(DEPTH), "open").unwrap_err().to_string();
    assert_eq!(open, "open:1:1000001: the text ends where a name or a bracket ( is expected");
    let wide = Newick::parse(&format!("({}a)b;", ",".repeat(5_000_000)), "wide").unwrap_err().to_string();
    assert!(wide.contains("there are more than 4000000 nodes, the most that are read"), "{wide}");
    let nested = Newick::parse(&format!("(a{}b)c;", "[".repeat(DEPTH)), "comments").unwrap_err().to_string();
    assert_eq!(nested, "comments:1:3: the bracket [ that opens here is not closed");
    let comments = Newick::parse(&format!("a{};", "[&x=1]".repeat(DEPTH)), "comments").unwrap();
    assert_eq!(comments.nodes()[0].notes().len(), DEPTH);
}

/// Files are read up to their limit, and what is no text is refused with its place.
#[test]
fn files_that_are_no_newick() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("t.nwk");
    let said = |bytes: &[u8]| {
        std::fs::write(&path, bytes).unwrap();
        Newick::read(&path).unwrap_err().to_string().replace(&path.display().to_string(), "t.nwk")
    };
    assert_eq!(said(b"(a,b\xff)c;"), "t.nwk:1:5: byte 0xff is not UTF-8, as text must be");
    assert_eq!(said(b"\xff\xfe(\0"), "t.nwk:1:1: this is UTF-16; it must be saved as UTF-8");
    for (bytes, begins, what) in [
        (&b"{\"schema\": 1}"[..], "\"{\\\"schema\\\": 1}\"", "JSON"),
        (b"\xef\xbb\xbf\n#NEXUS\nBEGIN TREES;", "\"#NEXUS\"", "Nexus, in which the tree is what stands behind ="),
        (b"<?xml version=\"1.0\"?>", "\"<?xml version=\\\"1.0\\\"?>\"", "XML"),
    ] {
        assert_eq!(said(bytes), format!("t.nwk: is not a Newick file: it begins with {begins}, as {what} does"));
    }
    std::fs::File::create(&path).unwrap().set_len(100 << 20).unwrap();
    let long = Newick::read(&path).unwrap_err().to_string();
    assert!(long.contains("it has 100 MB, which is longer than 64 MB"), "{long}");
}
