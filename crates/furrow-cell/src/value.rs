//! The value of a parameter in the user's notation.

use std::borrow::Cow;
use std::fmt::{Display, Formatter};
use std::str::FromStr;

use serde::de::IntoDeserializer;
use serde::{Deserialize, Serialize};

use crate::{RigidityGradient, Scheme};

/// A number, or a text: a word if the parameter takes words, or the text after `=` in `--set`, which may also be a number.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged, expecting = "expected a number, or a word in quotes")]
pub enum Value {
    /// A number.
    Number(f64),
    /// A text.
    Text(String),
}

impl Value {
    /// The value as text.
    pub fn text(&self) -> Cow<'_, str> {
        match self {
            Value::Number(number) => Cow::Owned(number.to_string()),
            Value::Text(text) => Cow::Borrowed(text),
        }
    }

    /// The value as a number, which may be parsed from text.
    pub fn number(&self) -> Option<f64> {
        match self {
            Value::Number(number) => Some(*number),
            Value::Text(text) => text.parse().ok(),
        }
    }
}

impl Display for Value {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.text())
    }
}

/// A kind of parameter.
pub(crate) trait Kind: Sized {
    /// Reads a value; `None` if it has another kind.
    fn of(value: &Value) -> Option<Self>;
    /// Converts to a value.
    fn value(self) -> Value;
}

impl Kind for f64 {
    fn of(value: &Value) -> Option<f64> {
        value.number()
    }

    fn value(self) -> Value {
        Value::Number(self)
    }
}

impl Kind for bool {
    fn of(value: &Value) -> Option<bool> {
        value.text().parse().ok()
    }

    fn value(self) -> Value {
        Value::Text(self.to_string())
    }
}

impl Kind for usize {
    fn of(value: &Value) -> Option<usize> {
        match value {
            Value::Number(number) => {
                let whole = number.fract() == 0.0 && (0.0..=2f64.powi(53)).contains(number);
                whole.then_some(*number as usize)
            }
            Value::Text(text) => text.parse().ok(),
        }
    }

    fn value(self) -> Value {
        Value::Number(self as f64)
    }
}

/// Kinds with words as values.
macro_rules! words {
    ($($kind:ty),*) => {$(
        impl Display for $kind {
            fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
                self.serialize(f)
            }
        }

        impl FromStr for $kind {
            type Err = serde::de::value::Error;

            fn from_str(word: &str) -> Result<$kind, Self::Err> {
                <$kind>::deserialize(word.into_deserializer())
            }
        }

        impl Kind for $kind {
            fn of(value: &Value) -> Option<$kind> {
                match value {
                    Value::Number(_) => None,
                    Value::Text(word) => word.parse().ok(),
                }
            }

            fn value(self) -> Value {
                Value::Text(self.to_string())
            }
        }
    )*};
}

words!(RigidityGradient, Scheme);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn kinds_take_numbers_as_they_are_and_words_as_text() {
        let third = Value::Number(1.0 / 3.0);
        assert_eq!(f64::of(&third), Some(1.0 / 3.0));
        assert_eq!(f64::of(&Value::Text("0.1".to_owned())), Some(0.1));
        assert_eq!(usize::of(&Value::Number(64.0)), Some(64));
        for number in [0.5, -1.0, f64::NAN, f64::INFINITY, 1e300] {
            assert_eq!(usize::of(&Value::Number(number)), None, "{number}");
        }
        assert_eq!(Scheme::of(&Value::Text("published".to_owned())), Some(Scheme::Published));
        assert_eq!(Scheme::of(&third), None);
        assert_eq!(RigidityGradient::Full.value(), Value::Text("full".to_owned()));
    }
}
