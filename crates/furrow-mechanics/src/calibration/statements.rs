//! Qualitative statements about thresholds and divisions: the side of the asymmetric branch, the order of folds, the
//! outcome of a division. A set of constants satisfies such a statement or is excluded by it.

use std::fmt::{self, Display, Formatter};

use serde::{Deserialize, Serialize};

use super::Targets;
use crate::division::{Division, Outcome};
use crate::equilibria::Criticality;
use furrow_cell::cue::Profile;
use furrow_cell::{Cell, Cue, Parameter};
use furrow_input::InputError;

/// A known side of the asymmetric branch at a pitchfork.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GivenCriticality {
    /// Cell radius R0.
    pub r0: f64,
    /// Volume fraction ε.
    pub epsilon: f64,
    /// The side.
    pub kind: Criticality,
}

/// The fold of a branch of asymmetric shapes with the larger ξ_s.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum HigherFold {
    /// The fold of the shorter shape.
    SmallH,
    /// The fold of the longer shape.
    LargeH,
}

impl HigherFold {
    /// The higher fold, from ξ_s at the fold of the shorter and of the longer shape.
    pub fn of([short, long]: [f64; 2]) -> HigherFold {
        if short > long { HigherFold::SmallH } else { HigherFold::LargeH }
    }

    /// Its name in files.
    pub fn name(self) -> &'static str {
        match self {
            HigherFold::SmallH => "small_h",
            HigherFold::LargeH => "large_h",
        }
    }
}

/// The order of the folds of an S-shaped branch.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GivenFolds {
    /// Cell radius R0.
    pub r0: f64,
    /// Volume fraction ε.
    pub epsilon: f64,
    /// The fold with the larger ξ_s.
    pub higher: HigherFold,
}

/// An activity between the pitchfork and the turning point of the symmetric branch, at which cells divide unequally.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GivenWindow {
    /// Cell radius R0.
    pub r0: f64,
    /// Volume fraction ε.
    pub epsilon: f64,
    /// The activity ξ_s.
    pub xi_s: f64,
}

/// The place of a furrow relative to a cue at u0, as seen from the middle of the cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum FurrowPlace {
    /// Nearer to the middle than the cue.
    Short,
    /// Within [`FurrowPlace::AT`] of the cue.
    At,
    /// More than [`FurrowPlace::BESIDE`] away from the cue.
    Beside,
    /// Further from the middle than the cue.
    Beyond,
}

impl FurrowPlace {
    /// Largest distance in u at which a furrow counts as at the cue.
    pub const AT: f64 = 0.005;
    /// Least distance in u at which a furrow counts as beside it.
    pub const BESIDE: f64 = 0.003;

    /// Whether a furrow at `u` has this place relative to a cue at `u0`.
    pub fn holds(self, u: f64, u0: f64) -> bool {
        // Distances from the middle, on the side of the cue.
        let [furrow, cue] = [u, u0].map(|u| (0.5 - u) * (0.5 - u0).signum());
        match self {
            FurrowPlace::Short => furrow < cue,
            FurrowPlace::At => (u - u0).abs() <= FurrowPlace::AT,
            FurrowPlace::Beside => (u - u0).abs() > FurrowPlace::BESIDE,
            FurrowPlace::Beyond => furrow > cue,
        }
    }

    fn name(self) -> &'static str {
        match self {
            FurrowPlace::Short => "short of",
            FurrowPlace::At => "at",
            FurrowPlace::Beside => "beside",
            FurrowPlace::Beyond => "beyond",
        }
    }
}

/// A known division.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GivenDivision {
    /// Cell radius R0.
    pub r0: f64,
    /// Volume fraction ε; default: the value of the run.
    #[serde(default)]
    pub epsilon: Option<f64>,
    /// Activity ξ_s; default: the value of the run.
    #[serde(default)]
    pub xi_s: Option<f64>,
    /// Its cue; default: no cue.
    #[serde(default = "Cue::none")]
    pub cue: Cue,
    /// Its outcome, if known.
    #[serde(default)]
    pub outcome: Option<Outcome>,
    /// The place of the furrow relative to the first term of the cue, if known.
    #[serde(default)]
    pub furrow: Option<FurrowPlace>,
}

