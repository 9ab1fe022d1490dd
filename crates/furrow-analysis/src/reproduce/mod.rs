//! The paper reproduced: every statement that can be computed, beside the computed value.
//!
//! | file | contents |
//! |---|---|
//! | [`paper`] | the statements of `data/paper.ron`, by figure |
//! | [`context`] | what figures share: settings, memo, findings, artifacts |
//! | `readings` | χ of a sweep along one axis |
//! | `films`, `sweeps`, `thresholds`, `branches`, `embryo`, `compression`, `perturbed` | the figures |
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
//! let context = Context { settings: &settings, memo: &memo, threads: 0, cancel: &cancel, measured: None, progress: &|_, _, _| () };
//! let found = reproduce(&context, &selected(&["S4".to_owned()])?)?;
//! assert!(found.items.iter().all(|item| item.pass));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod branches;
mod compression;
pub mod context;
mod embryo;
mod films;
pub mod measured;
pub mod paper;
mod perturbed;
mod readings;
mod sweeps;
mod thresholds;

use std::time::Instant;

use serde::Serialize;

pub use context::{Artifact, Context, Figure, Finding, Map, NamedArtifact, ReproduceError};
use furrow_lineage::batch::StoreWarning;
use paper::Statement;
use serde_json::{Value, json};

/// Whether a result agrees with the paper's.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// It agrees, by the stated criterion.
    Agrees,
    /// It is not.
    Differs,
    /// It is not judged, nor counted.
    #[serde(rename = "set apart")]
    Apart,
}

impl std::fmt::Display for Verdict {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Verdict::Agrees => "agrees",
            Verdict::Differs => "differs",
            Verdict::Apart => "set apart",
        })
    }
}

/// One statement of the paper beside the computed result.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Item {
    /// The statement's name.
    pub id: String,
    /// The figure, table or movie.
    pub figure: String,
    /// Its subject.
    pub quantity: String,
    /// The paper's value or words.
    pub paper: Value,
    /// The value computed with the converged scheme.
    pub computed: Value,
    /// The value of the published scheme at Δt = 0.1 τ, where that was computed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub published_scheme: Option<String>,
    /// Whether that would agree.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub published_scheme_agrees: Option<bool>,
    /// The same at Δt = 0.01 τ.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub published_fine: Option<String>,
    /// Whether that would agree.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub published_fine_agrees: Option<bool>,
    /// The value without axial symmetry, where that was computed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub without_axis: Option<Value>,
    /// Whether that would agree.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub without_axis_agrees: Option<bool>,
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
    /// A remark, for example the reason why there is no verdict.
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

    /// As `furrow reproduce --json` prints it, of the constants that `constants` names.
    pub fn document(&self, constants: &str) -> Value {
        json!({
            "constants": constants,
            "items": self.items,
            "agrees": self.count(Verdict::Agrees),
            "differs": self.count(Verdict::Differs),
            "apart": self.count(Verdict::Apart),
        })
    }
}

/// Computes a figure.
type Compute = fn(&mut Figure<'_>) -> Result<(), ReproduceError>;

/// The function of a figure. Statements that are set apart are not computed.
fn compute(figure: &str) -> Compute {
    match figure {
        "1" => films::rest_shape,
        "1B" => films::curvatures,
        "1C" => films::concentration,
        "1D" => films::slip,
        "2A" => sweeps::sizes,
        "2B" => thresholds::over_radius,
        "2C" | "2D" | "2E" | "2F" | "2I" | "2J" | "2K" | "2L" | "S3" | "S4" => branches::shapes,
        "2G" => sweeps::confinement,
        "2H" => thresholds::over_confinement,
        "3B" | "3E" => sweeps::over_axis,
        "3C" => sweeps::over_amplitude,
        "3D" => sweeps::cued_sizes,
        "4B" => embryo::divisions,
        "4C" => embryo::rounds,
        "5B" => embryo::volumes,
        "5C" => embryo::descent,
        "5D" => embryo::germline,
        "6B" => compression::compression,
        "6C" => compression::lineages,
        "S2" => films::balance,
        "S5" => perturbed::shapes,
        "Movie 1" | "Movie 2" | "Movie 3" | "Movie 4" => films::movie,
        _ => nothing,
    }
}

fn nothing(_: &mut Figure<'_>) -> Result<(), ReproduceError> {
    Ok(())
}

/// Figures of divisions and trees, which have results without axial symmetry too.
const WITHOUT_AXIS: [&str; 12] = ["2A", "2G", "3B", "3C", "3D", "3E", "4B", "4C", "5B", "5C", "5D", "6B"];

/// Computes the results for the statements, figure by figure, each on all cores; they depend on the settings alone. Settings with
/// azimuthal modes add the results without axial symmetry to those with it.
///
/// # Errors
/// [`ReproduceError`]. A statement that cannot be computed does not agree, and says why.
pub fn reproduce(context: &Context<'_>, statements: &[Statement]) -> Result<Reproduction, ReproduceError> {
    let mut out = Reproduction::default();
    let groups: Vec<&[Statement]> = statements.chunk_by(|a, b| a.figure == b.figure).collect();
    let mut settings = context.settings.clone();
    settings.numerics.modes = 0;
    let with_axis = Context { settings: &settings, ..*context };
    for (done, group) in groups.iter().enumerate() {
        let name = group[0].figure.as_str();
        (context.progress)(name, done, groups.len());
        let start = Instant::now();
        let figure = computed(&with_axis, group)?;
        let bent = context.settings.numerics.modes > 0 && WITHOUT_AXIS.contains(&name);
        let bent = bent.then(|| computed(context, group)).transpose()?;
        let seconds = start.elapsed().as_secs_f64();
        for statement in *group {
            let found =
                |figure: &Figure<'_>| figure.findings.iter().find(|finding| finding.id == statement.id).cloned();
            let mut item = item(statement, found(&figure), seconds);
            if let Some(finding) = bent.as_ref().and_then(found).filter(|_| item.verdict != Verdict::Apart) {
                item.without_axis_agrees = Some(agrees(statement, &finding).1 == Some(true));
                item.without_axis = Some(finding.computed);
            }
            out.items.push(item);
        }
        out.warnings.extend(bent.into_iter().flat_map(|figure| figure.warnings));
        out.panels.extend(figure.panels);
        out.warnings.extend(figure.warnings);
    }
    Ok(out)
}

fn computed<'a>(context: &'a Context<'a>, statements: &'a [Statement]) -> Result<Figure<'a>, ReproduceError> {
    let (findings, panels, warnings) = <_>::default();
    let mut figure = Figure { context, statements, findings, panels, warnings };
    compute(figure.name())(&mut figure)?;
    Ok(figure)
}

