//! docs/reproduction.md is current and reports the known differences from the paper.

use furrow_analysis::reproduce::paper::{Statement, statements};
use furrow_report::reproduction::value;

use crate::common::command::answer;

const PAGE: &str = include_str!("../../docs/reproduction.md");

/// What takes a few seconds. The rest is divisions by the thousand: `the_whole_page_is_current`.
const QUICK: [&str; 12] = ["1", "2C", "2E", "2I", "4", "5", "6", "S2", "S3", "S5", "Table S3", "movies"];

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
    assert!(quick.len() > 50, "{}", quick.len());
    for line in quick {
        assert!(PAGE.lines().any(|known| known == line), "docs/reproduction.md has no such line, {HELP}:\n{line}");
    }
    // The words before the first number are equal.
    let before = |page: &str| page.split("With the constants").next().map(str::to_owned);
    assert_eq!(before(&page), before(PAGE), "{HELP}");
}

/// All of the paper that computation can reach.
#[test]
#[ignore = "takes minutes"]
fn the_whole_page_is_current() {
    assert_eq!(page_of(&[]), PAGE, "{HELP}");
}

/// Every row has one statement and every statement one row.
#[test]
fn every_statement_has_its_row() {
    let (rows, statements) = (rows(PAGE), statements().unwrap());
    assert_eq!(rows.len(), statements.len(), "{HELP}");
    for (row, statement) in rows.iter().zip(&statements) {
        let Statement { figure, quantity, says, printed, apart, .. } = statement;
        assert_eq!((&row[0], &row[1]), (figure, quantity));
        assert_eq!(row[2], printed.map_or(says.clone(), |printed| value(&printed.value.into())), "{quantity}");
        assert_eq!(row[7] == "set apart", apart.is_some() && row[3] == "-", "{quantity}");
        assert!(!row[3].contains("not computed"), "{row:?}");
    }
    let count = |verdict: &str| rows.iter().filter(|row| row[7] == verdict).count();
    let [agree, differ, apart] = ["agrees", "**differs**", "set apart"].map(count);
    assert_eq!(agree + differ + apart, rows.len());
    let counts = format!("`gao2026`: {agree} statements agree, {differ} differ; {apart} are set apart.");
    assert!(PAGE.contains(&counts), "{counts}");
}

/// Differences are reported and not hidden: these are known.
#[test]
fn what_differs_is_said_to() {
    let rows = rows(PAGE);
    let differing: Vec<&str> = rows.iter().filter(|row| row[7] == "**differs**").map(|row| row[0].as_str()).collect();
    assert_eq!(differing, ["2A", "2B", "2G", "3C", "3D", "3D", "3E", "3E", "4B", "5C", "5D", "5D", "6B", "6C"]);
    // If the time step is the cause, the page has its results next to the converged ones.
    for figure in ["2A", "2G", "3D", "3E"] {
        assert!(rows.iter().any(|row| row[0] == figure && row[7] == "**differs**" && row[4] != "-"), "{figure}");
    }
}
