//! Scenarios: lineages with parameters that are grown and compared.

use super::{Lineage, TreeSettings};
use furrow_cell::CueError;
use furrow_input::{forbidden, shown};

/// One of several lineages that are grown and compared.
#[derive(Clone, Debug)]
pub struct Scenario {
    /// Name, unique among the scenarios.
    pub name: String,
    /// The name as a folder name, also unique.
    pub folder: String,
    /// Label of its lineage.
    pub label: String,
    /// The cue that replaces every cue of the lineage, as given but without its name; `None` if the lineage keeps its own cues.
    pub cue: Option<String>,
    /// The lineage with that cue.
    pub lineage: Lineage,
    /// Parameters of its divisions.
    pub settings: TreeSettings,
}

impl Scenario {
    /// Describes the scenario: its lineage and its cue.
    pub fn made_of(&self) -> String {
        let cue = self.cue.as_ref().map(|cue| format!(" with the cue {cue}"));
        format!("{}{}", self.label, cue.unwrap_or_default())
    }
}

/// Largest length of a cue's name on the command line, in characters.
const LONGEST: usize = 60;

/// Splits a cue in the user's notation, `NAME=CUE`, into name and cue. A name must not contain `: , +`, so
/// `tension:gradient,amplitude=0.3` has no name.
///
/// ```
/// use furrow_lineage::named_cue;
///
/// let cue = "tension:gradient,amplitude=0.3";
/// assert_eq!(named_cue("my tension=tension:gradient,amplitude=0.3")?, (Some("my tension"), cue));
/// assert_eq!(named_cue(cue)?, (None, cue));
/// # Ok::<(), furrow_cell::CueError>(())
/// ```
///
/// # Errors
/// A name that is empty, `none`, too long, or not printable.
pub fn named_cue(text: &str) -> Result<(Option<&str>, &str), CueError> {
    let Some((name, cue)) = text.split_once('=').filter(|(name, _)| !name.contains([':', ',', '+'])) else {
        return Ok((None, text));
    };
    let name = name.trim();
    let fits = !name.is_empty() && name != "none" && name.chars().count() <= LONGEST && forbidden(name).is_none();
    if fits {
        return Ok((Some(name), cue.trim()));
    }
    let allowed = format!("a name before =, other than none, of at most {LONGEST} printable characters");
    Err(CueError { field: "cue".to_owned(), value: shown(name), allowed })
}
