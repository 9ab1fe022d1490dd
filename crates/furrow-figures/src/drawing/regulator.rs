//! The colours of a cue's regulator: orange where φ > 0, blue where φ < 0.

use super::cell::FAINTEST;
use super::style::{CUE_LOWERS, CUE_RAISES, Colour};
use furrow_mechanics::cortex::forces::Place;

/// The smallest and largest φ in all shapes of a picture, always including 0. Equal |φ| gives equal strength of colour
/// in every shape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PhiRange([f64; 2]);

impl PhiRange {
    /// The range over all places of all shapes; `None` without a regulator.
    pub fn of<'a>(places: impl IntoIterator<Item = &'a Place>) -> Option<PhiRange> {
        let values = places.into_iter().filter_map(|place| place.phi).filter(|phi| phi.is_finite());
        values.fold(None, |range, phi| {
            let [low, high] = range.map_or([0.0; 2], |PhiRange(ends)| ends);
            Some(PhiRange([phi.min(low), phi.max(high)]))
        })
    }

    /// φ relative to the largest |φ|, from −1 to 1.
    pub fn share(self, phi: f64) -> f64 {
        let PhiRange([low, high]) = self;
        let most = high.max(-low);
        if most > 0.0 { (phi / most).clamp(-1.0, 1.0) } else { 0.0 }
    }

    /// The colours that occur, with their meanings.
    pub fn colours(self) -> Vec<(Colour, String)> {
        let PhiRange([low, high]) = self;
        let mut found = Vec::new();
        if self.share(high) >= FAINTEST {
            found.push((CUE_RAISES, format!("regulator φ > 0, to {}", short(high))));
        }
        if self.share(low) <= -FAINTEST {
            found.push((CUE_LOWERS, format!("regulator φ < 0, to \u{2212}{}", short(-low))));
        }
        found
    }
}

/// A positive number with two significant digits.
fn short(value: f64) -> String {
    let before = if value > 0.0 { value.log10().floor() } else { 0.0 };
    format!("{value:.*}", (1.0 - before).clamp(0.0, 9.0) as usize)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn range(values: &[f64]) -> Option<PhiRange> {
        let places: Vec<Place> = values.iter().map(|phi| Place { phi: Some(*phi), ..Place::default() }).collect();
        PhiRange::of(&places)
    }

    #[test]
    fn equal_distances_from_zero_have_equal_strength_of_colour() {
        let found = range(&[0.0, 0.5, -0.125, f64::NAN]).unwrap();
        assert_eq!([0.5, 0.25, -0.125, -9.0].map(|phi| found.share(phi)), [1.0, 0.5, -0.25, -1.0]);
        let words: Vec<String> = found.colours().into_iter().map(|(_, word)| word).collect();
        assert_eq!(words, ["regulator φ > 0, to 0.50", "regulator φ < 0, to \u{2212}0.12"]);
        // A colour too faint to be drawn is not named.
        assert_eq!(
            range(&[0.001, -12.3]).unwrap().colours(),
            [(CUE_LOWERS, "regulator φ < 0, to \u{2212}12".to_owned())]
        );
    }

    #[test]
    fn without_a_regulator_there_is_no_range_and_at_rest_no_colour() {
        assert_eq!(PhiRange::of(&[Place::default()]), None);
        let rest = range(&[0.0]).unwrap();
        assert!(rest.colours().is_empty() && rest.share(0.0) == 0.0);
    }
}
