//! What is known of thresholds beside their values: on which side the asymmetric branch lies, which fold is the higher, how
//! a cell divides. Such a statement is true of a set of constants or it is not, and excludes those of which it is not.

use serde::{Deserialize, Serialize};

use crate::equilibria::Criticality;
use furrow_input::InputError;

/// The asymmetric branch is known to lie on one side of a pitchfork.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GivenCriticality {
    /// Cell radius R0.
    pub r0: f64,
    /// Volume fraction ε.
    pub epsilon: f64,
    /// On which side.
    pub kind: Criticality,
}

/// Which fold of a branch of asymmetric shapes lies at the larger ξ_s.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum HigherFold {
    /// That of the shorter shape.
    SmallH,
    /// That of the longer shape.
    LargeH,
}

impl HigherFold {
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
    /// Which is the higher.
    pub higher: HigherFold,
}

/// A cell without a cue that is known to divide into equal daughters.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GivenSymmetric {
    /// Cell radius R0.
    pub r0: f64,
    /// Volume fraction ε; that of the run if not given.
    #[serde(default)]
    pub epsilon: Option<f64>,
    /// Activity ξ_s; that of the run if not given.
    #[serde(default)]
    pub xi_s: Option<f64>,
}

/// The volume fraction up to which cells divide, with its tolerance.
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

/// The least relative tolerance at which the paper's printed statements can be met together.
pub fn tolerance() -> f64 {
    0.003
}

/// Refuses numbers that no cell has; `name` is the statement's place in the file.
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
