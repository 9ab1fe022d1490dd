//! How long the next time step is.
//!
//! The error of a step of order k goes with its length to the power k + 1, which gives the length that makes the error what is
//! allowed. Where steps become shorter and shorter, as while a neck closes, that is always too long, and every other step would be
//! rejected; so the change of the error over the last two steps is continued, and the shorter of both lengths taken, N.15.
//!
//! # References
//! Gustafsson, *ACM Transactions on Mathematical Software* 20 (1994) 496; Hairer & Wanner, *Solving Ordinary Differential
//! Equations II*, Springer 1996, ch. IV.8.

/// Steps are this much shorter than what their error asks for: a step rejected costs as much as one made.
const SAFETY: f64 = 0.8;
/// A step is at least and at most this many times as long as the one before.
const GROWTH: [f64; 2] = [0.3, 2.0];
/// The same for a step that is tried again.
const SHRINKAGE: [f64; 2] = [0.2, 0.8];
/// Smaller errors, in units of what is allowed, are taken for this.
const SMALLEST: f64 = 1e-8;

/// Length and error, in units of what is allowed, of the step before.
#[derive(Clone, Copy, Debug, Default)]
pub struct StepSize(Option<[f64; 2]>);

impl StepSize {
    /// How many times longer than a step that is made, of this length, order and error, the next may be.
    pub fn growth(&mut self, length: f64, error: f64, order: usize) -> f64 {
        let power = 1.0 / (order as f64 + 1.0);
        let error = error.max(SMALLEST);
        let mut growth = SAFETY * error.powf(-power);
        if let Some([length_before, error_before]) = self.0.replace([length, error]) {
            growth = growth.min(growth * (length / length_before) * (error_before / error).powf(power));
        }
        growth.clamp(GROWTH[0], GROWTH[1])
    }

    /// How many times longer than a step that made too large an error the next attempt is.
    pub fn shrinkage(error: f64, order: usize) -> f64 {
        (SAFETY * error.powf(-1.0 / (order as f64 + 1.0))).clamp(SHRINKAGE[0], SHRINKAGE[1])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steady_errors_are_brought_to_what_is_allowed() {
        let mut size = StepSize::default();
        size.growth(0.1, 0.5, 4);
        assert_eq!(size.growth(0.1, 0.5, 4), 0.8 * 0.5f64.powf(-0.2));
        assert_eq!(size.growth(0.1, 0.0, 4), 2.0);
        assert!(StepSize::shrinkage(3.0, 4) < 0.8 && StepSize::shrinkage(f64::INFINITY, 4) == 0.2);
    }

    #[test]
    fn errors_that_grow_in_shorter_and_shorter_steps_are_foreseen() {
        // An error of (length/τ)⁵ with τ, the time that is left, falling to 0: steps of a fixed part of it make equal errors.
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
