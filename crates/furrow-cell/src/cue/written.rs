//! A parsed cue before conversion: joins its parts and converts numbers in µm and seconds to the model's units.

use super::{Cue, CueError, LENGTH_UM, Profile, Quantity, Regulator, RegulatorQuantity, Term};
use crate::{Cell, Parameter};

/// L_h and τ in physical units, for cues with numbers in µm and seconds.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Scale {
    /// L_h, in µm.
    pub length_um: Option<f64>,
    /// τ, in seconds.
    pub time_s: Option<f64>,
}

impl Scale {
    /// Converts a width, a turnover or a diffusion from µm and seconds to L_h and τ.
    ///
    /// # Errors
    /// L_h or τ is needed but unknown.
    fn converted(&self, parameter: Parameter, value: f64) -> Result<f64, &'static str> {
        const NO_LENGTH: &str =
            "in L_h, or in um where the lineage file says how long L_h is, as in units: (length_um: 3.16)";
        const NO_TIME: &str =
            "in 1/τ, or in 1/s where the lineage file says how long τ is, as in units: (time_min: 2.0)";
        const NEITHER: &str = "in L_h²/τ, or in um2/s where the lineage file says how long L_h and τ are, as in units: (length_um: 3.16, time_min: 2.0)";
        match parameter {
            Parameter::Regulator(RegulatorQuantity::Turnover) => Ok(value * self.time_s.ok_or(NO_TIME)?),
            Parameter::Regulator(RegulatorQuantity::Diffusion) => {
                let (length, time) = self.length_um.zip(self.time_s).ok_or(NEITHER)?;
                Ok(value * time / (length * length))
            }
            _ => Ok(value / self.length_um.ok_or(NO_LENGTH)?),
        }
    }
}

/// A cue before L_h and τ are known.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct WrittenCue {
    cue: Cue,
    /// Its numbers that are in µm and seconds.
    physical: Vec<Parameter>,
}

impl WrittenCue {
    /// One term; `micrometres` says whether its width is in µm.
    pub(super) fn term(term: Term, micrometres: bool) -> WrittenCue {
        let omega = Parameter::Cue { term: 0, quantity: Quantity::Omega };
        let cue = Cue { terms: vec![term], regulator: None };
        WrittenCue { cue, physical: if micrometres { vec![omega] } else { Vec::new() } }
    }

    /// A regulator; `physical` are its numbers in µm and seconds.
    pub(super) fn regulator(regulator: Regulator, physical: Vec<RegulatorQuantity>) -> WrittenCue {
        let cue = Cue { terms: Vec::new(), regulator: Some(regulator.sorted()) };
        WrittenCue { cue, physical: physical.into_iter().map(Parameter::Regulator).collect() }
    }

    /// Whether it has a number in µm.
    pub fn is_in_micrometres(&self) -> bool {
        let has_no_length = Parameter::Regulator(RegulatorQuantity::Turnover);
        self.physical.iter().any(|parameter| *parameter != has_no_length)
    }

    /// The number of terms.
    pub(super) fn terms(&self) -> usize {
        self.cue.terms.len()
    }

    /// Adds the terms and the regulator of another cue.
    ///
    /// # Errors
    /// Both cues have a regulator.
    pub(super) fn add(&mut self, other: WrittenCue) -> Result<(), CueError> {
        let before = self.cue.terms.len();
        let WrittenCue { cue: Cue { terms, regulator }, physical } = other;
        if let (Some(_), Some(second)) = (&self.cue.regulator, &regulator) {
            let allowed = "the only one: a cue has one regulator, which may act on several fields";
            return Err(CueError::new("regulator", second, allowed));
        }
        self.cue.terms.extend(terms);
        self.cue.regulator = self.cue.regulator.take().or(regulator);
        self.physical.extend(physical.into_iter().map(|parameter| match parameter {
            Parameter::Cue { term, quantity } => Parameter::Cue { term: before + term, quantity },
            other => other,
        }));
        Ok(())
    }

    /// Converts the cue to L_h and τ. Its numbers are not checked.
    ///
    /// # Errors
    /// A number is in µm or seconds, but the scale lacks L_h or τ.
    pub fn in_units(self, scale: &Scale) -> Result<Cue, CueError> {
        let WrittenCue { cue, physical } = self;
        let mut cell = Cell::new(1.0).with_cue(cue);
        for profile in cell.cue.profiles_mut() {
            if let Profile::Par { length_um: length @ None, .. } = profile {
                *length = scale.length_um.filter(|um| *um != LENGTH_UM);
            }
        }
        for parameter in physical {
            let written = parameter.get(&cell);
            let value = scale.converted(parameter, written).map_err(|allowed| {
                let field = match parameter {
                    Parameter::Cue { term, .. } => format!("{}.omega", cell.cue.terms[term].field.name()),
                    other => other.to_string(),
                };
                let unit = match parameter {
                    Parameter::Regulator(RegulatorQuantity::Turnover) => "/s",
                    Parameter::Regulator(RegulatorQuantity::Diffusion) => "um2/s",
                    _ => "um",
                };
                CueError::new(field, format!("{written}{unit}"), allowed)
            })?;
            parameter.set(&mut cell, value);
        }
        Ok(cell.cue)
    }
}

impl From<Cue> for WrittenCue {
    fn from(cue: Cue) -> WrittenCue {
        WrittenCue { cue, physical: Vec::new() }
    }
}
