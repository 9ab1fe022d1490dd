//! The book can be put together, and leaves out nothing of the guide.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use book::{CHAPTERS, chapter, files_below, markdown, stage};

fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// All links lead somewhere and all formulas are LaTeX, or there would be an error.
#[test]
fn the_book_is_put_together_with_all_that_it_shows() {
    let folder = tempfile::tempdir().unwrap();
    let chapters = stage::stage(&root(), folder.path()).unwrap();
    assert!(chapters >= 24, "{chapters}");
    let model = fs::read_to_string(folder.path().join("src/theory/model.md")).unwrap();
    assert!(model.contains("id=\"M.6\"") && !model.contains("$$") && !model.contains("\\frac"));
    let commands = fs::read_to_string(folder.path().join("src/guide/commands.md")).unwrap();
    assert!(
        commands.starts_with("# Commands\n") && commands.contains("([Scenarios](../guide/scenarios.md#scenarios))")
    );
    assert!(folder.path().join("src/files/docs/floors.svg").is_file());
    // Nothing is taken from a network: neither pages nor style name a source elsewhere, but in links.
    for file in files_below(folder.path(), "").unwrap() {
        let Ok(text) = fs::read_to_string(&file) else { continue };
        for loads in ["src=\"http", "@import", "url(http", "rel=\"stylesheet\" href=\"http"] {
            assert!(!text.contains(loads), "{} loads from elsewhere: {loads}", file.display());
        }
    }
}

/// A section that is added to the guide has its place in the book.
#[test]
fn every_section_of_the_guide_is_in_the_book() {
    let guide = fs::read_to_string(root().join("GUIDE.md")).unwrap();
    let chapters = files_below(&root().join(CHAPTERS), ".md").unwrap();
    let text: String = chapters.iter().map(|file| fs::read_to_string(file).unwrap()).collect();
    for heading in markdown::headings(&guide).into_iter().filter(|heading| heading.level == 2) {
        let line = format!("{{{{section GUIDE.md#{}}}}}", heading.anchor);
        assert_eq!(text.matches(&line).count(), 1, "a chapter in {CHAPTERS} has to have the line {line}");
    }
}

/// No chapter that cannot be reached from the contents, and none twice.
#[test]
fn every_chapter_is_in_the_contents_once() {
    let folder = root().join(CHAPTERS);
    let listed = chapter::contents(&fs::read_to_string(folder.join("SUMMARY.md")).unwrap());
    let once: BTreeSet<&PathBuf> = listed.iter().collect();
    assert_eq!(once.len(), listed.len());
    for file in files_below(&folder, ".md").unwrap() {
        let path = file.strip_prefix(&folder).unwrap();
        assert!(path == Path::new("SUMMARY.md") || once.contains(&path.to_owned()), "{}", path.display());
    }
}

/// Whoever cites furrow cites the version that this is.
#[test]
fn the_citation_names_this_version() {
    let citation = fs::read_to_string(root().join("CITATION.cff")).unwrap();
    let version = citation.lines().find_map(|line| line.strip_prefix("version: "));
    assert_eq!(version, Some(env!("CARGO_PKG_VERSION")));
}

/// What the reasons for trust and the other chapters name is there: sources, data, and tests by their names.
#[test]
fn files_and_tests_that_chapters_name_are_there() {
    let mut seen = 0;
    for file in files_below(&root().join(CHAPTERS), ".md").unwrap() {
        let text = fs::read_to_string(&file).unwrap();
        let trust = file.ends_with("numerics/trust.md");
        for line in text.lines() {
            let last = line.trim_end_matches('|').rsplit('|').next().unwrap_or("");
            for word in line.split('`').skip(1).step_by(2) {
                let source = ["src/", "crates/", "tests/", "data/", "docs/", "lineages/", "studies/"];
                let path = source.iter().any(|start| word.starts_with(start)) && !word.contains(['*', '…', ' ']);
                // In the table of reasons the last column names tests.
                let test = trust && last.contains(&format!("`{word}`")) && !word.contains('/');
                if path || (test && line.starts_with("| ")) {
                    let themes = ["cells", "trees", "studies", "command", "project"];
                    let there = match path {
                        true => root().join(word).exists(),
                        false => themes.iter().any(|theme| root().join(format!("tests/{theme}/{word}.rs")).exists()),
                    };
                    assert!(there, "{}: there is no {word}", file.display());
                    seen += 1;
                }
            }
        }
    }
    assert!(seen > 15, "{seen}");
}
