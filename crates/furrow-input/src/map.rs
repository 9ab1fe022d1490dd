//! Maps by name that refuse a name which is given again; serde's own keep the last value without a word.

use std::collections::BTreeMap;
use std::marker::PhantomData;

use serde::de::{Deserialize, Deserializer, Error, MapAccess, Visitor};

use super::shown;

/// The entries of a map by name; `twice` is the error for a name, in quotes, that is given again.
///
/// # Errors
/// The error of the format, or of a name that is given again.
pub fn unique_entries<'de, V: Deserialize<'de>, A: MapAccess<'de>>(
    mut map: A,
    twice: impl Fn(&str) -> String,
) -> Result<BTreeMap<String, V>, A::Error> {
    let mut entries = BTreeMap::new();
    while let Some((name, value)) = map.next_entry::<String, V>()? {
        if entries.insert(name.clone(), value).is_some() {
            return Err(A::Error::custom(twice(&shown(&name))));
        }
    }
    Ok(entries)
}

/// Reads a map by name, for `deserialize_with`; `what` it holds is said where there is no map.
///
/// # Errors
/// As [`unique_entries`].
pub fn unique_map<'de, V: Deserialize<'de>, D: Deserializer<'de>>(
    deserializer: D,
    what: &'static str,
    twice: fn(&str) -> String,
) -> Result<BTreeMap<String, V>, D::Error> {
    struct Map<V> {
        what: &'static str,
        twice: fn(&str) -> String,
        values: PhantomData<V>,
    }
    impl<'de, V: Deserialize<'de>> Visitor<'de> for Map<V> {
        type Value = BTreeMap<String, V>;

        fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
            f.write_str(self.what)
        }

        fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Self::Value, A::Error> {
            unique_entries(map, self.twice)
        }
    }
    deserializer.deserialize_map(Map { what, twice, values: PhantomData })
}
