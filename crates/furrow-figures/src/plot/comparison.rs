//! Size asymmetries of measured divisions beside the model's: by mother, and over the mother's volume.

use furrow_measured::events::Division;
use furrow_measured::statistics::{BoxPlot, distinct};
use furrow_measured::trend::{VolumeBin, adjacent_tests};

use crate::drawing::legend::{Key, Legend, Marker, point, titled};
use crate::drawing::panel::{Axis, Chart, widened};
use crate::drawing::style::{self, Colour, WHITE, text};
use crate::drawing::{Anchor, Canvas, Stroke, font};
use furrow_analysis::compare::noise::{Interval, NoiseBin};
use furrow_analysis::compare::volumes::{Band, GroupComparison, ModelDivision, MotherComparison, SizeCurve};

/// Heights of the chart by mother and the chart over volume.
const CHARTS: [f64; 2] = [440.0, 400.0];
/// Largest width of a picture.
const WIDEST: f64 = 1400.0;

/// Fewest embryos for a box; with fewer, a mean and its standard deviation are drawn.
const FEWEST: usize = 4;

/// The data of the picture.
#[derive(Clone, Debug)]
pub struct Comparison<'a> {
    /// Groups of measured divisions beside the model.
    pub groups: &'a [GroupComparison],
    /// Single divisions; empty if only means are known.
    pub divisions: &'a [Division],
    /// |χ| by the mother's volume, of all groups.
    pub bins: &'a [VolumeBin],
    /// χ of equal divisions due to measurement noise, by bin; may be empty.
    pub noise: &'a [NoiseBin],
    /// The unit in the label of the volume axis.
    pub unit: String,
    /// L_h in the cube root of the unit, which gives the model's cells a volume.
    pub length: Option<f64>,
    /// χ of the model over size.
    pub curves: Vec<SizeCurve>,
}

/// Draws groups beside the model and, if single divisions are known, χ over the mother's volume below.
pub fn draw(comparison: &Comparison<'_>) -> Canvas {
    let Comparison { groups, divisions, .. } = *comparison;
    // In order of first appearance.
    let events = || groups.iter().flat_map(|group| &group.events);
    let mothers: Vec<String> = distinct(events().map(|event| event.measured.mother.clone()));
    let longest = mothers.iter().map(|mother| font::width(mother, style::text::TICK)).fold(0.0, f64::max);
    let each = (30.0 + 24.0 * groups.len() as f64).max(longest + 14.0);
    // The number of mothers in a row is limited to keep the text readable.
    let in_row = (((WIDEST - 150.0) / each) as usize).clamp(1, mothers.len().max(1));
    let width = (150.0 + in_row as f64 * each).max(760.0);
    let rows = mothers.len().div_ceil(in_row);
    let height = if rows > 1 { CHARTS[0] * 0.75 } else { CHARTS[0] };
    let charts = height * rows as f64 + if divisions.is_empty() { 0.0 } else { CHARTS[1] };
    let title = "Size asymmetry of divisions, by mother";
    let (mut canvas, top) = titled(width, charts, title, &legend(comparison));
    let most = events().map(highest).fold(0.3, f64::max);
    for (k, row) in mothers.chunks(in_row).enumerate() {
        let label = if k + 1 == rows { "mother" } else { "" };
        let mut x = Axis::names(label, row.to_vec(), false);
        // The last row is as wide as the others.
        x.range = [-0.6, in_row as f64 - 0.4];
        let y = Axis::new(style::CHI, [-0.02, 1.06 * most]);
        let at = [0.0, top + k as f64 * height];
        let mut chart = Chart::new(&mut canvas, at, [width, height], x, y);
        let apart = 0.8 / (groups.len() as f64).max(2.0);
        for (k, group) in groups.iter().enumerate() {
            let aside = (k as f64 - 0.5 * groups.len() as f64 + 0.2) * apart;
            for event in &group.events {
                if let Some(place) = row.iter().position(|mother| *mother == event.measured.mother) {
                    beside(&mut chart, [place as f64 + aside, apart], event, colour(k));
                }
            }
        }
    }
    if !divisions.is_empty() {
        over_volume(&mut canvas, [top + height * rows as f64, width], comparison);
    }
    canvas
}

