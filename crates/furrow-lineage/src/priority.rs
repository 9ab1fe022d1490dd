//! The expected work for a cell and its descendants, which determines the order of divisions.

use furrow_mechanics::division::DivisionInput;

/// Ratio of the upper edge of the asymmetric window to the lower one, the critical radius, for the preset `gao2026`: 2.25/1.7.
/// It is slightly different for other parameters, which affects only the computing time.
const WINDOW: f64 = 1.32;
/// Work of a division in the window, in units of a symmetric division.
const SLOW: f64 = 2.5;
/// Relative radius of a daughter with half the volume, ½^{1/3}.
const HALF: f64 = 0.793_700_525_984_099_7;
/// Relative radius of the larger daughter at χ = 0.8, 0.9^{1/3}.
const LARGER: f64 = 0.965_489_384_605_629_7;
/// A bound that exceeds the length of any chain; it ends the loop for infinite radii.
const LONGEST_CHAIN: usize = 64;

/// Expected work of a cell and the longest chain of divisions below it, in units of a symmetric division, for cells that
/// come to rest undivided below the radius `critical`.
///
/// Large cells divide into equal halves. Below the upper edge of the asymmetric window a division costs two to three times as much
/// and produces a daughter almost as large as its mother, so the longest chains lead through the window and are started
/// first. Cues are ignored. The order of work does not affect the results.
pub fn expected_work(critical: f64) -> impl Fn(&DivisionInput) -> f64 {
    move |input| {
        let mut work = 1.0;
        let mut r0 = input.cell.r0;
        for _ in 0..LONGEST_CHAIN {
            if r0.is_nan() || r0 < critical {
                break;
            }
            let slow = r0 < WINDOW * critical;
            work += if slow { SLOW } else { 1.0 };
            r0 *= if slow { LARGER } else { HALF };
        }
        work
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use furrow_cell::Cell;

    fn work(critical: f64, r0: f64) -> f64 {
        expected_work(critical)(&DivisionInput::new(Cell::gao2026_thresholds(r0)))
    }

    #[test]
    fn larger_cells_hold_up_more_and_slow_ones_weigh_more() {
        assert!(work(1.7, 5.4) > work(1.7, 4.2) && work(1.7, 4.2) > work(1.7, 3.3));
        assert!(work(1.7, 2.0) > work(1.7, 1.4));
        for r0 in [f64::NAN, f64::INFINITY, -1.0, 0.0] {
            assert!(work(1.7, r0).is_finite());
        }
    }

    #[test]
    fn cells_in_proportion_to_their_critical_radius_weigh_the_same() {
        for r0 in [1.4, 2.0, 3.3, 5.4] {
            assert_eq!(work(1.7, r0), work(3.4, 2.0 * r0));
        }
    }
}
