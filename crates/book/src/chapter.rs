//! A chapter: what its own file says, and sections of other files that it stands for.

use std::path::{Path, PathBuf};

use crate::{BookError, markdown, read};

/// Text from one file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Piece {
    /// The file, from the folder of the whole; links are relative to it.
    pub file: PathBuf,
    /// The text.
    pub text: String,
}

/// Reads a chapter of the folder `root`, with every line `{{section FILE#ANCHOR}}` replaced by that section.
///
/// FILE is a path from `root`; without an anchor the line stands for all of it. A section that nothing stands before becomes the chapter's title, and what is below it moves up
/// with it; further ones keep their level.
///
/// # Errors
/// Files that cannot be read, sections that are not there, lines that begin with `{{` and are no such line.
pub fn read_chapter(root: &Path, chapter: &Path) -> Result<Vec<Piece>, BookError> {
    let text = read(&root.join(chapter))?;
    let mut pieces = Vec::new();
    let mut own = String::new();
    for line in text.lines() {
        let Some(inside) = line.strip_prefix("{{") else {
            own.push_str(line);
            own.push('\n');
            continue;
        };
        let named = inside.strip_suffix("}}").and_then(|inside| inside.strip_prefix("section "));
        let Some(name) = named else {
            return Err(BookError::Line { chapter: chapter.to_owned(), line: line.to_owned() });
        };
        let (file, anchor) = name.split_once('#').unwrap_or((name, ""));
        let first = pieces.is_empty() && own.trim().is_empty();
        pieces.push(Piece { file: chapter.to_owned(), text: std::mem::take(&mut own) });
        pieces.push(section(root, chapter, file, anchor, first)?);
    }
    pieces.push(Piece { file: chapter.to_owned(), text: own });
    pieces.retain(|piece| !piece.text.trim().is_empty());
    Ok(pieces)
}

fn section(root: &Path, chapter: &Path, file: &str, anchor: &str, first: bool) -> Result<Piece, BookError> {
    let text = read(&root.join(file))?;
    if anchor.is_empty() {
        return Ok(Piece { file: file.into(), text });
    }
    let missing = || BookError::Section { chapter: chapter.to_owned(), file: file.into(), anchor: anchor.to_owned() };
    let found = markdown::section(&text, anchor).ok_or_else(missing)?;
    let level = markdown::headings(found).first().map_or(1, |heading| heading.level);
    let text = markdown::promoted(found, if first { level - 1 } else { level.saturating_sub(2) });
    Ok(Piece { file: file.into(), text: format!("{}\n", text.trim_end()) })
}

/// The chapters that a table of contents names, in order, as paths from the folder of the chapters.
pub fn contents(summary: &str) -> Vec<PathBuf> {
    let links = markdown::marks(summary).into_iter().filter_map(|(mark, _)| match mark {
        markdown::Mark::Link(target) => Some(PathBuf::from(target)),
        _ => None,
    });
    links.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sections_take_the_place_of_their_lines() {
        let folder = tempfile::tempdir().unwrap();
        let root = folder.path();
        std::fs::write(root.join("G.md"), "# G\n## Cues\nof cues\n### More\nmore\n## End\n").unwrap();
        std::fs::write(root.join("c.md"), "{{section G.md#cues}}\n\nbetween\n{{section G.md#more}}\n").unwrap();
        let pieces = read_chapter(root, Path::new("c.md")).unwrap();
        let texts: Vec<&str> = pieces.iter().map(|piece| piece.text.as_str()).collect();
        assert_eq!(texts, ["# Cues\nof cues\n## More\nmore\n", "\nbetween\n", "## More\nmore\n"]);
        std::fs::write(root.join("c.md"), "{{section G.md#none}}\n").unwrap();
        let said = read_chapter(root, Path::new("c.md")).unwrap_err().to_string();
        assert_eq!(said, "c.md: G.md has no section #none");
        std::fs::write(root.join("c.md"), "{{include x}}\n").unwrap();
        assert!(read_chapter(root, Path::new("c.md")).unwrap_err().to_string().contains("is not understood"));
    }
}
