//! The values of one parameter at which a cell divides with a wanted outcome.
//!
//! A coarse scan brackets every change of sign of outcome − wanted; Brent's method refines each. Where |χ| = C is wanted, these are the
//! changes of signed χ − C and of signed χ + C. If two values are as close as the tolerance and their outcomes still differ, they enclose
//! a jump (a fold of the division's outcome) and no root.

mod search;

pub use search::solve;

use furrow_cell::cue::{LEAST_DIFFUSION, Quantity, RegulatorQuantity};
use furrow_cell::{Cell, Numerics, Parameter};
use furrow_lineage::batch::{SchedulerError, StoreWarning};
use furrow_mechanics::division::{Division, Ending, SecondNeck};
use serde::{Serialize, Serializer};

/// A number that a division gives.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Measure {
    /// Size asymmetry χ.
    Chi,
    /// χ with its sign: positive where the daughter at the pole u = 0 is the smaller.
    ChiSigned,
    /// Position of the furrow, in arclength fraction from the pole u = 0.
    UFurrow,
    /// Time of pinch-off, in τ.
    TEnd,
}

impl Measure {
    /// Its name in answers.
    pub fn name(self) -> &'static str {
        match self {
            Measure::Chi => "chi",
            Measure::ChiSigned => "chi_signed",
            Measure::UFurrow => "u_furrow",
            Measure::TEnd => "t_end",
        }
    }

    /// Its value; `None` if the cell did not divide.
    pub fn of(self, division: &Division) -> Option<f64> {
        match self {
            Measure::Chi => division.chi(),
            Measure::ChiSigned => division.chi_signed(),
            Measure::UFurrow => division.u_furrow(),
            Measure::TEnd => division.u_furrow().map(|_| division.t_end),
        }
    }

    /// The allowed range, if a wanted value is outside it.
    pub fn validate(self, wanted: f64) -> Result<(), &'static str> {
        let (fine, allowed) = match self {
            // No division has |χ| below 0: the outcome does not pass it.
            Measure::Chi => (wanted > 0.0 && wanted < 1.0, "above 0 and below 1"),
            Measure::ChiSigned => (wanted > -1.0 && wanted < 1.0, "above -1 and below 1"),
            Measure::UFurrow => (wanted > 0.0 && wanted < 1.0, "above 0 and below 1"),
            Measure::TEnd => (wanted > 0.0 && wanted.is_finite(), "a finite number above 0"),
        };
        if fine { Ok(()) } else { Err(allowed) }
    }

    /// The outcomes that are sought: χ with either sign where the sign does not matter.
    fn goals(self, wanted: f64) -> Vec<f64> {
        if self == Measure::Chi { vec![wanted, -wanted] } else { vec![wanted] }
    }

    /// Outcomes that differ by more than this at neighbouring values are a jump.
    fn continuous(self, wanted: f64) -> f64 {
        CONTINUOUS * if self == Measure::TEnd { wanted.abs().max(1.0) } else { 1.0 }
    }
}

impl Serialize for Measure {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.name())
    }
}

/// Largest difference in χ, u or relative time, between values [`TOLERANCE`] apart, that is no jump.
pub const CONTINUOUS: f64 = 1e-3;
/// Width of the bracket of a root, relative to the range.
pub const TOLERANCE: f64 = 1e-9;
/// Values of the scan, unless another number is asked for.
pub const POINTS: usize = 65;

