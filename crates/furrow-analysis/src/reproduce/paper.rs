//! The paper's statements by figure.

use furrow_input::{InputError, parse_document};
use furrow_mechanics::calibration::statements::{FurrowPlace, HigherFold};
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
    /// χ over the cue's place, for three widths.
    CueWidth,
    /// χ over the cue's place, for three amplitudes.
    CueAmplitude,
    /// χ over R0, with the cue.
    CueSize,
    /// χ over ε, with the cue.
    CueConfinement,
}

/// What χ over an axis must do within a range.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Criterion {
    /// All divisions fail up to a place in the range, and above it all succeed.
    Rest,
    /// All divisions are equal.
    Halves,
    /// χ falls.
    Falling,
    /// χ rises.
    Rising,
    /// χ stays within 15 % of the middle of its values.
    Flat,
    /// χ falls to a third between the ends of the range.
    Steep,
    /// χ is proportional to the cue's distance from the middle, within 15 %.
    Proportional,
    /// Mean χ over the cue's distance from the middle falls from each width of the cue to the next.
    Flatter,
    /// Every furrow has this place beside its cue.
    Furrow(FurrowPlace),
}

/// What must be true of the stationary shapes of a cell, or of its divisions near them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Check {
    /// The first pitchfork lies at the printed ξ_s.
    Threshold,
    /// The kind of the first pitchfork.
    Kind(Criticality),
    /// The asymmetric branch opens with the printed exponent.
    Exponent,
    /// ξ_s = 25 lies below the first pitchfork.
    Below,
    /// ξ_s = 25 lies between pitchfork and fold.
    Window,
    /// Divisions next to pitchfork and fold end as the branches say.
    Regimes,
    /// Two symmetric shapes are stable at the same ξ_s.
    Bistable,
    /// Which of two folds is higher.
    Folds(HigherFold),
    /// How divisions end as ξ_s rises.
    Outcomes(Transition),
}

/// Outcomes as ξ_s rises.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Transition {
    /// Failed, asymmetric, symmetric.
    WithWindow,
    /// Failed, symmetric.
    WithoutWindow,
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
    /// Whether the published scheme is compared too, at both of its time steps.
    #[serde(default)]
    pub both_schemes: bool,
}

/// One statement of the paper.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Statement {
    /// Its name, unique.
    pub id: String,
    /// The figure, table or movie, as `2A`, `S5`, `Table S3`, `Movie 1`; `1` for statements of the text about figure 1.
    pub figure: String,
    /// Its subject.
    pub quantity: String,
    /// The paper's statement, in our words; empty where it prints a number.
    #[serde(default)]
    pub says: String,
    /// When a result counts as agreeing.
    pub criterion: String,
    /// The number that it prints.
    pub printed: Option<Printed>,
    /// The cell.
    pub cell: Option<OfCell>,
    /// Its statement about χ over an axis.
    pub over: Option<OverAxis>,
    /// What must be true of its stationary shapes.
    pub check: Option<Check>,
    /// The reason why it is set apart, if it is: it is then neither judged nor counted.
    pub apart: Option<String>,
}

#[derive(Deserialize)]
#[serde(rename = "Paper", deny_unknown_fields)]
struct Paper {
    statements: Vec<Statement>,
}

/// All statements, in the order of the figures.
///
/// # Errors
/// Only if the shipped file is invalid.
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
    if statement.says.is_empty() && statement.printed.is_none() {
        return refuse("says", "\"\"".to_owned(), "what the paper says, unless it prints a number");
    }
    Ok(())
}

/// A name in lower case, without blanks, with plain hyphens, for comparison.
fn plain(name: &str) -> String {
    let letters = name.chars().filter(|c| !c.is_whitespace()).flat_map(char::to_lowercase);
    letters.map(|c| if matches!(c, '–' | '−' | '_') { '-' } else { c }).collect()
}

/// Whether a user's text means a figure: by the figure's own name, or by the number of the whole (`2` of `2A`, `movies` of
/// `Movie 1`).
pub fn means(wanted: &str, figure: &str) -> bool {
    let (wanted, figure) = (plain(wanted), plain(figure));
    let is_number = wanted.ends_with(|c: char| c.is_ascii_digit());
    let panel = |rest: &str| rest.starts_with(|c: char| c.is_ascii_alphabetic());
    wanted == figure
        || (wanted == "movies" && figure.starts_with("movie"))
        || (is_number && figure.strip_prefix(&wanted).is_some_and(panel))
}

/// The statements that belong to any of the named figures; all statements without names.
///
/// # Errors
/// A name belongs to no figure.
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
        let meant = "2A=2A 2a=2A 2=2A 2=2L 1=1 1=1B s5=S5 Table~S3=Table~S3 tables3=Table~S3 \
                     movies=Movie~3 movie3=Movie~3";
        let others = "2B=2C 1B=1 S=S5 3=S3 S3=Table~S3 movie=Movie~3 =2A 2CD=2C";
        for (pairs, expected) in [(meant, true), (others, false)] {
            for (wanted, figure) in pairs.split(' ').filter_map(|pair| pair.split_once('=')) {
                let [wanted, figure] = [wanted, figure].map(|name| name.replace('~', " "));
                assert_eq!(means(&wanted, &figure), expected, "{wanted} {figure}");
            }
        }
    }

    #[test]
    fn an_unknown_figure_is_refused_with_the_known_ones() {
        let error = selected(&["9Z".to_owned()]).unwrap_err().to_string();
        assert!(error.contains("\"9Z\"") && error.contains("2C") && error.contains("Movie 4"), "{error}");
        assert!(selected(&["2".to_owned()]).unwrap().iter().all(|statement| statement.figure.starts_with('2')));
        assert_eq!(selected(&[]).unwrap(), statements().unwrap());
    }
}
