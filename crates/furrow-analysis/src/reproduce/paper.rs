//! The paper's statements by figure.

use furrow_input::{InputError, parse_document};
use furrow_mechanics::calibration::statements::HigherFold;
use furrow_mechanics::equilibria::Criticality;
use serde::Deserialize;
use std::collections::{BTreeMap, HashSet};

/// The statements, as shipped.
const PAPER: &str = include_str!("../../data/paper.ron");
/// Its name in errors.
const FILE: &str = "paper.ron";

/// A number that the paper prints.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Printed {
    /// The number.
    pub value: f64,
    /// Relative deviation up to which a computed one agrees; of a 0 the absolute one.
    pub tolerance: f64,
}

impl Printed {
    /// The deviation of a computed number: relative, or absolute where 0 is printed.
    pub fn deviation(&self, computed: f64) -> f64 {
        if self.value == 0.0 { computed.abs() } else { (computed / self.value - 1.0).abs() }
    }
}

/// The cell that a statement is about.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct OfCell {
    /// Radius R0, in L_h.
    pub r0: f64,
    /// Volume fraction ε.
    pub epsilon: f64,
}

/// A shipped sweep.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Study {
    /// χ over R0.
    Size,
    /// χ over ε.
    Confinement,
    /// χ over the cue's place.
    CuePosition,
    /// χ over R0, with the cue.
    CueSize,
    /// χ over ε, with the cue.
    CueConfinement,
}

/// What χ over an axis must do within a range.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Criterion {
    /// All divisions fail up to a place in the range, and none above it.
    Rest,
    /// All divisions are equal.
    Halves,
    /// χ falls, from above 0.8 to below 0.7.
    Falling,
    /// χ rises, from above 0.5.
    Tightening,
    /// χ stays within 15 % of the middle of its values.
    Flat,
    /// χ is proportional to the cue's distance from the middle, within 10 %.
    Proportional,
    /// Every furrow is nearer to the middle than its cue.
    FurrowShort,
    /// Every furrow is farther from the middle than its cue.
    FurrowBeyond,
    /// χ falls to a third between the ends of the range.
    Steep,
    /// χ rises.
    Rising,
}

/// A statement on χ over one axis of a sweep.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct OverAxis {
    /// The sweep.
    pub study: Study,
    /// Values of its other axes.
    #[serde(default)]
    pub held: BTreeMap<String, f64>,
    /// The part of the axis that counts.
    pub range: [f64; 2],
    /// What χ must do there.
    pub criterion: Criterion,
    /// Whether the published scheme is compared too.
    #[serde(default)]
    pub both_schemes: bool,
    /// A remark on the result.
    pub note: Option<String>,
}

/// One statement of the paper, or a computable quantity of which the paper's words are not known.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Statement {
    /// Its name, unique.
    pub id: String,
    /// The figure, table or movie, as `2A`, `2C-F`, `S5`, `Table S3`, `Movie 1`.
    pub figure: String,
    /// Its subject.
    pub quantity: String,
    /// The paper's words; empty where it prints a number, or where they are not known.
    #[serde(default)]
    pub says: String,
    /// When a result counts as agreeing.
    pub criterion: String,
    /// The number that it prints.
    pub printed: Option<Printed>,
    /// The cell.
    pub cell: Option<OfCell>,
    /// What it says of χ over an axis.
    pub over: Option<OverAxis>,
    /// Of a pitchfork, its kind.
    pub kind: Option<Criticality>,
    /// Of a branch with two folds, which of them is higher.
    pub higher: Option<HigherFold>,
    /// The name of a constant.
    pub constant: Option<String>,
    /// Why there is no verdict, if there is none.
    pub open: Option<String>,
}

#[derive(Deserialize)]
#[serde(rename = "Paper", deny_unknown_fields)]
struct Paper {
    statements: Vec<Statement>,
}

/// All statements, in the order of the figures.
///
/// # Errors
/// None, as long as the shipped file is one.
pub fn statements() -> Result<Vec<Statement>, InputError> {
    let found: Paper = parse_document(PAPER, FILE, "statements of the paper", "Paper")?;
    let mut ids = HashSet::new();
    for statement in &found.statements {
        check(statement, ids.insert(statement.id.as_str()))?;
    }
    Ok(found.statements)
}

