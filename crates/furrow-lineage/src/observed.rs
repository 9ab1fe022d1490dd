//! Observed rounds of a founder's descendants.

use serde::{Deserialize, Serialize};

/// Rounds of division from a founder to each terminal cell, as observed. Any of it may be unknown.
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
    /// Generations, counted from the founder, that doubled fully.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub full_doublings: Option<u32>,
    /// Terminal cells, deaths included.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub terminal: Option<u32>,
    /// Terminal cells that die.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub deaths: Option<u32>,
}

impl ObservedRounds {
    /// The first field that contradicts the others: its name, its value and what is allowed.
    pub(super) fn contradiction(&self) -> Option<(&'static str, String, String)> {
        let (min, max) = (self.min.map(f64::from), self.max.map(f64::from));
        if let (Some(min), Some(max)) = (self.min, self.max)
            && max < min
        {
            return Some(("max", max.to_string(), format!("at least min = {min}")));
        }
        if let Some(mean) = self.mean {
            let inside = mean.is_finite()
                && mean >= 0.0
                && min.is_none_or(|min| min <= mean)
                && max.is_none_or(|max| mean <= max);
            if !inside {
                let low = self.min.map_or("0".to_owned(), |min| format!("min = {min}"));
                let high = self.max.map_or(String::new(), |max| format!(" to max = {max}"));
                return Some(("mean", mean.to_string(), format!("a number from {low}{high}")));
            }
        }
        if let (Some(full), Some(min)) = (self.full_doublings, self.min)
            && full > min
        {
            return Some(("full_doublings", full.to_string(), format!("at most min = {min}")));
        }
        if let (Some(deaths), Some(terminal)) = (self.deaths, self.terminal)
            && deaths > terminal
        {
            return Some(("deaths", deaths.to_string(), format!("at most terminal = {terminal}")));
        }
        None
    }
}
