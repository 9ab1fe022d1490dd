//! Axes, their values, and the points they span.

/// A value of an axis: a number, or a word where the parameter takes words; a cue as users write it.
pub use furrow_cell::settings::Value as AxisValue;
use furrow_cell::settings::number_set_by;
use furrow_cell::{Cue, Parameter};
use furrow_mechanics::division::DivisionInput;

/// What an axis sets.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Target {
    /// A parameter of the cell or of the numerics, by its canonical name.
    Field(&'static str),
    /// The whole cue.
    Cue,
    /// A number of a term of the cue.
    CueNumber(Parameter),
    /// The seed of the noise.
    Seed,
}

impl Target {
    /// The same, with the number that a field sets in place of the field: two targets with the same one exclude each other.
    pub(super) fn number(self) -> Target {
        match self {
            Target::Field(name) => Target::Field(number_set_by(name)),
            other => other,
        }
    }
}

/// One axis: a parameter and its values.
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    /// The parameter's name in the file, also the name of its column.
    pub name: String,
    /// The setting that it varies.
    pub target: Target,
    /// Its values, one at least.
    pub values: Vec<AxisValue>,
    /// Of an axis of cues what each value means; else empty.
    pub cues: Vec<Cue>,
    /// Whether it varies together with the other sampled axes, as one axis of points.
    pub sampled: bool,
}

/// The axes of a sweep.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Axes(pub Vec<Axis>);

impl Axes {
    /// Number of points; `None` if there are more than can be counted.
    pub fn points(&self) -> Option<usize> {
        self.independent().try_fold(1usize, |product, axis| product.checked_mul(axis.values.len()))
    }

    /// Every axis that is not sampled, and the first sampled axis, which represents all sampled axes.
    fn independent(&self) -> impl DoubleEndedIterator<Item = &Axis> {
        let first = self.0.iter().position(|axis| axis.sampled);
        self.0.iter().enumerate().filter(move |(k, axis)| !axis.sampled || Some(*k) == first).map(|(_, axis)| axis)
    }

    /// Which of its values each axis has at a point, points counted from 0: the first axis varies slowest.
    pub fn places(&self, index: usize) -> Vec<usize> {
        let mut left = index;
        let mut digit = |axis: &Axis| {
            let digit = left % axis.values.len();
            left /= axis.values.len();
            digit
        };
        let digits: Vec<usize> = self.independent().rev().map(&mut digit).collect();
        let mut digits = digits.into_iter().rev();
        let mut sample = None;
        let place = |axis: &Axis| match axis.sampled {
            true => *sample.get_or_insert_with(|| digits.next().unwrap_or(0)),
            false => digits.next().unwrap_or(0),
        };
        self.0.iter().map(place).collect()
    }

    /// The values at a point.
    pub fn values(&self, index: usize) -> Vec<&AxisValue> {
        self.0.iter().zip(self.places(index)).map(|(axis, place)| &axis.values[place]).collect()
    }
}

/// A point: the cell there, and how it is computed.
#[derive(Clone, Debug, PartialEq)]
pub struct Point {
    /// Its number in the order of the axes, from 0.
    pub index: usize,
    /// Cell, numerics and first seed; of a tree the first cell, with the cue that replaces the lineage's if one does.
    pub input: DivisionInput,
    /// The reason why these values cannot be computed together, if it is known beforehand.
    pub invalid: Option<String>,
}

#[cfg(test)]
mod tests {
    use super::*;

    fn axis(count: usize, sampled: bool) -> Axis {
        let values = (0..count).map(|k| AxisValue::Number(k as f64)).collect();
        Axis { name: String::new(), target: Target::Field("r0"), values, cues: vec![], sampled }
    }

    #[test]
    fn the_first_axis_varies_slowest() {
        let axes = Axes(vec![axis(2, false), axis(3, false)]);
        assert_eq!(axes.points(), Some(6));
        let places: Vec<Vec<usize>> = (0..6).map(|k| axes.places(k)).collect();
        assert_eq!(places, [[0, 0], [0, 1], [0, 2], [1, 0], [1, 1], [1, 2]]);
    }

    #[test]
    fn sampled_axes_go_together() {
        let axes = Axes(vec![axis(3, true), axis(2, false), axis(3, true)]);
        assert_eq!(axes.points(), Some(6));
        let places: Vec<Vec<usize>> = (0..6).map(|k| axes.places(k)).collect();
        assert_eq!(places, [[0, 0, 0], [0, 1, 0], [1, 0, 1], [1, 1, 1], [2, 0, 2], [2, 1, 2]]);
    }

    #[test]
    fn no_axes_make_one_point_and_too_many_values_none() {
        assert_eq!(Axes::default().points(), Some(1));
        let long = Axis { values: vec![AxisValue::Number(0.0); 1 << 16], ..axis(1, false) };
        assert_eq!(Axes(vec![long; 4]).points(), None);
    }
}