fn check(statement: &Statement, new: bool) -> Result<(), InputError> {
    let refuse = |field: &str, value: String, allowed: &str| {
        Err(InputError::not_allowed(FILE, format!("{}.{field}", statement.id), value, allowed))
    };
    if !new {
        return refuse("id", statement.id.clone(), "a name that no other statement has");
    }
    if let Some(Printed { value, tolerance }) = statement.printed
        && !(value.is_finite() && tolerance.is_finite() && tolerance >= 0.0)
    {
        return refuse("printed", format!("({value}, {tolerance})"), "a finite value and a tolerance of 0 or above");
    }
    if statement.says.is_empty() && statement.printed.is_none() && statement.open.is_none() {
        return refuse("says", "\"\"".to_owned(), "what the paper says, unless it prints a number or that is open");
    }
    Ok(())
}

/// A name in lower case, without blanks, with plain hyphens, for comparison.
fn plain(name: &str) -> String {
    let letters = name.chars().filter(|c| !c.is_whitespace()).flat_map(char::to_lowercase);
    letters.map(|c| if matches!(c, '–' | '−' | '_') { '-' } else { c }).collect()
}

/// Whether a figure is meant by what a user wrote: by its own name, by that of one of its panels (`2D` of `2C-F`), or by the
/// number of the whole (`2` of `2A`, `movies` of `Movie 1`).
pub fn means(wanted: &str, figure: &str) -> bool {
    let (wanted, figure) = (plain(wanted), plain(figure));
    if wanted == figure || (wanted == "movies" && figure.starts_with("movie")) {
        return true;
    }
    if !wanted.is_empty()
        && wanted.ends_with(|c: char| c.is_ascii_digit())
        && let Some(rest) = figure.strip_prefix(&wanted)
    {
        return rest.starts_with(|c: char| c.is_ascii_alphabetic());
    }
    let panels = |(first, last): (&str, &str)| {
        let from = first.chars().next_back()?;
        let mut panel = wanted.strip_prefix(first.strip_suffix(from)?)?.chars();
        Some((from..=last.chars().next()?).contains(&panel.next()?) && panel.next().is_none())
    };
    figure.split_once('-').and_then(panels).unwrap_or(false)
}

/// The statements that belong to any of the figures named; all where none is.
///
/// # Errors
/// A name is that of none of them.
pub fn selected(wanted: &[String]) -> Result<Vec<Statement>, InputError> {
    let mut found = statements()?;
    for name in wanted {
        if !found.iter().any(|statement| means(name, &statement.figure)) {
            let mut figures: Vec<&str> = found.iter().map(|statement| statement.figure.as_str()).collect();
            figures.dedup();
            let allowed = format!("one of {}, a panel such as 2D, or a whole such as 2 or movies", figures.join(", "));
            return Err(InputError::not_allowed("FIGURE", "figure", format!("{name:?}"), allowed));
        }
    }
    if !wanted.is_empty() {
        found.retain(|statement| wanted.iter().any(|name| means(name, &statement.figure)));
    }
    Ok(found)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures_are_meant_by_panels_and_by_the_whole() {
        let meant = "2A=2A 2a=2A 2=2A 2=2C-F 2d=2C-F 2C–F=2C-F s5=S5 Table~S3=Table~S3 tables3=Table~S3 \
                     movies=Movie~3 movie3=Movie~3 7=7";
        let others = "2B=2C-F 2G=2C-F S=S5 3=S3 S3=Table~S3 movie=Movie~3 =2A 2CD=2C-F";
        for (pairs, expected) in [(meant, true), (others, false)] {
            for (wanted, figure) in pairs.split(' ').filter_map(|pair| pair.split_once('=')) {
                let [wanted, figure] = [wanted, figure].map(|name| name.replace('~', " "));
                assert_eq!(means(&wanted, &figure), expected, "{wanted} {figure}");
            }
        }
    }

    #[test]
    fn a_figure_that_is_none_is_refused_with_those_that_are() {
        let error = selected(&["9Z".to_owned()]).unwrap_err().to_string();
        assert!(error.contains("\"9Z\"") && error.contains("2C-F") && error.contains("Movie 4"), "{error}");
        assert!(selected(&["2".to_owned()]).unwrap().iter().all(|statement| statement.figure.starts_with('2')));
        assert_eq!(selected(&[]).unwrap(), statements().unwrap());
    }
}
