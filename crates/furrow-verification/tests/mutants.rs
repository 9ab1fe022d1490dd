//! The table of mutants stays true: each still fits the sources, the test that must see it is there, and the page that says what
//! came of it has it. What is not tried here is whether the test does see it: `cargo run -p furrow-verification --bin mutations`.

use std::collections::BTreeSet;
use std::fs;

use furrow_verification::mutants::{root, table};

#[test]
fn every_mutant_fits_the_sources_and_names_a_test() {
    let (root, mut names) = (root(), BTreeSet::new());
    let mutants = table(&root).unwrap();
    assert!(mutants.len() >= 12);
    for mutant in &mutants {
        assert!(names.insert(&mutant.name), "two mutants are called {}", mutant.name);
        assert!(!mutant.edits.is_empty(), "{} changes nothing", mutant.name);
        for edit in &mutant.edits {
            edit.applied(&root).unwrap_or_else(|e| panic!("{}: {e}", mutant.name));
        }
        let (file, test) = &mutant.killed_by;
        let tests = fs::read_to_string(root.join(format!("crates/verification/tests/{file}.rs"))).unwrap();
        assert!(tests.contains(&format!("#[test]\nfn {test}(")), "{}: there is no test {test} in {file}", mutant.name);
    }
}

#[test]
fn the_page_of_mutants_has_all_of_them_killed() {
    let root = root();
    let page = fs::read_to_string(root.join("docs/mutations.md")).unwrap();
    let mutants = table(&root).unwrap();
    for mutant in &mutants {
        let (file, test) = &mutant.killed_by;
        let row = format!("| {} | {} | `{file}`: `{test}` |", mutant.name, mutant.means);
        assert!(page.contains(&row), "docs/mutations.md has no row `{row}`: run the mutants with --write");
    }
    // The table of the model ends there; others follow.
    let table = page.split("<!-- end -->").next().unwrap_or_default();
    let rows = table.lines().filter(|line| line.contains("`: `")).count();
    assert_eq!(rows, mutants.len(), "docs/mutations.md has rows of mutants that are no more");
}
