//! Links: where those of a chapter lead inside the book.

use std::collections::BTreeMap;
use std::path::{Component, Path, PathBuf};

use crate::chapter::Piece;
use crate::{BookError, markdown};

/// What a link of the book leads to.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Target {
    /// Another site; as it is.
    Elsewhere,
    /// A chapter, as a path from the folder of the chapters, with the anchor if there is one.
    Chapter(PathBuf, Option<String>),
    /// A file of the repository, which the book brings along.
    File(PathBuf),
    /// Something of the repository that the book does not bring: a folder, or text that is no chapter. It is named, not linked.
    Outside,
}

/// Where every heading and every file of the book is.
#[derive(Clone, Debug, Default)]
pub struct Places {
    /// Chapter of each heading, by the file it is written in and its anchor.
    headings: BTreeMap<(PathBuf, String), PathBuf>,
    /// Text of each heading, by the file it is written in and its anchor.
    texts: BTreeMap<(PathBuf, String), String>,
    /// Chapter of each chapter's own file.
    files: BTreeMap<PathBuf, PathBuf>,
}

impl Places {
    /// The places of chapters, each given by its path in the book, its own file and its pieces.
    pub fn new<'c>(chapters: impl IntoIterator<Item = (&'c Path, &'c Path, &'c [Piece])>) -> Places {
        let mut places = Places::default();
        for (path, own, pieces) in chapters {
            places.files.insert(own.to_owned(), path.to_owned());
            for piece in pieces {
                // A heading is known by the file it is written in, and by the chapter that shows it.
                for heading in markdown::headings(&piece.text) {
                    let key = (piece.file.clone(), heading.anchor.clone());
                    places.texts.entry(key).or_insert_with(|| heading.text.clone());
                    for file in [piece.file.as_path(), own] {
                        let key = (file.to_owned(), heading.anchor.clone());
                        places.headings.entry(key).or_insert_with(|| path.to_owned());
                    }
                }
            }
        }
        places
    }

    /// The text of a heading in `file`, by its anchor.
    pub fn heading(&self, file: &Path, anchor: &str) -> Option<&str> {
        self.texts.get(&(file.to_owned(), anchor.to_owned())).map(String::as_str)
    }

    /// What a link in `file`, a path from `root`, leads to.
    ///
    /// # Errors
    /// Links to files or headings that are not there.
    pub fn target(&self, root: &Path, file: &Path, link: &str) -> Result<Target, BookError> {
        let wrong = |why| BookError::Link { file: file.to_owned(), target: link.to_owned(), why };
        if ["http://", "https://", "mailto:"].iter().any(|scheme| link.starts_with(scheme)) {
            return Ok(Target::Elsewhere);
        }
        let (path, anchor) = link.split_once('#').map_or((link, None), |(path, anchor)| (path, Some(anchor)));
        let path = if path.is_empty() { file.to_owned() } else { beside(file, path) };
        if let Some(anchor) = anchor {
            let key = (path.clone(), anchor.to_owned());
            if let Some(chapter) = self.headings.get(&key) {
                return Ok(Target::Chapter(chapter.clone(), Some(anchor.to_owned())));
            }
            let text = crate::read(&root.join(&path)).map_err(|_| wrong("there is no such file"))?;
            // A heading of a file that the book shows in part, or not at all.
            let there = markdown::headings(&text).into_iter().any(|heading| heading.anchor == anchor);
            return if there { Ok(Target::Outside) } else { Err(wrong("there is no such heading")) };
        }
        let found = root.join(&path);
        match self.files.get(&path) {
            Some(chapter) => Ok(Target::Chapter(chapter.clone(), None)),
            None if found.is_dir() || (found.is_file() && path.extension().is_some_and(|end| end == "md")) => {
                Ok(Target::Outside)
            }
            None if found.is_file() => Ok(Target::File(path)),
            None => Err(wrong("there is no such file")),
        }
    }
}

/// The path that a link `to` in `file` means, without `..`.
fn beside(file: &Path, to: &str) -> PathBuf {
    let mut path = file.parent().map(Path::to_path_buf).unwrap_or_default();
    for part in Path::new(to).components() {
        match part {
            Component::ParentDir => {
                path.pop();
            }
            Component::Normal(name) => path.push(name),
            _ => {}
        }
    }
    path
}

/// The way from one file to another, both from the same folder, as links write it.
pub fn way(from: &Path, to: &Path) -> String {
    let up = from.parent().map_or(0, |folder| folder.components().count());
    let names = to.components().map(|part| part.as_os_str().to_string_lossy().into_owned());
    std::iter::repeat_n("..".to_owned(), up).chain(names).collect::<Vec<_>>().join("/")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ways_and_neighbours() {
        assert_eq!(way(Path::new("guide/cues.md"), Path::new("theory/a.md")), "../theory/a.md");
        assert_eq!(way(Path::new("a.md"), Path::new("b.md")), "b.md");
        assert_eq!(beside(Path::new("docs/book/src/a.md"), "../../tree.svg"), Path::new("docs/tree.svg"));
    }

    #[test]
    fn links_lead_to_chapters_files_or_are_told() {
        let folder = tempfile::tempdir().unwrap();
        let root = folder.path();
        std::fs::write(root.join("G.md"), "## Cues\n## Left out\n").unwrap();
        std::fs::write(root.join("p.svg"), "").unwrap();
        let pieces = [Piece { file: "G.md".into(), text: "# Cues\n".into() }];
        let places = Places::new([(Path::new("cues.md"), Path::new("own.md"), pieces.as_slice())]);
        let target = |link: &str| places.target(root, Path::new("G.md"), link);
        assert_eq!(target("#cues").unwrap(), Target::Chapter("cues.md".into(), Some("cues".into())));
        assert_eq!(target("own.md#cues").unwrap(), target("#cues").unwrap());
        assert_eq!(target("own.md").unwrap(), Target::Chapter("cues.md".into(), None));
        assert_eq!(target("#left-out").unwrap(), Target::Outside);
        assert_eq!(target("p.svg").unwrap(), Target::File("p.svg".into()));
        assert_eq!(target("https://a.b/#c").unwrap(), Target::Elsewhere);
        for (link, why) in [("#no", "no such heading"), ("q.svg", "no such file"), ("q.md#a", "no such file")] {
            assert!(target(link).unwrap_err().to_string().contains(why), "{link}");
        }
    }
}
