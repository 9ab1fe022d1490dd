//! `furrow export`: its files, and that other programs read the real tree from them unchanged.

use std::process::Command;

use crate::common::command::{CACHE, answer, json, names};

/// A folder with the tree of the built-in founders in `t`.
fn grown() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    answer(folder.path(), &["tree", "--out", "t", "--cache", CACHE]);
    folder
}

#[test]
fn exports_go_to_stdout_or_to_files() {
    let grown = grown();
    let folder = grown.path();
    let read = |name: &str| std::fs::read_to_string(folder.join(name)).unwrap();
    assert_eq!(answer(folder, &["export", "t/tree.json", "--to", "newick"]), read("t/tree.nwk"));
    let said = answer(folder, &["export", "t/tree.json", "--to", "nexus", "--out", "new/tree.nex"]);
    assert_eq!(said, "285 cells, 143 of them ends of branches, as nexus in new/tree.nex\n");
    assert_eq!(answer(folder, &["export", "t/tree.json", "--to", "nexus"]), read("new/tree.nex"));
    let said = json(folder, &["export", "t/tree.json", "--to", "itol", "--out", "itol"]);
    assert_eq!(
        (said["cells"].as_u64(), said["ends"].as_u64(), said["files"].as_array().unwrap().len()),
        (Some(285), Some(143), 5)
    );
    assert_eq!(names(&folder.join("itol")), ["birth_chi.txt", "chi.txt", "founders.txt", "labels.txt", "tree.nwk"]);
    let rows = |text: &str| text.lines().count();
    // A heading and a row a cell; a row a cell; a line a cell and one for each but the first, between those of keys and graph.
    assert_eq!(rows(&answer(folder, &["export", "t/tree.json", "--to", "csv"])), 286);
    assert_eq!(rows(&answer(folder, &["export", "t/tree.json", "--to", "lineagetree"])), 285);
    let graph = answer(folder, &["export", "t/tree.json", "--to", "graphml"]);
    assert_eq!((graph.matches("<node ").count(), graph.matches("<edge ").count()), (285, 284));
    // All discs and every end's label; every cell but the first was born from a division.
    assert_eq!(rows(read("itol/chi.txt").split_once("DATA\n").unwrap().1), 142);
    assert_eq!(rows(read("itol/birth_chi.txt").split_once("DATA\n").unwrap().1), 284);
    assert_eq!(rows(read("itol/labels.txt").split_once("DATA\n").unwrap().1), 285);
    assert!(read("itol/founders.txt").contains("\nAB\t#2f6db5\tAB\n"));
    let schema: serde_json::Value = serde_json::from_str(&answer(folder, &["export", "--schema"])).unwrap();
    assert_eq!(schema["title"], "furrow.tree");
}

/// Python, if there is one: that of the variable `FURROW_PYTHON`, else `python3`.
fn python() -> String {
    std::env::var("FURROW_PYTHON").unwrap_or_else(|_| "python3".to_owned())
}

/// Runs one part of `tests/trees/exchange.py` on the exports of the real tree. Where the package that it asks is not installed that is
/// said, and nothing is checked; with `FURROW_PYTHON` set a missing package is a failure.
fn ask(part: &str, exports: &[(&str, &[&str])]) {
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/trees/exchange.py");
    let asked = Command::new(python()).args([script, part, "--installed"]).output();
    let missing = match &asked {
        Ok(output) if output.status.success() => None,
        Ok(output) => Some(String::from_utf8_lossy(&output.stderr).lines().last().unwrap_or("").to_owned()),
        Err(error) => Some(format!("{}: {error}", python())),
    };
    if let Some(reason) = missing {
        assert!(std::env::var_os("FURROW_PYTHON").is_none(), "{part}: {reason}");
        println!("{part} is not asked: {reason}");
        return;
    }
    let grown = grown();
    let folder = grown.path();
    for (file, arguments) in exports {
        answer(folder, &[&["export", "t/tree.json", "--out", file, "--to"], *arguments].concat());
    }
    let mut command = Command::new(python());
    command.args([script, part]).current_dir(folder);
    command.env("FURROW_BINARY", env!("CARGO_BIN_EXE_furrow")).env("FURROW_ROOT", env!("CARGO_MANIFEST_DIR"));
    let output = command.output().unwrap();
    let (said, wrong) = (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    assert!(output.status.success(), "{part}: {said}{wrong}");
    println!("{said}");
}

const TREES: [(&str, &[&str]); 6] = [
    ("time.nwk", &["newick"]),
    ("generation.nwk", &["newick", "--branch-lengths", "generation"]),
    ("none.nwk", &["newick", "--branch-lengths", "none"]),
    ("time.nhx", &["nhx"]),
    ("time.nex", &["nexus"]),
    ("generation.nex", &["nexus", "--branch-lengths", "generation"]),
];

#[test]
fn other_programs_read_the_same_tree() {
    ["ete4", "dendropy", "Bio"].into_iter().for_each(|package| ask(package, &TREES));
    ask("lineagetree", &[("cells.txt", &["lineagetree"]), ("cells.csv", &["csv"])]);
    ask("networkx", &[("tree.graphml", &["graphml"])]);
    // An independent validator of the schema.
    ask("jsonschema", &[]);
}
