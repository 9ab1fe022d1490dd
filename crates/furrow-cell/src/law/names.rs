//! The names that expressions may use.

use std::collections::BTreeMap;
use std::collections::BTreeSet;
use std::sync::{Mutex, PoisonError};

use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::Constant;
use super::program::Step;
use super::text::{Names, functions};
use crate::Parameter;
use crate::settings::parameters;

/// A local quantity of the cortex.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Variable {
    /// Meridional curvature c1, in 1/L_h.
    C1,
    /// Azimuthal curvature c2, in 1/L_h.
    C2,
    /// C = c1 + c2, in 1/L_h.
    C,
    /// Arclength fraction u from the pole u = 0.
    U,
    /// Arclength s = L u, in L_h.
    S,
    /// Distance from the axis r, in L_h.
    R,
    /// Meridional rate of strain S_uu, in 1/τ.
    Suu,
    /// Azimuthal rate of strain S_φφ, in 1/τ.
    Sphiphi,
    /// The regulator φ; 0 without one.
    Phi,
    /// Local bending rigidity κ.
    Kappa,
    /// Local bulk viscosity η_b.
    EtaB,
    /// Local shear viscosity η_s.
    EtaS,
    /// Local friction Γ.
    Friction,
    /// Local passive tension γ.
    Tension,
    /// Local activity ξ_s, as published.
    XiS,
    /// Local activity ξ_b, as published.
    XiB,
    /// Position z along the axis, in L_h: 0 in the middle of the shell, positive towards the pole u = 0.
    Z,
}

impl Variable {
    /// Every quantity, in the order of [`LawValues::at`](super::LawValues::at).
    pub const ALL: [Variable; 17] = {
        use Variable::*;
        [C1, C2, C, U, S, R, Suu, Sphiphi, Phi, Kappa, EtaB, EtaS, Friction, Tension, XiS, XiB, Z]
    };

    /// Its name in expressions.
    pub fn name(self) -> &'static str {
        const NAMES: [&str; 17] = [
            "c1", "c2", "C", "u", "s", "r", "S_uu", "S_phiphi", "phi", "kappa", "eta_b", "eta_s", "friction",
            "tension", "xi_s", "xi_b", "z",
        ];
        NAMES[self as usize]
    }
}

/// Parameters that are uniform on a cell; the first is the gain.
pub(super) const UNIFORM: [Parameter; 7] = {
    use Parameter::*;
    [Gain, XiRatio, R0, Epsilon, Aspect, P0, W]
};

/// The names of a law with given constants.
pub(super) struct Known<'a>(pub &'a BTreeMap<String, Constant>);

impl Names for Known<'_> {
    fn named(&self, name: &str) -> Option<Step> {
        if let Some(k) = self.0.keys().position(|own| own == name) {
            return Some(Step::Uniform((UNIFORM.len() + k) as u16));
        }
        let variable = |name: &str| Variable::ALL.iter().position(|variable| variable.name() == name);
        if let Some(k) = variable(name) {
            return Some(Step::Variable(k as u16));
        }
        let (row, canonical, _) = parameters().find(|(_, own, aliases)| *own == name || aliases.contains(&name))?;
        match UNIFORM.iter().position(|parameter| *parameter == row.parameter) {
            Some(k) => Some(Step::Uniform(k as u16)),
            None => variable(canonical).map(|k| Step::Variable(k as u16)),
        }
    }

    fn all(&self) -> Vec<String> {
        let own = self.0.keys().cloned();
        own.chain(reserved().map(str::to_owned)).collect()
    }
}

/// Names that constants cannot have.
pub(super) fn reserved() -> impl Iterator<Item = &'static str> {
    let variables = Variable::ALL.into_iter().map(Variable::name);
    variables.chain(UNIFORM.into_iter().map(Parameter::name)).chain(["pi"]).chain(functions())
}

/// Largest number of characters of a constant's name.
pub const LONGEST_NAME: usize = 32;

/// The name of a constant of a law, as a parameter: `law.NAME`.
///
/// All names are kept for the lifetime of the program, so that [`Parameter`] is small and can be copied.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct ConstantName(&'static str);

/// The prefix of names of constants that are parameters.
pub(crate) const PREFIX: &str = "law.";

/// All names so far.
static KNOWN: Mutex<BTreeSet<&'static str>> = Mutex::new(BTreeSet::new());

impl ConstantName {
    /// A name without `law.`; `None` unless it is a letter followed by letters, digits and `_`, with at most [`LONGEST_NAME`]
    /// characters.
    pub fn new(bare: &str) -> Option<ConstantName> {
        let begins = bare.starts_with(|c: char| c.is_ascii_alphabetic());
        let fine = begins && bare.len() <= LONGEST_NAME && bare.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
        fine.then(|| {
            let whole = format!("{PREFIX}{bare}");
            let mut known = KNOWN.lock().unwrap_or_else(PoisonError::into_inner);
            ConstantName(match known.get(whole.as_str()) {
                Some(name) => name,
                None => {
                    let name: &'static str = whole.leak();
                    known.insert(name);
                    name
                }
            })
        })
    }

    /// A name with the prefix `law.`.
    pub fn read(whole: &str) -> Option<ConstantName> {
        whole.strip_prefix(PREFIX).and_then(ConstantName::new)
    }

    /// The name with the prefix `law.`.
    pub fn whole(self) -> &'static str {
        self.0
    }

    /// The name without the prefix.
    pub fn bare(self) -> &'static str {
        &self.0[PREFIX.len()..]
    }
}

impl Serialize for ConstantName {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.bare())
    }
}

impl<'de> Deserialize<'de> for ConstantName {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<ConstantName, D::Error> {
        let name = String::deserialize(deserializer)?;
        ConstantName::new(&name).ok_or_else(|| serde::de::Error::custom(format!("{name:?} is no name of a constant")))
    }
}
