//! Whether a set of constants agrees with what is known, and which statement excludes it if it does not.

use serde::Serialize;

use crate::calibration::Targets;
use crate::calibration::statements::{GivenFolds, HigherFold};
use crate::cell::{Cell, Numerics, Parameter};
use crate::division::{DivisionInput, Outcome, divide};
use crate::shapes::critical::critical_value;
use crate::shapes::pitchfork::Pitchfork;
use crate::shapes::{BranchEvent, BranchOptions, ShapeError, pitchfork, primary};

/// A statement that is not true of a set of constants.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Exclusion {
    /// The statement's place among the targets, as `criticalities[0]`.
    pub datum: String,
    /// What it is about, and what is given.
    pub given: String,
    /// What the constants give instead.
    pub computed: String,
}

/// A set of constants beside what is known.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Judgement {
    /// Thresholds ξ_s* in the order of the targets; fewer if one could not be found.
    pub thresholds: Vec<f64>,
    /// ½ Σ (relative deviation/tolerance)²: minus the logarithm of the likelihood.
    pub misfit: f64,
    /// Statements that are not true of it.
    pub excluded: Vec<Exclusion>,
}

impl Judgement {
    /// Whether no statement excludes the constants.
    pub fn is_admissible(&self) -> bool {
        self.excluded.is_empty()
    }
}

/// The pitchforks that were found on the way, each but once.
struct Judge<'a> {
    cell: &'a Cell,
    numerics: &'a Numerics,
    known: Vec<([f64; 2], Pitchfork)>,
    out: Judgement,
}

/// Sets constants beside the targets: the cheap statements first, and none of the dear ones after the first that excludes
/// them unless `all` are asked for.
pub fn judge(targets: &Targets, cell: &Cell, numerics: &Numerics, all: bool) -> Judgement {
    let mut judge = Judge { cell, numerics, known: Vec::new(), out: Judgement::default() };
    judge.thresholds(targets);
    judge.criticalities(targets);
    if all || judge.out.is_admissible() {
        judge.critical_epsilons(targets);
    }
    if all || judge.out.is_admissible() {
        judge.symmetric(targets);
    }
    if all || judge.out.is_admissible() {
        judge.folds(targets);
    }
    judge.out
}