fn legend(comparison: &Comparison<'_>) -> Legend {
    let measured = |(k, group): (usize, &GroupComparison)| {
        let name = if group.group.is_empty() { "measured" } else { &group.group };
        let boxes = group.events.iter().any(|event| boxed(event).is_some());
        let how = if boxes { "boxes, whiskers within 3 IQR" } else { "mean ± sd" };
        (Key::Point(colour(k), Marker::Disc), format!("{name}, {how}, {} embryos", group.embryos))
    };
    let any = |is: fn(&MotherComparison) -> bool| comparison.groups.iter().flat_map(|group| &group.events).any(is);
    let model = any(|event| event.model.as_ref().is_some_and(|model| model.chi.is_some()));
    let given_first = any(|event| event.given_first.as_ref().is_some_and(|model| model.chi.is_some()));
    let noise = Key::Point(NOISE, Marker::Square);
    let over_size = |(k, curve): (usize, &SizeCurve)| {
        let what = if curve.cue.is_empty() { "no cue".to_owned() } else { format!("cue {}", curve.cue) };
        let key = dash(k).map_or(Key::Line(style::MODEL), |dash| Key::Dashes(style::MODEL, dash));
        (key, format!("model over size, {what}"))
    };
    Legend::default()
        .with_all(comparison.groups.iter().enumerate().map(measured))
        .with_if(model, Key::Point(style::MODEL, Marker::Diamond), "model")
        .with_if(given_first, Key::Point(style::MODEL, Marker::Ring), "model, AB and P1 as measured")
        .with_if(any(|event| event.band.is_some()), Key::Area(BAND), "model, 90 % of the sets of constants")
        .with_if(!comparison.noise.is_empty(), noise, "equal divisions with noise, 95 % of draws")
        .with_all(comparison.curves.iter().enumerate().map(over_size))
}

/// The model's green, paler for a range.
const BAND: Colour = [0x99, 0xd8, 0xc7];

/// The colour of measurement noise, shared with the sixth group.
const NOISE: Colour = style::SERIES[6];

/// The dashes of a curve over size.
fn dash(curve: usize) -> Option<[f64; 2]> {
    [None, Some(style::DASHED), Some(style::DOTTED)][curve.min(2)]
}

/// The box of a mother's embryos, if there are enough of them.
fn boxed(event: &MotherComparison) -> Option<&BoxPlot> {
    event.box_plot.as_ref().filter(|_| event.measured.n >= FEWEST)
}

/// The largest χ drawn for a division.
fn highest(event: &MotherComparison) -> f64 {
    let measured = match boxed(event) {
        Some(found) => found.outliers.iter().copied().fold(found.whiskers[1], f64::max),
        None => event.measured.mean + event.measured.sd.unwrap_or(0.0),
    };
    let of = |modelled: &Option<ModelDivision>| modelled.and_then(|modelled| modelled.chi).unwrap_or(0.0);
    let band = event.band.and_then(|band| band.chi).map_or(0.0, |chi| chi.p95);
    measured.max(of(&event.model)).max(of(&event.given_first)).max(band)
}

/// The colour of a group; green is reserved for the model.
fn colour(group: usize) -> Colour {
    [0, 1, 5, 4, 2, 6].map(|k: usize| style::SERIES[k])[group % 6]
}

/// A measured division at `x`, and the model's to the right of it in steps of `apart`, the distance between two groups.
fn beside(chart: &mut Chart<'_>, [x, apart]: [f64; 2], event: &MotherComparison, colour: Colour) {
    let MotherComparison { measured, model, given_first, band, .. } = event;
    if let Some(Band { chi: Some(range), .. }) = band {
        chart.area([x + 0.2 * apart, range.p5], [x + 0.4 * apart, range.p95], 2.0, BAND, 1.0);
    }
    match boxed(event) {
        Some(found) => draw_box(chart, x, found, colour),
        None => {
            if let Some(sd) = measured.sd {
                let ends = [measured.mean - sd, measured.mean + sd].map(|y| y.max(-0.02));
                chart.error_bar(x, ends, 0.0, 4.0, Stroke::solid(colour, 1.8));
            }
            chart.point([x, measured.mean], 5.5, Marker::Disc, colour);
        }
    }
    for (of, marker, aside) in [(model, Marker::Diamond, 0.3), (given_first, Marker::Ring, 0.6)] {
        if let Some(ModelDivision { chi: Some(chi), .. }) = of {
            chart.point([x + aside * apart, *chi], 5.5, marker, style::MODEL);
        }
    }
}

