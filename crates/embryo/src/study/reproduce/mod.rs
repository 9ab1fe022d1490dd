//! The paper reproduced: every statement of it that computation can reach, beside what is computed.
//!
//! | file | what it says |
//! |---|---|
//! | [`paper`] | what the paper says, from `data/paper.ron`, and which figure it belongs to |
//! | [`lab`] | what results are computed with, and what is found |
//! | `series` | rows of sweeps as they are judged |
//! | `films`, `size`, `branches`, `confinement`, `cues`, `embryo`, `perturbed`, `constants` | the figures |
//!
//! ```
//! use std::sync::atomic::AtomicBool;
//!
//! use furrow::batch::{Memo, Quantisation};
//! use furrow::settings::Settings;
//! use furrow::study::reproduce::{Lab, paper::selected, reproduce};
//!
//! static STOP: AtomicBool = AtomicBool::new(false);
//! let (settings, memo) = (Settings::default(), Memo::new(Quantisation::DEFAULT));
//! let lab = Lab { settings: &settings, memo: &memo, threads: 0, interrupt: &STOP, progress: &|_| () };
//! let found = reproduce(&lab, &selected(&["S4".to_owned()])?)?;
//! assert!(found.items.iter().all(|item| item.pass));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod branches;
mod confinement;
mod constants;
mod cues;
mod embryo;
mod films;
pub mod lab;
pub mod paper;
mod perturbed;
mod series;
mod size;

use std::time::Instant;

use serde::Serialize;

use crate::batch::StoreWarning;
pub use lab::{Finding, Found, Lab, LabError, Map, Panel, Shown, Value};
use paper::Statement;

/// Whether a result is that of the paper.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// It is, by the criterion that is stated.
    Agrees,
    /// It is not.
    Differs,
    /// What the paper says is not known well enough to tell.
    #[serde(rename = "not pinned down")]
    NotPinnedDown,
}

impl std::fmt::Display for Verdict {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Verdict::Agrees => "agrees",
            Verdict::Differs => "differs",
            Verdict::NotPinnedDown => "not pinned down",
        })
    }
}

/// One statement of the paper beside what is computed.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Item {
    /// The statement's name.
    pub id: String,
    /// The figure, table or movie.
    pub figure: String,
    /// What it is about.
    pub quantity: String,
    /// What the paper says; none where that is not known.
    pub paper: Option<Value>,
    /// What is computed, converged.
    pub computed: Value,
    /// What the paper's kind of time step gives, where that is another division.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub published_scheme: Option<Value>,
    /// Whether that would agree.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub published_scheme_agrees: Option<bool>,
    /// |computed/paper − 1|, or |computed| where the paper prints 0; none where it prints no number.
    pub rel_error: Option<f64>,
    /// Whether it agrees: the verdict tells what differs from what cannot be told.
    pub pass: bool,
    /// When a result counts as agreeing.
    pub criterion: String,
    /// Whether it does.
    pub verdict: Verdict,
    /// How long all of its figure took, in seconds.
    pub seconds: f64,
    /// What else is to be said: why nothing is judged, say.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub note: Option<String>,
}

/// The paper, as far as it was asked for.
#[derive(Debug, Default)]
pub struct Reproduction {
    /// Statements in the order of the paper.
    pub items: Vec<Item>,
    /// What they can be seen in.
    pub panels: Vec<Panel>,
    /// What the user should know of the store.
    pub warnings: Vec<StoreWarning>,
}

impl Reproduction {
    /// How many statements have a verdict.
    pub fn count(&self, verdict: Verdict) -> usize {
        self.items.iter().filter(|item| item.verdict == verdict).count()
    }
}

