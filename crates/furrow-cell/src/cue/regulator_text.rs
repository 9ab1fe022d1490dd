//! Regulators as text: `regulator:PROFILE|none,key=value,…`.

use std::fmt;

use super::profile::NAMES;
use super::text::{Numbers, REGULATOR, entries, field, key_and_value, number, once, without_unit, write_spread};
use super::{Coupling, CueError, Field, Quantity, Regulator, RegulatorQuantity, Source, WrittenCue};
use furrow_input::{did_you_mean, shown};

/// The name of the profile of a regulator without a source.
pub(super) const NO_SOURCE: &str = "none";

impl fmt::Display for Regulator {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{REGULATOR}:")?;
        match &self.source {
            Some(source) => write_spread(f, &source.profile, source.amplitude)?,
            None => f.write_str(NO_SOURCE)?,
        }
        write!(f, ",turnover={},diffusion={}", self.turnover, self.diffusion)?;
        if !self.diluted {
            f.write_str(",diluted=false")?;
        }
        for Coupling { field, strength, half } in &self.couplings {
            write!(f, ",{}={strength}", field.name())?;
            if let Some(half) = half {
                write!(f, ",{}={half}", RegulatorQuantity::Half(*field).name())?;
            }
        }
        Ok(())
    }
}

/// Numbers given for a regulator, before it is known whether they are all there.
#[derive(Default)]
pub(super) struct RegulatorNumbers {
    pub source: Numbers,
    pub turnover: Option<f64>,
    pub diffusion: Option<f64>,
    pub diluted: Option<bool>,
    pub couplings: Vec<(Field, f64)>,
    pub halves: Vec<(Field, f64)>,
    /// Which of turnover and diffusion are in µm and seconds.
    pub physical: Vec<RegulatorQuantity>,
}

impl RegulatorNumbers {
    /// The regulator, if every number it needs is given, and no other. No profile is a band where it has numbers of one.
    pub fn regulator(mut self, profile: Option<&str>) -> Result<WrittenCue, CueError> {
        let refuse =
            |key: &str, value: String, allowed: &str| CueError::new(format!("{REGULATOR}.{key}"), value, allowed);
        let missing = |key| refuse(key, "(not given)".to_owned(), "given: it has no default");
        let of_source = [
            (Quantity::U0, self.source.u0.is_some()),
            (Quantity::Omega, self.source.omega.is_some()),
            (Quantity::Amplitude, self.source.amplitude.is_some()),
        ];
        let given = of_source.iter().find(|(_, given)| *given);
        let source = match (profile, given) {
            (Some(NO_SOURCE), Some((spare, _))) => {
                let allowed = "left out: a regulator without a source does not have it";
                return Err(CueError::new(format!("{REGULATOR}:{NO_SOURCE}"), shown(spare.name()), allowed));
            }
            (Some(NO_SOURCE), None) => None,
            (None, None) => {
                let allowed = format!("given: one of {NO_SOURCE}, {}", NAMES.join(", "));
                return Err(CueError::new(format!("{REGULATOR}.profile"), "(not given)", allowed));
            }
            (profile, _) => {
                if self.source.micrometres {
                    self.physical.push(RegulatorQuantity::Source(Quantity::Omega));
                }
                let (profile, amplitude) = self.source.spread(REGULATOR, profile.unwrap_or(NAMES[0]))?;
                Some(Source { profile, amplitude })
            }
        };
        let turnover = self.turnover.ok_or_else(|| missing("turnover"))?;
        let diffusion = self.diffusion.ok_or_else(|| missing("diffusion"))?;
        let mut couplings: Vec<Coupling> = Vec::new();
        for (field, strength) in self.couplings {
            let repeated = couplings.iter().any(|coupling| coupling.field == field);
            once(repeated, REGULATOR, field.name(), &strength.to_string())?;
            couplings.push(Coupling { field, strength, half: None });
        }
        for (field, half) in self.halves {
            let name = RegulatorQuantity::Half(field).name();
            let coupling = couplings.iter_mut().find(|coupling| coupling.field == field);
            let allowed = format!("left out, or given with {0}: it is the half-saturation of {0}", field.name());
            let coupling = coupling.ok_or_else(|| refuse(name, half.to_string(), &allowed))?;
            once(coupling.half.replace(half).is_some(), REGULATOR, name, &half.to_string())?;
        }
        if couplings.is_empty() {
            let allowed =
                format!("given with what it does, as in activity=0.3: {}", Field::ALL.map(Field::name).join(", "));
            return Err(CueError::new(REGULATOR, "(no field)", allowed));
        }
        let regulator = Regulator { source, turnover, diffusion, diluted: self.diluted.unwrap_or(true), couplings };
        Ok(WrittenCue::regulator(regulator, self.physical))
    }

    /// A number that may be in µm and seconds.
    fn physical(
        &mut self,
        quantity: RegulatorQuantity,
        unit: &str,
        value: &str,
        allowed: &str,
    ) -> Result<f64, CueError> {
        let without = without_unit(value, unit);
        self.physical.extend(without.map(|_| quantity));
        number(REGULATOR, quantity.name(), without.unwrap_or(value), value, allowed)
    }

    fn set(&mut self, profile: &str, key: &str, value: &str) -> Result<(), CueError> {
        use RegulatorQuantity::{Diffusion, Turnover};
        if self.source.set(REGULATOR, key, value)? {
            return Ok(());
        }
        let repeated = match key {
            "turnover" => {
                let turnover = self.physical(Turnover, "/s", value, "a number, in 1/τ, or with /s behind it in 1/s")?;
                self.turnover.replace(turnover).is_some()
            }
            "diffusion" => {
                let allowed = "a number, in L_h²/τ, or with um2/s behind it in µm²/s";
                let diffusion = self.physical(Diffusion, "um2/s", value, allowed)?;
                self.diffusion.replace(diffusion).is_some()
            }
            "diluted" => {
                let refused = |_| CueError::new(format!("{REGULATOR}.diluted"), shown(value), "true or false");
                self.diluted.replace(value.parse().map_err(refused)?).is_some()
            }
            _ => {
                let (name, half) = key.strip_suffix(".half").map_or((key, false), |name| (name, true));
                let field = field(name).map_err(|_| unknown_key(profile, key))?;
                let list = if half { &mut self.halves } else { &mut self.couplings };
                list.push((field, number(REGULATOR, key, value, value, "a number")?));
                // Whether it is given twice is seen when all are put together.
                false
            }
        };
        once(repeated, REGULATOR, key, value)
    }
}

fn unknown_key(profile: &str, key: &str) -> CueError {
    let own = ["u0", "omega", "amplitude", "turnover", "diffusion", "diluted"];
    let fields = Field::ALL.map(Field::name);
    let nearest = did_you_mean(key, own.into_iter().chain(fields));
    let allowed = format!("one of {}; or a field, {}; or FIELD.half{nearest}", own.join(", "), fields.join(", "));
    CueError::new(format!("{REGULATOR}:{profile}"), shown(key), allowed)
}

/// Reads the text behind the colon.
pub(super) fn parse(list: &str) -> Result<WrittenCue, CueError> {
    let (profile, entries) = entries(REGULATOR, list, &[NO_SOURCE, NAMES[0], NAMES[1], NAMES[2], NAMES[3], NAMES[4]]);
    let profile = profile?;
    let mut numbers = RegulatorNumbers::default();
    for entry in entries {
        let part = profile.unwrap_or(NAMES[0]);
        let (key, value) = key_and_value(&format!("{REGULATOR}:{part}"), entry)?;
        numbers.set(part, key, value)?;
    }
    numbers.regulator(profile)
}
