//! Charts: axes, and drawing in data coordinates.

use super::canvas::{Anchor, Canvas, Label, Stroke};
use super::font;
use super::legend::{Marker, point};
use super::style::{Colour, FAINT, GRID, INK, MUTED, WHITE, text};

/// The positions of an axis's ticks and grid lines.
#[derive(Clone, Debug)]
pub enum Ticks {
    /// About the given number of round values.
    About(usize),
    /// Powers of ten, and values between them if these are few, on a logarithmic scale.
    Logarithmic,
    /// 0, 1, 2, …, each labelled with a name.
    Names(Vec<String>),
}

/// An axis: its label, and the values at its ends.
#[derive(Clone, Debug)]
pub struct Axis {
    /// Name, with the unit in brackets.
    pub label: String,
    /// First and last value.
    pub range: [f64; 2],
    /// Whether its ticks have labels.
    pub numbered: bool,
    /// Its ticks.
    pub ticks: Ticks,
    /// The name of the part below 0, which has no numbers, if the axis has such a part.
    pub strip: Option<&'static str>,
}

impl Axis {
    /// An axis over a range.
    pub fn new(label: impl Into<String>, range: [f64; 2]) -> Axis {
        let range = if range[1] > range[0] { range } else { [range[0] - 0.5, range[0] + 0.5] };
        Axis { label: label.into(), range, numbered: true, ticks: Ticks::About(8), strip: None }
    }

    /// An axis over the given values, with some room on both sides.
    pub fn over(label: impl Into<String>, values: impl IntoIterator<Item = f64>) -> Axis {
        Axis::new(label, widened(values, 0.06))
    }

    /// An axis of names at 0, 1, 2, …: from left to right, or from top to bottom.
    pub fn names(label: impl Into<String>, names: Vec<String>, upright: bool) -> Axis {
        let (first, last) = (-0.5, names.len().max(1) as f64 - 0.5);
        let range = if upright { [last, first] } else { [first, last] };
        Axis { label: label.into(), range, numbered: true, ticks: Ticks::Names(names), strip: None }
    }

    /// The same axis in the opposite direction.
    pub fn reversed(self) -> Axis {
        let [first, last] = self.range;
        Axis { range: [last, first], ..self }
    }

    /// The same axis on a logarithmic scale.
    pub fn logarithmic(self) -> Axis {
        Axis { ticks: Ticks::Logarithmic, ..self }
    }

    /// The position of a value along the axis, from 0 to 1.
    fn share(&self, value: f64) -> f64 {
        let place = |value: f64| match self.ticks {
            Ticks::Logarithmic => value.max(1e-10).log10(),
            _ => value,
        };
        let [first, last] = self.range.map(place);
        (place(value) - first) / (last - first)
    }

    /// The values at the ticks, and their labels.
    fn marks(&self) -> Vec<(f64, String)> {
        let [first, last] = self.range;
        let (low, high) = (first.min(last), first.max(last));
        match &self.ticks {
            Ticks::Names(names) => names.iter().enumerate().map(|(k, name)| (k as f64, name.clone())).collect(),
            Ticks::Logarithmic => {
                let ends = self.range.map(|end| end.max(1e-10).log10());
                let digits: &[f64] = if ends[1] - ends[0] < 2.0 { &[1.0, 2.0, 5.0] } else { &[1.0] };
                let powers = ends[0].floor() as i32..=ends[1].ceil() as i32;
                let values = powers.flat_map(|power| digits.iter().map(move |digit| digit * 10_f64.powi(power)));
                let within = values.filter(|value| (low * (1.0 - 1e-9)..=high * (1.0 + 1e-9)).contains(value));
                within.map(|v| (v, if (1.0..1e6).contains(&v) { format!("{v}") } else { format!("{v:e}") })).collect()
            }
            Ticks::About(count) => {
                let step = spacing([low, high], *count);
                let digits = (-(step * 1.0001).log10().floor()).max(0.0) as usize;
                let written = |value: f64| {
                    // No minus sign before a zero.
                    let value = if value.abs() < 0.5 * 10f64.powi(-(digits as i32)) { 0.0 } else { value };
                    format!("{value:.digits$}").replace('-', "\u{2212}")
                };
                let inside = (low / step - 1e-9).ceil() as i64..=(high / step + 1e-9).floor() as i64;
                let numbered = inside.filter(|k| self.strip.is_none() || *k >= 0);
                numbered.map(|k| k as f64 * step).map(|value| (value, written(value))).collect()
            }
        }
    }
}

