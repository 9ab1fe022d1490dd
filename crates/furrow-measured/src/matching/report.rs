//! How cells were matched, as data and as text.

use std::fmt;

use furrow_input::listed;
use serde::Serialize;

/// What decided which daughter is which.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum By {
    /// A daughter has a name of her own, or one that a table gives.
    Names,
    /// Sizes are nearly equal or not known: the one that divides first is the cell with the shorter lifetime.
    Divisions,
    /// The order of divisions is not known: only one of them divides, and has all the generations of founders that the lineage lists
    /// below one of the names.
    Descendants,
    /// The larger one is the larger founder, or has the first letter.
    Sizes,
    /// Nothing distinguishes the names but their letters: the one that comes first in the file has the first letter.
    Order,
}

impl By {
    const ALL: [(By, &'static str); 5] = [
        (By::Names, "by names"),
        (By::Divisions, "by the order of their divisions"),
        (By::Descendants, "by their descendants"),
        (By::Sizes, "by sizes"),
        (By::Order, "by their order in the file"),
    ];
}

/// A cell below which names follow from divisions.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct MatchedRoot {
    /// Its name in the file of the tracking program.
    pub tracked: String,
    /// Its name in the lineage.
    pub name: String,
}

/// A division below a root.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MatchedDivision {
    /// The mother's name in the lineage.
    pub mother: String,
    /// Her name in the file of the tracking program.
    pub tracked: String,
    /// Her daughters' names in the lineage.
    pub daughters: [String; 2],
    /// Their names in the file of the tracking program.
    pub tracked_daughters: [String; 2],
    /// What decided which daughter is which.
    pub by: By,
    /// |V₁ − V₂|/(V₁ + V₂), where sizes are known.
    pub chi: Option<f64>,
}

/// A cell below a root; its daughters have no names.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Unmatched {
    /// The mother's name in the lineage.
    pub mother: String,
    /// Her name in the file of the tracking program.
    pub tracked: String,
    /// Why her daughters were not matched.
    pub why: String,
}

/// How the cells of an embryo were matched to the lineage.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Matched {
    /// The embryo.
    pub embryo: String,
    /// Cells with a name from the table.
    pub by_table: usize,
    /// Roots.
    pub roots: Vec<MatchedRoot>,
    /// Divisions below roots, mothers before daughters.
    pub divisions: Vec<MatchedDivision>,
    /// Cells below roots, where the daughters could not be matched.
    pub unmatched: Vec<Unmatched>,
    /// Cells without a name in the lineage.
    pub without_name: usize,
}

/// Sisters with a smaller χ are nearly equal: errors of volumes of 5 % make as much.
pub(super) const NEARLY_EQUAL: f64 = 0.05;

/// Cells that the text lists.
const MOST: usize = 5;

impl fmt::Display for Matched {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Matched { embryo, by_table, roots, divisions, unmatched, without_name } = self;
        writeln!(f, "cells of {embryo} matched; {without_name} have no name in the lineage")?;
        if *by_table > 0 {
            writeln!(f, "  {by_table} by the table of names")?;
        }
        for MatchedRoot { tracked, name } in roots {
            writeln!(f, "  root {tracked} = {name}")?;
        }
        for (by, words) in By::ALL {
            let of = || divisions.iter().filter(|division| division.by == by);
            let those = |near: bool| {
                let near = of().filter(|division| !near || division.chi.is_some_and(|chi| chi < NEARLY_EQUAL));
                near.map(|division| division.mother.as_str()).collect::<Vec<_>>()
            };
            let all = those(false);
            if !all.is_empty() {
                write!(f, "  daughters of {} {words}: {}", all.len(), listed(all.iter().copied(), ", "))?;
                let near = if by == By::Sizes { those(true) } else { Vec::new() };
                if !near.is_empty() {
                    let shown = listed(near.iter().copied(), ", ");
                    write!(
                        f,
                        "; {} of them nearly equal (χ below {NEARLY_EQUAL}), where noise may decide: {shown}",
                        near.len()
                    )?;
                }
                writeln!(f)?;
            }
        }
        for Unmatched { mother, tracked, why } in unmatched.iter().take(MOST) {
            writeln!(f, "  not matched: the daughters of {mother} ({tracked}): {why}")?;
        }
        match unmatched.len().saturating_sub(MOST) {
            0 => Ok(()),
            more => writeln!(f, "  and {more} more (--json lists them)"),
        }
    }
}
