//! Cues in RON and JSON: `none`, `FIELD(profile: …, u0: …, omega: …, amplitude: …)`, `regulator(…)`, or `sum([…])` of several.
//!
//! The profile may be left out, and is then a band. `omega_length` in place of `omega` is a width in L_h, `omega_um` one in
//! µm. No other number has a default: a missing one is refused, and so is one given twice.

use serde::de::value::MapAccessDeserializer;
use serde::de::{EnumAccess, Error, MapAccess, VariantAccess, Visitor};
use serde::ser::SerializeStructVariant;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::profile::NAMES;
use super::regulator_record::{RegulatorRecord, RegulatorVisitor};
use super::text::{Numbers, REGULATOR, field_of_term};
use super::{Cue, Field, Profile, Quantity, Scale, Term, Width, WrittenCue};

const KEYS: [&str; 6] = ["profile", "u0", "omega", "omega_length", "omega_um", "amplitude"];

/// `none`, the fields, `sum` and `regulator`.
pub(super) const VARIANTS: [&str; Field::ALL.len() + 3] = {
    let mut names = ["none"; Field::ALL.len() + 3];
    let mut k = 0;
    while k < Field::ALL.len() {
        names[k + 1] = Field::ALL[k].name();
        k += 1;
    }
    names[Field::ALL.len() + 1] = "sum";
    names[Field::ALL.len() + 2] = REGULATOR;
    names
};

/// The place of a name among the variants.
pub(super) fn index(name: &str) -> u32 {
    VARIANTS.iter().position(|other| *other == name).unwrap_or(0) as u32
}

/// A name as it stands in a file: a bare word in RON, a string in JSON.
#[derive(Deserialize)]
#[serde(field_identifier)]
pub(super) enum Name {
    Of(String),
}

/// The name of a profile.
pub(super) struct ProfileName(pub &'static str);

impl Serialize for ProfileName {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let index = NAMES.iter().position(|other| *other == self.0).unwrap_or(0) as u32;
        serializer.serialize_unit_variant("profile", index, self.0)
    }
}

/// The one width of those given, and whether it is in µm.
///
/// # Errors
/// There is more than one; errors call what they are of `name`.
pub(super) fn one_width(
    name: &str,
    omega: Option<f64>,
    length: Option<f64>,
    micrometres: Option<f64>,
) -> Result<(Option<Width>, bool), String> {
    let given = [("omega", omega), ("omega_length", length), ("omega_um", micrometres)];
    let mut given = given.into_iter().filter(|(_, width)| width.is_some()).map(|(key, _)| key);
    if let (Some(first), Some(second)) = (given.next(), given.next()) {
        return Err(format!("{name}: {first} and {second} are two widths; give one"));
    }
    let length = length.or(micrometres).map(Width::Length);
    Ok((omega.map(Width::Fraction).or(length), micrometres.is_some()))
}

/// Writes the numbers of a profile.
pub(super) fn serialize_place<S: SerializeStructVariant>(out: &mut S, profile: &Profile) -> Result<(), S::Error> {
    let far = matches!(profile, Profile::Par { far: true, .. }).then_some(1.0);
    if let Some(u0) = profile.quantity(Quantity::U0).or(far) {
        out.serialize_field("u0", &u0)?;
    }
    match profile.width() {
        Some(Width::Fraction(omega)) => out.serialize_field("omega", &omega),
        Some(Width::Length(omega)) => out.serialize_field("omega_length", &omega),
        None => Ok(()),
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields, rename = "term")]
struct Record {
    profile: Option<Name>,
    u0: Option<f64>,
    omega: Option<f64>,
    omega_length: Option<f64>,
    omega_um: Option<f64>,
    amplitude: Option<f64>,
}

impl Record {
    fn term(self, field: Field) -> Result<WrittenCue, String> {
        let (omega, micrometres) = one_width(field.name(), self.omega, self.omega_length, self.omega_um)?;
        let Name::Of(name) = self.profile.unwrap_or(Name::Of(NAMES[0].to_owned()));
        let numbers = Numbers { u0: self.u0, omega, micrometres, amplitude: self.amplitude };
        numbers.term(field, &name).map_err(|e| e.to_string())
    }
}