/// The deviation from the printed number, if there is one, and whether the statement is met, by it or by its criterion.
fn agrees(statement: &Statement, finding: &Finding) -> (Option<f64>, Option<bool>) {
    let off = finding.computed.as_f64().zip(statement.printed).map(|(computed, printed)| printed.deviation(computed));
    let close = off.zip(statement.printed).map(|(error, printed)| error <= printed.tolerance);
    (off, close.or(finding.holds))
}

/// A statement that is set apart is judged all the same where something was found: in a table of the user's.
fn item(statement: &Statement, finding: Option<Finding>, seconds: f64) -> Item {
    let apart = statement.apart.as_ref().filter(|_| finding.is_none());
    let finding = finding.unwrap_or_else(|| match apart {
        Some(_) => Finding::new(&statement.id, "-"),
        None => Finding::not_computed(&statement.id, "nothing was found"),
    });
    let (rel_error, met) = agrees(statement, &finding);
    let verdict = match (apart, met) {
        (Some(_), _) => Verdict::Apart,
        (None, Some(true)) => Verdict::Agrees,
        (None, _) => Verdict::Differs,
    };
    let note: Vec<&str> = apart.into_iter().chain(&finding.note).map(String::as_str).collect();
    let [coarse, fine] = [0, 1].map(|k| finding.published.get(k).cloned());
    Item {
        id: statement.id.clone(),
        figure: statement.figure.clone(),
        quantity: statement.quantity.clone(),
        paper: statement.printed.map_or(statement.says.clone().into(), |printed| printed.value.into()),
        computed: finding.computed,
        published_scheme_agrees: coarse.as_ref().map(|coarse| coarse.0),
        published_scheme: coarse.map(|coarse| coarse.1),
        published_fine_agrees: fine.as_ref().map(|fine| fine.0),
        published_fine: fine.map(|fine| fine.1),
        without_axis: None,
        without_axis_agrees: None,
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

    fn statement(printed: Option<Printed>, apart: Option<&str>) -> Statement {
        Statement {
            id: "x".into(),
            figure: "2A".into(),
            quantity: "χ".into(),
            says: "much".into(),
            criterion: "more".into(),
            printed,
            apart: apart.map(str::to_owned),
            ..Statement::default()
        }
    }

    #[test]
    fn verdicts_follow_numbers_criteria_and_missing_results() {
        let printed = Some(Printed { value: 2.0, tolerance: 0.01 });
        let judged = |holds: bool| Finding::judged("x", (holds, "a".into()));
        for (printed, apart, finding, expected) in [
            (printed, None, Some(Finding::new("x", 2.01)), Verdict::Agrees),
            (printed, None, Some(Finding::new("x", 2.03)), Verdict::Differs),
            (None, None, Some(judged(true)), Verdict::Agrees),
            (None, None, Some(judged(false)), Verdict::Differs),
            (None, None, None, Verdict::Differs),
            (None, Some("lost"), None, Verdict::Apart),
            (None, Some("lost"), Some(judged(true)), Verdict::Agrees),
        ] {
            assert_eq!(item(&statement(printed, apart), finding, 0.0).verdict, expected);
        }
        // A number that could not be computed is no agreement.
        let failed = item(&statement(printed, None), Some(Finding::not_computed("x", "why")), 0.0);
        assert_eq!((failed.verdict, failed.pass, failed.rel_error), (Verdict::Differs, false, None));
        let zero = Printed { value: 0.0, tolerance: 0.0 };
        assert_eq!(zero.deviation(0.0), 0.0);
        assert!(zero.deviation(-0.5) == 0.5);
    }

    #[test]
    fn every_judged_figure_has_a_function() {
        let nothing = compute("none") as usize;
        for statement in paper::statements().unwrap().iter().filter(|statement| statement.apart.is_none()) {
            assert!(compute(&statement.figure) as usize != nothing, "{}", statement.figure);
        }
    }
}