/// The round spacing closest to `count` ticks in a range, with at least two ticks inside it.
fn spacing([low, high]: [f64; 2], count: usize) -> f64 {
    let rough = (high - low) / count.max(1) as f64;
    let unit = 10f64.powf(rough.log10().floor());
    let steps = [0.5, 1.0, 2.0, 5.0, 10.0].map(|digit| digit * unit);
    let wanted = steps.iter().position(|step| *step >= rough).unwrap_or(steps.len() - 1);
    // A single tick shows no distances.
    let enough = |step: &&f64| (high / **step).floor() - (low / **step).ceil() >= 1.0;
    *steps[..=wanted].iter().rev().find(enough).unwrap_or(&steps[wanted])
}

/// The range of values, extended on both sides by a share of its length.
pub fn widened(values: impl IntoIterator<Item = f64>, share: f64) -> [f64; 2] {
    let finite = values.into_iter().filter(|value| value.is_finite());
    let [low, high] = finite.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], v| [low.min(v), high.max(v)]);
    if low > high {
        return [0.0, 1.0];
    }
    let room = if high > low { share * (high - low) } else { 0.1 * high.abs().max(1.0) };
    [low - room, high + room]
}

/// Margins on the left, on the right, above and below the data of a chart, for its axes.
pub const MARGINS: [f64; 4] = [86.0, 22.0, 14.0, 58.0];

/// A point of the data with its marker and colour.
pub type Mark = ([f64; 2], Marker, Colour);

/// A chart with its axes drawn. Points are given in the coordinates of its data.
#[derive(Debug)]
pub struct Chart<'c> {
    /// The canvas on which it is drawn.
    pub canvas: &'c mut Canvas,
    /// Left, top, right and bottom of the data on the canvas.
    pub frame: [f64; 4],
    x: Axis,
    y: Axis,
}

