//! Detects limit cycles: cells that neither divide nor come to rest, and would run until `t_max`.
//!
//! Where a stationary shape off the centre loses its stability to a pair of complex growth rates, the furrow wanders from side
//! to side around it, with the same period for ever. It is told by the length of the contour: a cycle lasts from one of its
//! maxima to the next.

/// Cycles that are looked at together, the older half beside the younger.
const CYCLES: usize = 24;
/// By how much the two halves may differ, relative to their mean. What changes more slowly does not end in the time that a
/// cell is given either.
const SAME: f64 = 1e-3;
/// By how much a single period may differ from the mean: shapes are known at time steps alone.
const SCATTER: f64 = 0.2;
/// Least change of the contour's length in a cycle, relative to it: a shape at rest moves by rounding.
const LEAST: f64 = 1e-4;

/// The length of a contour over time.
#[derive(Clone, Debug, Default)]
pub struct Oscillation {
    /// The last two times and lengths, newest first.
    recent: Vec<[f64; 2]>,
    /// Time of the last maximum.
    peak: Option<f64>,
    /// Least length since.
    least: f64,
    /// Of the last cycles, oldest first: the time from one maximum to the next, in τ, and the relative change of length.
    cycles: Vec<[f64; 2]>,
}

impl Oscillation {
    /// Notes the length at a time; gives the period once it is one.
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

    /// The period found in lengths over time, if any.
    fn period_of(length: impl Fn(f64) -> f64) -> Option<f64> {
        let mut oscillation = Oscillation::default();
        (0..4000).map(|k| f64::from(k) * 0.37).find_map(|t| oscillation.note(t, length(t)))
    }

    #[test]
    fn a_cycle_is_told_and_what_grows_dies_out_or_only_trembles_is_not() {
        let period = period_of(|t| 15.0 + 0.05 * (t / 3.0).sin()).unwrap();
        assert!((period / (6.0 * std::f64::consts::PI) - 1.0).abs() < 5e-3, "{period}");
        assert!(period_of(|t| 15.0 + 0.001 * (t / 300.0).exp() * (t / 3.0).sin()).is_none());
        assert!(period_of(|t| 15.0 + 0.05 * (-t / 300.0).exp() * (t / 3.0).sin()).is_none());
        assert!(period_of(|t| 15.0 + 1e-6 * (t / 3.0).sin()).is_none());
        assert!(period_of(|t| 15.0 - t).is_none());
    }

    /// With steps and meshes as fine as 1e-6 and 96 the period is 17.102; those of the preset see it 1.4 % shorter.
    #[test]
    fn a_cell_that_oscillates_says_so() {
        let input =
            DivisionInput::new(Cell { xi_s: 13.661062187437096, ..Cell::gao2026_thresholds(4.314170770347118) });
        match divide(&input) {
            Err(DivisionError::Oscillates { period, .. }) => assert!((period / 17.102 - 1.0).abs() < 0.02, "{period}"),
            other => panic!("{other:?}"),
        }
    }
}
