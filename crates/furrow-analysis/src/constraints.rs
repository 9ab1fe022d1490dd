//! Whether a set of constants agrees with the targets, and which statements exclude it.

use furrow_cell::{Cell, Numerics, Parameter};
use furrow_mechanics::calibration::Targets;
use furrow_mechanics::calibration::statements::HigherFold;
use furrow_mechanics::division::{DivisionInput, Outcome, divide};
use furrow_mechanics::equilibria::critical::critical_value;
use furrow_mechanics::equilibria::{Branch, BranchOptions, Pitchfork, ShapeError, StepBudget, pitchfork, primary};
use serde::Serialize;

/// A statement that is not true of a set of constants.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Exclusion {
    /// The statement's place among the targets, as `criticalities[0]`.
    pub datum: String,
    /// The statement.
    pub given: String,
    /// What the constants give instead.
    pub computed: String,
}

/// The check of one set of constants.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ConstraintCheck {
    /// Thresholds ξ_s* in the order of the targets; fewer if one could not be found.
    pub thresholds: Vec<f64>,
    /// ½ Σ (relative deviation/tolerance)²: minus the logarithm of the likelihood.
    pub misfit: f64,
    /// Statements that are not true.
    pub excluded: Vec<Exclusion>,
}

impl ConstraintCheck {
    /// Whether no statement excludes the constants.
    pub fn is_admissible(&self) -> bool {
        self.excluded.is_empty()
    }

    fn deviates(&mut self, computed: f64, given: f64, tolerance: f64) {
        let deviation = (computed / given - 1.0) / tolerance;
        self.misfit += 0.5 * deviation * deviation;
    }

    /// Adds an exclusion where a check found one.
    fn exclude(&mut self, list: &str, index: usize, given: String, found: Result<(), String>) -> bool {
        let Err(computed) = found else { return false };
        self.excluded.push(Exclusion { datum: format!("{list}[{index}]"), given, computed });
        true
    }
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

/// Checks constants against the targets, the cheap statements first. Unless `all` are asked for, the check stops at the first
/// group of costly statements with a violation.
pub fn check_constraints(targets: &Targets, cell: &Cell, numerics: &Numerics, all: bool) -> ConstraintCheck {
    let mut out = ConstraintCheck::default();
    let mut pitchforks = Pitchforks { cell, numerics, known: Vec::new() };
    for (k, given) in targets.thresholds.iter().enumerate() {
        let found = pitchforks.first(given.r0, given.epsilon).map(|found| {
            out.deviates(found.point.xi_s, given.xi_s, given.tolerance);
            out.thresholds.push(found.point.xi_s);
        });
        let text = format!("a pitchfork at R0 = {}, epsilon = {}", given.r0, given.epsilon);
        if out.exclude("thresholds", k, text, found) {
            break;
        }
    }
    for (k, given) in targets.criticalities.iter().enumerate() {
        let found =
            pitchforks.first(given.r0, given.epsilon).and_then(|found| match found.criticality() == given.kind {
                true => Ok(()),
                false => Err(format!("{} (coefficient {:+.1})", found.criticality(), found.coefficient)),
            });
        let text = format!("{} at R0 = {}, epsilon = {}", given.kind, given.r0, given.epsilon);
        out.exclude("criticalities", k, text, found);
    }
    let go_on = |out: &ConstraintCheck| all || out.is_admissible();
    let epsilons = if go_on(&out) { &targets.critical_epsilons[..] } else { &[] };
    for (k, given) in epsilons.iter().enumerate() {
        let cell = Cell { r0: given.r0, xi_s: given.xi_s, epsilon: given.epsilon, ..cell.clone() };
        let starts = [given.epsilon, 0.95 * given.epsilon, 0.85 * given.epsilon];
        let found = critical_value(&cell, numerics, Parameter::Epsilon, &starts, &StepBudget::unlimited())
            .map(|(_, point)| out.deviates(point.value, given.epsilon, given.tolerance));
        let text = format!("epsilon = {} at R0 = {}, xi_s = {}", given.epsilon, given.r0, given.xi_s);
        out.exclude("critical_epsilons", k, text, found.map_err(|error| error.to_string()));
    }
    let symmetric = if go_on(&out) { &targets.symmetric[..] } else { &[] };
    for (k, given) in symmetric.iter().enumerate() {
        let (epsilon, xi_s) = (given.epsilon.unwrap_or(cell.epsilon), given.xi_s.unwrap_or(cell.xi_s));
        let cell = Cell { r0: given.r0, epsilon, xi_s, ..cell.clone() };
        let found = match divide(&DivisionInput { numerics: *numerics, ..DivisionInput::new(cell) }) {
            Ok(division) if division.outcome() == Outcome::Symmetric => Ok(()),
            Ok(division) => Err(match division.chi() {
                Some(chi) => format!("{} (chi {chi:.3})", division.outcome()),
                None => division.outcome().to_string(),
            }),
            Err(error) => Err(error.to_string()),
        };
        out.exclude("symmetric", k, format!("symmetric at R0 = {}", given.r0), found);
    }
    let folds = if go_on(&out) { &targets.folds[..] } else { &[] };
    for (k, given) in folds.iter().enumerate() {
        let cell = Cell { r0: given.r0, epsilon: given.epsilon, ..cell.clone() };
        let found = match higher_fold(&cell, numerics) {
            Ok(Some(higher)) if higher == given.higher => Ok(()),
            Ok(Some(higher)) => Err(format!("{} higher", higher.name())),
            Ok(None) => Err("fewer than two folds".to_owned()),
            Err(error) => Err(error.to_string()),
        };
        let text = format!("{} higher at R0 = {}, epsilon = {}", given.higher.name(), given.r0, given.epsilon);
        out.exclude("folds", k, text, found);
    }
    out
}

fn higher_fold(cell: &Cell, numerics: &Numerics) -> Result<Option<HigherFold>, ShapeError> {
    let branch = primary::follow(cell, numerics, &BranchOptions::default(), |_| true)?;
    let higher = |[short, long]: [f64; 2]| if short > long { HigherFold::SmallH } else { HigherFold::LargeH };
    Ok(extreme_maxima(&branch).map(higher))
}

/// ξ_s at the maxima of ξ_s along a branch, of the shortest and of the longest shape; `None` for fewer than two maxima.
pub fn extreme_maxima(branch: &Branch) -> Option<[f64; 2]> {
    let mut maxima: Vec<_> = branch.folds().filter(|fold| fold.maximum).map(|fold| fold.point).collect();
    maxima.sort_by(|a, b| a.elongation.total_cmp(&b.elongation));
    let [short, .., long] = maxima[..] else { return None };
    Some([short.xi_s, long.xi_s])
}
