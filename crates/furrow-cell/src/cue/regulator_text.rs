//! Regulators as text: `regulator:PROFILE|none,key=value,…`.

use std::fmt;

use super::RegulatorQuantity::{Diffusion, Half, Strength, Turnover};
use super::profile::NAMES;
use super::text::{Numbers, REGULATOR, entries, key_and_value, number, once, without_unit, write_spread};
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

/// The keys given for a regulator, before missing ones are reported.
#[derive(Default)]
struct Given {
    source: Numbers,
    /// The other numbers, in the order of the text.
    numbers: Vec<(RegulatorQuantity, f64)>,
    diluted: Option<bool>,
    /// The numbers that are in µm and seconds.
    physical: Vec<RegulatorQuantity>,
}

impl Given {
    /// The regulator, if exactly the required numbers are given. Without a profile it is a band if it has the numbers of one.
    fn regulator(self, profile: Option<&str>) -> Result<WrittenCue, CueError> {
        let Given { source, numbers, diluted, mut physical } = self;
        let refuse = |quantity: RegulatorQuantity, value: String, allowed: &str| {
            CueError::new(format!("{REGULATOR}.{}", quantity.name()), value, allowed)
        };
        let of_source = [
            (Quantity::U0, source.u0.is_some()),
            (Quantity::Omega, source.omega.is_some()),
            (Quantity::Amplitude, source.amplitude.is_some()),
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
                physical.extend(source.micrometres.then_some(RegulatorQuantity::Source(Quantity::Omega)));
                let (profile, amplitude) = source.profile(REGULATOR, profile.unwrap_or(NAMES[0]))?;
                Some(Source { profile, amplitude })
            }
        };
        let get = |wanted| numbers.iter().find(|(quantity, _)| *quantity == wanted).map(|(_, number)| *number);
        let needed = |quantity| {
            get(quantity).ok_or_else(|| refuse(quantity, "(not given)".to_owned(), "given: it has no default"))
        };
        let (turnover, diffusion) = (needed(Turnover)?, needed(Diffusion)?);
        let mut couplings = Vec::new();
        for (quantity, number) in &numbers {
            match *quantity {
                Strength(field) => couplings.push(Coupling { field, strength: *number, half: get(Half(field)) }),
                Half(field) if get(Strength(field)).is_none() => {
                    let name = field.name();
                    let allowed = format!("left out, or given with {name}: it is the half-saturation of {name}");
                    return Err(refuse(*quantity, number.to_string(), &allowed));
                }
                _ => {}
            }
        }
        if couplings.is_empty() {
            let allowed =
                format!("given with what it does, as in activity=0.3: {}", Field::ALL.map(Field::name).join(", "));
            return Err(CueError::new(REGULATOR, "(no field)", allowed));
        }
        let regulator = Regulator { source, turnover, diffusion, diluted: diluted.unwrap_or(true), couplings };
        Ok(WrittenCue::regulator(regulator, physical))
    }

    fn set(&mut self, profile: &str, key: &str, value: &str) -> Result<(), CueError> {
        if self.source.set(REGULATOR, key, value)? {
            return Ok(());
        }
        if key == "diluted" {
            let refused = |_| CueError::new(format!("{REGULATOR}.{key}"), shown(value), "true or false");
            let diluted = value.parse().map_err(refused)?;
            return once(self.diluted.replace(diluted).is_some(), REGULATOR, key, value);
        }
        let quantity = RegulatorQuantity::named(key).ok_or_else(|| unknown_key(profile, key))?;
        let (unit, allowed) = match quantity {
            Turnover => ("/s", "a number, in 1/τ, or with /s behind it in 1/s"),
            Diffusion => ("um2/s", "a number, in L_h²/τ, or with um2/s behind it in µm²/s"),
            _ => ("", "a number"),
        };
        let physical = without_unit(value, unit).filter(|_| !unit.is_empty());
        let number = number(REGULATOR, key, physical.unwrap_or(value), value, allowed)?;
        once(self.numbers.iter().any(|(given, _)| *given == quantity), REGULATOR, key, value)?;
        self.physical.extend(physical.map(|_| quantity));
        self.numbers.push((quantity, number));
        Ok(())
    }
}

fn unknown_key(profile: &str, key: &str) -> CueError {
    let own = ["u0", "omega", "amplitude", "turnover", "diffusion", "diluted"];
    let fields = Field::ALL.map(Field::name);
    let nearest = did_you_mean(key, own.into_iter().chain(fields));
    let allowed = format!("one of {}; or a field, {}; or FIELD.half{nearest}", own.join(", "), fields.join(", "));
    CueError::new(format!("{REGULATOR}:{profile}"), shown(key), allowed)
}

/// Parses the text after the colon.
pub(super) fn parse(list: &str) -> Result<WrittenCue, CueError> {
    let known: Vec<&str> = [NO_SOURCE].into_iter().chain(NAMES).collect();
    let (profile, entries) = entries(REGULATOR, list, &known);
    let profile = profile?;
    let mut given = Given::default();
    for entry in entries {
        let part = profile.unwrap_or(NAMES[0]);
        let (key, value) = key_and_value(&format!("{REGULATOR}:{part}"), entry)?;
        given.set(part, key, value)?;
    }
    given.regulator(profile)
}
