//! The paper reproduced: every statement that can be computed, beside the computed value.
//!
//! | file | contents |
//! |---|---|
//! | [`paper`] | the statements of `data/paper.ron`, by figure |
//! | [`context`] | what figures share: settings, memo, findings, artifacts |
//! | `readings` | χ of a sweep along one axis |
//! | `films`, `sweeps`, `branches`, `embryo`, `perturbed` | the figures |
//!
//! ```
//! use std::sync::atomic::AtomicBool;
//!
//! use furrow_lineage::batch::{Memo, Quantisation};
//! use furrow_cell::settings::Settings;
//! use furrow_analysis::reproduce::{Context, paper::selected, reproduce};
//!
//! let (settings, memo) = (Settings::default(), Memo::new(Quantisation::DEFAULT));
//! let cancel = AtomicBool::new(false);
//! let context = Context { settings: &settings, memo: &memo, threads: 0, cancel: &cancel, progress: &|_| () };
//! let found = reproduce(&context, &selected(&["S4".to_owned()])?)?;
//! assert!(found.items.iter().all(|item| item.pass));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod branches;
pub mod context;
mod embryo;
mod films;
pub mod paper;
mod perturbed;
mod readings;
mod sweeps;

use std::time::Instant;

use serde::Serialize;

pub use context::{Artifact, Context, Figure, Finding, Map, NamedArtifact, ReproduceError};
use furrow_lineage::batch::StoreWarning;
use paper::Statement;
use serde_json::Value;

/// Whether a result is that of the paper.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// It is, by the criterion that is stated.
    Agrees,
    /// It is not.
    Differs,
    /// The paper's statement is not known well enough.
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
    /// Its subject.
    pub quantity: String,
    /// The paper's value or words; `None` if not known.
    pub paper: Option<Value>,
    /// The value computed with the converged scheme.
    pub computed: Value,
    /// The value computed with the paper's time step, where it differs.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub published_scheme: Option<Value>,
    /// Whether that would agree.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub published_scheme_agrees: Option<bool>,
    /// |computed/paper − 1|, or |computed| where the paper prints 0; `None` where it prints no number.
    pub rel_error: Option<f64>,
    /// Whether the verdict is that it agrees.
    pub pass: bool,
    /// When a result counts as agreeing.
    pub criterion: String,
    /// Whether it does.
    pub verdict: Verdict,
    /// How long all of its figure took, in seconds.
    pub seconds: f64,
    /// A remark, such as why nothing is judged.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub note: Option<String>,
}

/// The results of the figures that were asked for.
#[derive(Debug, Default)]
pub struct Reproduction {
    /// Statements in the order of the paper.
    pub items: Vec<Item>,
    /// Pictures of them.
    pub panels: Vec<NamedArtifact>,
    /// Warnings about the store.
    pub warnings: Vec<StoreWarning>,
}

impl Reproduction {
    /// How many statements have a verdict.
    pub fn count(&self, verdict: Verdict) -> usize {
        self.items.iter().filter(|item| item.verdict == verdict).count()
    }
}

/// Computes a figure.
type Compute = fn(&mut Figure<'_>) -> Result<(), ReproduceError>;

/// The function of each figure.
const FIGURES: [(&str, Compute); 19] = [
    ("1B-D", films::furrow),
    ("2A", sweeps::sizes),
    ("2B", sweeps::plane),
    ("2C-F", branches::shapes),
    ("2G", sweeps::confinement),
    ("2H-L", branches::over_confinement),
    ("4B-C", sweeps::over_axis),
    ("4C", sweeps::over_axis),
    ("4D", sweeps::over_axis),
    ("4E", sweeps::over_axis),
    ("5A", embryo::rounds),
    ("5B-C", embryo::germline),
    ("6D-E", embryo::trends),
    ("7", embryo::equalised),
    ("S2", films::balance),
    ("S3", branches::over_radius),
    ("S4", branches::shapes),
    ("S5", perturbed::shapes),
    ("Table S3", embryo::constants),
];

/// Computes what the statements are about, figure by figure, each on all cores; results depend on the settings alone.
///
/// # Errors
/// [`ReproduceError`]. A statement that cannot be computed does not agree, and says why.
pub fn reproduce(context: &Context<'_>, statements: &[Statement]) -> Result<Reproduction, ReproduceError> {
    let mut out = Reproduction::default();
    for group in statements.chunk_by(|a, b| a.figure == b.figure) {
        let (findings, panels, warnings) = <_>::default();
        let mut figure = Figure { context, statements: group, findings, panels, warnings };
        (context.progress)(figure.name());
        let start = Instant::now();
        // The figures that the table does not name are movies.
        let compute = FIGURES.iter().find(|(of, _)| *of == figure.name()).map_or(films::movies as Compute, |(_, f)| *f);
        compute(&mut figure)?;
        let seconds = start.elapsed().as_secs_f64();
        for statement in group {
            let missing = || Finding::not_computed(&statement.id, "nothing was found");
            let finding = figure.findings.iter().find(|finding| finding.id == statement.id).cloned();
            out.items.push(item(statement, finding.unwrap_or_else(missing), seconds));
        }
        out.panels.extend(figure.panels);
        out.warnings.extend(figure.warnings);
    }
    Ok(out)
}

fn item(statement: &Statement, finding: Finding, seconds: f64) -> Item {
    let rel_error =
        finding.computed.as_f64().zip(statement.printed).map(|(computed, printed)| printed.deviation(computed));
    let close = rel_error.zip(statement.printed).map(|(error, printed)| error <= printed.tolerance);
    let verdict = match (&statement.open, close.or(finding.holds)) {
        (Some(_), _) | (None, None) => Verdict::NotPinnedDown,
        (None, Some(true)) => Verdict::Agrees,
        (None, Some(false)) => Verdict::Differs,
    };
    let words = (!statement.says.is_empty()).then(|| statement.says.as_str().into());
    let note: Vec<&str> = statement.open.iter().chain(&finding.note).map(String::as_str).collect();
    Item {
        id: statement.id.clone(),
        figure: statement.figure.clone(),
        quantity: statement.quantity.clone(),
        paper: statement.printed.map(|printed| printed.value.into()).or(words),
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
            open: open.map(str::to_owned),
            ..Statement::default()
        }
    }

    #[test]
    fn verdicts_follow_numbers_criteria_and_what_is_not_known() {
        let printed = Some(Printed { value: 2.0, tolerance: 0.01 });
        let judged = |holds: bool| Finding::judged("x", (holds, "a".into()));
        for (printed, open, finding, expected) in [
            (printed, None, Finding::new("x", 2.01), Verdict::Agrees),
            (printed, None, Finding::new("x", 2.03), Verdict::Differs),
            (None, None, judged(true), Verdict::Agrees),
            (None, None, judged(false), Verdict::Differs),
            (None, Some("lost"), judged(true), Verdict::NotPinnedDown),
        ] {
            assert_eq!(item(&statement(printed, open), finding, 0.0).verdict, expected);
        }
        // A number that could not be computed is no agreement.
        let failed = item(&statement(printed, None), Finding::not_computed("x", "why"), 0.0);
        assert_eq!((failed.verdict, failed.pass, failed.rel_error), (Verdict::Differs, false, None));
        let zero = Printed { value: 0.0, tolerance: 0.0 };
        assert_eq!(zero.deviation(0.0), 0.0);
        assert!(zero.deviation(-0.5) == 0.5);
    }

    #[test]
    fn every_figure_of_the_paper_has_a_function() {
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
