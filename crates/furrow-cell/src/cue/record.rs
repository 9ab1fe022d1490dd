//! Cues in RON and JSON: `none`, `FIELD(profile: …, u0: …, omega: …, amplitude: …)`, or `sum([…])` of several.
//!
//! The profile may be left out, and is then a band. `omega_length` in place of `omega` is a width in L_h. No other number
//! has a default: a missing one is refused, and so is one given twice.

use serde::de::value::MapAccessDeserializer;
use serde::de::{EnumAccess, Error, MapAccess, VariantAccess, Visitor};
use serde::ser::SerializeStructVariant;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::profile::NAMES;
use super::text::{Numbers, field};
use super::{Cue, Field, Profile, Quantity, Term, Width};

const KEYS: [&str; 5] = ["profile", "u0", "omega", "omega_length", "amplitude"];

/// `none`, the fields, and `sum`.
const VARIANTS: [&str; Field::ALL.len() + 2] = {
    let mut names = ["none"; Field::ALL.len() + 2];
    let mut k = 0;
    while k < Field::ALL.len() {
        names[k + 1] = Field::ALL[k].name();
        k += 1;
    }
    names[Field::ALL.len() + 1] = "sum";
    names
};

/// A name as it stands in a file: a bare word in RON, a string in JSON.
#[derive(Deserialize)]
#[serde(field_identifier)]
enum Name {
    Of(String),
}

/// The name of a profile.
struct ProfileName<'a>(&'a Profile);

impl Serialize for ProfileName<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let name = self.0.name();
        let index = NAMES.iter().position(|other| *other == name).unwrap_or(0) as u32;
        serializer.serialize_unit_variant("profile", index, name)
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields, rename = "term")]
struct Record {
    profile: Option<Name>,
    u0: Option<f64>,
    omega: Option<f64>,
    omega_length: Option<f64>,
    amplitude: Option<f64>,
}

impl Record {
    fn term(self, field: Field) -> Result<Term, String> {
        if self.omega.is_some() && self.omega_length.is_some() {
            return Err(format!("{}: omega and omega_length are two widths; give one", field.name()));
        }
        let omega = self.omega.map(Width::Fraction).or(self.omega_length.map(Width::Length));
        let Name::Of(name) = self.profile.unwrap_or(Name::Of(NAMES[0].to_owned()));
        Numbers { u0: self.u0, omega, amplitude: self.amplitude }.term(field, &name).map_err(|e| e.to_string())
    }
}

/// One term, as the variant of an enum named after its field.
struct TermRecord(Term);

impl Serialize for TermRecord {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let Term { field, profile, amplitude } = &self.0;
        let index = VARIANTS.iter().position(|name| *name == field.name()).unwrap_or(0) as u32;
        let mut out = serializer.serialize_struct_variant("cue", index, field.name(), 4)?;
        out.serialize_field("profile", &ProfileName(profile))?;
        if let Some(u0) = profile.quantity(Quantity::U0) {
            out.serialize_field("u0", &u0)?;
        }
        match profile.width() {
            Some(Width::Fraction(omega)) => out.serialize_field("omega", &omega)?,
            Some(Width::Length(omega)) => out.serialize_field("omega_length", &omega)?,
            None => {}
        }
        out.serialize_field("amplitude", amplitude)?;
        out.end()
    }
}

impl Serialize for Cue {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self.terms() {
            [] => serializer.serialize_unit_variant("cue", 0, "none"),
            [term] => TermRecord(*term).serialize(serializer),
            terms => {
                let list: Vec<TermRecord> = terms.iter().copied().map(TermRecord).collect();
                serializer.serialize_newtype_variant("cue", VARIANTS.len() as u32 - 1, "sum", &list)
            }
        }
    }
}

/// Reads the numbers of a term of a known field.
struct NumbersOf(Field);

impl<'de> Visitor<'de> for NumbersOf {
    type Value = Term;

    fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "the numbers of a term, as in {}(profile: band, u0: 0.5, omega: 0.1, amplitude: 0.1)", self.0.name())
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Term, A::Error> {
        Record::deserialize(MapAccessDeserializer::new(map))?.term(self.0).map_err(A::Error::custom)
    }
}

/// Reads one term or a whole cue.
struct CueVisitor;

impl<'de> Visitor<'de> for CueVisitor {
    type Value = Vec<Term>;

    fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("a cue: none, FIELD(profile: .., u0: .., omega: .., amplitude: ..) or sum([..])")
    }

    fn visit_enum<A: EnumAccess<'de>>(self, data: A) -> Result<Vec<Term>, A::Error> {
        let (Name::Of(name), variant) = data.variant()?;
        match name.as_str() {
            "none" => {
                variant.unit_variant()?;
                Ok(Vec::new())
            }
            "sum" => Ok(variant.newtype_variant::<Vec<Part>>()?.into_iter().flat_map(|Part(terms)| terms).collect()),
            name => {
                let field = field(name).map_err(A::Error::custom)?;
                Ok(vec![variant.struct_variant(&KEYS, NumbersOf(field))?])
            }
        }
    }
}

/// A cue within a sum.
struct Part(Vec<Term>);

impl<'de> Deserialize<'de> for Part {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Part, D::Error> {
        deserializer.deserialize_enum("cue", &VARIANTS, CueVisitor).map(Part)
    }
}

impl<'de> Deserialize<'de> for Cue {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Cue, D::Error> {
        Part::deserialize(deserializer).map(|part| Cue { terms: part.0, regulator: None })
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
        ] {
            let complaint = read(text).unwrap_err();
            assert!(complaint.contains(expected), "{text}: {complaint}");
        }
    }
}
