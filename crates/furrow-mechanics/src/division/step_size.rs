//! Control of the time step.
//!
//! The error of a step of order k is proportional to its length to the power k + 1, which gives the length with the
//! allowed error. While steps become shorter and shorter, as when a neck closes, this length is always too long, and
//! every other step would be rejected. Therefore the change of the error over the last two steps is extrapolated, and
//! the shorter of both lengths taken, N.15.
//!
//! # References
//! Gustafsson, *ACM Transactions on Mathematical Software* 20 (1994) 496; Hairer & Wanner, *Solving Ordinary Differential
//! Equations II*, Springer 1996, ch. IV.8.

/// Safety factor on the length of steps: a rejected step costs as much as an accepted one.
const SAFETY: f64 = 0.8;
/// Smallest and largest ratio of the lengths of successive steps.
const GROWTH: [f64; 2] = [0.3, 2.0];
/// The same for a repeated step.
const SHRINKAGE: [f64; 2] = [0.2, 0.8];
/// Smaller errors, in units of the tolerance, are replaced by this.
const SMALLEST: f64 = 1e-8;

/// Length and error, in units of the tolerance, of the previous step.
#[derive(Clone, Copy, Debug, Default)]
pub struct StepSize(Option<[f64; 2]>);

impl StepSize {
    /// Ratio of the next step to an accepted step of the given length, error and order.
    pub fn growth(&mut self, length: f64, error: f64, order: usize) -> f64 {
        let power = 1.0 / (order as f64 + 1.0);
        let error = error.max(SMALLEST);
        let mut growth = SAFETY * error.powf(-power);
        if let Some([length_before, error_before]) = self.0.replace([length, error]) {
            growth = growth.min(growth * (length / length_before) * (error_before / error).powf(power));
        }
        growth.clamp(GROWTH[0], GROWTH[1])
    }

    /// Ratio of the next attempt to a step with too large an error.
    pub fn shrinkage(error: f64, order: usize) -> f64 {
        (SAFETY * error.powf(-1.0 / (order as f64 + 1.0))).clamp(SHRINKAGE[0], SHRINKAGE[1])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steady_errors_are_brought_to_the_tolerance() {
        let mut size = StepSize::default();
        size.growth(0.1, 0.5, 4);
        assert_eq!(size.growth(0.1, 0.5, 4), 0.8 * 0.5f64.powf(-0.2));
        assert_eq!(size.growth(0.1, 0.0, 4), 2.0);
        assert!(StepSize::shrinkage(3.0, 4) < 0.8 && StepSize::shrinkage(f64::INFINITY, 4) == 0.2);
    }

    #[test]
    fn growing_errors_of_ever_shorter_steps_are_anticipated() {
        // An error of (length/τ)⁵, where the remaining time τ falls to 0: steps of a fixed fraction of τ make equal
        // errors.
        let (mut size, mut left, mut length, mut rejected) = (StepSize::default(), 1.0, 0.2, 0);
        for _ in 0..40 {
            let error = f64::powi(length / (0.3 * left), 5);
            if error > 1.0 {
                rejected += 1;
                length *= StepSize::shrinkage(error, 4);
            } else {
                left -= length;
                length *= size.growth(length, error, 4);
            }
        }
        assert_eq!(rejected, 0);
        assert!(left < 1e-3, "{left}");
    }
}
