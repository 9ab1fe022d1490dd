//! Whether a set of constants agrees with the targets, and which statements exclude it.

use furrow_cell::{Cell, Numerics, Parameter};
use furrow_mechanics::calibration::Targets;
use furrow_mechanics::calibration::statements::{GivenWindow, HigherFold};
use furrow_mechanics::critical::critical_value;
use furrow_mechanics::division::{DivisionInput, divide};
use furrow_mechanics::equilibria::{Branch, BranchOptions, Pitchfork, ShapeError, StepBudget, pitchfork, primary};
use ordered_float::OrderedFloat;
use serde::{Deserialize, Serialize};

/// A statement that is false for a set of constants.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Exclusion {
    /// The statement's place among the targets, as `criticalities[0]`.
    pub datum: String,
    /// The statement.
    pub given: String,
    /// The result with the constants instead.
    pub computed: String,
}

impl std::fmt::Display for Exclusion {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}: {}; computed: {}", self.datum, self.given, self.computed)
    }
}

/// The check of one set of constants.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ConstraintCheck {
    /// Thresholds ξ_s* in the order of the targets; fewer if one could not be found.
    pub thresholds: Vec<f64>,
    /// Largest relative deviation of a threshold, without sign.
    pub worst: f64,
    /// ½ Σ (relative deviation/tolerance)²: minus the logarithm of the likelihood.
    pub misfit: f64,
    /// Statements that are not true.
    pub excluded: Vec<Exclusion>,
    /// Critical volume fractions that are off by more than their tolerance: they count in `misfit`, and exclude nothing.
    pub off: Vec<Exclusion>,
}

impl ConstraintCheck {
    /// Whether no statement excludes the constants.
    pub fn is_admissible(&self) -> bool {
        self.excluded.is_empty()
    }

    /// Adds a relative deviation, in units of its tolerance.
    fn deviates(&mut self, deviation: f64) {
        self.misfit += 0.5 * deviation * deviation;
    }

    /// Adds an exclusion where a check found one.
    fn exclude(&mut self, list: &str, index: usize, given: String, found: Result<(), String>) -> bool {
        let Err(computed) = found else { return false };
        self.excluded.push(Exclusion { datum: format!("{list}[{index}]"), given, computed });
        true
    }
}

/// How much of the targets is checked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Extent {
    /// The cheap statements first, up to the first group with a violation.
    UntilExcluded,
    /// All of them, unless a threshold deviates by more than this.
    Within(f64),
}

/// The pitchforks found so far, by size and confinement.
struct Pitchforks<'a> {
    cell: &'a Cell,
    numerics: &'a Numerics,
    known: Vec<([f64; 2], Pitchfork)>,
}

impl Pitchforks<'_> {
    fn first(&mut self, r0: f64, epsilon: f64) -> Result<Pitchfork, String> {
        if let Some((_, found)) = self.known.iter().find(|(at, _)| *at == [r0, epsilon]) {
            return Ok(found.clone());
        }
        let cell = Cell { r0, epsilon, ..self.cell.clone() };
        let found = pitchfork::first(&cell, self.numerics, &BranchOptions::default()).map_err(|e| e.to_string())?;
        self.known.push(([r0, epsilon], found.clone()));
        Ok(found)
    }
}

/// Checks constants against the targets.
pub fn check_constraints(targets: &Targets, cell: &Cell, numerics: &Numerics, extent: Extent) -> ConstraintCheck {
    let mut out = ConstraintCheck::default();
    for prior in &targets.priors {
        out.deviates((prior.parameter.get(cell) / prior.value - 1.0) / prior.tolerance);
    }
    let mut pitchforks = Pitchforks { cell, numerics, known: Vec::new() };
    check_thresholds(targets, &mut pitchforks, &mut out);
    let steps = [check_criticalities, check_windows, check_epsilons, check_divisions, check_folds];
    for step in steps {
        let goes_on = match extent {
            Extent::UntilExcluded => out.is_admissible(),
            Extent::Within(limit) => out.worst <= limit && out.thresholds.len() == targets.thresholds.len(),
        };
        if goes_on {
            step(targets, &mut pitchforks, &mut out);
        }
    }
    out
}

fn check_thresholds(targets: &Targets, pitchforks: &mut Pitchforks<'_>, out: &mut ConstraintCheck) {
    for (k, given) in targets.thresholds.iter().enumerate() {
        let found = pitchforks.first(given.r0, given.epsilon).map(|found| {
            let deviation = found.point.xi_s / given.xi_s - 1.0;
            out.worst = out.worst.max(deviation.abs());
            out.deviates(deviation / given.tolerance);
            out.thresholds.push(found.point.xi_s);
        });
        let text = format!("a pitchfork at R0 = {}, epsilon = {}", given.r0, given.epsilon);
        if out.exclude("thresholds", k, text, found) {
            break;
        }
    }
}

