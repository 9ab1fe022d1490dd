//! Curves over any quantity, with marked places and shapes: for results that no command has.

use crate::drawing::cell::{Site, body};
use crate::drawing::legend::{Key, Legend, Marker, titled};
use crate::drawing::panel::{Axis, Chart};
use crate::drawing::style::{self, Colour, text};
use crate::drawing::{Anchor, Canvas, Label, Stroke};
use furrow_measured::statistics::distinct;

const WIDTH: f64 = 1000.0;
/// Height of the chart.
const CHART: f64 = 460.0;
/// Height of the row of shapes.
const SHAPES: f64 = 170.0;

/// A curve.
#[derive(Clone, Debug)]
pub struct Series {
    /// Its name; curves of one name have one colour and one entry in the legend.
    pub name: String,
    /// Its points.
    pub points: Vec<[f64; 2]>,
    /// Whether it is dashed.
    pub dashed: bool,
}

/// A measured place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measured {
    /// Where.
    pub at: [f64; 2],
    /// Standard deviation of the second number; 0 without one.
    pub sd: f64,
    /// Whether it is a ring instead of a disc.
    pub open: bool,
}

/// A picture of curves.
#[derive(Clone, Debug, Default)]
pub struct Curves {
    /// The title; further lines are smaller.
    pub title: String,
    /// Labels of both axes, with the values at their ends.
    pub axes: [(String, [f64; 2]); 2],
    /// Whether the second axis is logarithmic.
    pub logarithmic: bool,
    /// The curves.
    pub series: Vec<Series>,
    /// Marked places, with a word beside each.
    pub marks: Vec<(String, [f64; 2])>,
    /// Measured places.
    pub measured: Vec<Measured>,
    /// Contours (r, z) from pole to pole below the chart, with a word each; all on one scale.
    pub shapes: Vec<(String, Vec<[f64; 2]>)>,
}

impl Curves {
    fn height(&self) -> f64 {
        CHART + if self.shapes.is_empty() { 0.0 } else { SHAPES }
    }
}

/// Draws them.
pub fn draw(curves: &Curves) -> Canvas {
    stack(std::slice::from_ref(curves), &[])
}

/// Draws several below one another, with the title of the first and one legend: a curve has the same colour everywhere. `notes` are further
/// entries of the legend, for dashes, discs and rings.
pub fn stack(panels: &[Curves], notes: &[(Note, &str)]) -> Canvas {
    let names = distinct(panels.iter().flat_map(|panel| &panel.series).map(|one| one.name.as_str()));
    let colour = |name: &str| -> Colour {
        let place = names.iter().position(|of| *of == name).unwrap_or_default();
        style::SERIES[place % style::SERIES.len()]
    };
    let legend = Legend::default()
        .with_all(names.iter().map(|name| (Key::Line(colour(name)), (*name).to_owned())))
        .with_all(notes.iter().map(|(note, word)| (note.key(), (*word).to_owned())));
    let below = panels.iter().map(Curves::height).sum();
    let title = panels.first().map_or("", |panel| &panel.title);
    let (mut canvas, mut top) = titled(WIDTH, below, title, &legend);
    for panel in panels {
        chart(&mut canvas, panel, top, &colour);
        row(&mut canvas, &panel.shapes, top + CHART);
        top += panel.height();
    }
    canvas
}

/// What an entry of a legend explains.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Note {
    /// Dashed curves.
    Dashes,
    /// Measured places with a disc.
    Disc,
    /// Measured places with a ring.
    Ring,
}

impl Note {
    fn key(self) -> Key {
        match self {
            Note::Dashes => Key::Dashes(style::OBSERVED, style::DASHED),
            Note::Disc => Key::Point(style::OBSERVED, Marker::Disc),
            Note::Ring => Key::Point(style::OBSERVED, Marker::Ring),
        }
    }
}

fn chart(canvas: &mut Canvas, curves: &Curves, top: f64, colour: &dyn Fn(&str) -> Colour) {
    let [x, y] = &curves.axes;
    let axis = |(label, ends): &(String, [f64; 2])| match ends[0] > ends[1] {
        true => Axis::new(label.clone(), [ends[1], ends[0]]).reversed(),
        false => Axis::new(label.clone(), *ends),
    };
    let upright = if curves.logarithmic { axis(y).logarithmic() } else { axis(y) };
    let mut chart = Chart::new(canvas, [0.0, top], [WIDTH, CHART], axis(x), upright);
    for Series { name, points, dashed } in &curves.series {
        let dash = dashed.then_some(style::DASHED);
        chart.line(points.iter().copied(), Stroke { colour: colour(name), width: style::CURVE, dash });
        if let [alone] = points[..] {
            chart.point(alone, 4.0, Marker::Square, colour(name));
        }
    }
    for Measured { at: [x, y], sd, open } in &curves.measured {
        if *sd > 0.0 {
            let ends = [(y - sd).max(curves.axes[1].1[0]), y + sd];
            chart.error_bar(*x, ends, 0.0, 3.0, Stroke::solid(style::OBSERVED, 1.0));
        }
        chart.point([*x, *y], 6.0, if *open { Marker::Ring } else { Marker::Disc }, style::OBSERVED);
    }
    for (word, place) in &curves.marks {
        chart.point(*place, 6.0, Marker::Disc, style::INK);
        let [x, y] = chart.at(*place);
        let (aside, anchor) = if x + 170.0 > chart.frame[2] { (-11.0, Anchor::End) } else { (11.0, Anchor::Start) };
        let label = Label::new([x + aside, y - 9.0], word, text::TICK, anchor, style::INK);
        chart.canvas.label(label.over(style::WHITE));
    }
}

fn row(canvas: &mut Canvas, shapes: &[(String, Vec<[f64; 2]>)], top: f64) {
    let all = || shapes.iter().flat_map(|(_, contour)| contour);
    let width = (WIDTH - 40.0) / shapes.len().max(1) as f64;
    let [across, along] = all().fold([0.0f64; 2], |[r, z], at| [r.max(at[0].abs()), z.max(at[1].abs())]);
    let scale = (0.44 * width / along).min(0.36 * SHAPES / across);
    for (k, (word, contour)) in shapes.iter().enumerate() {
        let centre = [20.0 + width * (k as f64 + 0.5), top + 0.42 * SHAPES];
        body(canvas, contour, &Site { centre, scale }, 1.8);
        canvas.text([centre[0], top + SHAPES - 8.0], word, text::TICK, Anchor::Middle, style::MUTED);
    }
}