/// A question: at which values of a parameter does a division give a certain number?
///
/// ```
/// use furrow_analysis::solve::{Measure, Question, default_range, solve};
/// use furrow_cell::{Cell, Numerics, Parameter};
/// use furrow_lineage::batch::{Memo, Quantisation, SchedulerOptions};
///
/// let (cell, parameter) = (Cell::new(2.0), Parameter::R0);
/// assert_eq!(default_range(parameter, &cell), [1.0, 10.0]);
/// let question = Question {
///     cell, parameter, numerics: Numerics::default(), seed: 0, range: [1.8, 2.2], points: 5, measure: Measure::Chi, wanted: 0.8,
/// };
/// let found = solve(&question, &Memo::new(Quantisation::DEFAULT), &SchedulerOptions::default())?;
/// // Smaller cells divide less equally.
/// assert!(found.roots.len() == 1 && (found.roots[0].chi - 0.8).abs() < 1e-5);
/// # Ok::<(), furrow_analysis::solve::SolveError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Question {
    /// The cell; the parameter is replaced.
    pub cell: Cell,
    /// Discretisation.
    pub numerics: Numerics,
    /// Seed of the noise.
    pub seed: u64,
    /// The parameter.
    pub parameter: Parameter,
    /// First and last value of the parameter.
    pub range: [f64; 2],
    /// Values of the scan, both ends included: two or more.
    pub points: usize,
    /// The measured quantity of the division.
    pub measure: Measure,
    /// The wanted value.
    pub wanted: f64,
}

/// A value of the parameter at which the division gives the wanted number.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Root {
    /// The value.
    pub value: f64,
    /// χ of the division there.
    pub chi: f64,
    /// χ with its sign.
    pub chi_signed: f64,
    /// Which daughter is the smaller.
    pub smaller: Smaller,
    /// Position of its furrow.
    pub u_furrow: f64,
    /// Its time, in τ.
    pub t_end: f64,
    /// Its second neck, if the cell falls into three parts.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub second_neck: Option<SecondNeck>,
}

/// Which daughter is the smaller.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Smaller {
    /// The one at u = 0, as with a positive `chi_signed`.
    Posterior,
    /// The one at u = 1.
    Anterior,
    /// Either, by chance: the cell is mirror-symmetric, and the seed's noise decides.
    Either,
    /// Neither daughter: |χ| is below [`Numerics::chi_symmetric`].
    Neither,
}

impl Smaller {
    fn of(division: &Division, symmetric_cell: bool) -> Option<Smaller> {
        Some(match (division.ending, symmetric_cell) {
            (Ending::Divided { symmetric: true, .. }, _) => Smaller::Neither,
            (Ending::Divided { .. }, true) => Smaller::Either,
            (Ending::Divided { chi_signed, .. }, false) if chi_signed > 0.0 => Smaller::Posterior,
            (Ending::Divided { .. }, false) => Smaller::Anterior,
            (Ending::Arrested { .. }, _) => return None,
        })
    }
}

impl std::fmt::Display for Smaller {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        self.serialize(f)
    }
}

/// Two neighbouring values between which the outcome jumps over the wanted one.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Jump {
    /// The values.
    pub between: [f64; 2],
    /// The outcomes at them.
    pub outcomes: [f64; 2],
}

/// An interval of values at which the cell does not divide.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Gap {
    /// First value.
    pub from: f64,
    /// Last value.
    pub to: f64,
    /// Why, at the first value.
    pub why: String,
}

/// An outcome that was seen, and where.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Extreme {
    /// The outcome.
    pub outcome: f64,
    /// The value of the parameter.
    pub value: f64,
}

/// Answers to a [`Question`], each list in the order of the values.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Solution {
    /// All roots that the scan brackets.
    pub roots: Vec<Root>,
    /// Jumps over the wanted outcome.
    pub jumps: Vec<Jump>,
    /// Where the cell does not divide.
    pub gaps: Vec<Gap>,
    /// The least and the greatest outcome; `None` if the cell divides nowhere.
    pub seen: Option<[Extreme; 2]>,
    /// Divisions looked up or solved.
    pub divisions: usize,
    /// Warnings about the store.
    #[serde(skip)]
    pub warnings: Vec<StoreWarning>,
}

