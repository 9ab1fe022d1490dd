//! Fingerprints the sources that the module in the page is compiled from, so that one which belongs to others is noticed.

use std::{
    env, fs, io,
    path::{Path, PathBuf},
};

#[path = "../embryo/build.rs"]
#[allow(dead_code)]
mod solver;

/// Files, and folders with all that is in them, that decide what the module answers. Reports and studies, which it
/// does not use, are left out, though they are in the same crate.
pub const PAGE_SOURCES: [&str; 15] = [
    "crates/bvp/src",
    "crates/embryo/src/batch",
    "crates/embryo/src/io/tree_json",
    "crates/embryo/src/lineage",
    "crates/embryo/src/settings.rs",
    "crates/mechanics/data",
    "crates/mechanics/src/cell",
    "crates/mechanics/src/cortex",
    "crates/mechanics/src/division",
    "crates/mechanics/src/input",
    "crates/mechanics/src/perturbation.rs",
    "crates/mechanics/src/shapes",
    "crates/mechanics/src/stability.rs",
    "crates/page/src",
    "crates/spectra/src",
];

fn main() -> io::Result<()> {
    let root = PathBuf::from(env::var_os("CARGO_MANIFEST_DIR").unwrap_or_default()).join("../..");
    for source in PAGE_SOURCES {
        println!("cargo::rerun-if-changed={}", root.join(source).display());
    }
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rerun-if-changed=../embryo/build.rs");
    let out = PathBuf::from(env::var_os("OUT_DIR").unwrap_or_default());
    fs::write(out.join("fingerprint"), page_fingerprint(&root)?)
}

/// The fingerprint of [`PAGE_SOURCES`], which changes with their code and not with their comments and tests.
///
/// # Errors
/// A source that is not there: the list must follow when something is moved.
pub fn page_fingerprint(root: &Path) -> io::Result<String> {
    solver::fingerprint(root, &PAGE_SOURCES).map(|hash| format!("{hash:016x}"))
}

/// The files of [`PAGE_SOURCES`], in the order of their names.
///
/// # Errors
/// As [`page_fingerprint`].
pub fn page_files(root: &Path) -> io::Result<Vec<PathBuf>> {
    solver::files_of(root, &PAGE_SOURCES)
}