/// One part of a cue, as the variant of an enum named after its field.
enum PartRecord<'a> {
    Term(&'a Term),
    Regulator(RegulatorRecord<'a>),
}

impl Serialize for PartRecord<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let Term { field, profile, amplitude } = match self {
            PartRecord::Term(term) => term,
            PartRecord::Regulator(regulator) => return regulator.serialize(serializer),
        };
        let mut out = serializer.serialize_struct_variant("cue", index(field.name()), field.name(), 4)?;
        out.serialize_field("profile", &ProfileName(profile.name()))?;
        serialize_place(&mut out, profile)?;
        out.serialize_field("amplitude", amplitude)?;
        out.end()
    }
}

impl Serialize for Cue {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let regulator = self.regulator().map(|regulator| PartRecord::Regulator(RegulatorRecord(regulator)));
        let parts: Vec<PartRecord> = self.terms().iter().map(PartRecord::Term).chain(regulator).collect();
        match &parts[..] {
            [] => serializer.serialize_unit_variant("cue", 0, "none"),
            [part] => part.serialize(serializer),
            parts => serializer.serialize_newtype_variant("cue", index("sum"), "sum", parts),
        }
    }
}

/// Reads the numbers of a term of a known field.
struct NumbersOf(Field);

impl<'de> Visitor<'de> for NumbersOf {
    type Value = WrittenCue;

    fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "the numbers of a term, as in {}(profile: band, u0: 0.5, omega: 0.1, amplitude: 0.1)", self.0.name())
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<WrittenCue, A::Error> {
        Record::deserialize(MapAccessDeserializer::new(map))?.term(self.0).map_err(A::Error::custom)
    }
}

/// Reads one part or a whole cue.
struct CueVisitor;

impl<'de> Visitor<'de> for CueVisitor {
    type Value = WrittenCue;

    fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("a cue: none, FIELD(profile: .., u0: .., omega: .., amplitude: ..), regulator(..) or sum([..])")
    }

    fn visit_enum<A: EnumAccess<'de>>(self, data: A) -> Result<WrittenCue, A::Error> {
        let (Name::Of(name), variant) = data.variant()?;
        match name.as_str() {
            "none" => {
                variant.unit_variant()?;
                Ok(WrittenCue::default())
            }
            "sum" => {
                let mut sum = WrittenCue::default();
                for part in variant.newtype_variant::<Vec<WrittenCue>>()? {
                    sum.add(part).map_err(A::Error::custom)?;
                }
                Ok(sum)
            }
            REGULATOR => variant.struct_variant(&super::regulator_record::KEYS, RegulatorVisitor),
            name => {
                let field = field_of_term(name).map_err(A::Error::custom)?;
                variant.struct_variant(&KEYS, NumbersOf(field))
            }
        }
    }
}

impl<'de> Deserialize<'de> for WrittenCue {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<WrittenCue, D::Error> {
        deserializer.deserialize_enum("cue", &VARIANTS, CueVisitor)
    }
}

