//! docs/reproduction.md is current and reports the known differences from the paper.

use furrow_analysis::reproduce::paper::{Statement, statements};
use furrow_report::reproduction::value;
use serde_json::Value as Json;

use crate::common::command::{HERE, answer, json, names};

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

/// What is reproduced, without times, which are no result.
fn items(arguments: &[&str]) -> Vec<Json> {
    let mut json = json(HERE, &[&["reproduce", "--no-cache"], arguments].concat());
    let items = json["items"].as_array_mut().unwrap();
    for item in items.iter_mut() {
        assert!(item["seconds"].take().as_f64().unwrap() >= 0.0);
    }
    items.clone()
}

#[test]
fn the_answer_is_the_same_at_any_number_of_threads() {
    let run = |threads| items(&["2C", "S5", "5A", "--threads", threads]);
    let found = run("2");
    assert_eq!(found, run("1"));
    assert_eq!(found, run("5"));
    for item in &found {
        for key in ["figure", "quantity", "computed", "pass", "criterion", "verdict"] {
            assert!(!item[key].is_null(), "{key}: {item}");
        }
        assert!(item.get("paper").is_some() && item.get("rel_error").is_some());
        assert_eq!(item["pass"].as_bool().unwrap(), item["verdict"] == "agrees");
    }
    let threshold = &found[0];
    assert_eq!((&threshold["figure"], &threshold["paper"]), (&"2C-F".into(), &25.796.into()));
    let error = (threshold["computed"].as_f64().unwrap() / 25.796 - 1.0).abs();
    assert!((threshold["rel_error"].as_f64().unwrap() - error).abs() < 1e-12 && error < 3e-3);
}

/// The constants decide: with a stiffer shell the thresholds are others.
#[test]
fn other_constants_are_held_against_the_same_paper() {
    let found = items(&["2C", "Table S3", "--set", "p0=0.2", "--set", "xi_s=24"]);
    let verdict = |id: &str| found.iter().find(|item| item["id"] == id).unwrap()["verdict"].clone();
    assert_eq!(verdict("threshold_small"), "differs");
    assert_eq!(verdict("table_xi_s"), "differs");
    assert_eq!(verdict("table_xi_b"), "differs");
    assert_eq!(verdict("table_kappa"), "agrees");
    // What is not pinned down stays so, and is no pass.
    assert_eq!(verdict("table_shell"), "not pinned down");
}

#[test]
fn a_folder_has_pictures_and_tables() {
    let folder = tempfile::tempdir().unwrap();
    answer(folder.path(), &["reproduce", "1", "S4", "S5", "movie2", "--out", "out", "--no-cache"]);
    let names = names(&folder.path().join("out"));
    let shape = "S5-R0_2-epsilon_0.87";
    for name in
        ["1B-D.svg", "S4-R0_2.22-epsilon_0.56.svg", &format!("{shape}.svg"), &format!("{shape}.csv"), "movie_2.svg"]
    {
        assert!(names.iter().any(|known| known == name), "{name}: {names:?}");
    }
    let csv = std::fs::read_to_string(folder.path().join("out/results.csv")).unwrap();
    assert!(csv.starts_with("figure,id,quantity,paper,computed,"));
    assert_eq!(csv.lines().count(), 8);
    assert!(folder.path().join("out/reproduce.json").is_file() && folder.path().join("out/reproduction.md").is_file());
}
