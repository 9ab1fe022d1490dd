//! The WebAssembly module of the page has the solver version of the sources.

use furrow_lineage::batch::SOLVER_VERSION;

/// The module in the page.
const MODULE: &str = include_str!("../../crates/furrow-report/src/page/furrow.wasm.txt");

#[test]
fn the_module_in_the_page_has_this_version_of_the_solver() {
    let lines: Vec<&str> = MODULE.lines().collect();
    let wanted = format!("solver {SOLVER_VERSION}");
    assert_eq!(
        lines[0], wanted,
        "crates/furrow-report/src/page/furrow.wasm.txt was built from another version of the solver: run crates/furrow-page/build.sh"
    );
    // Gzip, in base64.
    assert!(lines.len() == 2 && lines[1].starts_with("H4sI"));
}
