//! Commands in README, guide and book: each is run as it stands, or read as far as its options, or listed here with the reason
//! why it is not run.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

use pulldown_cmark::{CodeBlockKind, Event, Options, Parser, Tag, TagEnd};

use crate::common::command::{furrow, keep_what_is_solved};

/// Commands that are not run, by how they begin, and why. Their options are looked up all the same.
const NOT_RUN: &[(&str, &str)] = &[
    ("fit", "a search takes minutes: tests/command/help.rs and tests/studies/fit.rs run short ones"),
    ("calibrate data/statements.ron", "judging all statements takes long, 100 sets longer: tests/studies/ensemble.rs"),
    (
        "tree --constants constants.csv",
        "a hundred trees, of constants that an ensemble writes: tests/studies/ensemble.rs",
    ),
    ("sweep studies/", "a minute or less each, but not in a test: tests/studies/sweep.rs runs small ones"),
    ("sweep sizes.ron", "150 divisions: tests/studies/sweep.rs runs small ones"),
    ("tree lineages/c_elegans.ron lineages/c_elegans_*.ron", "the star is the shell's, and eight trees take long"),
    ("phase --vary r0 --from 1.6 --to 2.4 --points 9", "63 divisions: tests/command/help.rs runs smaller diagrams"),
    ("boundary --vary r0 --from 1.5 --to 5.4 --no-folds --write", "writes what is compiled in"),
    ("compare volumes my-volumes.csv", "the reader's own table"),
    ("compare volumes --constants constants.csv", "constants that an ensemble writes: tests/studies/compare.rs"),
    ("divide --r0 17um --cue polar --lineage my.ron", "a file of the reader's own: tests/trees/own_lineage.rs"),
    ("tree <(generate)", "the file is what the reader's own program writes"),
    ("reproduce", "all figures take minutes: tests/studies/reproduction.rs computes the quick ones"),
];

/// A command as it is written somewhere.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Written {
    words: Vec<String>,
    /// In a block, and so meant to be typed.
    block: bool,
}

impl Written {
    fn line(&self) -> String {
        self.words.join(" ")
    }

    /// Words that stand for something else, such as `FILE.svg`, `[--seed S]` or `…`.
    fn is_form(&self) -> bool {
        let stands_for = |word: &String| {
            let stem = word.split(['.', '/']).next().unwrap_or("");
            let capitals = !stem.is_empty() && stem.chars().all(|c| c.is_ascii_uppercase());
            capitals || word.contains('…') || word.contains('|') || word.starts_with('[')
        };
        self.words.iter().any(stands_for)
    }

    /// A command in running text without any argument is a name.
    fn is_name(&self) -> bool {
        !self.block && self.words.iter().all(|word| word.chars().all(|c| c.is_ascii_lowercase() || c == '-'))
    }
}

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// The commands of a page, in order. `$` and what stands behind `#` are the shell's.
fn commands(page: &str) -> Vec<Written> {
    let mut found = Vec::new();
    let mut add = |text: &str, block: bool| {
        let text = text.trim().trim_start_matches("$ ").split(" #").next().unwrap_or("").trim();
        let command = ["furrow ", "cargo run --release -- "].iter().find_map(|start| text.strip_prefix(start));
        // What begins with a word of the command line, unlike `furrow = …` in a manifest.
        let command = command.filter(|rest| rest.starts_with(|c: char| c.is_ascii_lowercase() || c == '-'));
        found
            .extend(command.map(|rest| Written { words: rest.split_whitespace().map(str::to_owned).collect(), block }));
    };
    let mut block = false;
    for event in Parser::new_ext(page, Options::ENABLE_TABLES) {
        match event {
            Event::Start(Tag::CodeBlock(CodeBlockKind::Fenced(_))) => block = true,
            Event::End(TagEnd::CodeBlock) => block = false,
            Event::Text(text) if block => text.lines().for_each(|line| add(line, true)),
            Event::Code(text) => add(&text, false),
            _ => {}
        }
    }
    found
}

fn pages_below(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            found.extend(pages_below(&path));
        } else if path.extension().is_some_and(|extension| extension == "md") {
            found.push(path);
        }
    }
    found.sort();
    found
}

