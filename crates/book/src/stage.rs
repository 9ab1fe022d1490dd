//! The folder that mdBook builds from: chapters with their sections, MathML, links that lead inside the book, and the files
//! that these lead to.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::ops::Range;
use std::path::{Path, PathBuf};

use crate::chapter::{Piece, contents, read_chapter};
use crate::equations::{self, Equation};
use crate::links::{Places, Target, way};
use crate::markdown::Mark;
use crate::{BookError, CHAPTERS, formula, markdown, read};

/// Puts the book of the folder `root` together in `out`: `book.toml`, a style, and `src` with all chapters. What is in `out/src`
/// goes. Returns how many chapters there are.
///
/// # Errors
/// Whatever is missing or wrong in a chapter, and files that cannot be written.
pub fn stage(root: &Path, out: &Path) -> Result<usize, BookError> {
    let summary = with_reports(root, &read(&root.join(CHAPTERS).join("SUMMARY.md"))?)?;
    let equations = equations::in_book(root)?;
    let mut chapters = Vec::new();
    for path in contents(&summary) {
        let report = reports(root)?.into_iter().find(|(name, _)| *name == path);
        let file = report.map_or_else(|| Path::new(CHAPTERS).join(&path), |(_, file)| file);
        let pieces = read_chapter(root, &file)?;
        chapters.push((path, file, pieces));
    }
    let places =
        Places::new(chapters.iter().map(|(path, file, pieces)| (path.as_path(), file.as_path(), pieces.as_slice())));
    let folder = out.join("src");
    if folder.exists() {
        fs::remove_dir_all(&folder).map_err(|error| BookError::File { path: folder.clone(), error })?;
    }
    let mut files = BTreeSet::new();
    for (path, _, pieces) in &chapters {
        let mut text = String::new();
        for piece in pieces {
            let page = Page { root, places: &places, equations: &equations, chapter: path };
            text.push_str(&page.rewritten(piece, &mut files)?);
        }
        write(&folder.join(path), text.as_bytes())?;
    }
    write(&folder.join("SUMMARY.md"), summary.as_bytes())?;
    for file in files {
        copy(&root.join(&file), &folder.join("files").join(&file))?;
    }
    for name in ["book.toml", "book.css"] {
        copy(&root.join("docs/book").join(name), &out.join(name))?;
    }
    Ok(chapters.len())
}

/// The reports in `docs`, pages of Markdown that are made or kept there: each with its path as a chapter, and its file.
fn reports(root: &Path) -> Result<Vec<(PathBuf, PathBuf)>, BookError> {
    let folder = root.join("docs");
    let failed = |error| BookError::File { path: folder.clone(), error };
    let mut found = Vec::new();
    for entry in fs::read_dir(&folder).map_err(failed)? {
        let name = PathBuf::from(entry.map_err(failed)?.file_name());
        if name.extension().is_some_and(|end| end == "md") {
            found.push((Path::new("reports").join(&name), Path::new("docs").join(&name)));
        }
    }
    found.sort();
    Ok(found)
}

/// The table of contents with the line `{{reports}}` replaced by the pages that there are in `docs`, by their titles.
fn with_reports(root: &Path, summary: &str) -> Result<String, BookError> {
    let mut lines = Vec::new();
    for line in summary.lines() {
        match line {
            "{{reports}}" => {
                for (path, file) in reports(root)? {
                    let title = markdown::headings(&read(&root.join(&file))?).into_iter().next();
                    let title = title.map_or_else(|| file.display().to_string(), |heading| heading.text);
                    lines.push(format!("- [{title}]({})", path.display()));
                }
            }
            _ if line.starts_with("{{") => {
                return Err(BookError::Line { chapter: "SUMMARY.md".into(), line: line.to_owned() });
            }
            _ => lines.push(line.to_owned()),
        }
    }
    Ok(lines.join("\n") + "\n")
}

/// What is needed to write a chapter's text anew.
struct Page<'b> {
    root: &'b Path,
    places: &'b Places,
    equations: &'b BTreeMap<String, Equation>,
    chapter: &'b Path,
}

