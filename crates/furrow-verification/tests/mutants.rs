//! Every mutant applies to the sources, its test exists, and docs/mutations.md lists it. Whether the test fails is checked by
//! `cargo run -p furrow-verification --bin mutations`.

use std::collections::BTreeSet;
use std::fs;

use furrow_verification::mutants::{root, table};

#[test]
fn every_mutant_fits_the_sources_and_names_a_test() {
    let (root, mut names) = (root(), BTreeSet::new());
    let mutants = table(&root).unwrap();
    assert!(mutants.len() >= 12);
    for mutant in &mutants {
        assert!(names.insert(&mutant.name), "duplicate mutant {}", mutant.name);
        assert!(!mutant.edits.is_empty(), "{} changes nothing", mutant.name);
        for edit in &mutant.edits {
            edit.applied(&root).unwrap_or_else(|e| panic!("{}: {e}", mutant.name));
        }
        let (file, test) = &mutant.killed_by;
        let tests = fs::read_to_string(root.join(format!("crates/furrow-verification/tests/{file}.rs"))).unwrap();
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
        assert!(page.contains(&row), "docs/mutations.md lacks the row `{row}`: run `mutations -- --write`");
    }
    // Other tables follow the one of the model.
    let table = page.split("<!-- end -->").next().unwrap_or_default();
    let rows = table.lines().filter(|line| line.contains("`: `")).count();
    assert_eq!(rows, mutants.len(), "docs/mutations.md has rows of removed mutants");
}
