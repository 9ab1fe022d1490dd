//! Conversion to micrometres, minutes and seconds if a lineage file gives L_h and τ.

use serde::{Deserialize, Serialize};

use furrow_cell::SIZES;
use furrow_cell::cue::Scale;
use furrow_cell::settings::Value;
use furrow_input::{InputError, shown_number};
use furrow_mechanics::polarity::LENGTH_UM;

/// L_h and τ of an embryo. The paper does not give them; users do.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Units {
    /// L_h, in µm.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub length_um: Option<f64>,
    /// τ, in minutes.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub time_min: Option<f64>,
}

impl Units {
    /// Converts a length from L_h to µm.
    pub fn micrometres(&self, length: f64) -> Option<f64> {
        self.length_um.map(|unit| unit * length)
    }

    /// Converts a time from τ to minutes.
    pub fn minutes(&self, time: f64) -> Option<f64> {
        self.time_min.map(|unit| unit * time)
    }

    /// L_h in µm; if not given, the worm's, since the presets are for the worm.
    pub fn length_um(&self) -> f64 {
        self.length_um.unwrap_or(LENGTH_UM)
    }

    /// The same units, with the worm's L_h if L_h is not given and a length is in µm, so that results are in µm too.
    pub fn asked_in(self, length: Length) -> Units {
        match length {
            Length::Natural(_) => self,
            Length::Micrometres(_) => Units { length_um: Some(self.length_um()), ..self },
        }
    }

    /// The value of a parameter, in L_h if it is a radius in µm.
    pub fn natural(&self, name: &str, value: Value) -> Value {
        match value {
            Value::Text(text) if name == "r0" => match text.parse() {
                Ok(length @ Length::Micrometres(_)) => Value::Number(length.in_units(self)),
                _ => Value::Text(text),
            },
            other => other,
        }
    }

    /// The units for cues with numbers in µm and seconds.
    pub fn scale(&self) -> Scale {
        Scale { length_um: Some(self.length_um()), time_s: self.time_min.map(|minutes| 60.0 * minutes) }
    }

    /// A length in L_h as text, followed by µm if L_h is known: ` (17.06 µm)`.
    pub fn in_micrometres(&self, length: f64) -> String {
        self.micrometres(length).map_or(String::new(), |length| format!(" ({length:.2} µm)"))
    }

    /// A time in τ as text, followed by minutes if τ is known: ` (3.10 min)`.
    pub fn in_minutes(&self, time: f64) -> String {
        self.minutes(time).map_or(String::new(), |time| format!(" ({time:.2} min)"))
    }

    pub(super) fn check(&self, file: &str) -> Result<(), InputError> {
        for (name, value) in [("units.length_um", self.length_um), ("units.time_min", self.time_min)] {
            if let Some(value) = value.filter(|value| !(value.is_finite() && *value > 0.0)) {
                return Err(InputError::not_allowed(file, name, value, "a finite number above 0"));
            }
        }
        Ok(())
    }
}

/// Radii R0 in L_h for which the presets are intended: the zygote's is 5.4, and cells below 1.7 do not divide.
const MADE_FOR: std::ops::RangeInclusive<f64> = 0.5..=8.0;

/// Largest radius of a founder without a unit, and hence in L_h: a tree from a larger cell has tens of thousands of cells, and
/// the number is more likely in µm. A larger radius must be given in µm.
pub const MOST_PLAIN: f64 = 20.0;

/// Describes how to write a radius above [`MOST_PLAIN`].
pub fn plain_radius(r0: f64) -> String {
    let r0 = shown_number(r0);
    format!(
        "at most {MOST_PLAIN} as a plain number, which is in L_h (the worm's zygote has 5.4); in µm write {r0}um, in a file r0: \"{r0}um\""
    )
}

