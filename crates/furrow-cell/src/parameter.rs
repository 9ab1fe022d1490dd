//! Every scalar of a cell by its name: what can be continued in, fitted, swept, or set from the command line.

use serde::{Deserialize, Serialize};

use super::Cell;
use super::cue::Quantity;

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

    /// Where it is kept in a cell; none for a cue's, and the cue's own quantities are looked up in its terms.
    fn slot(self, cell: &mut Cell) -> Option<&mut f64> {
        Some(match self {
            Parameter::XiS => &mut cell.xi_s,
            Parameter::XiRatio => &mut cell.material.xi_ratio,
            Parameter::Gain => &mut cell.material.gain,
            Parameter::R0 => &mut cell.r0,
            Parameter::Epsilon => &mut cell.epsilon,
            Parameter::Aspect => &mut cell.shell.aspect,
            Parameter::P0 => &mut cell.shell.p0,
            Parameter::W => &mut cell.shell.w,
            Parameter::Kappa => &mut cell.material.kappa,
            Parameter::EtaB => &mut cell.material.eta_b,
            Parameter::EtaS => &mut cell.material.eta_s,
            Parameter::Friction => &mut cell.material.friction,
            Parameter::Tension => &mut cell.material.tension,
            Parameter::Cue { term, quantity } => return cell.cue.terms_mut().get_mut(term)?.quantity_mut(quantity),
        })
    }

    /// Its value; 0 for a quantity that the cell's cue does not have.
    pub fn get(self, cell: &Cell) -> f64 {
        match self {
            Parameter::XiS => cell.xi_s,
            Parameter::XiRatio => cell.material.xi_ratio,
            Parameter::Gain => cell.material.gain,
            Parameter::R0 => cell.r0,
            Parameter::Epsilon => cell.epsilon,
            Parameter::Aspect => cell.shell.aspect,
            Parameter::P0 => cell.shell.p0,
            Parameter::W => cell.shell.w,
            Parameter::Kappa => cell.material.kappa,
            Parameter::EtaB => cell.material.eta_b,
            Parameter::EtaS => cell.material.eta_s,
            Parameter::Friction => cell.material.friction,
            Parameter::Tension => cell.material.tension,
            Parameter::Cue { term, quantity } => {
                cell.cue.terms().get(term).and_then(|term| term.quantity(quantity)).unwrap_or(0.0)
            }
        }
    }

    /// Sets it. A quantity that the cell's cue does not have is left alone.
    pub fn set(self, cell: &mut Cell, value: f64) {
        if let Some(slot) = self.slot(cell) {
            *slot = value;
        }
    }

    /// What is allowed, if `value` is not: for the parameters of a cell alone, not for those of its cue.
    pub fn refuses(self, value: f64) -> Option<&'static str> {
        let (allowed, what) = match self {
            Parameter::XiS | Parameter::XiRatio | Parameter::Tension | Parameter::Cue { .. } => {
                (value.is_finite(), "a finite number")
            }
            Parameter::Epsilon => (value > 0.0 && value < 1.0, "above 0 and below 1"),
            Parameter::EtaS => (value.is_finite() && value >= 0.0, "a finite number, 0 or above"),
            _ => (value.is_finite() && value > 0.0, "a finite number above 0"),
        };
        (!allowed).then_some(what)
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
            Parameter::XiS => "xi_s",
            Parameter::XiRatio => "xi_ratio",
            Parameter::Gain => "gain",
            Parameter::R0 => "r0",
            Parameter::Epsilon => "epsilon",
            Parameter::Aspect => "aspect",
            Parameter::P0 => "p0",
            Parameter::W => "w",
            Parameter::Kappa => "kappa",
            Parameter::EtaB => "eta_b",
            Parameter::EtaS => "eta_s",
            Parameter::Friction => "friction",
            Parameter::Tension => "tension",
            Parameter::Cue { quantity, .. } => quantity.name(),
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
        match text {
            "xi" => Ok(Parameter::XiS),
            "g" => Ok(Parameter::Gain),
            "R0" => Ok(Parameter::R0),
            "eps" => Ok(Parameter::Epsilon),
            "a_over_b" => Ok(Parameter::Aspect),
            "P0" => Ok(Parameter::P0),
            "Gamma" => Ok(Parameter::Friction),
            "gamma" => Ok(Parameter::Tension),
            _ => Parameter::ALL.into_iter().find(|p| p.name() == text).ok_or_else(unknown),
        }
    }
}
