//! Documents: links exist, commands parse, and the book has the equations that comments cite.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

pub fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// Files below a folder with this extension, in the order of their names.
pub fn files_below(folder: &Path, extension: &str) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() && !path.is_symlink() && !path.ends_with("target") {
            found.extend(files_below(&path, extension));
        } else if path.extension().is_some_and(|e| e == extension) {
            found.push(path);
        }
    }
    found.sort();
    found
}

/// The pages at the root and in `docs`, which has the book.
fn pages() -> Vec<PathBuf> {
    let names = ["README.md", "CONTRIBUTING.md"].map(|name| root().join(name));
    names.into_iter().chain(files_below(&root().join("docs"), "md")).collect()
}

#[test]
fn links_lead_to_files_that_are_there() {
    let mut seen = 0;
    for page in pages() {
        for after in fs::read_to_string(&page).unwrap().split("](").skip(1) {
            let target = after.split([')', '#']).next().unwrap();
            if !target.is_empty() && !target.contains(":") {
                assert!(page.with_file_name(target).exists(), "{}: there is no {target}", page.display());
                seen += 1;
            }
        }
    }
    assert!(seen > 100, "{seen}");
}

/// The help and the book list every profile of a cue, which they state again.
#[test]
fn profiles_are_listed_in_the_help_and_in_the_book() {
    for file in ["src/cli/cell.rs", "docs/book/src/use/cues.md"] {
        let text = fs::read_to_string(root().join(file)).unwrap();
        for name in furrow_cell::cue::profile::NAMES {
            let named = text.split(|c: char| !c.is_alphanumeric() && c != '_').any(|word| word == name);
            assert!(named, "{file} does not list the profile {name}");
        }
    }
}

#[test]
fn the_citation_names_this_version() {
    let citation = fs::read_to_string(root().join("CITATION.cff")).unwrap();
    let version = citation.lines().find_map(|line| line.strip_prefix("version: "));
    assert_eq!(version, Some(env!("CARGO_PKG_VERSION")));
}

/// Numbers of equations in a text, such as M.6, with the text behind them.
fn numbers(text: &str) -> impl Iterator<Item = (&str, &str)> {
    let starts = text.char_indices().filter(|(at, c)| {
        "MNFPAS".contains(*c) && !text[..*at].ends_with(|before: char| before.is_alphanumeric() || before == '_')
    });
    starts.filter_map(|(at, _)| {
        let digits = text[at + 1..].strip_prefix('.')?;
        let length = digits.find(|c: char| !c.is_ascii_digit()).unwrap_or(digits.len());
        let behind = &digits[length..];
        let apart = length > 0 && !behind.starts_with(|c: char| c.is_alphanumeric());
        apart.then(|| (&text[at..at + 2 + length], behind))
    })
}

/// Comments cite an equation of the book as `M.6`, and state it as `[M.6 normal]`; every equation is cited.
#[test]
fn comments_and_the_book_have_the_same_equations() {
    let mut equations = BTreeMap::new();
    for page in files_below(&root().join("docs/book/src"), "md") {
        for label in fs::read_to_string(&page).unwrap().split("\\tag{").skip(1) {
            let (number, name) = label.split('}').next().unwrap().split_once(' ').unwrap();
            let before = equations.insert(number.to_owned(), (name.to_owned(), false));
            assert!(before.is_none(), "{number} is in the book twice");
        }
    }
    for file in ["src", "crates"].iter().flat_map(|folder| files_below(&root().join(folder), "rs")) {
        for comment in fs::read_to_string(&file).unwrap().lines().filter_map(|line| Some(line.split_once("//")?.1)) {
            for (number, behind) in numbers(comment) {
                let place = format!("{}: {number}", file.display());
                let (name, cited) = equations.get_mut(number).unwrap_or_else(|| panic!("{place} is not in the book"));
                *cited = true;
                if comment.contains(&format!("[{number} ")) {
                    assert_eq!(behind.split([']', '\\']).next().unwrap().trim(), name, "{place}");
                }
            }
        }
    }
    let alone: Vec<&String> = equations.iter().filter(|(_, (_, cited))| !cited).map(|(number, _)| number).collect();
    assert!(alone.is_empty() && equations.len() > 40, "no comment cites {alone:?} of {}", equations.len());
}

/// The commands in the blocks of a page, each as its words. `$` and what follows `#` are the shell's.
fn commands(page: &Path) -> Vec<Vec<String>> {
    let text = fs::read_to_string(page).unwrap();
    let lines = text.split("```").skip(1).step_by(2).flat_map(str::lines);
    let commands = lines.filter_map(|line| {
        let line = line.trim_start_matches("$ ").split(" #").next()?;
        let words = line.strip_prefix("furrow ").or(line.strip_prefix("cargo run --release -- "))?;
        Some(words.split_whitespace().map(|word| word.trim_matches(['\'', '"']).to_owned()).collect())
    });
    commands.collect()
}

#[test]
fn commands_are_understood() {
    let mut seen = 0;
    for page in pages() {
        for words in commands(&page) {
            let said = furrow::cli::command().try_get_matches_from([&["furrow".to_owned()], words.as_slice()].concat());
            assert!(said.is_ok(), "{}: {}", page.display(), said.unwrap_err());
            seen += 1;
        }
    }
    assert!(seen > 40, "{seen}");
}
