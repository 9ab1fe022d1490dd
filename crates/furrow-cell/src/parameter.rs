//! The scalars of a cell by name, which can be varied in continuation, fitted, swept, or set on the command line.

use serde::{Deserialize, Serialize};

use super::Cell;
use super::cue::{Cue, Quantity, Regulator, RegulatorQuantity};
use super::law::ConstantName;
use super::settings::{Number, parameters};
use furrow_input::did_you_mean;

/// A scalar parameter of one cell.
///
/// ```
/// use furrow_cell::{Cell, Parameter};
///
/// let mut cell = Cell::new(2.0);
/// Parameter::Epsilon.set(&mut cell, 0.8);
/// assert_eq!(Parameter::Epsilon.get(&cell), 0.8);
/// assert_eq!("cue.amplitude".parse::<Parameter>().unwrap().to_string(), "cue[0].amplitude");
/// assert_eq!("regulator.kappa".parse::<Parameter>().unwrap().name(), "kappa");
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
    /// Flattening of the shell.
    #[serde(rename = "shell_flattening")]
    Flattening,
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
    /// Spontaneous curvature C0.
    SpontaneousCurvature,
    /// Normal friction Γ_n.
    NormalFriction,
    /// A quantity of one term of the cue.
    Cue {
        /// Index of the term, from 0.
        term: usize,
        /// The quantity of the term.
        quantity: Quantity,
    },
    /// A number of the cue's regulator.
    Regulator(RegulatorQuantity),
    /// A constant of the cell's law. In files it is always text, `law.NAME`.
    #[serde(skip_deserializing)]
    Law(ConstantName),
}

/// A name that does not denote a parameter.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{name:?} is not a parameter of a cell")]
pub struct UnknownParameter {
    /// The name.
    pub name: String,
}

impl Parameter {
    /// Names of the numbers of a cue, for listings: FIELD is any of [`Field::ALL`](super::cue::Field::ALL), and `cue` denotes the
    /// first term.
    pub const OF_CUES: [&str; 11] = [
        "cue.u0",
        "cue.omega",
        "cue.amplitude",
        "cue.k_ap and other constants of PAR polarity",
        "regulator.turnover",
        "regulator.diffusion",
        "regulator.u0",
        "regulator.omega",
        "regulator.amplitude",
        "regulator.FIELD",
        "regulator.FIELD.half",
    ];

    /// Every parameter except the numbers of cues, for listings.
    pub const ALL: [Parameter; 16] = {
        use Parameter::*;
        [
            XiS,
            XiRatio,
            Gain,
            R0,
            Epsilon,
            Aspect,
            P0,
            W,
            Flattening,
            Kappa,
            EtaB,
            EtaS,
            Friction,
            Tension,
            SpontaneousCurvature,
            NormalFriction,
        ]
    };

    /// The numbers of a cue, first from its terms, then from its regulator, without the constants of PAR polarity.
    pub fn of_cue(cue: &Cue) -> Vec<Parameter> {
        let has = |term: usize| move |quantity: &Quantity| cue.terms()[term].quantity(*quantity).is_some();
        let of_term =
            |term| Quantity::ALL.into_iter().filter(has(term)).map(move |quantity| Parameter::Cue { term, quantity });
        let of_regulator = cue.regulator().into_iter().flat_map(Regulator::quantities).map(Parameter::Regulator);
        (0..cue.terms().len()).flat_map(of_term).chain(of_regulator).collect()
    }

    /// The allowed values named in errors if a requested number does not exist in a cue.
    pub fn allowed_of_cue(cue: &Cue) -> String {
        match (cue.terms().len(), cue.regulator()) {
            (0, None) => "a number of a cue, and none is given".to_owned(),
            (0, Some(_)) => format!("a number of the cue's regulator: {cue}"),
            (terms, None) => format!("a number of the cue's terms, cue[0] to cue[{}]: {cue}", terms - 1),
            (terms, Some(_)) => {
                format!("a number of the cue's terms, cue[0] to cue[{}], or of its regulator: {cue}", terms - 1)
            }
        }
    }

    /// The allowed values named in errors if a requested constant does not exist in the cell's law.
    pub fn allowed_of_law(cell: &Cell, asked: ConstantName) -> String {
        let Some(law) = &cell.law else { return "given with a law that has this constant".to_owned() };
        let known: Vec<&str> = law.parameters().map(Parameter::name).collect();
        if known.is_empty() {
            return format!("given with a law that has this constant; {:?} has none", law.name());
        }
        let nearest = did_you_mean(asked.whole(), known.iter().copied());
        format!("a constant of the law {:?}: {}{nearest}", law.name(), known.join(", "))
    }

    /// Whether it is a number of a cue.
    pub fn is_of_cue(self) -> bool {
        matches!(self, Parameter::Cue { .. } | Parameter::Regulator(_))
    }

    /// Its row in the table of parameters, and its name; `None` for a number of a cue or of a law.
    fn row(self) -> Option<(&'static Number, &'static str)> {
        parameters().find(|(row, ..)| row.parameter == self).map(|(row, name, _)| (row, name))
    }

    /// Its value; `None` for a quantity that the cell's cue or law lacks.
    fn read(self, cell: &Cell) -> Option<f64> {
        match self {
            Parameter::Cue { term, quantity } => cell.cue.terms().get(term)?.quantity(quantity),
            Parameter::Regulator(quantity) => cell.cue.regulator()?.quantity(quantity),
            Parameter::Law(name) => cell.law.as_ref()?.constant(name),
            _ => self.row().map(|(row, _)| (row.get)(cell)),
        }
    }

    /// Its value; 0 for a quantity that the cell's cue or law lacks.
    pub fn get(self, cell: &Cell) -> f64 {
        self.read(cell).unwrap_or(0.0)
    }

