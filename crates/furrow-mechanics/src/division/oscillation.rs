//! Detection of limit cycles: cells that neither divide nor come to rest, and would run until `t_max`.
//!
//! Where a stationary shape off the centre loses its stability to a pair of complex growth rates, the furrow oscillates
//! about it with a constant period. The cycle is detected in the length of the contour: it lasts from one maximum to
//! the next.

/// Cycles that are compared, the older half with the younger.
const CYCLES: usize = 24;
/// Largest difference between the two halves, relative to their mean. A slower change does not end within the allowed
/// time either.
const SAME: f64 = 1e-3;
/// Largest deviation of a single period from the mean: shapes are known only at time steps.
const SCATTER: f64 = 0.2;
/// Least relative change of the contour's length in a cycle: a shape at rest moves by rounding.
const LEAST: f64 = 1e-4;

/// The length of a contour over time.
#[derive(Clone, Debug, Default)]
pub struct Oscillation {
    /// The last two times and lengths, newest first.
    recent: Vec<[f64; 2]>,
    /// Time of the last maximum.
    peak: Option<f64>,
    /// Least length since then.
    least: f64,
    /// The last cycles, oldest first: the time from one maximum to the next, in τ, and the relative change of length.
    cycles: Vec<[f64; 2]>,
}

impl Oscillation {
    /// Records the length at a time; returns the period once the motion is periodic.
    pub fn note(&mut self, t: f64, length: f64) -> Option<f64> {
        self.least = self.least.min(length);
        let peaked = match self.recent[..] {
            [[at, middle], [_, before]] if middle > before && middle > length => Some((at, middle)),
            _ => None,
        };
        self.recent.insert(0, [t, length]);
        self.recent.truncate(2);
        let (at, most) = peaked?;
        if let Some(last) = self.peak.replace(at) {
            self.cycles.push([at - last, (most - self.least) / most]);
        }
        self.least = most;
        if self.cycles.len() > CYCLES {
            self.cycles.remove(0);
        }
        self.period()
    }

    fn period(&self) -> Option<f64> {
        if self.cycles.len() < CYCLES || self.cycles.iter().any(|[_, swing]| *swing < LEAST) {
            return None;
        }
        let mean = |of: &[[f64; 2]], k: usize| of.iter().map(|cycle| cycle[k]).sum::<f64>() / of.len() as f64;
        let (older, younger) = self.cycles.split_at(CYCLES / 2);
        let steady = |k: usize| {
            let all = mean(&self.cycles, k);
            let scattered = self.cycles.iter().any(|cycle| (cycle[k] - all).abs() > SCATTER * all);
            !scattered && (mean(older, k) - mean(younger, k)).abs() < SAME * all
        };
        (steady(0) && steady(1)).then(|| mean(younger, 0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::division::{DivisionError, DivisionInput, divide};
    use furrow_cell::Cell;

    /// The period detected in lengths over time, if any.
    fn period_of(length: impl Fn(f64) -> f64) -> Option<f64> {
        let mut oscillation = Oscillation::default();
        (0..4000).map(|k| f64::from(k) * 0.37).find_map(|t| oscillation.note(t, length(t)))
    }

    #[test]
    fn a_cycle_is_detected_but_growth_decay_and_rounding_are_not() {
        let period = period_of(|t| 15.0 + 0.05 * (t / 3.0).sin()).unwrap();
        assert!((period / (6.0 * std::f64::consts::PI) - 1.0).abs() < 5e-3, "{period}");
        assert!(period_of(|t| 15.0 + 0.001 * (t / 300.0).exp() * (t / 3.0).sin()).is_none());
        assert!(period_of(|t| 15.0 + 0.05 * (-t / 300.0).exp() * (t / 3.0).sin()).is_none());
        assert!(period_of(|t| 15.0 + 1e-6 * (t / 3.0).sin()).is_none());
        assert!(period_of(|t| 15.0 - t).is_none());
    }

    /// On 96 intervals with a time tolerance of 1e-6 the period is 17.102; with the preset's numerics it is 1.4 % shorter.
    #[test]
    fn an_oscillating_cell_is_an_error_with_its_period() {
        let input =
            DivisionInput::new(Cell { xi_s: 13.661062187437096, ..Cell::gao2026_thresholds(4.314170770347118) });
        match divide(&input) {
            Err(DivisionError::Oscillates { period, .. }) => assert!((period / 17.102 - 1.0).abs() < 0.02, "{period}"),
            other => panic!("{other:?}"),
        }
    }
}
