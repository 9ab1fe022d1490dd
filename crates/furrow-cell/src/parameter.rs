//! Every scalar of a cell by its name: what can be continued in, fitted, swept, or set from the command line.

use serde::{Deserialize, Serialize};

use super::Cell;
use super::cue::Quantity;
use super::settings::{Number, parameters};

/// A scalar parameter of one cell.
///
/// ```
/// use furrow_cell::{Cell, Parameter};
///
/// let mut cell = Cell::new(2.0);
/// Parameter::Epsilon.set(&mut cell, 0.8);
/// assert_eq!(Parameter::Epsilon.get(&cell), 0.8);
/// assert_eq!("cue.amplitude".parse::<Parameter>().unwrap().to_string(), "cue[0].amplitude");
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Parameter {
    /// Anisotropic activity ξ_s at fixed ratio ξ_b/ξ_s.
    #[serde(alias = "xi")]
    XiS,
    /// Ratio ξ_b/ξ_s.
    XiRatio,
    /// Gain g.
    Gain,
    /// Cell radius R0.
    R0,
    /// Volume fraction ε.
    Epsilon,
    /// Shell aspect ratio a/b.
    Aspect,
    /// Shell strength p0.
    P0,
    /// Shell width w.
    W,
    /// Bending rigidity κ.
    Kappa,
    /// Bulk viscosity η_b.
    EtaB,
    /// Shear viscosity η_s.
    EtaS,
    /// Friction Γ.
    Friction,
    /// Tension γ.
    Tension,
    /// A quantity of one term of the cue.
    Cue {
        /// Which term, from 0.
        term: usize,
        /// Which of its quantities.
        quantity: Quantity,
    },
}

/// A name that is no parameter's.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{name:?} is not a parameter of a cell")]
pub struct UnknownParameter {
    /// The name.
    pub name: String,
}

impl Parameter {
    /// Every parameter but those of cues, for listings.
    pub const ALL: [Parameter; 13] = [
        Parameter::XiS,
        Parameter::XiRatio,
        Parameter::Gain,
        Parameter::R0,
        Parameter::Epsilon,
        Parameter::Aspect,
        Parameter::P0,
        Parameter::W,
        Parameter::Kappa,
        Parameter::EtaB,
        Parameter::EtaS,
        Parameter::Friction,
        Parameter::Tension,
    ];

    /// Its row in the table of parameters, with its name; none for a cue's.
    fn row(self) -> Option<(&'static Number, &'static str)> {
        parameters().find(|(row, ..)| row.parameter == self).map(|(row, name, _)| (row, name))
    }

    /// Its value; 0 for a quantity that the cell's cue does not have.
    pub fn get(self, cell: &Cell) -> f64 {
        match (self, self.row()) {
            (Parameter::Cue { term, quantity }, _) => {
                cell.cue.terms().get(term).and_then(|term| term.quantity(quantity)).unwrap_or(0.0)
            }
            (_, row) => row.map_or(0.0, |(row, _)| (row.get)(cell)),
        }
    }

    /// Sets it. A quantity that the cell's cue does not have is left alone.
    pub fn set(self, cell: &mut Cell, value: f64) {
        let slot = match (self, self.row()) {
            (Parameter::Cue { term, quantity }, _) => {
                cell.cue.terms_mut().get_mut(term).and_then(|term| term.quantity_mut(quantity))
            }
            (_, row) => row.map(|(row, _)| (row.slot)(cell)),
        };
        if let Some(slot) = slot {
            *slot = value;
        }
    }

    /// Checks a value. Of a cue's quantity it need only be finite.
    ///
    /// # Errors
    /// What is allowed.
    pub fn validate(self, value: f64) -> Result<(), &'static str> {
        match self.row() {
            Some((row, _)) => (row.validate)(value),
            None if value.is_finite() => Ok(()),
            None => Err("a finite number"),
        }
    }

    /// Whether the cell has it: false for quantities of terms that its cue does not have.
    pub fn is_of(self, cell: &Cell) -> bool {
        match self {
            Parameter::Cue { term, quantity } => {
                cell.cue.terms().get(term).is_some_and(|term| term.quantity(quantity).is_some())
            }
            _ => true,
        }
    }

    /// Its name in files and options; of a cue's quantity the quantity's alone.
    pub fn name(self) -> &'static str {
        match self {
            Parameter::Cue { quantity, .. } => quantity.name(),
            _ => self.row().map_or("", |(_, name)| name),
        }
    }
}

impl std::fmt::Display for Parameter {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Parameter::Cue { term, quantity } => write!(f, "cue[{term}].{}", quantity.name()),
            other => f.write_str(other.name()),
        }
    }
}

impl std::str::FromStr for Parameter {
    type Err = UnknownParameter;

    /// Reads a name; `cue.u0` is the first term's u0, `cue[1].u0` the second's.
    fn from_str(text: &str) -> Result<Parameter, UnknownParameter> {
        let unknown = || UnknownParameter { name: text.to_owned() };
        if let Some(rest) = text.strip_prefix("cue") {
            let (index, name) = rest.split_once('.').ok_or_else(unknown)?;
            let term = match index {
                "" => 0,
                index => {
                    let digits = index.strip_prefix('[').and_then(|i| i.strip_suffix(']')).ok_or_else(unknown)?;
                    digits.parse().map_err(|_| unknown())?
                }
            };
            let quantity = Quantity::ALL.into_iter().find(|q| q.name() == name).ok_or_else(unknown)?;
            return Ok(Parameter::Cue { term, quantity });
        }
        let named = parameters().find(|(_, name, aliases)| *name == text || aliases.contains(&text));
        named.map(|(row, ..)| row.parameter).ok_or_else(unknown)
    }
}