/// The options that the help page of a command names, by the words the command begins with.
fn options_of(command: &Written, known: &mut BTreeMap<String, BTreeSet<String>>) -> BTreeSet<String> {
    let named: Vec<String> = command
        .words
        .iter()
        .take_while(|word| word.chars().all(|c| c.is_ascii_lowercase() || c == '-'))
        .cloned()
        .collect();
    // `compare counts` is a command of two words, `compare volumes FILE…` too, `cache stat` as well.
    let first = named.iter().take_while(|word| !word.starts_with('-')).take(2).cloned().collect::<Vec<_>>();
    for length in (0..=first.len()).rev() {
        let name = first[..length].join(" ");
        if let Some(options) = known.get(&name) {
            return options.clone();
        }
        let output = furrow(root(), &[&first[..length], &["--help".to_owned()]].concat());
        if output.status.success() {
            let page = String::from_utf8(output.stdout).unwrap();
            let words = page.split(|c: char| !(c.is_alphanumeric() || c == '-'));
            let options: BTreeSet<String> = words.filter(|word| word.starts_with("--")).map(str::to_owned).collect();
            known.insert(name, options.clone());
            assert!(length > 0 || first.is_empty(), "there is no command furrow {}", command.line());
            return options;
        }
    }
    panic!("no help for furrow {}", command.line());
}

fn copy_folder(from: &Path, to: &Path) {
    fs::create_dir(to).unwrap();
    for entry in fs::read_dir(from).unwrap() {
        let path = entry.unwrap().path();
        let copy = to.join(path.file_name().unwrap());
        if path.is_dir() {
            copy_folder(&path, &copy);
        } else {
            fs::copy(&path, copy).unwrap();
        }
    }
}

/// A folder with what the repository has and what the text tells the reader to write.
fn reader() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    keep_what_is_solved(folder.path());
    fs::create_dir(folder.path().join("docs")).unwrap();
    for name in ["data", "lineages", "studies"] {
        copy_folder(&root().join(name), &folder.path().join(name));
    }
    let ten_minutes = fs::read_to_string(root().join("docs/book/src/ten-minutes.md")).unwrap();
    let strong = ten_minutes.split("```ron\n").nth(1).and_then(|text| text.split("```").next()).unwrap();
    fs::write(folder.path().join("strong.ron"), strong).unwrap();
    folder
}

/// Runs or reads the commands of pages as a reader would who does all that they say, one after the other.
fn follow(pages: &[PathBuf]) {
    let folder = reader();
    let (mut known, mut done) = (BTreeMap::new(), BTreeSet::new());
    let (mut run, mut read) = (0, 0);
    for page in pages {
        for command in commands(&fs::read_to_string(page).unwrap()) {
            let place = format!("{}: furrow {}", page.strip_prefix(root()).unwrap().display(), command.line());
            let options = options_of(&command, &mut known);
            for word in command.words.iter().map(|word| word.trim_start_matches('[').trim_end_matches(']')) {
                let option = word.split('=').next().unwrap_or("");
                assert!(!option.starts_with("--") || options.contains(option), "{place}: there is no {option}");
            }
            read += 1;
            let listed = NOT_RUN.iter().any(|&(begin, _)| command.line().starts_with(begin));
            if command.is_form() || command.is_name() || listed || !done.insert(command.words.clone()) {
                continue;
            }
            let output = furrow(folder.path(), &command.words);
            assert!(output.status.success(), "{place}: {}", String::from_utf8_lossy(&output.stderr));
            run += 1;
        }
    }
    println!("{run} commands run, {read} read");
    assert!(run > 5 && read > run, "{run} {read}");
}

#[test]
fn commands_of_the_readme_and_the_book_run() {
    let book = pages_below(&root().join("docs")).into_iter();
    follow(&[root().join("README.md")].into_iter().chain(book).collect::<Vec<_>>());
}

#[test]
fn commands_of_the_guide_run() {
    follow(&[root().join("GUIDE.md")]);
}

/// A reason that no command needs any more would hide the next one that begins alike.
#[test]
fn every_reason_not_to_run_is_needed() {
    let pages = ["README.md", "GUIDE.md", "crates/mechanics/README.md"].map(|name| root().join(name));
    let pages = pages.into_iter().chain(pages_below(&root().join("docs")));
    let written: Vec<Written> = pages.flat_map(|page| commands(&fs::read_to_string(page).unwrap())).collect();
    for &(begin, why) in NOT_RUN {
        assert!(!why.is_empty() && written.iter().any(|command| command.line().starts_with(begin)), "{begin}");
    }
}

#[test]
fn commands_are_found_in_blocks_and_in_text() {
    let page = "Say `furrow tree\n--out a` or `furrow = 1`.\n\n| `furrow cache stat\\|verify` | |\n|---|---|\n\n```sh\n$ furrow divide --r0 2   # one\nfurrowed\n```\n";
    let lines: Vec<String> = commands(page).iter().map(Written::line).collect();
    assert_eq!(lines, ["tree --out a", "cache stat|verify", "divide --r0 2"]);
    assert!(commands(page)[1].is_form() && !commands(page)[2].is_form());
}