impl GivenDivision {
    /// The cell, with the constants of another.
    pub fn cell(&self, constants: &Cell) -> Cell {
        let (epsilon, xi_s) = (self.epsilon.unwrap_or(constants.epsilon), self.xi_s.unwrap_or(constants.xi_s));
        Cell { r0: self.r0, epsilon, xi_s, cue: self.cue.clone(), ..constants.clone() }
    }

    /// The position of the cue in u.
    fn cue_place(&self) -> Option<f64> {
        match self.cue.terms().first()?.profile {
            Profile::Band { u0, .. } | Profile::Step { u0, .. } => Some(u0),
            Profile::Gradient | Profile::Par { .. } => None,
        }
    }

    /// Describes the contradiction between the division and this statement, if there is one.
    pub fn contradiction(&self, division: &Division) -> Option<String> {
        let chi = division.chi().map_or(String::new(), |chi| format!(" (chi {chi:.3})"));
        if self.outcome.is_some_and(|outcome| outcome != division.outcome()) {
            return Some(format!("{}{chi}", division.outcome()));
        }
        let place = self.furrow?;
        match division.u_furrow().zip(self.cue_place()) {
            Some((u, u0)) if place.holds(u, u0) => None,
            Some((u, _)) => Some(format!("furrow at u = {u:.4}")),
            None => Some("no furrow".to_owned()),
        }
    }

    /// Checks its numbers; `name` is its place in the file `source_name`.
    ///
    /// # Errors
    /// Names the field, its value and the allowed values.
    pub fn check(&self, source_name: &str, name: &str) -> Result<(), InputError> {
        let numbers = [("r0", self.r0), ("epsilon", self.epsilon.unwrap_or(0.5)), ("xi_s", self.xi_s.unwrap_or(1.0))];
        check_numbers(source_name, name, &numbers)?;
        let refuse = |field: &str, value: &str, allowed: &str| {
            Err(InputError::not_allowed(source_name, format!("{name}.{field}"), value, allowed))
        };
        match (self.outcome, self.furrow) {
            (None, None) => refuse("outcome", "(none)", "given, unless furrow is"),
            (_, Some(_)) if self.cue_place().is_none() => refuse("cue", &self.cue.to_string(), "one with a place u0"),
            _ => Ok(()),
        }
    }
}

impl Display for GivenDivision {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match (self.outcome, self.furrow) {
            (Some(outcome), _) => write!(f, "{outcome}")?,
            (None, Some(place)) => write!(f, "furrow {} u0", place.name())?,
            (None, None) => {}
        }
        write!(f, " at R0 = {}", self.r0)?;
        if !self.cue.is_none() {
            write!(f, ", {}", self.cue)?;
        }
        Ok(())
    }
}

/// Prior knowledge of a constant.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Prior {
    /// The constant.
    pub parameter: Parameter,
    /// Its value, above 0.
    pub value: f64,
    /// Its relative tolerance.
    pub tolerance: f64,
}

/// The critical volume fraction of division, with its tolerance.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GivenEpsilon {
    /// Cell radius R0.
    pub r0: f64,
    /// Activity ξ_s.
    pub xi_s: f64,
    /// The critical ε.
    pub epsilon: f64,
    /// Its relative tolerance.
    #[serde(default = "tolerance")]
    pub tolerance: f64,
}

/// The relative tolerance of thresholds and critical volume fractions. The paper prints ε with two digits, and ±0.005
/// in ε moves its thresholds by 3 %: the default is a third of this.
pub fn tolerance() -> f64 {
    0.01
}

impl Targets {
    /// Number of statements that a set of constants satisfies or violates; a critical volume fraction counts as
    /// satisfied within its tolerance.
    pub fn statements(&self) -> usize {
        let Targets { criticalities, folds, windows, divisions, critical_epsilons, .. } = self;
        criticalities.len() + folds.len() + windows.len() + divisions.len() + critical_epsilons.len()
    }

