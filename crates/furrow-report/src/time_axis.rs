//! The axis of time of a drawn tree: generations, or minutes by the lineage's clock.

use furrow_lineage::clock::last_times;
use furrow_lineage::{CellId, CellTimes, Tree};

/// The quantity that runs downwards in a drawing of a tree.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum TimeAxis {
    /// A row for each generation.
    #[default]
    Generations,
    /// Minutes, for a lineage with a clock.
    Minutes,
}

impl TimeAxis {
    /// All axes, by the names that users give them.
    pub const NAMED: [(&'static str, TimeAxis); 2] =
        [("generations", TimeAxis::Generations), ("minutes", TimeAxis::Minutes)];
}

/// Minutes along an axis.
pub(super) struct TimeScale {
    /// By node.
    pub(super) times: Vec<CellTimes>,
    /// The times of the last dividing cell, by founder, as [`last_times`] gives them.
    pub(super) last_times: Vec<Option<CellTimes>>,
    /// The last birth drawn.
    pub(super) last: f64,
    first: f64,
    per_min: f64,
}

/// Least distance between two ticks.
const APART: f64 = 44.0;

impl TimeScale {
    /// The births of the drawn cells over an axis of the given length; `None` without a clock.
    pub(super) fn new(tree: &Tree, drawn: &[CellId], length: f64) -> Option<TimeScale> {
        let times = tree.times()?;
        let births = || drawn.iter().map(|id| times[id.index()].birth_min);
        let (first, last) = (births().fold(f64::INFINITY, f64::min), births().fold(f64::NEG_INFINITY, f64::max));
        let per_min = if last > first { length / (last - first) } else { 0.0 };
        Some(TimeScale { last_times: last_times(tree, &times), times, last, first, per_min })
    }

    /// The depth at which a minute is drawn.
    pub(super) fn at(&self, min: f64) -> f64 {
        (min - self.first) * self.per_min
    }

    /// Round minutes: their positions, their labels, and the numbers of cells alive then.
    pub(super) fn ticks(&self) -> Vec<(f64, String, usize)> {
        let steps = (0..6).flat_map(|power| [1.0, 2.0, 5.0].map(|digit| digit * 10_f64.powi(power)));
        let Some(step) = steps.into_iter().find(|step| step * self.per_min >= APART) else { return Vec::new() };
        let (from, to) = ((self.first / step).ceil() as i64, (self.last / step).floor() as i64);
        let tick = |k: i64| {
            let min = k as f64 * step;
            (self.at(min), format!("{min:.0}").replace('-', "\u{2212}"), self.alive(min))
        };
        (from..=to).map(tick).collect()
    }

    fn alive(&self, min: f64) -> usize {
        let alive =
            |times: &&CellTimes| times.birth_min <= min && times.division_min.is_none_or(|division| division > min);
        self.times.iter().filter(alive).count()
    }
}
