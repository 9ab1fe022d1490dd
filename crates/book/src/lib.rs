//! The book of furrow: its chapters put together, its equations made readable, its citations held to the code.
//!
//! Chapters stand in `docs/book/src`. What the guide says already is not said there again: a line
//! `{{section GUIDE.md#cues}}` stands for that section. Equations are written in LaTeX, as code hosting sites show them, and
//! become MathML, which browsers draw without a script and without a network. Comments in the code cite equations by
//! number, and [`equations`] finds both ends of every citation.
//!
//! | module | role |
//! |---|---|
//! | [`markdown`] | headings and their anchors, sections of a file, places of links and of formulas |
//! | [`chapter`] | a chapter with the sections it stands for, each with the file it is from |
//! | [`formula`] | LaTeX to MathML |
//! | [`equations`] | numbered equations of the book, and where the code cites them |
//! | [`links`] | what a link in a chapter leads to, inside the book |
//! | [`stage`](mod@stage) | the folder that mdBook builds from |
//!
//! # Examples
//! ```
//! let html = book::formula::mathml("c_2 = \\sin\\psi / r", false)?;
//! assert!(html.starts_with("<math") && html.contains("sin"));
//! # Ok::<(), book::BookError>(())
//! ```

use std::path::{Path, PathBuf};

pub mod chapter;
pub mod equations;
pub mod formula;
pub mod links;
pub mod markdown;
pub mod stage;

/// Where the chapters are, from the folder of the whole.
pub const CHAPTERS: &str = "docs/book/src";

/// Why the book cannot be put together.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum BookError {
    /// A file cannot be read or written.
    #[error("{path}: {error}", path = .path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// What the system says.
        error: std::io::Error,
    },
    /// A chapter asks for a section that its file does not have.
    #[error("{chapter}: {file} has no section #{anchor}", chapter = .chapter.display(), file = .file.display())]
    Section {
        /// The chapter.
        chapter: PathBuf,
        /// The file that the section should be in.
        file: PathBuf,
        /// Anchor of its heading.
        anchor: String,
    },
    /// A line that begins as one of the book's own and is none.
    #[error("{chapter}: `{line}` is not understood; allowed is {{{{section FILE}}}} or {{{{section FILE#ANCHOR}}}}, in SUMMARY.md {{{{reports}}}}", chapter = .chapter.display())]
    Line {
        /// The chapter.
        chapter: PathBuf,
        /// The line.
        line: String,
    },
    /// A formula that is no LaTeX.
    #[error("the formula {latex}: {why}")]
    Formula {
        /// The formula.
        latex: String,
        /// What is wrong with it.
        why: String,
    },
    /// A link that leads nowhere.
    #[error("{file}: the link to {target} leads nowhere: {why}", file = .file.display())]
    Link {
        /// The file that the link stands in.
        file: PathBuf,
        /// What it leads to.
        target: String,
        /// Why not.
        why: &'static str,
    },
    /// An equation whose label is none, or that there are two of.
    #[error("{chapter}: the equation labelled `{label}`: {why}", chapter = .chapter.display())]
    Equation {
        /// The chapter.
        chapter: PathBuf,
        /// The label.
        label: String,
        /// What is wrong with it.
        why: &'static str,
    },
}

/// The text of a file.
///
/// # Errors
/// A file that cannot be read or is not UTF-8.
pub fn read(path: &Path) -> Result<String, BookError> {
    std::fs::read_to_string(path).map_err(|error| BookError::File { path: path.to_owned(), error })
}

/// The files below a folder whose names end in `ending`, in the order of their paths; folders called `target` are left out.
///
/// # Errors
/// A folder that cannot be read.
pub fn files_below(folder: &Path, ending: &str) -> Result<Vec<PathBuf>, BookError> {
    let failed = |error| BookError::File { path: folder.to_owned(), error };
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(failed)? {
        let path = entry.map_err(failed)?.path();
        if path.is_dir() && !path.ends_with("target") {
            found.extend(files_below(&path, ending)?);
        } else if path.to_string_lossy().ends_with(ending) {
            found.push(path);
        }
    }
    found.sort();
    Ok(found)
}
