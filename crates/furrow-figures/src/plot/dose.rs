//! Asymmetry over the dose of a protein, beside the model's over the strength of its cue, for both readings of the
//! sizes.

use furrow_analysis::compare::dose::DoseModel;
use furrow_measured::dose::{DoseGroup, DosedDivision};
use furrow_measured::statistics::Line;

use crate::drawing::legend::{Key, Legend, Marker, titled};
use crate::drawing::panel::{Axis, Chart, Rows};
use crate::drawing::style::{self, Colour, text};
use crate::drawing::{Anchor, Canvas, Label, Stroke, font};
use ordered_float::OrderedFloat;

const WIDTH: f64 = 1180.0;
const CHART: f64 = 480.0;

/// One reading of the sizes.
#[derive(Clone, Debug)]
pub struct Reading<'a> {
    /// Its name.
    pub name: &'a str,
    /// χ of a division.
    pub chi: fn(&DosedDivision) -> f64,
    /// Mean and standard deviation of χ in a bin.
    pub mean_sd: fn(&DoseGroup) -> (f64, Option<f64>),
    /// The line through all divisions.
    pub line: Option<Line>,
}

/// The data of the picture.
#[derive(Clone, Debug)]
pub struct DoseComparison<'a> {
    /// Single divisions; empty if only means are known.
    pub divisions: &'a [DosedDivision],
    /// Conditions in the order of their colours.
    pub conditions: &'a [DoseGroup],
    /// Divisions by dose.
    pub bins: &'a [DoseGroup],
    /// The readings, side by side.
    pub readings: [Reading<'a>; 2],
    /// The model's curve.
    pub model: &'a [DoseModel],
    /// The model's cell.
    pub cell: String,
}

/// The colour of one of several conditions; green is reserved for the model, black for means.
fn colour(condition: usize, of: usize) -> Colour {
    style::series(condition, of, &[5, 1, 2, 4, 6].map(|k: usize| style::SERIES[k]))
}

/// Draws a chart for each reading.
pub fn draw(comparison: &DoseComparison<'_>) -> Canvas {
    let DoseComparison { divisions, conditions, bins, readings, model, cell } = comparison;
    let measured = |(k, condition): (usize, &DoseGroup)| {
        let name = if condition.name.is_empty() { "measured" } else { &condition.name };
        (Key::Point(colour(k, conditions.len()), Marker::Disc), format!("{name}, n = {}", condition.n))
    };
    let legend = Legend::default()
        .with_all(conditions.iter().enumerate().filter(|_| !divisions.is_empty()).map(measured))
        .with(Key::Point(style::INK, Marker::Square), "bins of the dose, mean ± sd, and the number of divisions below")
        .with_if(readings.iter().any(|r| r.line.is_some()), Key::Dashes(style::MUTED, style::DASHED), "least squares")
        .with(Key::Line(style::MODEL), format!("model, amplitude of the cue × dose: {}", style::symbols(cell)));
    let title = "Size asymmetry over the dose of a protein";
    let (mut canvas, top) = titled(WIDTH, CHART, title, &legend);
    let highest = |reading: &Reading<'_>| {
        let single = divisions.iter().map(reading.chi);
        let means = bins.iter().map(|bin| {
            let (mean, sd) = (reading.mean_sd)(bin);
            mean + sd.unwrap_or(0.0)
        });
        single.chain(means).chain(model.iter().filter_map(|point| point.chi)).fold(0.1, f64::max)
    };
    let most = readings.iter().map(highest).fold(0.0, f64::max);
    let farthest = divisions.iter().map(|division| division.dose).chain(model.iter().map(|point| point.dose));
    let farthest = 1.04 * farthest.fold(1.0, f64::max);
    let width = 0.5 * WIDTH;
    for (k, reading) in readings.iter().enumerate() {
        let x = Axis::new("dose (wild type 1)", [-0.03 * farthest, farthest]);
        let y = Axis::new(format!("{}, sizes as {}", style::CHI, reading.name), [-0.1 * most, 1.06 * most]);
        let mut chart = Chart::new(&mut canvas, [k as f64 * width, top], [width, CHART], x, y);
        panel(&mut chart, comparison, reading, farthest);
    }
    canvas
}

fn panel(chart: &mut Chart<'_>, comparison: &DoseComparison<'_>, reading: &Reading<'_>, farthest: f64) {
    let DoseComparison { divisions, conditions, bins, model, .. } = comparison;
    for division in *divisions {
        let k = conditions.iter().position(|condition| condition.name == division.condition).unwrap_or(0);
        let at = chart.at([division.dose, (reading.chi)(division)]);
        chart.canvas.disc(at, 3.4, colour(k, conditions.len()), 0.6, None);
    }
    if let Some(Line { slope, intercept, .. }) = reading.line {
        let ends = [0.0, farthest].map(|dose| [dose, intercept + slope * dose]);
        chart.line(ends, Stroke::dashed(style::MUTED, 1.6, style::DASHED));
    }
    // The curve has a gap where a cell does not divide.
    for piece in model.split(|point| point.chi.is_none()) {
        let points: Vec<[f64; 2]> = piece.iter().filter_map(|point| Some([point.dose, point.chi?])).collect();
        chart.line(points, Stroke::solid(style::MODEL, 2.4));
    }
    for bin in *bins {
        let (mean, sd) = (reading.mean_sd)(bin);
        if let Some(sd) = sd {
            chart.error_bar(bin.dose.mean, [mean - sd, mean + sd], 0.0, 4.0, Stroke::solid(style::INK, 1.6));
        }
        chart.point([bin.dose.mean, mean], 5.0, Marker::Square, style::INK);
    }
    numbers(chart, bins);
}

/// The numbers of divisions below the data, each in the first row where it overlaps no other.
fn numbers(chart: &mut Chart<'_>, bins: &[DoseGroup]) {
    let mut bins: Vec<&DoseGroup> = bins.iter().collect();
    bins.sort_by_cached_key(|bin| OrderedFloat(bin.dose.mean));
    let mut rows = Rows::default();
    for bin in bins {
        let (word, x) = (bin.n.to_string(), chart.at([bin.dose.mean, 0.0])[0]);
        let half = 0.5 * font::width(&word, text::TICK);
        let y = chart.frame[3] - 6.0 - 16.0 * rows.free([x - half, x + half]) as f64;
        chart.canvas.label(Label::new([x, y], &word, text::TICK, Anchor::Middle, style::MUTED).over(style::WHITE));
    }
}
