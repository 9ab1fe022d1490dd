//! Replays the files of `tests/fuzz/corpus` with the functions of the fuzzers.

use std::fs;
use std::path::{Path, PathBuf};

#[path = "../fuzz/targets/mod.rs"]
mod readers;

/// The entries of a folder of `tests/fuzz`, sorted by name.
fn listed(folder: &str) -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fuzz").join(folder);
    let mut paths: Vec<PathBuf> = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    paths.sort();
    paths
}

/// Every target has a fuzzer and a corpus, and reads every file of its corpus without a failure.
#[test]
fn every_target_passes_its_corpus() {
    let names = |folder: &str| -> Vec<String> {
        let stems = listed(folder).into_iter().map(|path| path.file_stem().unwrap().to_str().unwrap().to_owned());
        stems.filter(|name| name != "mod").collect()
    };
    let targets: Vec<String> = readers::TARGETS.iter().map(|(name, _)| (*name).to_owned()).collect();
    assert_eq!((names("targets"), names("corpus")), (targets.clone(), targets));
    let fuzzers = include_str!("../fuzz/Cargo.toml");
    for (name, check) in readers::TARGETS {
        assert!(fuzzers.contains(&format!("name = \"{name}\"")), "{name}");
        let paths = listed(&format!("corpus/{name}"));
        assert!(paths.len() >= 5, "{} files of {name}", paths.len());
        for path in paths {
            let bytes = fs::read(&path).unwrap();
            assert!(std::panic::catch_unwind(|| check(&bytes)).is_ok(), "{} fails: see above", path.display());
        }
    }
}