/// A box with its whiskers, and outliers as points.
fn draw_box(chart: &mut Chart<'_>, x: f64, found: &BoxPlot, colour: Colour) {
    const HALF: f64 = 6.0;
    chart.error_bar(x, found.whiskers, 0.0, 3.5, Stroke::solid(colour, 1.4));
    let [low, median, high] = found.quartiles.map(|y| chart.at([x, y]));
    let [left, right] = [low[0] - HALF, low[0] + HALF];
    let around = [[left, high[1]], [right, high[1]], [right, low[1]], [left, low[1]]];
    chart.canvas.polygon(&around, WHITE, 1.0, None);
    chart.canvas.polygon(&around, colour, 0.3, Some(Stroke::solid(colour, 1.4)));
    chart.canvas.polyline(&[[left, median[1]], [right, median[1]]], Stroke::solid(colour, 2.6));
    for outlier in &found.outliers {
        chart.canvas.disc(chart.at([x, *outlier]), 2.2, colour, 1.0, None);
    }
}

/// χ over the mother's volume: every division, boxes of the bins with the stars of their tests, the model's cells, and
/// the model over size.
fn over_volume(canvas: &mut Canvas, [top, width]: [f64; 2], comparison: &Comparison<'_>) {
    let Comparison { groups, divisions, bins, noise, ref unit, length, ref curves } = *comparison;
    let volume = |r0: f64, length: f64| 4.0 / 3.0 * std::f64::consts::PI * (length * r0).powi(3);
    let modelled: Vec<[f64; 2]> = groups
        .iter()
        .flat_map(|group| &group.events)
        .filter_map(|event| Some([volume(event.model.as_ref()?.r0, length?), event.model.as_ref()?.chi?]))
        .collect();
    let mut pieces: Vec<(usize, Vec<[f64; 2]>)> = Vec::new();
    for (k, curve) in curves.iter().enumerate() {
        // The curve has a gap where a cell does not divide.
        for piece in curve.points.split(|(_, chi)| chi.is_none()) {
            pieces.push((k, piece.iter().filter_map(|(r0, chi)| Some([volume(*r0, length?), (*chi)?])).collect()));
        }
    }
    let measured = divisions.iter().map(|division| [division.mother_volume(), division.chi()]);
    let of_model = modelled.iter().chain(pieces.iter().flat_map(|(_, points)| points)).copied();
    let all: Vec<[f64; 2]> = measured.chain(of_model).collect();
    let [least, most] = widened(all.iter().map(|[volume, _]| volume.log10()), 0.06).map(|power| 10_f64.powf(power));
    let highest = all.iter().map(|[_, chi]| *chi).fold(0.3, f64::max);
    let x = Axis::new(format!("volume of the mother {unit}"), [least, most]).logarithmic();
    let y = Axis::new(style::CHI, [-0.02, 1.2 * highest]);
    let mut chart = Chart::new(canvas, [0.0, top], [width, CHARTS[1]], x, y);
    for (k, points) in &pieces {
        chart.line(points.iter().copied(), Stroke { dash: dash(*k), ..Stroke::solid(style::MODEL, 2.0) });
    }
    for division in divisions {
        let group = groups.iter().position(|group| group.group == division.group).unwrap_or(0);
        let at = chart.at([division.mother_volume(), division.chi()]);
        chart.canvas.disc(at, 3.2, colour(group), 0.45, None);
    }
    let middle = |bin: &VolumeBin| (bin.from.clamp(least, most) * bin.to.clamp(least, most)).sqrt();
    for bin in bins.iter().filter(|bin| bin.n >= FEWEST) {
        if let Some(found) = &bin.box_plot {
            draw_box(&mut chart, middle(bin), found, style::INK);
        }
    }
    for (bin, null) in bins.iter().zip(noise) {
        if let Some(Interval { mean, low, high }) = null.null {
            // To the right of the box.
            chart.error_bar(middle(bin), [low, high], 18.0, 4.0, Stroke::solid(NOISE, 1.8));
            let [x, y] = chart.at([middle(bin), mean]);
            point(chart.canvas, [x + 18.0, y], 4.5, Marker::Square, NOISE);
        }
    }
    for (pair, test) in bins.windows(2).zip(adjacent_tests(bins)) {
        let [a, b] = [&pair[0], &pair[1]].map(|bin| chart.at([middle(bin), 1.12 * highest]));
        chart.canvas.polyline(&[a, b], Stroke::solid(style::MUTED, 1.2));
        let at = [0.5 * (a[0] + b[0]), a[1] - 5.0];
        chart.canvas.text(at, test.stars, text::TICK, Anchor::Middle, style::MUTED);
    }
    chart.points(modelled, 6.0, Marker::Diamond, style::MODEL);
}