impl Chart<'_> {
    /// Draws the grid and the axes of a chart, x to the right and y upwards. The upper left corner and the size include
    /// the labels of the axes.
    pub fn new(canvas: &mut Canvas, at: [f64; 2], size: [f64; 2], x: Axis, y: Axis) -> Chart<'_> {
        Chart::within(canvas, at, size, MARGINS, x, y)
    }

    /// The same with other [margins](MARGINS).
    pub fn within(
        canvas: &mut Canvas,
        at: [f64; 2],
        [width, height]: [f64; 2],
        margins: [f64; 4],
        x: Axis,
        y: Axis,
    ) -> Chart<'_> {
        let [left, top] = [at[0] + margins[0], at[1] + margins[2]];
        let (right, bottom) = (at[0] + width - margins[1], at[1] + height - margins[3]);
        let mut chart = Chart { canvas, frame: [left, top, right, bottom], x, y };
        let (grid, thin) = (Stroke::solid(GRID, 1.0), Stroke::solid(INK, 1.0));
        let column = |(value, word)| (left + chart.x.share(value) * (right - left), word);
        let row = |(value, word)| (bottom - chart.y.share(value) * (bottom - top), word);
        let across: Vec<(f64, String)> = chart.x.marks().into_iter().map(column).collect();
        let up: Vec<(f64, String)> = chart.y.marks().into_iter().map(row).collect();
        for (x, _) in &across {
            chart.canvas.polyline(&[[*x, top], [*x, bottom]], grid);
            chart.canvas.polyline(&[[*x, bottom], [*x, bottom + 5.0]], thin);
        }
        for (y, _) in &up {
            chart.canvas.polyline(&[[left, *y], [right, *y]], grid);
            chart.canvas.polyline(&[[left - 5.0, *y], [left, *y]], thin);
        }
        if let Some(name) = chart.y.strip {
            let zero = bottom - chart.y.share(0.0) * (bottom - top);
            chart.canvas.rectangle([left, zero], [right - left, bottom - zero], FAINT, 0.5);
            chart.canvas.text([left - 8.0, 0.5 * (zero + bottom) + 5.5], name, text::TICK, Anchor::End, MUTED);
        }
        chart.border();
        for (x, word) in across.iter().filter(|_| chart.x.numbered) {
            chart.canvas.text([*x, bottom + 20.0], word, text::TICK, Anchor::Middle, INK);
        }
        for (y, word) in up.iter().filter(|_| chart.y.numbered) {
            chart.canvas.text([left - 8.0, y + 5.5], word, text::TICK, Anchor::End, INK);
        }
        chart.name([at[0], width], [at[1], height]);
        chart
    }

    /// Writes the labels of the axes: within the chart, in smaller lines if one is too long.
    fn name(&mut self, across: [f64; 2], down: [f64; 2]) {
        let [left, top, right, bottom] = self.frame;
        let lines = |label: &str, length: f64| {
            let fits = font::width(label, text::LABEL) <= length - 8.0;
            let size = if fits { text::LABEL } else { text::TICK };
            (size, font::wrapped(label, size, length - 8.0))
        };
        // The middle of a line that stays within a length.
        let inside = |middle: f64, [from, length]: [f64; 2], line: &str, size: u32| {
            let half = 0.5 * font::width(line, size) + 4.0;
            middle.max(from + half).min((from + length - half).max(from + half))
        };
        let (size, found) = lines(&self.x.label, across[1]);
        let last = down[0] + down[1] - if found.len() > 1 { 5.0 } else { 9.0 };
        for (k, line) in found.iter().rev().enumerate() {
            let x = inside(0.5 * (left + right), across, line, size);
            self.canvas.text([x, last - 16.0 * k as f64], line, size, Anchor::Middle, INK);
        }
        let (size, found) = lines(&self.y.label, down[1]);
        let words = self.y.marks().into_iter().filter(|_| self.y.numbered);
        let widest = words.map(|(_, word)| font::width(&word, text::TICK)).fold(0.0, f64::max);
        // Left of the ticks' labels, within the canvas.
        let least = across[0] + 16.0 + 17.0 * found.len().saturating_sub(1) as f64;
        let last = (across[0] + 30.0).min(left - 16.0 - widest).max(least);
        for (k, line) in found.iter().rev().enumerate() {
            let y = inside(0.5 * (top + bottom), down, line, size);
            let at = [last - 17.0 * k as f64, y];
            self.canvas.label(Label::new(at, line, size, Anchor::Middle, INK).upwards());
        }
    }

    fn border(&mut self) {
        self.canvas.frame(self.frame, Stroke::solid(INK, 1.0));
    }

    /// A point of the data on the canvas.
    pub fn at(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let [left, top, right, bottom] = self.frame;
        [left + self.x.share(x) * (right - left), bottom - self.y.share(y) * (bottom - top)]
    }

    /// Whether a point of the data lies within the axes.
    pub fn holds(&self, at: [f64; 2]) -> bool {
        [self.x.share(at[0]), self.y.share(at[1])].iter().all(|share| (0.0..=1.0).contains(share))
    }

    /// Draws a line, cut off at the axes.
    pub fn line(&mut self, points: impl IntoIterator<Item = [f64; 2]>, stroke: Stroke) {
        let points: Vec<[f64; 2]> = points.into_iter().map(|point| self.at(point)).collect();
        if points.len() > 1 {
            self.canvas.clipped(self.frame, |canvas| canvas.polyline(&points, stroke));
        }
    }

    /// Writes a note into the middle, for a chart without data.
    pub fn note(&mut self, words: &str) {
        let [left, top, right, bottom] = self.frame;
        let middle = [0.5 * (left + right), 0.5 * (top + bottom)];
        self.canvas.label(Label::new(middle, words, text::LABEL, Anchor::Middle, MUTED).over(WHITE));
    }

    /// Draws a point.
    pub fn point(&mut self, at: [f64; 2], size: f64, marker: Marker, colour: Colour) {
        point(self.canvas, self.at(at), size, marker, colour);
    }

    /// Draws points that are alike.
    pub fn points(&mut self, at: impl IntoIterator<Item = [f64; 2]>, size: f64, marker: Marker, colour: Colour) {
        at.into_iter().for_each(|at| self.point(at, size, marker, colour));
    }

    /// Draws markers of different kinds, later ones above. A marker below others is larger, so that it stays visible.
    pub fn marks(&mut self, marks: &[Mark], size: f64) {
        for (k, (at, marker, colour)) in marks.iter().enumerate() {
            let here = self.at(*at);
            let covers = |(place, other, paint): &&Mark| {
                let [x, y] = self.at(*place);
                (other, paint) != (marker, colour) && (x - here[0]).hypot(y - here[1]) < size
            };
            let above = marks[k + 1..].iter().filter(covers).count();
            self.point(*at, size * (1.0 + 0.45 * above as f64), *marker, *colour);
        }
    }

    /// Draws a rectangle between two opposite corners, with width and height of at least `least` on the canvas.
    pub fn area(&mut self, from: [f64; 2], to: [f64; 2], least: f64, colour: Colour, opacity: f64) {
        let (a, b) = (self.at(from), self.at(to));
        let corner = [a[0].min(b[0]), a[1].min(b[1])];
        let size = [0, 1].map(|k: usize| (b[k] - a[k]).abs().max(least));
        self.canvas.rectangle(corner, size, colour, opacity);
    }

    /// Draws a bar from one value to another, shifted by `aside` on the canvas, with ticks of half width `half` at its
    /// ends.
    pub fn error_bar(&mut self, x: f64, ends: [f64; 2], aside: f64, half: f64, stroke: Stroke) {
        let ends = ends.map(|y| self.at([x, y])).map(|[x, y]| [x + aside, y]);
        self.canvas.polyline(&ends, stroke);
        for [x, y] in ends {
            self.canvas.polyline(&[[x - half, y], [x + half, y]], stroke);
        }
    }

    /// Draws adjacent areas, each over an interval of x and one of y.
    pub fn tiles(&mut self, tiles: impl IntoIterator<Item = ([f64; 2], [f64; 2], Colour)>) {
        for ([x, x2], [y, y2], colour) in tiles {
            let (a, b) = (self.at([x, y2]), self.at([x2, y]));
            // A little wider than its interval, so that no gap shows between two.
            self.canvas.rectangle(a, [b[0] - a[0] + 0.3, b[1] - a[1] + 0.3], colour, 1.0);
        }
        self.border();
    }
}

