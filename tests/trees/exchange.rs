//! `furrow export`, by the command: what it writes, what it refuses, and that other programs read the exports of the real tree as
//! the tree that was grown.

use std::path::Path;
use std::process::Command;

use crate::common::command::{self, CACHE, answer};

/// Runs a command that must refuse its input, and gives what it says, which is short.
fn refusal(folder: &Path, arguments: &[&str]) -> String {
    let said = command::refusal(folder, arguments);
    assert!(said.len() < 600, "{said}");
    said
}

/// A folder with the tree of the built-in founders in `t`.
fn grown() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    answer(folder.path(), &["tree", "--out", "t", "--cache", CACHE]);
    folder
}

fn names(folder: &Path) -> Vec<String> {
    let mut names: Vec<String> =
        std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
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
    let said = answer(folder, &["export", "t/tree.json", "--to", "itol", "--out", "itol", "--json"]);
    let said: serde_json::Value = serde_json::from_str(&said).unwrap();
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

#[test]
fn what_cannot_be_exported_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let write = |name: &str, bytes: &[u8]| std::fs::write(folder.join(name), bytes).unwrap();
    write("a.nwk", b"(a,b)c;\n");
    write("latin.json", b"{\n \"schema\": \"\xe9\"}");
    write("empty.json", b"\xef\xbb\xbf \r\n");
    write("cut.json", b"{\n  \"schema\": \"furrow.tree\",\n  \"sche");
    write("other.json", b"{\"schema\": \"furrow.run\", \"schema_version\": 1}");
    let to_newick = |file: &str| refusal(folder, &["export", file, "--to", "newick"]);
    for (file, expected) in [
        ("none.json", "none.json: cannot be read: No such file or directory (os error 2)"),
        (".", ".: cannot be read: it is a folder, not a file"),
        ("a.nwk", "a.nwk: is not a tree.json: it begins with \"(a,b)c;\", and a tree.json is JSON that begins with {"),
        ("empty.json", "empty.json: is not a tree.json: it is empty"),
        ("latin.json", "latin.json:2:13: byte 0xe9 is not UTF-8, as text must be"),
        ("cut.json", "cut.json:3:7: EOF while parsing a string"),
        ("other.json", "other.json: schema = \"furrow.run\", version 1: must be \"furrow.tree\", version 2"),
    ] {
        assert_eq!(to_newick(file), format!("furrow: error: {expected}\n"));
    }
    let long = std::fs::File::create(folder.join("long.json")).unwrap();
    long.set_len(600 << 20).unwrap();
    assert!(to_newick("long.json").contains("it has 600 MB, which is longer than 512 MB"));
    for (arguments, expected) in [
        (&["--to", "itol"][..], "--out: out = (not given): must be a folder for the files of itol"),
        (
            &["--to", "csv", "--branch-lengths", "time"],
            "--branch-lengths: branch_lengths = time: must be left out with --to csv: it has a column for each",
        ),
        (
            &["--to", "lineagetree", "--branch-lengths", "none"],
            "must be left out with --to lineagetree: its time points are generations",
        ),
        (
            &["--to", "nhx", "--json"],
            "--out: out = (not given): must be given with --json, since without it the export itself goes to stdout",
        ),
        (&["--to", "nhx", "--out", "."], "--out: out = \".\": must be a file that can be written"),
        (&["--to", "itol", "--out", "a.nwk"], "--out: out = \"a.nwk\": must be a folder that can be written to"),
        (&["--to", "phyloxml"], "[possible values: newick, nhx, nexus, itol, csv, lineagetree, graphml]"),
        (&[], "--to <FORMAT>"),
        (&["--schema"], "cannot be used with"),
    ] {
        let said = refusal(folder, &[&["export", "none.json"], arguments].concat());
        assert!(said.contains(expected), "{arguments:?}: {said}");
    }
    assert_eq!(names(folder).len(), 6, "nothing was written: {:?}", names(folder));
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
fn ete_reads_the_same_tree() {
    ask("ete4", &TREES);
}

#[test]
fn dendropy_reads_the_same_tree() {
    ask("dendropy", &TREES);
}

#[test]
fn biopython_reads_the_same_tree() {
    ask("Bio", &TREES);
}

#[test]
fn lineagetree_reads_the_same_tree() {
    ask("lineagetree", &[("cells.txt", &["lineagetree"]), ("cells.csv", &["csv"])]);
}

#[test]
fn networkx_reads_the_same_tree() {
    ask("networkx", &[("tree.graphml", &["graphml"])]);
}

#[test]
fn an_independent_validator_accepts_schema_and_trees() {
    ask("jsonschema", &[]);
}
