//! The order in which two sisters divide, from known lifetimes.

use std::collections::HashMap;

use furrow_input::InputError;

use crate::lifetimes::Lifetimes;
use crate::names::Names;
use crate::published::{jankele2021_lifetimes, sulston};

/// Lifetimes that differ by a smaller part of the shorter one give no order.
const NEARLY_EQUAL: f64 = 0.05;

/// Known lifetimes of the lineage's cells.
pub(super) struct Lives<'a> {
    names: &'a Names,
    /// Of the worm: means over embryos, and those in Sulston's chart.
    of_worm: Option<(Lifetimes, HashMap<&'static str, f64>)>,
}

impl<'a> Lives<'a> {
    /// The lifetimes that the lineage gives, and the observed ones if it is the worm's.
    ///
    /// # Errors
    /// Only if a shipped table is invalid.
    pub fn of(names: &'a Names) -> Result<Lives<'a>, InputError> {
        let observed = || Ok((jankele2021_lifetimes()?, in_chart()));
        Ok(Lives { names, of_worm: names.are_of_worm().then(observed).transpose()? })
    }

    /// The place of the sister that divides first; `None` if their lifetimes are not known or nearly equal, or if the means and the chart
    /// contradict each other.
    pub fn first(&self, sisters: &[String; 2]) -> Option<usize> {
        let [one, other] = sisters;
        if let Some(given) = self.names.lifetime(one).zip(self.names.lifetime(other)) {
            return shorter(given);
        }
        let (means, chart) = self.of_worm.as_ref()?;
        let mean = |name: &str| Some(means.of(name)?.mean);
        let drawn = chart.get(one.as_str()).copied().zip(chart.get(other.as_str()).copied()).map(shorter);
        match (mean(one).zip(mean(other)).map(shorter), drawn) {
            (Some(Some(first)), Some(Some(other))) if first != other => None,
            (Some(first), _) => first,
            (None, drawn) => drawn?,
        }
    }
}

/// The place of the shorter of two lifetimes, unless they are nearly equal.
fn shorter((one, other): (f64, f64)) -> Option<usize> {
    ((one - other).abs() > NEARLY_EQUAL * one.min(other)).then_some(usize::from(other < one))
}

/// Lifetimes in Sulston's chart: the births of daughters minus the birth of their mother.
fn in_chart() -> HashMap<&'static str, f64> {
    let mut births: HashMap<&str, f64> = HashMap::new();
    let mut lives = HashMap::new();
    for (name, mother, birth) in sulston() {
        let Some(birth) = birth else { continue };
        births.insert(name, birth);
        if let Some(begin) = births.get(mother) {
            lives.insert(mother, birth - begin);
        }
    }
    lives
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_order_of_the_worms_sisters_is_known_where_observations_agree() {
        let names = Names::default();
        let lives = Lives::of(&names).unwrap();
        let first = |one: &str, other: &str| lives.first(&[one.to_owned(), other.to_owned()]);
        assert_eq!([first("AB", "P1"), first("P1", "AB"), first("EMS", "P2")], [Some(0), Some(1), Some(0)]);
        // The chart has MS and E divide together, and the means have MS first.
        assert_eq!([first("MS", "E"), first("D", "P4"), first("Z3", "Z2")], [Some(0), Some(0), None]);
        // The means have C first, and the chart has P3 first.
        assert_eq!([first("C", "P3"), first("ABa", "ABp"), first("ABpl", "ABpr")], [None; 3]);
        // Only the chart has these: 90 minutes, and 98.
        assert_eq!(first("Caaa", "Caap"), Some(0));
    }
}
