//! Curves over any quantity, with marked places and shapes: for results that no command has.

use crate::drawing::cell::{Site, body};
use crate::drawing::legend::{Key, Legend, Marker, titled};
use crate::drawing::panel::{Axis, Chart};
use crate::drawing::style::{self, Colour, text};
use crate::drawing::{Anchor, Canvas, Label, Stroke};

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

/// A picture of curves.
#[derive(Clone, Debug)]
pub struct Curves {
    /// The title; further lines are smaller.
    pub title: String,
    /// Labels of both axes, with their ranges.
    pub axes: [(String, [f64; 2]); 2],
    /// The curves.
    pub series: Vec<Series>,
    /// Marked places, with a word beside each.
    pub marks: Vec<(String, [f64; 2])>,
    /// Contours (r, z) from pole to pole below the chart, with a word each; all on one scale.
    pub shapes: Vec<(String, Vec<[f64; 2]>)>,
}

/// Draws them.
pub fn draw(curves: &Curves) -> Canvas {
    let Curves { title, axes: [x, y], series, marks, shapes } = curves;
    let mut names: Vec<&str> = Vec::new();
    for one in series {
        if !names.contains(&one.name.as_str()) {
            names.push(&one.name);
        }
    }
    let colour = |name: &str| -> Colour {
        let place = names.iter().position(|of| *of == name).unwrap_or_default();
        style::SERIES[place % style::SERIES.len()]
    };
    let legend = Legend::default().with_all(names.iter().map(|name| (Key::Line(colour(name)), (*name).to_owned())));
    let below = CHART + if shapes.is_empty() { 0.0 } else { SHAPES };
    let (mut canvas, top) = titled(WIDTH, below, title, &legend);
    let axis = |(label, range): &(String, [f64; 2])| Axis::new(label.clone(), *range);
    let mut chart = Chart::new(&mut canvas, [0.0, top], [WIDTH, CHART], axis(x), axis(y));
    for Series { name, points, dashed } in series {
        let dash = dashed.then_some(style::DASHED);
        chart.line(points.iter().copied(), Stroke { colour: colour(name), width: style::CURVE, dash });
    }
    for (word, place) in marks {
        chart.point(*place, 6.0, Marker::Disc, style::INK);
        let [x, y] = chart.at(*place);
        let (aside, anchor) = if x + 170.0 > chart.frame[2] { (-11.0, Anchor::End) } else { (11.0, Anchor::Start) };
        let label = Label::new([x + aside, y - 9.0], word, text::TICK, anchor, style::INK);
        chart.canvas.label(label.over(style::WHITE));
    }
    row(&mut canvas, shapes, top + CHART);
    canvas
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