fn check_criticalities(targets: &Targets, pitchforks: &mut Pitchforks<'_>, out: &mut ConstraintCheck) {
    for (k, given) in targets.criticalities.iter().enumerate() {
        let found =
            pitchforks.first(given.r0, given.epsilon).and_then(|found| match found.criticality() == given.kind {
                true => Ok(()),
                false => Err(format!("{} (coefficient {:+.1})", found.criticality(), found.coefficient)),
            });
        let text = format!("{} at R0 = {}, epsilon = {}", given.kind, given.r0, given.epsilon);
        out.exclude("criticalities", k, text, found);
    }
}

fn check_windows(targets: &Targets, pitchforks: &mut Pitchforks<'_>, out: &mut ConstraintCheck) {
    for (k, given) in targets.windows.iter().enumerate() {
        let cell = Cell { r0: given.r0, epsilon: given.epsilon, ..pitchforks.cell.clone() };
        let found = pitchforks.first(given.r0, given.epsilon).and_then(|found| {
            let low = found.point.xi_s;
            let branch = primary::follow(&cell, pitchforks.numerics, &BranchOptions::default(), |_| true)
                .map_err(|error| error.to_string())?;
            let high = turning_point(&branch).unwrap_or(f64::INFINITY);
            match low < given.xi_s && given.xi_s < high {
                true => Ok(()),
                false => Err(format!("pitchfork at {low:.2}, fold at {high:.2}")),
            }
        });
        let GivenWindow { r0, epsilon, xi_s } = given;
        let text = format!("xi_s = {xi_s} between pitchfork and fold at R0 = {r0}, epsilon = {epsilon}");
        out.exclude("windows", k, text, found);
    }
}

fn check_epsilons(targets: &Targets, pitchforks: &mut Pitchforks<'_>, out: &mut ConstraintCheck) {
    for (k, given) in targets.critical_epsilons.iter().enumerate() {
        let cell = Cell { r0: given.r0, xi_s: given.xi_s, epsilon: given.epsilon, ..pitchforks.cell.clone() };
        let starts = [given.epsilon, 0.95 * given.epsilon, 0.85 * given.epsilon];
        let found = critical_value(&cell, pitchforks.numerics, Parameter::Epsilon, &starts, &StepBudget::unlimited());
        let text = format!("epsilon = {} at R0 = {}, xi_s = {}", given.epsilon, given.r0, given.xi_s);
        match found {
            Ok((_, point)) => {
                let deviation = (point.value / given.epsilon - 1.0) / given.tolerance;
                out.deviates(deviation);
                if deviation.abs() > 1.0 {
                    let (datum, computed) = (format!("critical_epsilons[{k}]"), format!("{:.4}", point.value));
                    out.off.push(Exclusion { datum, given: text, computed });
                }
            }
            Err(error) => drop(out.exclude("critical_epsilons", k, text, Err(error.to_string()))),
        }
    }
}

fn check_divisions(targets: &Targets, pitchforks: &mut Pitchforks<'_>, out: &mut ConstraintCheck) {
    for (k, given) in targets.divisions.iter().enumerate() {
        let input = DivisionInput { numerics: *pitchforks.numerics, ..DivisionInput::new(given.cell(pitchforks.cell)) };
        let found = match divide(&input) {
            Ok(division) => given.contradiction(&division).map_or(Ok(()), Err),
            Err(error) => Err(error.to_string()),
        };
        out.exclude("divisions", k, given.to_string(), found);
    }
}

fn check_folds(targets: &Targets, pitchforks: &mut Pitchforks<'_>, out: &mut ConstraintCheck) {
    for (k, given) in targets.folds.iter().enumerate() {
        let cell = Cell { r0: given.r0, epsilon: given.epsilon, ..pitchforks.cell.clone() };
        let found = match higher_fold(&cell, pitchforks.numerics) {
            Ok(Some(higher)) if higher == given.higher => Ok(()),
            Ok(Some(higher)) => Err(format!("{} higher", higher.name())),
            Ok(None) => Err("fewer than two folds".to_owned()),
            Err(error) => Err(error.to_string()),
        };
        let text = format!("{} higher at R0 = {}, epsilon = {}", given.higher.name(), given.r0, given.epsilon);
        out.exclude("folds", k, text, found);
    }
}

fn higher_fold(cell: &Cell, numerics: &Numerics) -> Result<Option<HigherFold>, ShapeError> {
    let branch = primary::follow(cell, numerics, &BranchOptions::default(), |_| true)?;
    Ok(extreme_maxima(&branch).map(HigherFold::of))
}

/// ξ_s of the first maximum of ξ_s along a branch, where it turns back.
pub fn turning_point(branch: &Branch) -> Option<f64> {
    branch.folds().find(|fold| fold.maximum).map(|fold| fold.point.xi_s)
}

/// ξ_s at the maxima of ξ_s along a branch, of the shortest and of the longest shape; `None` for fewer than two maxima.
pub(crate) fn extreme_maxima(branch: &Branch) -> Option<[f64; 2]> {
    let mut maxima: Vec<_> = branch.folds().filter(|fold| fold.maximum).map(|fold| fold.point).collect();
    maxima.sort_by_cached_key(|item| OrderedFloat(item.elongation));
    let [short, .., long] = maxima[..] else { return None };
    Some([short.xi_s, long.xi_s])
}
