//! Rounding of sizes, which makes sizes equal that differ only by rounding errors.

/// Rounding of sizes to a number of binary digits, applied before a task is looked up or solved.
///
/// Tasks with sizes that differ only by rounding errors then share one record. Rounding to binary digits is exact and
/// idempotent. It needs no logarithm, which could differ between machines in its last digit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Quantisation {
    /// Binary digits kept after the leading one, 0 to 52; 52 keeps a size unchanged.
    digits: u32,
}

impl Quantisation {
    /// No rounding.
    pub const EXACT: Quantisation = Quantisation { digits: 52 };

    /// The default relative step, 2⁻³⁰ ≈ 9.3·10⁻¹⁰, is far above rounding errors. It has no visible effect on a
    /// result unless its relative slope over the size exceeds a million.
    pub const DEFAULT: Quantisation = Quantisation { digits: 30 };

    /// The coarsest quantisation with a relative step of at most `step`; 0 is exact.
    ///
    /// # Errors
    /// Returns a step that is negative, above ½ or not a number.
    pub fn with_relative_step(step: f64) -> Result<Self, f64> {
        if !(0.0..=0.5).contains(&step) {
            return Err(step);
        }
        let digits = (0..52).find(|&digits| Quantisation { digits }.relative_step() <= step).unwrap_or(52);
        Ok(Quantisation { digits })
    }

    /// Upper bound of the spacing of rounded sizes relative to the size; 0 if exact.
    pub fn relative_step(self) -> f64 {
        if self.digits >= 52 { 0.0 } else { f64::from_bits((1023 - u64::from(self.digits)) << 52) }
    }

    /// The rounded size: the nearest one on the grid, ties to even. The relative shift is at most half the step.
    pub fn apply(self, size: f64) -> f64 {
        if self.digits >= 52 || !size.is_normal() {
            return size;
        }
        let dropped = 52 - self.digits;
        let bits = size.to_bits();
        let odd = (bits >> dropped) & 1;
        // Adding half a step less one, plus the oddness, rounds half to even; the carry may run into the exponent.
        let rounded = (bits + (1 << (dropped - 1)) - 1 + odd) >> dropped << dropped;
        let rounded = f64::from_bits(rounded);
        if rounded.is_finite() { rounded } else { size }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn rounding_is_idempotent_and_keeps_the_order(
            size in 1e-3..1e3_f64, other in 1e-3..1e3_f64, digits in 0..=52_u32,
        ) {
            let quantisation = Quantisation { digits };
            let once = quantisation.apply(size);
            prop_assert_eq!(quantisation.apply(once).to_bits(), once.to_bits());
            prop_assert!((once - size).abs() <= 0.5 * quantisation.relative_step() * size);
            prop_assert!(size > other || once <= quantisation.apply(other));
        }
    }

    #[test]
    fn sizes_a_rounding_apart_become_one_and_distinct_sizes_do_not() {
        let q = Quantisation::DEFAULT;
        let size = 5.4 * 0.5_f64.cbrt();
        assert_eq!(q.apply(size).to_bits(), q.apply(size.next_up()).to_bits());
        assert_ne!(q.apply(size).to_bits(), q.apply(size * (1.0 + 2e-9)).to_bits());
        assert_eq!(Quantisation::EXACT.apply(size).to_bits(), size.to_bits());
    }

    #[test]
    fn a_step_is_rounded_down_to_a_power_of_two_and_nonsense_is_refused() {
        let q = Quantisation::with_relative_step(1e-9).unwrap();
        assert_eq!(q, Quantisation::DEFAULT);
        assert!(q.relative_step() <= 1e-9);
        assert_eq!(Quantisation::with_relative_step(0.0).unwrap(), Quantisation::EXACT);
        assert_eq!(Quantisation::with_relative_step(0.25).unwrap().relative_step(), 0.25);
        assert!([-1e-9, 0.6, f64::NAN].into_iter().all(|step| Quantisation::with_relative_step(step).is_err()));
    }

    #[test]
    fn sizes_that_are_no_numbers_pass_through() {
        for size in [f64::NAN, f64::INFINITY, 0.0, -0.0, f64::MAX] {
            assert_eq!(Quantisation { digits: 3 }.apply(size).to_bits(), size.to_bits());
        }
    }
}
