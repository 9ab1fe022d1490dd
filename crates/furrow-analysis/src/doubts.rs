//! Warnings about a sweep and its results, one sentence each.

use super::points::{AxisValue, Target};
use super::run::SweepResult;
use super::sweep::{Kind, Sweep};
use furrow_lineage::Length;
use furrow_lineage::units::size_doubt;

impl Sweep {
    /// Doubts about the lineage and about the sizes, and who gets a cue in a lineage without cues.
    pub fn doubts(&self) -> Vec<String> {
        let mut doubts = self.lineage.doubts();
        doubts.extend(self.radii().find_map(|r0| size_doubt(r0, &self.lineage.units())));
        if self.sets_cues_of_trees() {
            doubts.extend(self.lineage.who_gets("the cue", &self.settings.cell));
        }
        doubts
    }

    /// Says that the law of the cells reads a regulator that the first of them lacks.
    pub fn lacks_regulator(&self) -> Option<String> {
        if self.kind == Kind::Tree { None } else { self.point(0).input.cell.lacks_regulator() }
    }

    /// The radii of an axis.
    fn radii(&self) -> impl Iterator<Item = Length> {
        let axes = self.axes.0.iter().filter(|axis| axis.target == Target::Field("r0"));
        axes.flat_map(|axis| &axis.values).filter_map(|value| match value {
            AxisValue::Number(r0) => Some(Length::Natural(*r0)),
            AxisValue::Text(_) => None,
        })
    }
}

impl SweepResult {
    /// How many points are undecided, and why the first of them is.
    pub fn undecided_points(&self) -> Option<String> {
        let first = self.undecided().next()?;
        let (undecided, of, index) = (self.undecided().count(), self.rows.len(), first.index);
        let why = first.why.as_deref().unwrap_or_default();
        Some(format!("{undecided} of {of} points are undecided, wholly or in part; the first has index {index}: {why}"))
    }
}