impl Page<'_> {
    /// A piece with formulas as MathML and links that lead inside the book; what the book brings along for them joins `files`.
    fn rewritten(&self, piece: &Piece, files: &mut BTreeSet<PathBuf>) -> Result<String, BookError> {
        let mut text = piece.text.clone();
        for (mark, place) in markdown::marks(&piece.text).into_iter().rev() {
            let old = piece.text.get(place.clone()).unwrap_or("");
            let new = match mark {
                Mark::Inline(latex) => formula::mathml(&latex, false)?,
                Mark::Display(latex) => displayed(&latex)?,
                Mark::Words(words) => self.with_equations_linked(&words, old),
                Mark::Link(link) => {
                    let target = self.places.target(self.root, &piece.file, &link)?;
                    // A picture within a link has been changed already, and so the link's own text.
                    self.relinked(&mut text, place.clone(), &link, target, files);
                    self.named(&mut text, place.start, &link, &piece.file);
                    continue;
                }
            };
            if new != old {
                text.replace_range(place, &new);
            }
        }
        Ok(text)
    }

    fn relinked(
        &self,
        text: &mut String,
        place: Range<usize>,
        link: &str,
        target: Target,
        files: &mut BTreeSet<PathBuf>,
    ) {
        let destination = format!("]({link})");
        let Some(at) = text.get(place.start..).and_then(|rest| rest.find(&destination)) else { return };
        let at = place.start + at;
        let to = match target {
            Target::Elsewhere => return,
            Target::Chapter(path, anchor) => {
                let anchor = anchor.map_or_else(String::new, |anchor| format!("#{anchor}"));
                way(self.chapter, &path) + &anchor
            }
            Target::File(path) => {
                let to = way(self.chapter, &Path::new("files").join(&path));
                files.insert(path);
                to
            }
            Target::Outside => {
                text.replace_range(at..at + destination.len(), "");
                text.replace_range(place.start..=place.start, "");
                return;
            }
        };
        text.replace_range(at..at + destination.len(), &format!("]({to})"));
    }

    /// What stands below in a long page is in another chapter of the book: a link that says `below` says which.
    fn named(&self, text: &mut String, start: usize, link: &str, file: &Path) {
        const BELOW: &str = "[below]";
        let heading = link.strip_prefix('#').and_then(|anchor| self.places.heading(file, anchor));
        if let Some(heading) = heading
            && text.get(start..).is_some_and(|rest| rest.starts_with(BELOW))
        {
            text.replace_range(start..start + BELOW.len(), &format!("[{heading}]"));
        }
    }

    /// Numbers of equations in running text, as links to them.
    fn with_equations_linked(&self, words: &str, old: &str) -> String {
        // Where marks were escaped the text is not what stands there; such words cite nothing.
        if words != old {
            return old.to_owned();
        }
        let mut new = words.to_owned();
        for (at, number) in equations::numbers(words).into_iter().rev() {
            if let Some(equation) = self.equations.get(number) {
                let to = way(self.chapter, &equation.chapter);
                new.replace_range(at..at + number.len(), &format!("[{number}]({to}#{number})"));
            }
        }
        new
    }
}

/// A formula of its own, with its number beside it.
fn displayed(latex: &str) -> Result<String, BookError> {
    let (formula, number, name) = equations::label(latex).unwrap_or((latex, "", ""));
    let math = formula::mathml(formula, true)?;
    Ok(format!(
        "<div class=\"equation\" id=\"{number}\"><div class=\"formula\">{math}</div><div class=\"number\">{number} {name}</div></div>"
    ))
}

fn write(path: &Path, bytes: &[u8]) -> Result<(), BookError> {
    let failed = |error| BookError::File { path: path.to_owned(), error };
    path.parent().map_or(Ok(()), fs::create_dir_all).map_err(failed)?;
    fs::write(path, bytes).map_err(failed)
}

fn copy(from: &Path, to: &Path) -> Result<(), BookError> {
    let bytes = fs::read(from).map_err(|error| BookError::File { path: from.to_owned(), error })?;
    write(to, &bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A book of one chapter and one report, with all that is done to a text.
    #[test]
    fn reports_join_the_contents_and_links_lead_inside() {
        let (folder, out) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
        let file = |path: &str, text: &str| write(&folder.path().join(path), text.as_bytes()).unwrap();
        for path in ["docs/book/book.toml", "docs/book/book.css", "data/t.csv", "docs/p.svg"] {
            file(path, "x");
        }
        file("docs/book/src/SUMMARY.md", "# Summary\n\n- [A](a.md)\n{{reports}}\n");
        let a = "# A\n\nSee M.1, [b](../../b.md#two) and [t](../../../data/t.csv).\n\n$$ x < y \\tag{M.1 order} $$\n";
        file("docs/book/src/a.md", a);
        file("docs/b.md", "# B of all\n\n## Two\n\n![p](p.svg) [folder](../data)\n");
        assert_eq!(stage(folder.path(), out.path()).unwrap(), 2);
        let text = |path: &str| read(&out.path().join("src").join(path)).unwrap();
        assert!(text("SUMMARY.md").ends_with("- [A](a.md)\n- [B of all](reports/b.md)\n"));
        let a = text("a.md");
        assert!(a.contains("See [M.1](a.md#M.1), [b](reports/b.md#two) and [t](files/data/t.csv)."), "{a}");
        assert!(a.contains("id=\"M.1\"") && a.contains("M.1 order") && a.contains("&lt;") && !a.contains("$$"), "{a}");
        assert!(text("reports/b.md").contains("![p](../files/docs/p.svg) folder\n"), "{}", text("reports/b.md"));
        assert_eq!(text("files/data/t.csv"), "x");
        file("docs/b.md", "# B\n## Two\n[a](nowhere.svg)\n");
        let said = stage(folder.path(), out.path()).unwrap_err().to_string();
        assert_eq!(said, "docs/b.md: the link to nowhere.svg leads nowhere: there is no such file");
    }
}
