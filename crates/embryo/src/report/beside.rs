//! What is set side by side of several scenarios: the same columns for the table on the page and for the one in a terminal.

use super::table::decimals;
use crate::io::{FounderRow, founder_rows};
use crate::lineage::{ObservedRounds, Tree};

/// Columns of a scenario.
pub const MODEL: [&str; 5] = ["min", "mean", "max", "χ", "cells"];

/// A founder in one scenario.
pub struct Entry {
    /// The text of each column of [`MODEL`].
    pub texts: [String; 5],
    /// Which of them differ from those of the first scenario.
    pub differs: [bool; 5],
}

/// A founder in all scenarios.
pub struct FounderLine {
    /// Its name.
    pub name: String,
    /// In every scenario, in their order.
    pub entries: Vec<Entry>,
    /// Observed counts: those of the first scenario that has any.
    pub observed: Option<ObservedRounds>,
}

/// The founders of several trees, those of the first one first. A founder that is not in a scenario has no numbers there.
pub fn founder_lines(trees: &[Tree]) -> Vec<FounderLine> {
    let rows: Vec<Vec<FounderRow>> = trees.iter().map(founder_rows).collect();
    let mut names: Vec<&str> = Vec::new();
    for row in rows.iter().flatten() {
        if !names.contains(&row.name.as_str()) {
            names.push(&row.name);
        }
    }
    let line = |name: &str| {
        let of = |rows: &'_ Vec<FounderRow>| rows.iter().position(|row| row.name == name);
        let found: Vec<Option<&FounderRow>> = rows.iter().map(|rows| of(rows).map(|k| &rows[k])).collect();
        let texts: Vec<[String; 5]> = found.iter().map(|row| texts(*row)).collect();
        let differs = |k: usize| std::array::from_fn(|column| texts[k][column] != texts[0][column]);
        let entries = (0..texts.len()).map(|k| Entry { texts: texts[k].clone(), differs: differs(k) }).collect();
        let observed = found.iter().flatten().find_map(|row| row.observed);
        FounderLine { name: name.to_owned(), entries, observed }
    };
    names.into_iter().map(line).collect()
}

/// The columns of [`MODEL`]; a founder that was not born has dashes, one that is not in the lineage has nothing.
fn texts(row: Option<&FounderRow>) -> [String; 5] {
    let Some(row) = row else { return Default::default() };
    let Some(rounds) = row.rounds else { return std::array::from_fn(|_| "-".to_owned()) };
    [
        rounds.min.to_string(),
        format!("{:.2}", rounds.mean),
        rounds.max.to_string(),
        decimals(row.chi, 3),
        rounds.terminal.to_string(),
    ]
}

/// Columns of the observed counts: their headings and what they say of a founder, empty where that is not known.
pub const OBSERVED: [&str; 4] = ["min", "mean", "max", "cells"];

/// The texts of [`OBSERVED`].
pub fn observed_texts(observed: Option<ObservedRounds>) -> [String; 4] {
    let Some(ObservedRounds { min, mean, max, terminal, .. }) = observed else { return Default::default() };
    let whole = |count: Option<u32>| count.map_or(String::new(), |count| count.to_string());
    [whole(min), mean.map_or(String::new(), |mean| format!("{mean:.2}")), whole(max), whole(terminal)]
}
