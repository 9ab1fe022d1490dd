//! Size asymmetries of measured divisions beside the model's: by mother, and over the mother's volume.

use measured::events::Division;
use measured::statistics::BoxPlot;
use measured::trend::{VolumeBin, adjacent_tests};

use crate::drawing::legend::{self, Key, Marker};
use crate::drawing::panel::{Axis, Mapping, Panel, widened};
use crate::drawing::style::{self, text};
use crate::drawing::{Anchor, Canvas, Drawing, Stroke};
use crate::study::compare::volumes::{Band, Beside, GroupBeside, Modelled, SizeCurve};

/// Height of the chart by mother, and of that over volume.
const CHARTS: [f64; 2] = [440.0, 400.0];
/// Width that a picture has at most.
const WIDEST: f64 = 1400.0;

/// Boxes are drawn of as many embryos; of fewer a mean with its standard deviation.
const FEWEST: usize = 4;

/// What is drawn.
#[derive(Clone, Debug)]
pub struct Comparison<'a> {
    /// Groups beside the model.
    pub groups: &'a [GroupBeside],
    /// Single divisions; none where means alone are known.
    pub divisions: &'a [Division],
    /// |χ| by the mother's volume, of all groups.
    pub bins: &'a [VolumeBin],
    /// What stands behind "volume of the mother".
    pub unit: String,
    /// One L_h in the cube root of the unit, by which the model's cells have a volume too.
    pub length: Option<f64>,
    /// χ of the model over size.
    pub curves: Vec<SizeCurve>,
}

/// Draws groups beside the model, and below them, where single divisions are known, χ over the mother's volume.
pub fn draw(comparison: &Comparison<'_>) -> Drawing {
    let Comparison { groups, divisions, .. } = *comparison;
    let mothers = mothers(groups);
    let each = 30.0 + 24.0 * groups.len() as f64;
    // As many mothers in a row as leave the text large enough to be read.
    let in_row = (((WIDEST - 150.0) / each) as usize).clamp(1, mothers.len().max(1));
    let width = (150.0 + in_row as f64 * each).max(760.0);
    let rows: Vec<&[String]> = mothers.chunks(in_row).collect();
    let height = if rows.len() > 1 { CHARTS[0] * 0.75 } else { CHARTS[0] };
    let entries = entries(comparison);
    let second = if divisions.is_empty() { 0.0 } else { CHARTS[1] };
    let charts = height * rows.len() as f64 + second;
    let mut canvas = Canvas::new(width, 52.0 + charts + legend::height(width - 40.0, &entries));
    canvas.text([24.0, 30.0], "Size asymmetry of divisions, by mother", text::TITLE, Anchor::Start, style::INK);
    let top = 48.0 + legend::rows(&mut canvas, [24.0, 42.0], width - 40.0, &entries);
    let most = groups.iter().flat_map(|group| &group.events).map(highest).fold(0.3, f64::max);
    for (k, row) in rows.iter().enumerate() {
        let name = if k + 1 == rows.len() { "mother" } else { "" };
        let x = Axis::new(name, [-0.6, in_row as f64 - 0.4]).every(1.0).unnumbered();
        let y = Axis::new(style::CHI, [-0.02, 1.06 * most]);
        let panel = Panel::new([0.0, top + k as f64 * height], [width, height], x, y);
        by_mother(&mut canvas, &panel, groups, row);
    }
    let below = top + height * rows.len() as f64;
    if !divisions.is_empty() {
        over_volume(&mut canvas, [below, width], comparison);
    }
    canvas.finish()
}

/// What the legend says.
fn entries(comparison: &Comparison<'_>) -> Vec<(Key, String)> {
    let groups = comparison.groups;
    let name = |group: &GroupBeside| if group.group.is_empty() { "measured".to_owned() } else { group.group.clone() };
    let has_boxes = |group: &GroupBeside| group.events.iter().any(|event| boxed(event).is_some());
    let of = |(k, group): (usize, &GroupBeside)| {
        let how = if has_boxes(group) { "boxes, whiskers within 3 IQR" } else { "mean ± sd" };
        let what = format!("{}, {how}, {} embryos", name(group), group.embryos);
        (Key::point(&colour(k), Marker::Disc), what)
    };
    let mut out: Vec<(Key, String)> = groups.iter().enumerate().map(of).collect();
    out.push((Key::point(style::MODEL, Marker::Diamond), "model".to_owned()));
    out.push((Key::point(style::MODEL, Marker::Ring), "model, AB and P1 as measured".to_owned()));
    if groups.iter().flat_map(|group| &group.events).any(|event| event.band.is_some()) {
        out.push((Key::area(BAND), "model, 90 % of the sets of constants".to_owned()));
    }
    for (k, curve) in comparison.curves.iter().enumerate() {
        let what = if curve.cue.is_empty() { "no cue".to_owned() } else { format!("cue {}", curve.cue) };
        out.push((Key::line(style::MODEL, dash(k)), format!("model over size, {what}")));
    }
    out
}

