//! docs/reproduction.md is current and reports the known differences from the paper.

use furrow_analysis::reproduce::paper::{Statement, statements};
use furrow_report::reproduction::value;

use crate::common::command::answer;

const PAGE: &str = include_str!("../../docs/reproduction.md");

/// What takes a few seconds. The rest is divisions by the thousand: `the_whole_page_is_current`.
const QUICK: [&str; 12] = ["1", "2C", "5", "6", "7", "S2", "S3", "S4", "S5", "Table S3", "movies", "2C-F"];

/// The page that the command writes of some figures.
fn page_of(figures: &[&str]) -> String {
    let folder = tempfile::tempdir().unwrap();
    let arguments: Vec<&str> =
        ["reproduce", "--no-cache", "--table", "page.md"].into_iter().chain(figures.iter().copied()).collect();
    answer(folder.path(), &arguments);
    std::fs::read_to_string(folder.path().join("page.md")).unwrap()
}

/// The rows of the table, each as its cells.
fn rows(page: &str) -> Vec<Vec<String>> {
    let lines = page.lines().filter(|line| line.starts_with("| ")).skip(1);
    let cells = |line: &str| -> Vec<String> {
        let line = line.trim_start_matches("| ").trim_end_matches(" |").replace("\\|", "\u{0}");
        line.split(" | ").map(|cell| cell.replace('\u{0}', "|")).collect()
    };
    lines.map(cells).collect()
}

const HELP: &str = "run `furrow reproduce --no-cache --table docs/reproduction.md`";

#[test]
fn the_page_is_current_as_far_as_is_quickly_told() {
    let page = page_of(&QUICK);
    let quick: Vec<&str> = page.lines().filter(|line| line.starts_with("| ") || line.starts_with("- **")).collect();
    assert!(quick.len() > 60, "{}", quick.len());
    for line in quick {
        assert!(PAGE.lines().any(|known| known == line), "docs/reproduction.md has no such line, {HELP}:\n{line}");
    }
    // The words before the first number are equal.
    let before = |page: &str| page.split("With the constants").next().map(str::to_owned);
    assert_eq!(before(&page), before(PAGE), "{HELP}");
}

/// All of the paper that computation can reach: two minutes of computing.
#[test]
#[ignore = "divisions by the thousand"]
fn the_whole_page_is_current() {
    assert_eq!(page_of(&[]), PAGE, "{HELP}");
}

/// Rows and statements belong together one by one, so that none is left out.
#[test]
fn every_statement_has_its_row() {
    let (rows, statements) = (rows(PAGE), statements().unwrap());
    assert_eq!(rows.len(), statements.len(), "{HELP}");
    for (row, statement) in rows.iter().zip(&statements) {
        let Statement { figure, quantity, says, printed, open, .. } = statement;
        assert_eq!(row[0], figure.replace('-', "–"));
        assert_eq!(row[1], *quantity);
        let paper = printed.map(|printed| value(Some(&printed.value.into())));
        let paper = paper.or((!says.is_empty()).then(|| says.clone())).unwrap_or("-".to_owned());
        assert_eq!(row[2], paper, "{quantity}");
        assert_eq!(row[6] == "not pinned down", open.is_some(), "{quantity}");
        assert!(!row[3].contains("not computed"), "{row:?}");
    }
    let count = |verdict: &str| rows.iter().filter(|row| row[6] == verdict).count();
    let [agree, differ, open] = ["agrees", "**differs**", "not pinned down"].map(count);
    assert_eq!(agree + differ + open, rows.len());
    let counts = format!("`gao2026`: {agree} statements agree, {differ} differ, {open} are not pinned down.");
    assert!(PAGE.contains(&counts), "{counts}");
}

/// Differences are reported and not hidden: these are known.
#[test]
fn what_differs_is_said_to() {
    let rows = rows(PAGE);
    let differing: Vec<&str> = rows.iter().filter(|row| row[6] == "**differs**").map(|row| row[0].as_str()).collect();
    assert_eq!(differing, ["2A", "2B", "2G", "4C", "4D", "4E"]);
    // If the time step is the cause, the page has its results next to the converged ones.
    for figure in ["2A", "2B", "4C", "4D"] {
        assert!(rows.iter().any(|row| row[0] == figure && row[6] == "**differs**" && row[4] != "-"), "{figure}");
    }
}
