//! A lineage with its parameters, one of several that are grown and compared.

use super::{Lineage, TreeSettings};

/// One lineage of several that are grown and compared.
#[derive(Clone, Debug)]
pub struct Scenario {
    /// Unique among the scenarios, and fit to be the name of a folder.
    pub name: String,
    /// Label of its lineage.
    pub label: String,
    /// The cue that replaces every cue of the lineage, as it was asked for; none if the lineage keeps its own.
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