/// Green as the model, and pale as what is not sure.
const BAND: &str = "#99d8c7";

/// The dashes of a curve over size.
fn dash(curve: usize) -> Option<[f64; 2]> {
    [None, Some(style::DASHED), Some(style::DOTTED)][curve.min(2)]
}

/// The box of a mother's embryos, if these are enough.
fn boxed(event: &Beside) -> Option<&BoxPlot> {
    event.box_plot.as_ref().filter(|_| event.measured.n >= FEWEST)
}

/// The largest χ that is drawn of a division.
fn highest(event: &Beside) -> f64 {
    let measured = match boxed(event) {
        Some(found) => found.outliers.iter().copied().fold(found.whiskers[1], f64::max),
        None => event.measured.mean + event.measured.sd.unwrap_or(0.0),
    };
    let of = |modelled: &Option<Modelled>| modelled.and_then(|modelled| modelled.chi).unwrap_or(0.0);
    let band = event.band.and_then(|band| band.chi).map_or(0.0, |chi| chi.p95);
    measured.max(of(&event.model)).max(of(&event.given_first)).max(band)
}

/// One row of mothers.
fn by_mother(canvas: &mut Canvas, panel: &Panel, groups: &[GroupBeside], mothers: &[String]) {
    let map = panel.draw(canvas, &[], |_, _| {});
    for (k, group) in groups.iter().enumerate() {
        let apart = 0.8 / (groups.len() as f64).max(2.0);
        let aside = (k as f64 - 0.5 * groups.len() as f64 + 0.2) * apart;
        for event in &group.events {
            if let Some(place) = mothers.iter().position(|mother| *mother == event.measured.mother) {
                beside(canvas, &map, [place as f64 + aside, apart], event, &colour(k));
            }
        }
    }
    for (k, mother) in mothers.iter().enumerate() {
        let at = [map.point([k as f64, 0.0])[0], map.frame()[3] + 24.0];
        canvas.text(at, mother, text::TICK, Anchor::Middle, style::INK);
    }
}

/// Mothers of all groups, in the order in which they are first told.
fn mothers(groups: &[GroupBeside]) -> Vec<String> {
    let mut out: Vec<String> = Vec::new();
    for event in groups.iter().flat_map(|group| &group.events) {
        if !out.contains(&event.measured.mother) {
            out.push(event.measured.mother.clone());
        }
    }
    out
}

/// The colour of a group: green is the model's.
fn colour(group: usize) -> String {
    let hues = ["#000000", "#e69f00", "#0072b2", "#cc79a7", "#56b4e9", "#d55e00"];
    hues[group % hues.len()].to_owned()
}

/// A division beside the model's, at `x` and to the right of it by parts of `apart`, the distance of two groups.
fn beside(canvas: &mut Canvas, map: &Mapping, [x, apart]: [f64; 2], event: &Beside, colour: &str) {
    let Beside { measured, model, given_first, band, .. } = event;
    if let Some(Band { chi: Some(range), .. }) = band {
        let [left, low] = map.point([x + 0.2 * apart, range.p5]);
        let [right, high] = map.point([x + 0.4 * apart, range.p95]);
        canvas.rectangle([left, high], [right - left, (low - high).max(2.0)], BAND, 1.0);
    }
    match boxed(event) {
        Some(found) => draw_box(canvas, map, x, found, colour),
        None => {
            if let Some(sd) = measured.sd {
                let ends = [measured.mean - sd, measured.mean + sd].map(|y| map.point([x, y.max(-0.02)]));
                legend::error_bar(canvas, ends, 4.0, Stroke::solid(colour, 1.8));
            }
            legend::point(canvas, map.point([x, measured.mean]), 5.5, Marker::Disc, colour);
        }
    }
    for (of, marker, aside) in [(model, Marker::Diamond, 0.3), (given_first, Marker::Ring, 0.6)] {
        if let Some(Modelled { chi: Some(chi), .. }) = of {
            legend::point(canvas, map.point([x + aside * apart, *chi]), 5.5, marker, style::MODEL);
        }
    }
}

