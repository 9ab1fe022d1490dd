//! The effect of rounding radii, estimated from how χ changes with the radius.

use crate::batch::key::{Key, KeyMap};
use furrow_cell::Cell;
use furrow_mechanics::division::{Division, DivisionInput};

/// Of one run's divisions the key of the same input without its radius, the radius and χ.
#[derive(Debug, Default)]
pub struct Responses(KeyMap<(Key, f64, f64)>);

impl Responses {
    /// Notes χ of a canonical input's division.
    pub fn note(&mut self, key: Key, canonical: &DivisionInput, division: &Division) {
        let Some(chi) = division.chi() else { return };
        self.0.entry(key).or_insert_with(|| {
            let cell = Cell { r0: 0.0, ..canonical.cell.clone() };
            let family = Key::new(&DivisionInput { cell, ..*canonical });
            (family, canonical.cell.r0, chi)
        });
    }

    /// Largest |Δχ/Δln R0| between neighbouring radii of one family; 0 if there are none.
    pub fn steepest_slope(self) -> f64 {
        let mut samples: Vec<_> = self.0.into_values().collect();
        samples.sort_by(|a, b| a.0.cmp(&b.0).then_with(|| a.1.total_cmp(&b.1)));
        let pairs = samples.windows(2).map(|pair| (pair[0], pair[1]));
        let neighbours = pairs.filter(|((family, r0, _), (other, larger, _))| family == other && r0 < larger);
        neighbours
            .map(|((_, r0, chi), (_, larger, there))| ((there - chi) / (larger / r0).ln()).abs())
            .fold(0.0, f64::max)
    }
}
