//! Equations and their citations: every comment that cites one is right, and every one is cited.

use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;

use book::chapter::contents;
use book::equations::{in_book, in_code, label};
use book::markdown::{Mark, marks};
use book::{CHAPTERS, read};

fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../..")
}

#[test]
fn every_equation_cited_is_in_the_book_by_that_name() {
    let (equations, citations) = (in_book(&root()).unwrap(), in_code(&root()).unwrap());
    assert!(citations.len() > 40, "only {} citations were found", citations.len());
    for cited in citations {
        let place = format!("{}:{}: {}", cited.file.display(), cited.line, cited.number);
        let equation = equations.get(&cited.number).unwrap_or_else(|| panic!("{place} is not in the book"));
        if let Some(name) = cited.name {
            assert_eq!(name, equation.name, "{place}");
        }
    }
}

#[test]
fn every_equation_of_the_book_is_cited_in_the_code() {
    let equations = in_book(&root()).unwrap();
    let cited: BTreeSet<String> = in_code(&root()).unwrap().into_iter().map(|citation| citation.number).collect();
    let alone: Vec<&String> = equations.keys().filter(|number| !cited.contains(*number)).collect();
    assert!(alone.is_empty(), "no comment cites {alone:?}");
    assert!(equations.len() > 40, "{}", equations.len());
}

/// Numbers run from 1 in the order in which one reads, so that one who looks for M.7 finds it between M.6 and M.8.
#[test]
fn numbers_run_from_one_in_the_order_of_the_book() {
    let folder = root().join(CHAPTERS);
    let mut last: BTreeMap<String, usize> = BTreeMap::new();
    for chapter in contents(&read(&folder.join("SUMMARY.md")).unwrap()) {
        for (mark, _) in marks(&read(&folder.join(&chapter)).unwrap()) {
            let Mark::Display(latex) = mark else { continue };
            let (_, number, _) = label(&latex).unwrap();
            let (letter, k) = number.split_once('.').unwrap();
            let before = last.insert(letter.to_owned(), k.parse().unwrap()).unwrap_or(0);
            assert_eq!(k.parse(), Ok(before + 1), "{}: {number}", chapter.display());
        }
    }
    assert_eq!(last.keys().collect::<Vec<_>>(), ["F", "M", "N"]);
}