/// Computes the figures that a group of statements is about.
type Figure = fn(&Lab<'_>, &[Statement]) -> Result<Found, LabError>;

/// What computes which figure.
const FIGURES: [(&str, Figure); 19] = [
    ("1B-D", films::furrow),
    ("2A", size::sizes),
    ("2B", size::plane),
    ("2C-F", branches::over_size),
    ("2G", confinement::over_epsilon),
    ("2H-L", branches::over_confinement),
    ("4B-C", cues::places),
    ("4C", cues::places),
    ("4D", cues::sizes),
    ("4E", cues::confinement),
    ("5A", embryo::rounds),
    ("5B-C", embryo::germline),
    ("6D-E", embryo::trends),
    ("7", embryo::equalised),
    ("S2", films::balance),
    ("S3", branches::over_radius),
    ("S4", branches::folds),
    ("S5", perturbed::shapes),
    ("Table S3", constants::table),
];

fn figure(name: &str) -> Figure {
    // What is no figure of the table is a movie.
    FIGURES.iter().find(|(of, _)| *of == name).map_or(films::movies, |(_, figure)| *figure)
}

/// Computes what the statements are about, figure by figure, each on all cores; results depend on the lab's settings alone.
///
/// # Errors
/// [`LabError`]. What of a figure cannot be computed does not agree, and says so.
pub fn reproduce(lab: &Lab<'_>, statements: &[Statement]) -> Result<Reproduction, LabError> {
    let mut out = Reproduction::default();
    for group in statements.chunk_by(|a, b| a.figure == b.figure) {
        let Some(first) = group.first() else { continue };
        (lab.progress)(&first.figure);
        let start = Instant::now();
        let found = figure(&first.figure)(lab, group)?;
        let seconds = start.elapsed().as_secs_f64();
        for statement in group {
            let missing = || Finding::not_computed(&statement.id, "nothing was found");
            let finding = found.findings.iter().find(|finding| finding.id == statement.id).cloned();
            out.items.push(item(statement, finding.unwrap_or_else(missing), seconds));
        }
        out.panels.extend(found.panels);
        out.warnings.extend(found.warnings);
    }
    Ok(out)
}

fn item(statement: &Statement, finding: Finding, seconds: f64) -> Item {
    let rel_error = match (&finding.computed, &statement.printed) {
        (Value::Number(computed), Some(printed)) => Some(printed.deviation(*computed)),
        _ => None,
    };
    let close = rel_error.zip(statement.printed).map(|(error, printed)| error <= printed.tolerance);
    let verdict = match (&statement.open, close.or(finding.holds)) {
        (Some(_), _) | (None, None) => Verdict::NotPinnedDown,
        (None, Some(true)) => Verdict::Agrees,
        (None, Some(false)) => Verdict::Differs,
    };
    let words = (!statement.says.is_empty()).then(|| Value::Words(statement.says.clone()));
    let note: Vec<&str> = statement.open.iter().chain(&finding.note).map(String::as_str).collect();
    Item {
        id: statement.id.clone(),
        figure: statement.figure.clone(),
        quantity: statement.quantity.clone(),
        paper: statement.printed.map(|printed| Value::Number(printed.value)).or(words),
        computed: finding.computed,
        published_scheme: finding.published_scheme,
        published_scheme_agrees: finding.published_holds,
        rel_error,
        pass: verdict == Verdict::Agrees,
        criterion: statement.criterion.clone(),
        verdict,
        seconds,
        note: (!note.is_empty()).then(|| note.join("; ")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use paper::Printed;

    fn statement(printed: Option<Printed>, open: Option<&str>) -> Statement {
        Statement {
            id: "x".into(),
            figure: "2A".into(),
            quantity: "χ".into(),
            says: "much".into(),
            criterion: "more".into(),
            printed,
            cell: None,
            kind: None,
            higher: None,
            constant: None,
            open: open.map(str::to_owned),
        }
    }

    #[test]
    fn verdicts_follow_numbers_criteria_and_what_is_not_known() {
        let printed = Some(Printed { value: 2.0, tolerance: 0.01 });
        let verdict = |statement: Statement, finding: Finding| item(&statement, finding, 0.0).verdict;
        assert_eq!(verdict(statement(printed, None), Finding::number("x", 2.01)), Verdict::Agrees);
        assert_eq!(verdict(statement(printed, None), Finding::number("x", 2.03)), Verdict::Differs);
        assert_eq!(verdict(statement(None, None), Finding::words("x", true, "a".into())), Verdict::Agrees);
        assert_eq!(verdict(statement(None, None), Finding::words("x", false, "a".into())), Verdict::Differs);
        assert_eq!(
            verdict(statement(None, Some("lost")), Finding::words("x", true, "a".into())),
            Verdict::NotPinnedDown
        );
        // A number that could not be computed is no agreement.
        let failed = item(&statement(printed, None), Finding::not_computed("x", "why"), 0.0);
        assert_eq!((failed.verdict, failed.pass, failed.rel_error), (Verdict::Differs, false, None));
        let zero = Printed { value: 0.0, tolerance: 0.0 };
        assert_eq!(zero.deviation(0.0), 0.0);
        assert!(zero.deviation(-0.5) == 0.5);
    }

    #[test]
    fn every_figure_of_the_paper_has_what_computes_it() {
        let statements = paper::statements().unwrap();
        for statement in &statements {
            let known = FIGURES.iter().any(|(name, _)| *name == statement.figure);
            assert!(known || statement.figure.starts_with("Movie "), "{}", statement.figure);
        }
        for (name, _) in FIGURES {
            assert!(statements.iter().any(|statement| statement.figure == name), "{name}");
        }
    }
}