impl Judge<'_> {
    fn exclude(&mut self, datum: String, given: String, computed: String) {
        self.out.excluded.push(Exclusion { datum, given, computed });
    }

    /// The first pitchfork of a cell of a size and confinement.
    fn pitchfork(&mut self, r0: f64, epsilon: f64) -> Result<Pitchfork, ShapeError> {
        if let Some((_, found)) = self.known.iter().find(|(at, _)| *at == [r0, epsilon]) {
            return Ok(found.clone());
        }
        let cell = Cell { r0, epsilon, ..self.cell.clone() };
        let found = pitchfork::first(&cell, self.numerics, &BranchOptions::default())?;
        self.known.push(([r0, epsilon], found.clone()));
        Ok(found)
    }

    fn thresholds(&mut self, targets: &Targets) {
        for (k, given) in targets.thresholds.iter().enumerate() {
            match self.pitchfork(given.r0, given.epsilon) {
                Ok(found) => {
                    let deviation = (found.point.xi_s / given.xi_s - 1.0) / given.tolerance;
                    self.out.misfit += 0.5 * deviation * deviation;
                    self.out.thresholds.push(found.point.xi_s);
                }
                Err(error) => {
                    let text = format!("a pitchfork at R0 = {}, epsilon = {}", given.r0, given.epsilon);
                    self.exclude(format!("thresholds[{k}]"), text, error.to_string());
                    return;
                }
            }
        }
    }

    fn criticalities(&mut self, targets: &Targets) {
        for (k, given) in targets.criticalities.iter().enumerate() {
            let text = format!("{} at R0 = {}, epsilon = {}", given.kind, given.r0, given.epsilon);
            let computed = match self.pitchfork(given.r0, given.epsilon) {
                Ok(found) if found.criticality() == given.kind => continue,
                Ok(found) => format!("{} (coefficient {:+.1})", found.criticality(), found.coefficient),
                Err(error) => error.to_string(),
            };
            self.exclude(format!("criticalities[{k}]"), text, computed);
        }
    }

    fn critical_epsilons(&mut self, targets: &Targets) {
        for (k, given) in targets.critical_epsilons.iter().enumerate() {
            let cell = Cell { r0: given.r0, xi_s: given.xi_s, epsilon: given.epsilon, ..self.cell.clone() };
            let starts = [given.epsilon, 0.95 * given.epsilon, 0.85 * given.epsilon];
            match critical_value(&cell, self.numerics, Parameter::Epsilon, &starts) {
                Ok((_, point)) => {
                    let deviation = (point.value / given.epsilon - 1.0) / given.tolerance;
                    self.out.misfit += 0.5 * deviation * deviation;
                }
                Err(error) => {
                    let text = format!("epsilon = {} at R0 = {}, xi_s = {}", given.epsilon, given.r0, given.xi_s);
                    self.exclude(format!("critical_epsilons[{k}]"), text, error.to_string());
                }
            }
        }
    }

    fn symmetric(&mut self, targets: &Targets) {
        for (k, given) in targets.symmetric.iter().enumerate() {
            let mut cell = Cell { r0: given.r0, ..self.cell.clone() };
            cell.epsilon = given.epsilon.unwrap_or(cell.epsilon);
            cell.xi_s = given.xi_s.unwrap_or(cell.xi_s);
            let computed = match divide(&DivisionInput { numerics: *self.numerics, ..DivisionInput::new(cell) }) {
                Ok(division) if division.outcome == Outcome::Symmetric => continue,
                Ok(division) => match division.chi {
                    Some(chi) => format!("{} (chi {chi:.3})", division.outcome),
                    None => division.outcome.to_string(),
                },
                Err(error) => error.to_string(),
            };
            self.exclude(format!("symmetric[{k}]"), format!("symmetric at R0 = {}", given.r0), computed);
        }
    }

    fn folds(&mut self, targets: &Targets) {
        for (k, given) in targets.folds.iter().enumerate() {
            let text = format!("{} higher at R0 = {}, epsilon = {}", given.higher.name(), given.r0, given.epsilon);
            let computed = match self.higher_fold(given) {
                Ok(Some(higher)) if higher == given.higher => continue,
                Ok(Some(higher)) => format!("{} higher", higher.name()),
                Ok(None) => "fewer than two folds".to_owned(),
                Err(error) => error.to_string(),
            };
            self.exclude(format!("folds[{k}]"), text, computed);
        }
    }

    /// Which of the maxima of ξ_s along the branch of symmetric shapes, that of the shortest and that of the longest shape,
    /// is the larger.
    fn higher_fold(&mut self, given: &GivenFolds) -> Result<Option<HigherFold>, ShapeError> {
        let cell = Cell { r0: given.r0, epsilon: given.epsilon, ..self.cell.clone() };
        let branch = primary::follow(&cell, self.numerics, &BranchOptions::default(), |_| true)?;
        let maximum = |event: &BranchEvent| match event {
            BranchEvent::Fold(fold) if fold.maximum => Some([fold.point.elongation, fold.point.xi_s]),
            _ => None,
        };
        let mut folds: Vec<[f64; 2]> = branch.events.iter().filter_map(maximum).collect();
        folds.sort_by(|a, b| a[0].total_cmp(&b[0]));
        let (Some(short), Some(long)) = (folds.first(), folds.last().filter(|_| folds.len() > 1)) else {
            return Ok(None);
        };
        Ok(Some(if short[1] > long[1] { HigherFold::SmallH } else { HigherFold::LargeH }))
    }
}
