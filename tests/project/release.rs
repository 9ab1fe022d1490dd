//! Requirements of a release: metadata of every crate, pinned actions, a list of entries to fill in, and no forgotten test.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use super::documents::{files_below, root};

fn read(path: impl AsRef<Path>) -> String {
    let path = root().join(path);
    fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// Folders of the packages, the root's among them.
fn packages() -> Vec<PathBuf> {
    let crates = fs::read_dir(root().join("crates")).unwrap().map(|entry| entry.unwrap().path());
    crates.chain([root().to_owned(), root().join("python")]).collect()
}

/// The part of a manifest that describes its package.
fn package_of(folder: &Path) -> String {
    let manifest = read(folder.join("Cargo.toml"));
    let from = manifest.find("[package]\n").unwrap();
    let package = &manifest[from + 10..];
    package.split("\n[").next().unwrap().to_owned() + "\n"
}

/// The strings of a list such as `keywords = ["a", "b"]`.
fn list<'a>(package: &'a str, key: &str) -> Vec<&'a str> {
    let line = package.lines().find_map(|line| line.strip_prefix(key)?.strip_prefix(" = ["));
    line.map_or(vec![], |line| line.trim_end_matches(']').split(", ").map(|word| word.trim_matches('"')).collect())
}

/// Slugs of crates.io that furrow's crates use.
const CATEGORIES: [&str; 7] = [
    "science",
    "simulation",
    "mathematics",
    "visualization",
    "encoding",
    "parser-implementations",
    "command-line-utilities",
];

#[test]
fn every_crate_is_described_as_a_registry_wants_it() {
    let mut published = 0;
    for folder in packages() {
        let (package, name) = (package_of(&folder), folder.display());
        for key in ["version", "edition", "rust-version", "license", "authors", "repository", "homepage"] {
            assert!(package.contains(&format!("{key}.workspace = true\n")), "{name}: {key} is not the workspace's");
        }
        for key in ["description = \"", "documentation"] {
            assert!(package.lines().any(|line| line.starts_with(key)), "{name}: no {key}");
        }
        for file in ["README.md", "LICENSE-MIT", "LICENSE-APACHE"] {
            assert!(folder.join(file).exists(), "{name}: no {file}");
        }
        if package.contains("publish = false") {
            continue;
        }
        assert!(package.contains("readme = \"README.md\"\n"), "{name}: no readme");
        let (keywords, categories) = (list(&package, "keywords"), list(&package, "categories"));
        assert!(
            (1..=5).contains(&keywords.len()) && keywords.iter().all(|word| word.len() <= 20),
            "{name}: {keywords:?}"
        );
        let known = categories.iter().all(|category| CATEGORIES.contains(category));
        assert!((1..=5).contains(&categories.len()) && known, "{name}: {categories:?}");
        assert!(
            read(folder.join("Cargo.toml")).contains("[package.metadata.docs.rs]\n"),
            "{name}: no metadata of docs.rs"
        );
        published += 1;
    }
    assert_eq!(published, 13);
    let python = read("python/pyproject.toml");
    assert!(python.contains("dynamic = [\"version\", \"authors\", \"urls\"]\n"), "they come from Cargo.toml");
}

/// docs/RELEASING.md lists the files in which something is still to be filled in, and no others.
#[test]
fn what_is_to_be_filled_in_is_listed() {
    let extensions = ["toml", "cff", "md", "yml", "yaml", "bib"];
    let found: BTreeSet<String> = [".ci/packaging", ".github", "crates", "docs", "python"]
        .iter()
        .flat_map(|folder| extensions.iter().flat_map(move |extension| files_below(&root().join(folder), extension)))
        .chain(fs::read_dir(root()).unwrap().map(|entry| entry.unwrap().path()))
        .filter(|file| {
            !file.is_symlink() && file.extension().is_some_and(|e| extensions.iter().any(|known| e == *known))
        })
        .filter(|file| !file.ends_with("RELEASING.md") && read(file).contains("FILL-IN"))
        .map(|file| file.strip_prefix(root()).unwrap().display().to_string())
        .collect();
    let releasing = read("docs/RELEASING.md");
    let rows = releasing.split("## To fill in").nth(1).unwrap().split("\n## ").next().unwrap();
    let listed = rows.lines().filter_map(|row| Some(row.strip_prefix("| `")?.split('`').next()?.to_owned())).collect();
    assert_eq!(found, listed);
}

#[test]
fn workflows_pin_their_actions_and_restrict_their_permissions() {
    let mut seen = 0;
    for file in files_below(&root().join(".github/workflows"), "yml") {
        let (text, name) = (read(&file), file.display());
        assert!(text.contains("\npermissions:"), "{name}: no permissions");
        for action in text.lines().filter_map(|line| line.trim_start_matches([' ', '-']).strip_prefix("uses: ")) {
            let (_, hash) = action.split_once('@').unwrap_or_else(|| panic!("{name}: {action}"));
            let (hash, version) = hash.split_once(" # v").unwrap_or_else(|| panic!("{name}: {action} has no version"));
            assert!(hash.len() == 40 && hash.bytes().all(|byte| byte.is_ascii_hexdigit()), "{name}: {action}");
            assert!(version.starts_with(|c: char| c.is_ascii_digit()), "{name}: {action}");
            seen += 1;
        }
    }
    assert!(seen > 20, "{seen}");
}

/// A test that is ignored because it needs something runs in `.ci/run`, where that is there.
#[test]
fn ignored_tests_are_run_by_ci() {
    let ci = read(".ci/run");
    let mut seen = 0;
    for file in ["tests", "crates"].iter().flat_map(|folder| files_below(&root().join(folder), "rs")) {
        let text = read(&file);
        for after in text.split("\n#[ignore = \"needs ").skip(1) {
            let name = after.split("fn ").nth(1).and_then(|text| text.split('(').next()).unwrap();
            assert!(ci.contains(name), "{}: .ci/run does not name {name}", file.display());
            seen += 1;
        }
    }
    assert!(seen > 12, "{seen}");
}
