//! Regulators in RON and JSON: `regulator(profile: band, u0: …, omega: …, amplitude: …, turnover: …, diffusion: …, couplings: {"kappa": …})`.

use serde::de::value::MapAccessDeserializer;
use serde::de::{Error, MapAccess, Visitor};
use serde::ser::SerializeStructVariant;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::record::{Name, ProfileName, index, one_width, serialize_place};
use super::regulator_text::{NO_SOURCE, RegulatorNumbers};
use super::text::{Numbers, REGULATOR, field};
use super::{CueError, Field, Regulator, RegulatorQuantity, WrittenCue};

pub(super) const KEYS: [&str; 13] = [
    "profile",
    "u0",
    "omega",
    "omega_length",
    "omega_um",
    "amplitude",
    "turnover",
    "turnover_per_s",
    "diffusion",
    "diffusion_um2_per_s",
    "diluted",
    "couplings",
    "half",
];

/// Numbers by the name of a field, in the order in which they are written; one given twice is there twice.
#[derive(Default)]
struct ByField(Vec<(String, f64)>);

impl<'de> Deserialize<'de> for ByField {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<ByField, D::Error> {
        struct Pairs;
        impl<'de> Visitor<'de> for Pairs {
            type Value = ByField;

            fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.write_str("numbers by field, as in {\"kappa\": 0.3}")
            }

            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<ByField, A::Error> {
                let mut pairs = Vec::new();
                while let Some(pair) = map.next_entry()? {
                    pairs.push(pair);
                }
                Ok(ByField(pairs))
            }
        }
        deserializer.deserialize_map(Pairs)
    }
}

impl ByField {
    fn read(self) -> Result<Vec<(Field, f64)>, CueError> {
        let of_regulator = |error: CueError| CueError { field: REGULATOR.to_owned(), ..error };
        self.0.into_iter().map(|(name, number)| Ok((field(&name).map_err(of_regulator)?, number))).collect()
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields, rename = "regulator")]
struct Record {
    profile: Option<Name>,
    u0: Option<f64>,
    omega: Option<f64>,
    omega_length: Option<f64>,
    omega_um: Option<f64>,
    amplitude: Option<f64>,
    turnover: Option<f64>,
    turnover_per_s: Option<f64>,
    diffusion: Option<f64>,
    diffusion_um2_per_s: Option<f64>,
    diluted: Option<bool>,
    #[serde(default)]
    couplings: ByField,
    #[serde(default)]
    half: ByField,
}

impl Record {
    fn regulator(self) -> Result<WrittenCue, String> {
        let twice =
            |first, second| Err(format!("{REGULATOR}: {first} and {second} are one number in two units; give one"));
        if self.turnover.is_some() && self.turnover_per_s.is_some() {
            return twice("turnover", "turnover_per_s");
        }
        if self.diffusion.is_some() && self.diffusion_um2_per_s.is_some() {
            return twice("diffusion", "diffusion_um2_per_s");
        }
        let (omega, micrometres) = one_width(REGULATOR, self.omega, self.omega_length, self.omega_um)?;
        let per_s = self.turnover_per_s.map(|_| RegulatorQuantity::Turnover);
        let um2_per_s = self.diffusion_um2_per_s.map(|_| RegulatorQuantity::Diffusion);
        let numbers = || -> Result<WrittenCue, CueError> {
            RegulatorNumbers {
                source: Numbers { u0: self.u0, omega, micrometres, amplitude: self.amplitude },
                turnover: self.turnover.or(self.turnover_per_s),
                diffusion: self.diffusion.or(self.diffusion_um2_per_s),
                diluted: self.diluted,
                couplings: self.couplings.read()?,
                halves: self.half.read()?,
                physical: per_s.into_iter().chain(um2_per_s).collect(),
            }
            .regulator(self.profile.as_ref().map(|Name::Of(name)| name.as_str()))
        };
        numbers().map_err(|error| error.to_string())
    }
}

/// Reads the numbers of a regulator.
pub(super) struct RegulatorVisitor;

impl<'de> Visitor<'de> for RegulatorVisitor {
    type Value = WrittenCue;

    fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(
            "the numbers of a regulator, as in regulator(profile: none, turnover: 10, diffusion: 1, couplings: {\"activity\": 0.3})",
        )
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<WrittenCue, A::Error> {
        Record::deserialize(MapAccessDeserializer::new(map))?.regulator().map_err(A::Error::custom)
    }
}

/// Numbers by field, to be written.
struct Written(Vec<(Field, f64)>);

impl Serialize for Written {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.0.iter().map(|(field, number)| (field.name(), number)))
    }
}

/// A regulator, as a variant of a cue.
pub(super) struct RegulatorRecord<'a>(pub &'a Regulator);

impl Serialize for RegulatorRecord<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let Regulator { source, turnover, diffusion, diluted, couplings } = self.0;
        let mut out = serializer.serialize_struct_variant("cue", index(REGULATOR), REGULATOR, 5)?;
        out.serialize_field("profile", &ProfileName(source.map_or(NO_SOURCE, |source| source.profile.name())))?;
        if let Some(source) = source {
            serialize_place(&mut out, &source.profile)?;
            out.serialize_field("amplitude", &source.amplitude)?;
        }
        out.serialize_field("turnover", turnover)?;
        out.serialize_field("diffusion", diffusion)?;
        if !diluted {
            out.serialize_field("diluted", &false)?;
        }
        out.serialize_field("couplings", &Written(couplings.iter().map(|c| (c.field, c.strength)).collect()))?;
        let halves: Vec<(Field, f64)> = couplings.iter().filter_map(|c| Some((c.field, c.half?))).collect();
        if !halves.is_empty() {
            out.serialize_field("half", &Written(halves))?;
        }
        out.end()
    }
}