/// Warns of a radius that is allowed but far outside the range for which the presets are intended.
pub fn size_doubt(given: Length, units: &Units) -> Option<String> {
    let [least, most] = [MADE_FOR.start(), MADE_FOR.end()];
    let natural = given.in_units(units);
    if !SIZES.contains(&natural) || MADE_FOR.contains(&natural) {
        return None;
    }
    let r0 = shown_number(natural);
    let far = format!(
        "is far from the sizes that the constants were made for, {least} to {most} (the worm's zygote has 5.4)"
    );
    let of_lineage = "units: (length_um: …) in its lineage file";
    Some(match (given, units.length_um) {
        (Length::Micrometres(_), _) => {
            let length = units.length_um();
            format!(
                "R0 = {given} is {r0} L_h, which {far}; one L_h is {length} µm here: of another animal say how long it is, {of_lineage}"
            )
        }
        (Length::Natural(_), Some(_)) => {
            format!("R0 = {r0} L_h{} {far}; if it is in µm, write {r0}um", units.in_micrometres(natural))
        }
        (Length::Natural(_), None) => {
            format!(
                "R0 = {r0} L_h {far}; if it is in µm, write {r0}um, and of another animal say how long L_h is: {of_lineage}"
            )
        }
    })
}

/// A length in the user's notation: a number in L_h, or a number in µm followed by the unit.
///
/// ```
/// use furrow_lineage::{Length, Units};
///
/// let units = Units { length_um: Some(3.0), time_min: None };
/// assert_eq!("17.1um".parse::<Length>()?.in_units(&units), 17.1 / 3.0);
/// assert_eq!("5.4".parse::<Length>()?.in_units(&units), 5.4);
/// assert_eq!("16um".parse::<Length>()?.in_units(&Units::default()), 16.0 / 3.2);
/// # Ok::<(), String>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Length {
    /// A length in L_h.
    Natural(f64),
    /// A length in µm.
    Micrometres(f64),
}

impl Length {
    /// The length in L_h.
    pub fn in_units(self, units: &Units) -> f64 {
        match self {
            Length::Natural(length) => length,
            Length::Micrometres(length) => length / units.length_um(),
        }
    }
}

impl std::fmt::Display for Length {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Length::Natural(length) => write!(f, "{length}"),
            Length::Micrometres(length) => write!(f, "{length}um"),
        }
    }
}

impl std::str::FromStr for Length {
    type Err = String;

    fn from_str(text: &str) -> Result<Length, String> {
        let text = text.trim();
        let micrometres = ["um", "µm", "μm"].into_iter().find_map(|unit| text.strip_suffix(unit));
        let number = micrometres.map_or(text, str::trim_end);
        let value: f64 = number.parse().map_err(|_| "a number of L_h, as in 5.4, or of um, as in 17um".to_owned())?;
        Ok(if micrometres.is_some() { Length::Micrometres(value) } else { Length::Natural(value) })
    }
}

impl Serialize for Length {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Length::Natural(length) => serializer.serialize_f64(*length),
            Length::Micrometres(_) => serializer.collect_str(self),
        }
    }
}

impl<'de> Deserialize<'de> for Length {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Length, D::Error> {
        struct Written;
        impl serde::de::Visitor<'_> for Written {
            type Value = Length;

            fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.write_str("a length: a number of L_h, as in 5.4, or of µm, as in \"17um\"")
            }

            fn visit_f64<E: serde::de::Error>(self, value: f64) -> Result<Length, E> {
                Ok(Length::Natural(value))
            }

            fn visit_i64<E: serde::de::Error>(self, value: i64) -> Result<Length, E> {
                Ok(Length::Natural(value as f64))
            }

            fn visit_u64<E: serde::de::Error>(self, value: u64) -> Result<Length, E> {
                Ok(Length::Natural(value as f64))
            }

            fn visit_str<E: serde::de::Error>(self, text: &str) -> Result<Length, E> {
                text.parse().map_err(|_| E::invalid_value(serde::de::Unexpected::Str(text), &self))
            }
        }
        deserializer.deserialize_any(Written)
    }
}