    pub(super) fn check_statements(&self, source_name: &str) -> Result<(), InputError> {
        let check = |list: &str, k: usize, numbers: &[(&str, f64)]| {
            check_numbers(source_name, &format!("{list}[{k}]"), numbers)
        };
        for (k, given) in self.criticalities.iter().enumerate() {
            check("criticalities", k, &[("r0", given.r0), ("epsilon", given.epsilon)])?;
        }
        for (k, given) in self.folds.iter().enumerate() {
            check("folds", k, &[("r0", given.r0), ("epsilon", given.epsilon)])?;
        }
        for (k, given) in self.windows.iter().enumerate() {
            check("windows", k, &[("r0", given.r0), ("epsilon", given.epsilon), ("xi_s", given.xi_s)])?;
        }
        for (k, given) in self.divisions.iter().enumerate() {
            given.check(source_name, &format!("divisions[{k}]"))?;
        }
        for (k, given) in self.critical_epsilons.iter().enumerate() {
            let numbers =
                [("r0", given.r0), ("xi_s", given.xi_s), ("epsilon", given.epsilon), ("tolerance", given.tolerance)];
            check("critical_epsilons", k, &numbers)?;
        }
        for (k, given) in self.priors.iter().enumerate() {
            check("priors", k, &[("value", given.value), ("tolerance", given.tolerance)])?;
        }
        Ok(())
    }
}

/// Refuses numbers that are impossible for a cell; `name` is the statement's place in the file.
pub(super) fn check_numbers(source_name: &str, name: &str, numbers: &[(&str, f64)]) -> Result<(), InputError> {
    for (field, value) in numbers {
        let (ok, allowed) = match *field {
            "epsilon" | "tolerance" => (*value > 0.0 && *value < 1.0, "above 0 and below 1"),
            _ => (value.is_finite() && *value > 0.0, "a finite number above 0"),
        };
        if !ok {
            return Err(InputError::not_allowed(source_name, format!("{name}.{field}"), value, allowed));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Short and beyond are seen from the middle of the cell, on the side of the cue.
    #[test]
    fn places_are_measured_from_the_middle() {
        use FurrowPlace::{At, Beside, Beyond, Short};
        for (u, u0, holds) in [
            (0.45, 0.42, [Short, Beside].as_slice()),
            (0.55, 0.42, &[Short, Beside]),
            (0.40, 0.42, &[Beyond, Beside]),
            (0.55, 0.58, &[Short, Beside]),
            (0.60, 0.58, &[Beyond, Beside]),
            (0.422, 0.42, &[Short, At]),
            (0.416, 0.42, &[Beyond, At, Beside]),
        ] {
            for place in [Short, At, Beside, Beyond] {
                assert_eq!(place.holds(u, u0), holds.contains(&place), "{place:?}: {u} beside {u0}");
            }
        }
    }

    #[test]
    fn wrong_statements_are_named() {
        let complaint = |text: &str| {
            let text =
                format!("Targets(unknowns: [(parameter: w)], thresholds: [(r0: 2, epsilon: 0.87, xi_s: 22)], {text})");
            let targets: Targets =
                furrow_input::parse_document(&text, "t.ron", "a file of targets", "Targets").unwrap();
            targets.check("t.ron").unwrap_err().to_string()
        };
        assert_eq!(
            complaint("divisions: [(r0: 2)]"),
            "t.ron: divisions[0].outcome = (none): must be given, unless furrow is"
        );
        assert_eq!(
            complaint("divisions: [(r0: 2, furrow: at)]"),
            "t.ron: divisions[0].cue = none: must be one with a place u0"
        );
        assert_eq!(
            complaint("windows: [(r0: 2, epsilon: 1.5, xi_s: 25)]"),
            "t.ron: windows[0].epsilon = 1.5: must be above 0 and below 1"
        );
        assert_eq!(
            complaint("priors: [(parameter: w, value: 0, tolerance: 0.1)]"),
            "t.ron: priors[0].value = 0: must be a finite number above 0"
        );
    }
}