    /// Whether the cell has it: false for quantities of terms that its cue lacks, and for constants of another law.
    pub fn is_of(self, cell: &Cell) -> bool {
        self.read(cell).is_some()
    }

    /// Sets it. A quantity that the cell's cue or law lacks is ignored.
    pub fn set(self, cell: &mut Cell, value: f64) {
        let slot = match self {
            Parameter::Cue { term, quantity } => {
                cell.cue.terms_mut().get_mut(term).and_then(|term| term.quantity_mut(quantity))
            }
            Parameter::Regulator(quantity) => {
                cell.cue.regulator_mut().and_then(|regulator| regulator.quantity_mut(quantity))
            }
            Parameter::Law(name) => cell.law.as_mut().and_then(|law| law.constant_mut(name)),
            _ => self.row().map(|(row, _)| (row.slot)(cell)),
        };
        if let Some(slot) = slot {
            *slot = value;
        }
    }

    /// Checks a value. The value of a quantity of a cue's profile, or of a law's constant, need only be finite.
    ///
    /// # Errors
    /// The allowed values.
    pub fn validate(self, value: f64) -> Result<(), &'static str> {
        if let Parameter::Regulator(quantity) = self {
            return quantity.refused(value).map_or(Ok(()), Err);
        }
        if let Parameter::Cue { quantity: Quantity::Par(constant), .. } = self {
            return constant.refused(value).map_or(Ok(()), Err);
        }
        match self.row() {
            Some((row, _)) => (row.validate)(value),
            None if value.is_finite() => Ok(()),
            None => Err("a finite number"),
        }
    }

    /// Its name in files and options; for a cue's quantity only the name of the quantity, for a law's constant with the prefix `law.`.
    pub fn name(self) -> &'static str {
        match self {
            Parameter::Cue { quantity, .. } => quantity.name(),
            Parameter::Regulator(quantity) => quantity.name(),
            Parameter::Law(name) => name.whole(),
            _ => self.row().map_or("", |(_, name)| name),
        }
    }
}

impl std::fmt::Display for Parameter {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Parameter::Cue { term, quantity } => write!(f, "cue[{term}].{}", quantity.name()),
            Parameter::Regulator(quantity) => write!(f, "regulator.{}", quantity.name()),
            other => f.write_str(other.name()),
        }
    }
}

impl std::str::FromStr for Parameter {
    type Err = UnknownParameter;

    /// Parses a name; `cue.u0` is the first term's u0, `cue[1].u0` the second's, `regulator.kappa` the regulator's coupling to κ,
    /// `law.a` the constant a of the cell's law.
    fn from_str(text: &str) -> Result<Parameter, UnknownParameter> {
        let unknown = || UnknownParameter { name: text.to_owned() };
        if let Some(name) = text.strip_prefix("regulator.") {
            return RegulatorQuantity::named(name).map(Parameter::Regulator).ok_or_else(unknown);
        }
        if let Some(name) = ConstantName::read(text) {
            return Ok(Parameter::Law(name));
        }
        if let Some(rest) = text.strip_prefix("cue") {
            let (index, name) = rest.split_once('.').ok_or_else(unknown)?;
            let number = |index: &str| index.strip_prefix('[')?.strip_suffix(']')?.parse().ok();
            let term = if index.is_empty() { Some(0) } else { number(index) }.ok_or_else(unknown)?;
            let quantity = Quantity::named(name).ok_or_else(unknown)?;
            return Ok(Parameter::Cue { term, quantity });
        }
        let named = parameters().find(|(_, name, aliases)| *name == text || aliases.contains(&text));
        named.map(|(row, ..)| row.parameter).ok_or_else(unknown)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_a_cue_have_names_that_are_read_back_set_and_checked() {
        let cue = "kappa:gradient,amplitude=0.1+regulator:step,u0=0.4,omega=0.3Lh,amplitude=1,turnover=10,diffusion=1,kappa=0.2,tension=30,tension.half=10";
        let mut cell = Cell::new(2.0).with_cue(cue.parse().unwrap());
        let names: Vec<String> = Parameter::of_cue(&cell.cue).iter().map(Parameter::to_string).collect();
        let expected = "cue[0].amplitude regulator.u0 regulator.omega regulator.amplitude regulator.turnover regulator.diffusion regulator.kappa regulator.tension regulator.tension.half";
        assert_eq!(names.join(" "), expected);
        for (k, parameter) in Parameter::of_cue(&cell.cue).into_iter().enumerate() {
            assert_eq!(names[k].parse(), Ok(parameter));
            assert!(parameter.is_of_cue() && parameter.is_of(&cell), "{parameter}");
            parameter.set(&mut cell, 0.5 + k as f64);
            assert_eq!(parameter.get(&cell), 0.5 + k as f64);
        }
        let read = |name: &str| name.parse::<Parameter>().unwrap();
        assert!(!read("regulator.friction").is_of(&cell) && !read("regulator.kappa.half").is_of(&cell));
        assert_eq!(read("regulator.friction").get(&cell), 0.0);
        for (name, good, bad) in [
            ("regulator.turnover", 0.0, -1.0),
            ("regulator.diffusion", 0.05, 0.049),
            ("regulator.kappa", -1e4, 1.1e4),
            ("regulator.tension.half", 10.0, 0.0),
            ("regulator.u0", 0.3, f64::NAN),
        ] {
            assert!(read(name).validate(good).is_ok() && read(name).validate(bad).is_err(), "{name}");
        }
        for wrong in
            ["regulator", "regulator.", "regulator.diluted", "regulator.kapa", "regulator.half", "regulator[0].u0"]
        {
            assert!(wrong.parse::<Parameter>().is_err(), "{wrong}");
        }
    }
}
