//! Cues in RON and JSON: the text that `--cue` reads.
//!
//! Older files list cues by field, as in `kappa(u0: 0.4, omega_length: 0.3, amplitude: 0.1)`. They can still be read: such a cue is
//! converted to text first.

use serde::de::{Error, MapAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::{Cue, Scale, WrittenCue};

impl Serialize for Cue {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

impl<'de> Deserialize<'de> for WrittenCue {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<WrittenCue, D::Error> {
        WrittenCue::parse(&InFile::deserialize(deserializer)?.text(), |_| None).map_err(D::Error::custom)
    }
}

impl<'de> Deserialize<'de> for Cue {
    /// Reads a cue in L_h and τ; one in µm and seconds is a [`WrittenCue`].
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Cue, D::Error> {
        WrittenCue::deserialize(deserializer)?.in_units(&Scale::default()).map_err(D::Error::custom)
    }
}

/// A cue as written in a file.
#[derive(Deserialize)]
#[serde(
    untagged,
    deny_unknown_fields,
    expecting = "expected a cue as --cue reads it: \"none\", or \"FIELD:PROFILE,key=value,..\" joined by +"
)]
enum InFile {
    Text(String),
    Sum { sum: Vec<InFile> },
    Fields(Pairs<Pairs<Value>>),
}

#[derive(Deserialize)]
#[serde(untagged)]
enum Value {
    Bool(bool),
    Number(f64),
    Word(String),
    ByField(Pairs<f64>),
}

impl InFile {
    fn text(self) -> String {
        match self {
            InFile::Text(text) => text,
            InFile::Sum { sum } => sum.into_iter().map(InFile::text).collect::<Vec<_>>().join("+"),
            InFile::Fields(Pairs(parts)) => {
                let part = |(field, Pairs(mut numbers)): (String, Pairs<Value>)| {
                    numbers.sort_by_cached_key(|(key, _)| key != "profile");
                    let entries: Vec<String> = numbers.iter().flat_map(|(key, value)| value.entries(key)).collect();
                    format!("{field}:{}", entries.join(","))
                };
                parts.into_iter().map(part).collect::<Vec<_>>().join("+")
            }
        }
    }
}

impl Value {
    fn entries(&self, key: &str) -> Vec<String> {
        let value = match self {
            Value::ByField(Pairs(fields)) => {
                let suffix = if key == "half" { ".half" } else { "" };
                return fields.iter().map(|(field, number)| format!("{field}{suffix}={number}")).collect();
            }
            Value::Word(profile) if key == "profile" => return vec![profile.clone()],
            Value::Word(word) => word.clone(),
            Value::Bool(yes) => yes.to_string(),
            Value::Number(number) => number.to_string(),
        };
        vec![match key {
            "omega_length" => format!("omega={value}Lh"),
            "omega_um" => format!("omega={value}um"),
            "turnover_per_s" => format!("turnover={value}/s"),
            "diffusion_um2_per_s" => format!("diffusion={value}um2/s"),
            key => format!("{key}={value}"),
        }]
    }
}

/// A map in the order of the file; duplicate keys are kept.
struct Pairs<V>(Vec<(String, V)>);

impl<'de, V: Deserialize<'de>> Deserialize<'de> for Pairs<V> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Pairs<V>, D::Error> {
        struct Entries<V>(std::marker::PhantomData<V>);
        impl<'de, V: Deserialize<'de>> Visitor<'de> for Entries<V> {
            type Value = Pairs<V>;

            fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.write_str("a map")
            }

            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Pairs<V>, A::Error> {
                let mut pairs = Vec::new();
                while let Some(pair) = map.next_entry()? {
                    pairs.push(pair);
                }
                Ok(Pairs(pairs))
            }
        }
        deserializer.deserialize_map(Entries(std::marker::PhantomData))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<Cue, String> {
        furrow_input::parse_ron::<Cue>(text, "x").map_err(|e| e.to_string())
    }

    #[test]
    fn cues_by_field_are_read_as_their_text() {
        for case in include_str!("by_field.txt").trim_end().split("\n\n") {
            let (by_field, text) = case.split_once("\n> ").unwrap();
            let scale = Scale { length_um: Some(2.0), time_s: Some(200.0) };
            let written: WrittenCue =
                furrow_input::parse_ron(by_field, "x").unwrap_or_else(|e| panic!("{by_field}: {e}"));
            let expected = Cue::parse_with(text, &scale, |_| None).unwrap();
            assert_eq!(written.in_units(&scale).unwrap(), expected, "{by_field}");
        }
        let json = r#"{"sum":[{"kappa":{"profile":"band","u0":0.4,"omega_length":0.3,"amplitude":0.1}},"tension:gradient,amplitude=1"]}"#;
        let text = "kappa:band,u0=0.4,omega=0.3Lh,amplitude=0.1+tension:gradient,amplitude=1";
        let cue = serde_json::from_str::<Cue>(json).unwrap();
        assert_eq!(serde_json::to_string(&cue).unwrap(), format!("{text:?}"));
    }

    #[test]
    fn numbers_in_micrometres_and_seconds_need_the_units() {
        let text = "\"kappa:u0=0.4,omega=1um,amplitude=0.1 + \
            regulator:u0=0.4,omega=0.5µm,amplitude=1,turnover=0.05/s,diffusion=0.05 um2/s,activity=0.3\"";
        let written: WrittenCue = furrow_input::parse_ron(text, "x").unwrap();
        let scale = Scale { length_um: Some(2.0), time_s: Some(200.0) };
        let expected = "kappa:band,u0=0.4,omega=0.5Lh,amplitude=0.1+\
            regulator:band,u0=0.4,omega=0.25Lh,amplitude=1,turnover=10,diffusion=2.5,activity=0.3";
        assert_eq!(written.clone().in_units(&scale).unwrap().to_string(), expected);
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
    fn cues_in_files_are_refused_as_those_of_the_command_line_are() {
        for case in include_str!("by_field_refused.txt").lines().collect::<Vec<_>>().chunks(2) {
            let (text, expected) = (case[0], case[1].trim_start_matches("> "));
            let complaint = read(text).unwrap_err();
            assert!(complaint.contains(expected), "{text}: {complaint}");
        }
    }
}