/// A box with its whiskers, and what lies beyond them as points.
fn draw_box(canvas: &mut Canvas, map: &Mapping, x: f64, found: &BoxPlot, colour: &str) {
    const HALF: f64 = 6.0;
    let at = |y: f64| map.point([x, y]);
    let [low, median, high] = found.quartiles.map(at);
    legend::error_bar(canvas, found.whiskers.map(at), 3.5, Stroke::solid(colour, 1.4));
    let corner = [low[0] - HALF, high[1]];
    let size = [2.0 * HALF, (low[1] - high[1]).max(1.0)];
    canvas.rectangle(corner, size, "#ffffff", 1.0);
    canvas.rectangle(corner, size, colour, 0.3);
    let [left, right] = [low[0] - HALF, low[0] + HALF];
    let around = [[left, high[1]], [right, high[1]], [right, low[1]], [left, low[1]], [left, high[1]]];
    canvas.polyline(&around, Stroke::solid(colour, 1.4));
    canvas.polyline(&[[left, median[1]], [right, median[1]]], Stroke::solid(colour, 2.6));
    for outlier in &found.outliers {
        canvas.disc(at(*outlier), 2.2, colour, 1.0, None);
    }
}

/// χ over the mother's volume: every division, boxes of the bins with the stars of their tests, the model's cells, and the model
/// over size.
fn over_volume(canvas: &mut Canvas, [top, width]: [f64; 2], comparison: &Comparison<'_>) {
    let Comparison { groups, divisions, bins, ref unit, length, ref curves } = *comparison;
    let volume = |r0: f64, length: f64| 4.0 / 3.0 * std::f64::consts::PI * (length * r0).powi(3);
    let modelled: Vec<[f64; 2]> = groups
        .iter()
        .flat_map(|group| &group.events)
        .filter_map(|event| Some([volume(event.model.as_ref()?.r0, length?), event.model.as_ref()?.chi?]))
        .collect();
    let pieces: Vec<(usize, Vec<[f64; 2]>)> = curves
        .iter()
        .enumerate()
        .flat_map(|(k, curve)| {
            // Where a cell does not divide the curve has a gap.
            let pieces = curve.points.split(|(_, chi)| chi.is_none());
            pieces.map(move |piece| {
                (k, piece.iter().filter_map(|(r0, chi)| Some([volume(*r0, length?), (*chi)?])).collect())
            })
        })
        .collect();
    let of_curves = || pieces.iter().flat_map(|(_, points)| points);
    let volumes = divisions.iter().map(Division::mother_volume).chain(modelled.iter().chain(of_curves()).map(|p| p[0]));
    let [least, most] = widened(volumes.map(f64::log10), 0.06);
    let chi = divisions.iter().map(Division::chi).chain(modelled.iter().chain(of_curves()).map(|p| p[1]));
    let highest = chi.fold(0.3, f64::max);
    let x = Axis::new(format!("volume of the mother {unit}"), [10_f64.powf(least), 10_f64.powf(most)]).logarithmic();
    let panel = Panel::new([0.0, top], [width, CHARTS[1]], x, Axis::new(style::CHI, [-0.02, 1.2 * highest]));
    let map = panel.draw(canvas, &[], |_, _| {});
    for (k, points) in &pieces {
        let points: Vec<[f64; 2]> = points.iter().map(|point| map.point(*point)).collect();
        let stroke = Stroke { dash: dash(*k), ..Stroke::solid(style::MODEL, 2.0) };
        canvas.polyline(&points, stroke);
    }
    for division in divisions {
        let group = groups.iter().position(|group| group.group == division.group).unwrap_or(0);
        canvas.disc(map.point([division.mother_volume(), division.chi()]), 3.2, &colour(group), 0.45, None);
    }
    let middle = |bin: &VolumeBin| {
        let inside = |edge: f64| edge.clamp(10_f64.powf(least), 10_f64.powf(most));
        (inside(bin.from) * inside(bin.to)).sqrt()
    };
    for bin in bins.iter().filter(|bin| bin.n >= FEWEST) {
        if let Some(found) = &bin.box_plot {
            draw_box(canvas, &map, middle(bin), found, style::INK);
        }
    }
    for (pair, test) in bins.windows(2).zip(adjacent_tests(bins)) {
        let [a, b] = [&pair[0], &pair[1]].map(|bin| map.point([middle(bin), 1.12 * highest]));
        canvas.polyline(&[a, b], Stroke::solid(style::MUTED, 1.2));
        let at = [0.5 * (a[0] + b[0]), a[1] - 5.0];
        canvas.text(at, test.stars, text::TICK, Anchor::Middle, style::MUTED);
    }
    for point in modelled {
        legend::point(canvas, map.point(point), 6.0, Marker::Diamond, style::MODEL);
    }
}
