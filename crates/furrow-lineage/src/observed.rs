//! Observed rounds of a founder's descendants.

use serde::{Deserialize, Serialize};

/// Observed rounds of division from a founder to its terminal cells. Each number may be unknown.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ObservedRounds {
    /// Fewest rounds.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub min: Option<u32>,
    /// Mean over terminal cells.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mean: Option<f64>,
    /// Most rounds.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub max: Option<u32>,
    /// Generations, counted from the founder, in which every cell divided.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub full_doublings: Option<u32>,
    /// Terminal cells, including deaths.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub terminal: Option<u32>,
    /// Terminal cells that die.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub deaths: Option<u32>,
}

impl ObservedRounds {
    /// The first field that contradicts the others: its name, its value and the allowed values.
    pub(super) fn contradiction(&self) -> Option<(&'static str, String, String)> {
        let above = |a: Option<u32>, b: Option<u32>| a.zip(b).is_some_and(|(a, b)| a > b);
        let ObservedRounds { min, mean, max, full_doublings, terminal, deaths } = *self;
        let shown = |value: Option<u32>| value.map_or(String::new(), |value| value.to_string());
        if above(min, max) {
            return Some(("max", shown(max), format!("at least min = {}", shown(min))));
        }
        let (low, high) = (min.map_or(0.0, f64::from), max.map_or(f64::MAX, f64::from));
        if let Some(mean) = mean.filter(|mean| !(low..=high).contains(mean)) {
            let low = min.map_or("0".to_owned(), |min| format!("min = {min}"));
            let high = max.map_or(String::new(), |max| format!(" to max = {max}"));
            return Some(("mean", mean.to_string(), format!("a number from {low}{high}")));
        }
        if above(full_doublings, min) {
            return Some(("full_doublings", shown(full_doublings), format!("at most min = {}", shown(min))));
        }
        above(deaths, terminal).then(|| ("deaths", shown(deaths), format!("at most terminal = {}", shown(terminal))))
    }
}