impl<'de> Deserialize<'de> for Cue {
    /// Reads a cue in L_h and τ; one in µm and seconds is a [`WrittenCue`].
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Cue, D::Error> {
        WrittenCue::deserialize(deserializer)?.in_units(&Scale::default()).map_err(D::Error::custom)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<Cue, String> {
        furrow_input::parse_ron::<Cue>(text, "x").map_err(|e| e.to_string())
    }

    #[test]
    fn ron_reads_terms_sums_and_the_short_form_of_a_band() {
        let band = "kappa:u0=0.465,omega=0.0577,amplitude=0.1";
        assert_eq!(read("kappa(u0: 0.465, omega: 0.0577, amplitude: 0.1)").unwrap(), band.parse().unwrap());
        let sum =
            "sum([kappa(u0: 0.465, omega_length: 0.3, amplitude: 0.1), tension(profile: gradient, amplitude: 0.5)])";
        let expected = "kappa:band,u0=0.465,omega=0.3Lh,amplitude=0.1+tension:gradient,amplitude=0.5";
        assert_eq!(read(sum).unwrap(), expected.parse().unwrap());
        assert_eq!(read("none").unwrap(), Cue::none());
        let carried = "regulator(profile: none, turnover: 10, diffusion: 1, couplings: {\"activity\": 0.3})";
        assert_eq!(read(carried).unwrap(), "regulator:none,turnover=10,diffusion=1,activity=0.3".parse().unwrap());
        let sum = "sum([regulator(u0: 0.4, omega_length: 0.3, amplitude: 1, turnover: 10, diffusion: 1, diluted: false, \
            couplings: {\"tension\": 30, \"kappa\": 0.3}, half: {\"tension\": 10}), tension(profile: gradient, amplitude: 0.5)])";
        let expected = "tension:gradient,amplitude=0.5+regulator:band,u0=0.4,omega=0.3Lh,amplitude=1,turnover=10,diffusion=1,\
            diluted=false,kappa=0.3,tension=30,tension.half=10";
        assert_eq!(read(sum).unwrap().to_string(), expected);
        let json = "{\"regulator\":{\"profile\":\"none\",\"turnover\":10.0,\"diffusion\":1.0,\"couplings\":{\"activity\":0.3}}}";
        assert_eq!(serde_json::to_string(&read(carried).unwrap()).unwrap(), json);
    }

    #[test]
    fn numbers_in_micrometres_and_seconds_need_the_units() {
        let text = "sum([kappa(u0: 0.4, omega_um: 1.0, amplitude: 0.1), regulator(u0: 0.4, omega_um: 0.5, amplitude: 1, \
            turnover_per_s: 0.05, diffusion_um2_per_s: 0.05, couplings: {\"activity\": 0.3})])";
        let written: WrittenCue = furrow_input::parse_ron(text, "x").unwrap();
        let scale = Scale { length_um: Some(2.0), time_s: Some(200.0) };
        let expected = "kappa:band,u0=0.4,omega=0.5Lh,amplitude=0.1+\
            regulator:band,u0=0.4,omega=0.25Lh,amplitude=1,turnover=10,diffusion=2.5,activity=0.3";
        assert_eq!(written.clone().in_units(&scale).unwrap().to_string(), expected);
        let line = "kappa:u0=0.4,omega=1um,amplitude=0.1+\
            regulator:u0=0.4,omega=0.5µm,amplitude=1,turnover=0.05/s,diffusion=0.05 um2/s,activity=0.3";
        assert_eq!(Cue::parse_with(line, &scale, |_| None).unwrap().to_string(), expected);
        for (scale, expected) in [
            (Scale::default(), "kappa.omega = 1um: must be in L_h, or in um where"),
            (Scale { time_s: None, ..scale }, "regulator.turnover = 0.05/s: must be in 1/τ, or in 1/s where"),
        ] {
            let complaint = written.clone().in_units(&scale).unwrap_err().to_string();
            assert!(complaint.starts_with(expected), "{complaint}");
        }
        assert!(read(text).unwrap_err().contains("omega = 1um"));
    }

    #[test]
    fn ron_refuses_what_is_missing_twice_or_unknown() {
        for (text, expected) in [
            ("kappa(u0: 0.4, amplitude: 0.1)", "kappa.omega = (not given)"),
            ("kappa(u0: 0.4, u0: 0.4, omega: 0.1, amplitude: 0.1)", "u0"),
            ("kappa(u0: 0.4, omega: 0.1, omega_length: 0.1, amplitude: 0.1)", "two widths"),
            ("kapa(u0: 0.4, omega: 0.1, amplitude: 0.1)", "did you mean kappa?"),
            ("kappa(profile: bnad, u0: 0.4, omega: 0.1, amplitude: 0.1)", "bnad"),
            ("kappa(u0: 0.4, omga: 0.1, amplitude: 0.1)", "omga"),
            (
                "regulator(profile: none, diffusion: 1, couplings: {\"activity\": 0.3})",
                "regulator.turnover = (not given)",
            ),
            ("regulator(profile: none, turnover: 1, diffusion: 1)", "regulator = (no field)"),
            ("regulator(profile: none, turnover: 1, diffusion: 1, couplings: {\"kapa\": 0.3})", "did you mean kappa?"),
            (
                "regulator(profile: none, turnover: 1, diffusion: 1, couplings: {\"kappa\": 1, \"kappa\": 2})",
                "given twice",
            ),
            (
                "regulator(profile: none, turnover: 1, turnover_per_s: 1, diffusion: 1, couplings: {\"kappa\": 1})",
                "two units",
            ),
            ("regulator(profile: none, turnover: 1, difusion: 1, couplings: {\"kappa\": 1})", "difusion"),
            (
                "sum([regulator(profile: none, turnover: 1, diffusion: 1, couplings: {\"kappa\": 1}), regulator(profile: none, turnover: 1, diffusion: 1, couplings: {\"xi_s\": 1})])",
                "one regulator",
            ),
        ] {
            let complaint = read(text).unwrap_err();
            assert!(complaint.contains(expected), "{text}: {complaint}");
        }
    }
}
