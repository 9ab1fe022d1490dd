//! Cells with other names than the lineage's, matched to its cells.
//!
//! | file | content |
//! |---|---|
//! | `map` | tables that give tracked cells their names |
//! | `topology` | the cells below a root: which daughter is which |
//! | `order` | known orders of sisters' divisions |
//! | `report` | how cells were matched, as data and as text |
//!
//! A table names single cells. A root is a tracked cell with a name; the cells below it get theirs by their divisions: of two daughters
//! the larger one gets the name of the larger founder, or the first letter. Of two that are nearly equal or have no sizes, the one that
//! divides first gets the name of the cell that is known to divide first.

mod map;
mod order;
mod report;
mod topology;

use std::path::Path;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering};

use furrow_input::{InputError, open_file};

pub use report::{By, Matched, MatchedDivision, MatchedRoot, Unmatched};

use crate::names::Names;
use crate::tracked::TrackedLineage;
use map::NameMap;

/// How cells with other names are matched to the cells of a lineage.
#[derive(Debug, Default, PartialEq)]
pub struct Matching {
    map: NameMap,
    roots: Vec<Root>,
    /// What errors call the roots.
    source: String,
    /// The first value that could not be used, for errors: a missing cell may have been there.
    skipped: OnceLock<String>,
}

/// A tracked cell with a name, below which names follow from divisions.
#[derive(Debug)]
struct Root {
    /// The cell's name in the file of the tracking program; `None` for the only cell without a mother.
    tracked: Option<String>,
    /// Its name in the lineage.
    name: String,
    /// Whether an embryo has the cell.
    met: AtomicBool,
}

impl PartialEq for Root {
    fn eq(&self, other: &Root) -> bool {
        (&self.tracked, &self.name) == (&other.tracked, &other.name)
    }
}

impl Matching {
    /// Reads a table with the columns `tracked` and `name` and optionally `embryo`, and roots that are written `TRACKED=NAME`, or `NAME`
    /// for the only cell of an embryo that has no mother. Errors call the roots `source_name`.
    ///
    /// # Errors
    /// A table without these columns; a cell or a name that is given twice; a root without a name.
    pub fn read(map: Option<&Path>, roots: &[String], source_name: &str) -> Result<Matching, InputError> {
        let map = map.map(|path| NameMap::read(open_file(path)?, &path.display().to_string())).transpose()?;
        Matching::of(map.unwrap_or_default(), roots, source_name)
    }

    /// As [`Matching::read`], with a table as text, which errors call `file`.
    ///
    /// # Errors
    /// As [`Matching::read`].
    pub fn parse(text: &str, file: &str, roots: &[String], source_name: &str) -> Result<Matching, InputError> {
        Matching::of(NameMap::read(text.as_bytes(), file)?, roots, source_name)
    }

    fn of(map: NameMap, roots: &[String], source_name: &str) -> Result<Matching, InputError> {
        let mut matching = Matching { map, source: source_name.to_owned(), ..Matching::default() };
        for text in roots {
            let (tracked, name) = match text.rsplit_once('=') {
                Some((tracked, name)) => (Some(tracked.trim().to_owned()), name.trim().to_owned()),
                None => (None, text.trim().to_owned()),
            };
            let is_empty = name.is_empty() || tracked.as_ref().is_some_and(String::is_empty);
            let allowed = "TRACKED=NAME, or NAME for the only cell without a mother";
            InputError::require(!is_empty, source_name, "root", format!("{text:?}"), allowed)?;
            let same = |root: &Root| root.name == name || root.tracked == tracked;
            let allowed = "another cell and another name than the roots before";
            InputError::require(!matching.roots.iter().any(same), source_name, "root", format!("{text:?}"), allowed)?;
            matching.roots.push(Root { tracked, name, met: AtomicBool::new(false) });
        }
        Ok(matching)
    }

    /// Whether it matches nothing.
    pub fn is_empty(&self) -> bool {
        self.map.rows.is_empty() && self.roots.is_empty()
    }

    /// Requires that the names are of cells of the lineage, and writes them as it does.
    pub(crate) fn understand(&mut self, names: &Names) -> Result<(), InputError> {
        self.map.understand(names)?;
        for root in &mut self.roots {
            let refused = |allowed: String| {
                InputError::not_allowed(&self.source, "name of a root", format!("{:?}", root.name), allowed)
            };
            root.name = names.known(&root.name).map_err(refused)?;
        }
        Ok(())
    }

    /// The name that the table gives a cell of an embryo.
    pub(crate) fn name_of(&self, embryo: &str, tracked: &str) -> Option<&str> {
        self.map.name_of(embryo, tracked)
    }

    /// Notes what could not be used of an embryo.
    fn note_skipped(&self, embryo: &TrackedLineage) {
        if let Some(first) = embryo.skipped.first() {
            let text =
                || format!(" (what could not be used may have it: the first of {} is {first})", embryo.skipped_count);
            self.skipped.get_or_init(text);
        }
    }

    /// What could not be used, at the end of an error about a cell that is missing.
    fn after_skipping(&self) -> &str {
        self.skipped.get().map_or("", String::as_str)
    }

    /// Requires that each name of a tracked cell was met.
    pub(crate) fn require_met(&self) -> Result<(), InputError> {
        self.map.require_met(self.after_skipping())?;
        let Some(root) = self.roots.iter().find(|root| !root.met.load(Ordering::Relaxed)) else { return Ok(()) };
        let (value, allowed) = match &root.tracked {
            Some(tracked) => (tracked, format!("a cell of a tracked embryo{}", self.after_skipping())),
            None => {
                let allowed = "given with an embryo that has mothers and daughters; a table of cells has none";
                (&root.name, allowed.to_owned())
            }
        };
        Err(InputError::not_allowed(&self.source, "root", format!("{value:?}"), allowed))
    }
}