/// Why there is no answer.
#[expect(missing_docs, reason = "the messages say what the fields are")]
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SolveError {
    /// The workers could not be started.
    #[error(transparent)]
    Workers(#[from] SchedulerError),
    /// The search was interrupted.
    #[error("interrupted after {divisions} divisions")]
    Interrupted { divisions: usize },
    /// The wanted outcome is not among those in the range.
    #[error("no {parameter} from {from} to {to} gives {measure} = {wanted}: {seen}", from = .range[0], to = .range[1])]
    NoRoot { parameter: Parameter, range: [f64; 2], measure: &'static str, wanted: f64, seen: String },
}

impl Solution {
    /// The solution, if it has a root.
    ///
    /// # Errors
    /// [`SolveError::NoRoot`] says which outcomes were seen, and where.
    pub fn with_roots(self, question: &Question) -> Result<Solution, SolveError> {
        if !self.roots.is_empty() {
            return Ok(self);
        }
        let Question { parameter, range, measure, wanted, .. } = *question;
        let mut seen = match self.seen {
            None => self.gaps.first().map_or(String::new(), |gap| format!("the cell divides nowhere; {}", gap.why)),
            Some([least, most]) => format!(
                "{} runs from {:.6} (at {:.6}) to {:.6} (at {:.6})",
                measure.name(),
                least.outcome,
                least.value,
                most.outcome,
                most.value
            ),
        };
        for Jump { between: [a, b], outcomes: [before, behind] } in &self.jumps {
            seen += &format!("; it jumps from {before:.4} at {a:.9} to {behind:.4} at {b:.9}");
        }
        Err(SolveError::NoRoot { parameter, range, measure: measure.name(), wanted, seen })
    }
}

/// The range in which a parameter is searched by default: R0 from 1 to 10, ε from 0.6 to 0.95, ξ_s from 5 to 60 κ/g,
/// u0 from 0 to 1; amplitudes and a regulator's strengths from −0.9 to 0.9, or twice their size if that is more. Any other parameter
/// is searched from a quarter of the cell's value to four times it, or from −1 (or 0) to 1 if that value is 0.
pub fn default_range(parameter: Parameter, cell: &Cell) -> [f64; 2] {
    use RegulatorQuantity::{Diffusion, Source, Strength};
    let value = parameter.get(cell);
    match parameter {
        Parameter::R0 => [1.0, 10.0],
        Parameter::Epsilon => [0.6, 0.95],
        Parameter::XiS => [5.0, 60.0].map(|xi_s| xi_s * (cell.material.kappa / cell.material.gain)),
        Parameter::Cue { quantity: Quantity::U0, .. } | Parameter::Regulator(Source(Quantity::U0)) => [0.0, 1.0],
        Parameter::Cue { quantity: Quantity::Amplitude, .. }
        | Parameter::Regulator(Source(Quantity::Amplitude) | Strength(_)) => {
            [-1.0, 1.0].map(|end| end * (2.0 * value.abs()).max(0.9))
        }
        Parameter::Regulator(Diffusion) => [(0.25 * value).max(LEAST_DIFFUSION), 4.0 * value],
        _ if value == 0.0 => [if parameter.validate(-1.0).is_ok() { -1.0 } else { 0.0 }, 1.0],
        _ => [(0.25 * value).min(4.0 * value), (0.25 * value).max(4.0 * value)],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_a_regulator_have_ranges_that_are_allowed() {
        let cue =
            "regulator:band,u0=0.4,omega=0.1,amplitude=0.5,turnover=10,diffusion=0.1,activity=0.3".parse().unwrap();
        let cell = Cell::new(2.0).with_cue(cue);
        for (name, expected) in [
            ("regulator.turnover", [2.5, 40.0]),
            ("regulator.diffusion", [0.05, 0.4]),
            ("regulator.u0", [0.0, 1.0]),
            ("regulator.amplitude", [-1.0, 1.0]),
            ("regulator.activity", [-0.9, 0.9]),
        ] {
            assert_eq!(default_range(name.parse().unwrap(), &cell), expected, "{name}");
        }
    }
}
