//! Replays the files of `fuzz/corpus` with the functions of the fuzzers.

use std::fs;
use std::path::{Path, PathBuf};

#[path = "../../fuzz/targets/mod.rs"]
mod readers;

/// Every file of a target's corpus, in the order of their names; there must be some.
fn corpus(target: &str) -> Vec<(PathBuf, Vec<u8>)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("fuzz/corpus").join(target);
    let mut paths: Vec<PathBuf> = fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    paths.sort();
    assert!(paths.len() >= 5, "{} files in {}", paths.len(), folder.display());
    let read = |path: PathBuf| fs::read(&path).map(|bytes| (path, bytes)).unwrap();
    paths.into_iter().map(read).collect()
}

/// Runs a target over its corpus and names the file on which it fails.
fn try_all(target: &str, check: fn(&[u8])) {
    for (path, bytes) in corpus(target) {
        let tried = std::panic::catch_unwind(|| check(&bytes));
        assert!(tried.is_ok(), "{} fails: see above", path.display());
    }
}

#[test]
fn lineage_files() {
    try_all("lineage", readers::lineage::check);
}

#[test]
fn contours() {
    try_all("contours", readers::contours::check);
}

#[test]
fn sweep_files() {
    try_all("sweep", readers::sweep::check);
}

#[test]
fn files_of_targets() {
    try_all("targets", readers::targets::check);
}

#[test]
fn configuration_files() {
    try_all("config", readers::config::check);
}

#[test]
fn cues_and_settings() {
    try_all("cue", readers::cue::check);
}

#[test]
fn tree_files() {
    try_all("tree_json", readers::tree_json::check);
}

#[test]
fn tables_of_volumes() {
    try_all("volumes", readers::volumes::check);
}

#[test]
fn tables_of_constants() {
    try_all("constants", readers::constants::check);
}

/// Every target has a fuzzer and a corpus, and every fuzzer is tried here.
#[test]
fn no_target_is_left_out() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("fuzz");
    let names = |folder: &str| {
        let entries = fs::read_dir(root.join(folder)).unwrap();
        let mut names: Vec<String> =
            entries.map(|entry| entry.unwrap().path().file_stem().unwrap().to_str().unwrap().to_owned()).collect();
        names.retain(|name| name != "mod");
        names.sort();
        names
    };
    let here =
        fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/project/hostile_corpus.rs")).unwrap();
    let targets = names("targets");
    assert_eq!(names("fuzz_targets"), targets);
    assert_eq!(names("corpus"), targets);
    assert!(targets.iter().all(|name| here.contains(&format!("try_all(\"{name}\""))), "{targets:?}");
}
