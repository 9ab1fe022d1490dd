//! Every scalar of a cell by its name: what can be continued in, fitted, swept, or set from the command line.

use serde::{Deserialize, Serialize};

use super::Cell;
use super::cue::{Quantity, RegulatorQuantity};
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
    /// A number of the cue's regulator.
    Regulator(RegulatorQuantity),
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
    pub const ALL: [Parameter; 13] = {
        use Parameter::*;
        [XiS, XiRatio, Gain, R0, Epsilon, Aspect, P0, W, Kappa, EtaB, EtaS, Friction, Tension]
    };

    /// Its row in the table of parameters, with its name; none for a cue's.
    fn row(self) -> Option<(&'static Number, &'static str)> {
        parameters().find(|(row, ..)| row.parameter == self).map(|(row, name, _)| (row, name))
    }

    /// Its value, unless it is a quantity that the cell's cue does not have.
    fn read(self, cell: &Cell) -> Option<f64> {
        match self {
            Parameter::Cue { term, quantity } => cell.cue.terms().get(term)?.quantity(quantity),
            Parameter::Regulator(quantity) => cell.cue.regulator()?.quantity(quantity),
            _ => self.row().map(|(row, _)| (row.get)(cell)),
        }
    }

    /// Its value; 0 for a quantity that the cell's cue does not have.
    pub fn get(self, cell: &Cell) -> f64 {
        self.read(cell).unwrap_or(0.0)
    }

    /// Whether the cell has it: false for quantities of terms that its cue does not have.
    pub fn is_of(self, cell: &Cell) -> bool {
        self.read(cell).is_some()
    }

    /// Sets it. A quantity that the cell's cue does not have is left alone.
    pub fn set(self, cell: &mut Cell, value: f64) {
        let slot = match self {
            Parameter::Cue { term, quantity } => {
                cell.cue.terms_mut().get_mut(term).and_then(|term| term.quantity_mut(quantity))
            }
            Parameter::Regulator(quantity) => {
                cell.cue.regulator_mut().and_then(|regulator| regulator.quantity_mut(quantity))
            }
            _ => self.row().map(|(row, _)| (row.slot)(cell)),
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
            let number = |index: &str| index.strip_prefix('[')?.strip_suffix(']')?.parse().ok();
            let term = if index.is_empty() { Some(0) } else { number(index) }.ok_or_else(unknown)?;
            let quantity = Quantity::ALL.into_iter().find(|q| q.name() == name).ok_or_else(unknown)?;
            return Ok(Parameter::Cue { term, quantity });
        }
        let named = parameters().find(|(_, name, aliases)| *name == text || aliases.contains(&text));
        named.map(|(row, ..)| row.parameter).ok_or_else(unknown)
    }
}
