//! Numbered equations: those that the book has, and those that comments in the code cite.
//!
//! An equation of the book ends with a label, `\tag{M.6 normal}`: a letter for the chapter (M of the model, N of the numerics,
//! F of what is fitted), a number, and a name. A comment cites it by the number, `M.6`; where it states the equation itself it
//! gives number and name in brackets, `[M.6 normal]`.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use crate::{BookError, CHAPTERS, files_below, markdown, read};

/// The letters that numbers begin with.
const LETTERS: [char; 3] = ['M', 'N', 'F'];

/// An equation of the book.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Equation {
    /// Its name, such as `normal`.
    pub name: String,
    /// The chapter, from the folder of the chapters.
    pub chapter: PathBuf,
}

/// A place in the code where an equation is cited.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Citation {
    /// The file, from the folder of the whole.
    pub file: PathBuf,
    /// The line, from 1.
    pub line: usize,
    /// The number, such as `M.6`.
    pub number: String,
    /// The name, where the citation gives one.
    pub name: Option<String>,
}

/// The label that a formula ends with, and the formula without it.
pub fn label(latex: &str) -> Option<(&str, &str, &str)> {
    let (formula, behind) = latex.rsplit_once("\\tag{")?;
    let (label, rest) = behind.split_once('}')?;
    let (number, name) = label.split_once(' ')?;
    (rest.trim().is_empty() && numbers(number).len() == 1).then_some((formula, number, name))
}

/// The numbers of equations in a text, with their places.
pub fn numbers(text: &str) -> Vec<(usize, &str)> {
    let mut found = Vec::new();
    for (at, _) in text.match_indices(LETTERS) {
        let before = text.get(..at).and_then(|before| before.chars().next_back());
        let Some(digits) = text.get(at + 1..).and_then(|rest| rest.strip_prefix('.')) else { continue };
        let length = digits.bytes().take_while(u8::is_ascii_digit).count();
        let after = digits.get(length..).and_then(|rest| rest.chars().next());
        let apart = |c: Option<char>| c.is_none_or(|c| !c.is_alphanumeric());
        if length > 0 && apart(before) && apart(after) {
            found.extend(text.get(at..at + 2 + length).map(|number| (at, number)));
        }
    }
    found
}

/// The equations of the book's chapters, by number.
///
/// # Errors
/// Chapters that cannot be read, labels that are none, two equations of one number.
pub fn in_book(root: &Path) -> Result<BTreeMap<String, Equation>, BookError> {
    let folder = root.join(CHAPTERS);
    let mut found = BTreeMap::new();
    for file in files_below(&folder, ".md")? {
        let chapter = file.strip_prefix(&folder).unwrap_or(&file).to_owned();
        for (mark, _) in markdown::marks(&read(&file)?) {
            let markdown::Mark::Display(latex) = mark else { continue };
            let wrong = |label: &str, why| BookError::Equation {
                chapter: chapter.clone(),
                label: label.trim().to_owned(),
                why,
            };
            let Some((_, number, name)) = label(&latex) else {
                return Err(wrong(&latex, "has no label such as \\tag{M.6 normal} at its end"));
            };
            let equation = Equation { name: name.to_owned(), chapter: chapter.clone() };
            if found.insert(number.to_owned(), equation).is_some() {
                return Err(wrong(number, "is in the book twice"));
            }
        }
    }
    Ok(found)
}

/// Where comments of the code cite equations, in the order of files and lines.
///
/// # Errors
/// Sources that cannot be read.
pub fn in_code(root: &Path) -> Result<Vec<Citation>, BookError> {
    let mut found = Vec::new();
    let mut files = files_below(&root.join("src"), ".rs")?;
    files.extend(files_below(&root.join("crates"), ".rs")?);
    // What is said here of labels and citations cites nothing.
    for file in files.iter().filter(|file| !file.starts_with(root.join("crates/book"))) {
        let short = file.strip_prefix(root).unwrap_or(file);
        for (k, line) in read(file)?.lines().enumerate() {
            let comment = line.split_once("//").map_or("", |(_, comment)| comment);
            for (at, number) in numbers(comment) {
                let behind = comment.get(at + number.len()..).unwrap_or("");
                let stated = comment.get(..at).is_some_and(|before| before.ends_with('['));
                let name = behind.split_once(']').map(|(name, _)| name.trim_end_matches('\\').trim().to_owned());
                let name = name.filter(|_| stated);
                found.push(Citation { file: short.to_owned(), line: k + 1, number: number.to_owned(), name });
            }
        }
    }
    Ok(found)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_told_from_words() {
        let found = |text| numbers(text).into_iter().map(|(_, number)| number).collect::<Vec<_>>();
        assert_eq!(found("M.5 and [N.12 step], not SM.5, M.5a, M5, U. M. Ascher, F.e"), ["M.5", "N.12"]);
        assert_eq!(found("(F.3)."), ["F.3"]);
    }

    #[test]
    fn labels_stand_at_the_end() {
        assert_eq!(label(r" a = b \tag{M.6 normal} "), Some((" a = b ", "M.6", "normal")));
        assert_eq!(label(r" a = b \tag{normal} "), None);
        assert_eq!(label(r" a \tag{M.6 normal} = b"), None);
    }
}
