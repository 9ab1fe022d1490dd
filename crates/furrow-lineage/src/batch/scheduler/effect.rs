//! The effect of rounding radii, estimated from how χ changes with the radius.

use crate::batch::key::{Key, KeyMap};
use furrow_cell::Cell;
use furrow_mechanics::division::{Division, DivisionInput};

/// χ of one run's divisions, over their radii.
#[derive(Debug, Default)]
pub struct Responses(KeyMap<Sample>);

#[derive(Clone, Copy, Debug)]
struct Sample {
    /// Key of the same input, without its radius.
    family: Key,
    r0: f64,
    chi: f64,
}

impl Responses {
    /// Records χ of the division of a canonical input.
    pub fn note(&mut self, key: Key, canonical: &DivisionInput, division: &Division) {
        let Some(chi) = division.chi() else { return };
        self.0.entry(key).or_insert_with(|| {
            let cell = Cell { r0: 0.0, ..canonical.cell.clone() };
            let family = Key::new(&DivisionInput { cell, ..*canonical });
            Sample { family, r0: canonical.cell.r0, chi }
        });
    }

    /// Largest |Δχ/Δln R0| between neighbouring radii of one family; 0 without neighbours.
    pub fn steepest_slope(self) -> f64 {
        let mut samples: Vec<Sample> = self.0.into_values().collect();
        samples.sort_by(|a, b| a.family.cmp(&b.family).then_with(|| a.r0.total_cmp(&b.r0)));
        samples
            .windows(2)
            .filter(|pair| pair[0].family == pair[1].family && pair[0].r0 < pair[1].r0)
            .map(|pair| ((pair[1].chi - pair[0].chi) / (pair[1].r0 / pair[0].r0).ln()).abs())
            .fold(0.0, f64::max)
    }
}