/// The ends of texts in rows, filled from one side to the other.
#[derive(Debug, Default)]
pub struct Rows(Vec<f64>);

impl Rows {
    /// Least distance between two texts of a row.
    const APART: f64 = 8.0;

    /// The first row that is free from one place to another, and is taken from now on.
    pub fn free(&mut self, [from, to]: [f64; 2]) -> usize {
        let row = self.0.iter().position(|end| from > end + Rows::APART).unwrap_or(self.0.len());
        match self.0.get_mut(row) {
            Some(end) => *end = to,
            None => self.0.push(to),
        }
        row
    }
}

/// The interval around each value, up to half-way to its neighbours.
pub fn bins(values: &[f64]) -> Vec<[f64; 2]> {
    let half = |k: usize| values.get(k + 1).map(|next| 0.5 * (next - values[k]));
    (0..values.len())
        .map(|k| {
            let (before, after) = (k.checked_sub(1).and_then(half), half(k));
            let [before, after] = [before.or(after), after.or(before)].map(|gap| gap.unwrap_or(0.5));
            [values[k] - before, values[k] + after]
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::super::canvas::{Element, Outline};
    use super::*;

    #[test]
    fn labels_stay_within_their_charts() {
        let mut canvas = Canvas::new(700.0, 300.0);
        let words =
            ["place u₀ of the cue (rigidity band)", "amplitude of the cue's first term (tension gradient, κ₀/Lₕ²)"];
        for (k, words) in words.into_iter().enumerate() {
            let at = [350.0 * k as f64, 0.0];
            Chart::new(&mut canvas, at, [350.0, 300.0], Axis::new(words, [0.0, 1.0]), Axis::new(words, [0.0, 1.0]));
        }
        let mut labels = 0;
        for element in &canvas.elements {
            let Element::Text(label) = element else { continue };
            let half = 0.5 * font::width(&label.content, label.size);
            let (middle, end) = if label.upwards { (label.at[1], 300.0) } else { (label.at[0] % 350.0, 350.0) };
            if label.anchor == Anchor::Middle && half > 50.0 {
                assert!(middle - half > 0.0 && middle + half < end, "{label:?}");
                labels += 1;
            }
        }
        // The second is broken in two along both axes, the first along the axis that is too short for it.
        assert_eq!(labels, 1 + 1 + 2 + 2);
    }

    #[test]
    fn a_mark_under_another_is_larger() {
        let mut canvas = Canvas::new(300.0, 300.0);
        let mut chart =
            Chart::new(&mut canvas, [0.0; 2], [300.0; 2], Axis::new("", [0.0, 1.0]), Axis::new("", [0.0, 1.0]));
        let before = chart.canvas.elements.len();
        let [diamond, disc] = [(Marker::Diamond, GRID), (Marker::Disc, INK)];
        let marks = [([0.5, 0.5], diamond), ([0.5, 0.51], disc), ([0.1, 0.1], diamond)];
        chart.marks(&marks.map(|(at, (marker, colour))| (at, marker, colour)), 6.0);
        let width = |element: &Element| match element {
            Element::Shape(Outline::Lines(lines, true), ..) => lines[0][1][0] - lines[0][3][0],
            other => panic!("{other:?}"),
        };
        assert!(width(&canvas.elements[before]) > 1.3 * width(&canvas.elements[before + 2]));
    }

    #[test]
    fn ticks_are_round_numbers_written_alike() {
        for (axis, expected) in [
            (Axis::new("", [0.0, 1.0]), "0.0 0.2 0.4 0.6 0.8 1.0"),
            (Axis::new("", [-31.0, 31.0]), "−30 −20 −10 0 10 20 30"),
            (Axis { ticks: Ticks::About(3), ..Axis::new("", [1.94, 2.06]) }, "1.95 2.00 2.05"),
            (Axis::new("", [1e-3, 20.0]).logarithmic(), "1e-3 1e-2 1e-1 1 10"),
            (Axis::new("", [900.0, 6000.0]).logarithmic(), "1000 2000 5000"),
            (Axis::names("", vec!["AB".into(), "P1".into()], true), "AB P1"),
        ] {
            let written: Vec<String> = axis.marks().into_iter().map(|(_, word)| word).collect();
            assert_eq!(written.join(" "), expected);
        }
    }
}
