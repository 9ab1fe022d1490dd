//! The module that runs inside the page belongs to the sources as they are.

use std::path::Path;

#[path = "../../crates/page/build.rs"]
#[allow(dead_code)]
mod build_script;

use build_script::{PAGE_SOURCES, page_fingerprint};

/// What the page carries. A change to the code that it is built from must bring a new one: `crates/page/build.sh`.
const MODULE: &str = include_str!("../../crates/page/furrow.wasm.txt");

#[test]
fn the_module_in_the_page_belongs_to_the_sources() {
    let found = page_fingerprint(Path::new(env!("CARGO_MANIFEST_DIR"))).unwrap();
    let kept = MODULE.lines().next().unwrap();
    assert_eq!(kept, found, "crates/page/furrow.wasm.txt was built from other sources: run crates/page/build.sh");
}

/// A source that the list leaves out could change and leave the module stale: whatever is listed imports only what is listed.
#[test]
fn sources_of_the_module_import_nothing_that_is_not_listed() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let inside = |source: &'static str| source.split_once("/src/").map(|(_, inside)| inside.trim_end_matches(".rs"));
    let listed: Vec<&str> = PAGE_SOURCES.into_iter().filter_map(inside).collect();
    let files = build_script::page_files(root).unwrap();
    assert!(files.len() > 60, "{}", files.len());
    for file in files.iter().filter(|file| !file.starts_with(root.join("crates/page"))) {
        let text = std::fs::read_to_string(file).unwrap();
        for import in text
            .lines()
            .filter(|line| line.trim_start().starts_with("use crate::"))
            .flat_map(|line| line.split("crate::").skip(1))
        {
            let floor: String = import.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect();
            let known = listed.iter().any(|source| source.split('/').next() == Some(&floor));
            // The numerical crates are listed as a whole.
            let numerical = ["bvp", "spectra"].iter().any(|name| file.starts_with(root.join("crates").join(name)));
            assert!(
                known || numerical,
                "{} imports crate::{floor}, which crates/page/build.rs does not list",
                file.display()
            );
        }
    }
}
