//! Other programs read the exports. `exchange.py` compares their results with tree.json.
//!
//! Each test needs a Python package, so it is ignored; `.ci/run` runs it if the package is there. `FURROW_PYTHON` names the Python.

use std::process::Command;

use crate::common::command::{CACHE, answer};

/// Format, branch lengths and file of every export that a reader is given.
const EXPORTS: [[&str; 3]; 11] = [
    ["newick", "time", "time.nwk"],
    ["newick", "generation", "generation.nwk"],
    ["newick", "none", "none.nwk"],
    ["nexus", "time", "time.nex"],
    ["nexus", "generation", "generation.nex"],
    ["nhx", "time", "time.nhx"],
    ["graphml", "time", "tree.graphml"],
    ["geff", "", "tree.geff"],
    ["geff", "generation", "generation.geff"],
    ["lineagetree", "generation", "cells.txt"],
    ["csv", "", "cells.csv"],
];

/// Runs `exchange.py` for a package in a folder with a tree and its exports.
fn read_by(package: &str) {
    let folder = tempfile::tempdir().unwrap();
    answer(&folder, &["tree", "--out", "t", "--cache", CACHE]);
    for [format, lengths, file] in EXPORTS {
        let lengths = if lengths.is_empty() { vec![] } else { vec!["--branch-lengths", lengths] };
        answer(&folder, &[&["export", "t/tree.json", "--to", format, "--out", file], &lengths[..]].concat());
    }
    let python = std::env::var("FURROW_PYTHON").unwrap_or_else(|_| "python3".to_owned());
    let root = env!("CARGO_MANIFEST_DIR");
    let mut reader = Command::new(&python);
    reader.arg(format!("{root}/tests/command/exchange.py")).arg(package).current_dir(&folder);
    reader.env("FURROW_ROOT", root).env("FURROW_BINARY", env!("CARGO_BIN_EXE_furrow"));
    let output = reader.output().unwrap_or_else(|error| panic!("{python}: {error}"));
    println!("{}", String::from_utf8_lossy(&output.stdout));
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}

#[test]
#[ignore = "needs Python with ete4"]
fn ete4_reads_the_exports() {
    read_by("ete4");
}

#[test]
#[ignore = "needs Python with dendropy"]
fn dendropy_reads_the_exports() {
    read_by("dendropy");
}

#[test]
#[ignore = "needs Python with Biopython"]
fn biopython_reads_the_exports() {
    read_by("Bio");
}

#[test]
#[ignore = "needs Python with LineageTree"]
fn lineagetree_reads_the_exports() {
    read_by("lineagetree");
}

#[test]
#[ignore = "needs Python with networkx"]
fn networkx_reads_the_exports() {
    read_by("networkx");
}

#[test]
#[ignore = "needs Python with geff"]
fn geff_reads_the_exports() {
    read_by("geff");
}

#[test]
#[ignore = "needs Python with jsonschema"]
fn jsonschema_accepts_trees_and_refuses_wrong_ones() {
    read_by("jsonschema");
}
