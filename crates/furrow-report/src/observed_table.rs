//! Columns of the tables that set the rounds of founders beside the observed ones.

use furrow_formats::{FounderRow, founder_rows};
use furrow_lineage::{ObservedRounds, Rounds, Tree};

/// Heading, width in text, and the text of a value.
pub type Column<T> = (&'static str, usize, fn(&T) -> String);

/// Counts of the model.
pub const MODEL: [Column<Rounds>; 6] = [
    ("min", 3, |r| r.min.to_string()),
    ("mean", 6, |r| decimals(Some(r.mean), 2)),
    ("max", 3, |r| r.max.to_string()),
    ("full", 4, |r| r.full_doublings.to_string()),
    ("sym", 3, |r| r.symmetric.to_string()),
    ("cells", 5, |r| r.terminal.to_string()),
];

/// Observed counts; unknown ones are empty.
pub const OBSERVED: [Column<ObservedRounds>; 5] = [
    ("min", 3, |o| whole(o.min)),
    ("mean", 6, |o| o.mean.map_or(String::new(), |mean| decimals(Some(mean), 2))),
    ("max", 3, |o| whole(o.max)),
    ("full", 4, |o| whole(o.full_doublings)),
    ("cells", 5, |o| whole(o.terminal)),
];

fn whole(value: Option<u32>) -> String {
    value.map_or(String::new(), |value| value.to_string())
}

/// A number with the given number of decimals, or a dash.
pub fn decimals(value: Option<f64>, digits: usize) -> String {
    value.map_or("-".to_owned(), |v| format!("{v:.digits$}"))
}

/// The observed columns in which some founder has a number.
pub fn observed_columns(rows: &[FounderRow]) -> Vec<Column<ObservedRounds>> {
    let known =
        |text: fn(&ObservedRounds) -> String| rows.iter().flat_map(|row| row.observed).any(|o| !text(&o).is_empty());
    OBSERVED.into_iter().filter(|(_, _, text)| known(*text)).collect()
}

/// Columns of a scenario.
pub const SCENARIO: [&str; 5] = ["min", "mean", "max", "χ", "cells"];

/// Columns of observed counts beside scenarios.
pub const OBSERVED_BESIDE: [&str; 4] = ["min", "mean", "max", "cells"];

/// A founder in one scenario.
pub struct Entry {
    /// The text of each column of [`SCENARIO`].
    pub texts: [String; 5],
    /// Whether each text differs from the first scenario's.
    pub differs: [bool; 5],
}

/// A founder in all scenarios.
pub struct FounderLine {
    /// Its name.
    pub name: String,
    /// Its entry in every scenario, in order.
    pub entries: Vec<Entry>,
    /// Texts of [`OBSERVED_BESIDE`], from the first scenario with observed counts.
    pub observed: Option<[String; 4]>,
}

impl FounderLine {
    /// The text of a column of [`OBSERVED_BESIDE`].
    pub fn observed_text(&self, column: usize) -> &str {
        self.observed.as_ref().map_or("", |texts| &texts[column])
    }
}

/// The founders of several trees in order of first appearance. A founder has no numbers in a scenario without it.
pub fn founder_lines(trees: &[Tree]) -> Vec<FounderLine> {
    let rows: Vec<Vec<FounderRow>> = trees.iter().map(founder_rows).collect();
    let mut names: Vec<&str> = Vec::new();
    for row in rows.iter().flatten() {
        if !names.contains(&row.name.as_str()) {
            names.push(&row.name);
        }
    }
    let line = |name: &str| {
        let found: Vec<Option<&FounderRow>> =
            rows.iter().map(|rows| rows.iter().find(|row| row.name == name)).collect();
        let texts: Vec<[String; 5]> = found.iter().map(|row| texts(*row)).collect();
        let entry = |own: &[String; 5]| Entry {
            texts: own.clone(),
            differs: std::array::from_fn(|column| own[column] != texts[0][column]),
        };
        let observed = found.iter().flatten().find_map(|row| row.observed).map(|observed| {
            let [min, mean, max, _, cells] = OBSERVED.map(|(_, _, text)| text(&observed));
            [min, mean, max, cells]
        });
        FounderLine { name: name.to_owned(), entries: texts.iter().map(entry).collect(), observed }
    };
    names.into_iter().map(line).collect()
}

/// The columns of [`SCENARIO`]; dashes for a founder that was not born, empty for one outside the lineage.
fn texts(row: Option<&FounderRow>) -> [String; 5] {
    let Some(row) = row else { return Default::default() };
    let Some(rounds) = row.rounds else { return std::array::from_fn(|_| "-".to_owned()) };
    let [min, mean, max, _, _, cells] = MODEL.map(|(_, _, text)| text(&rounds));
    [min, mean, max, decimals(row.chi, 3), cells]
}
