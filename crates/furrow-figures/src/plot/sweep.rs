//! The results of a sweep: χ, or another quantity, over its first dense axis, with a curve for each value of a second axis and a
//! panel for each value of the others; a map of outcomes if two axes are dense.

use ordered_float::OrderedFloat;
use serde_json::Value;

use crate::drawing::legend::{Key, Legend, Marker, titled};
use crate::drawing::panel::{Axis, Chart, MARGINS, bins, widened};
use crate::drawing::style::{self, Colour};
use crate::drawing::{Anchor, Canvas, Label, Stroke, font, scale};
use furrow_analysis::{self as study, AxisValue, Kind, Row, Sweep, Target};
use furrow_cell::{Cell, Cue, Parameter};
use furrow_measured::statistics;
use furrow_mechanics::division::Outcome;

const WIDTH: f64 = 1000.0;
const CHART: f64 = 548.0;
/// Height of one of several panels, and the largest number of panels in a picture.
const PANEL: f64 = 360.0;
const PANELS: usize = 12;
/// Distance between lines of a panel's name.
const NAME: f64 = 19.0;
/// Fewest values of a dense axis; a second axis with as many values is not drawn as curves.
const DENSE: usize = 8;
/// Most curves with an entry in the legend.
const NAMED: usize = 12;

/// Outcomes in the order of a sweep's columns of counts.
const OUTCOMES: [Outcome; 3] = [Outcome::Symmetric, Outcome::Asymmetric, Outcome::Arrested];

/// A row prepared for drawing.
struct Point {
    /// Index of each axis's value in its list.
    places: Vec<usize>,
    value: Option<f64>,
    sd: Option<f64>,
    /// The outcome of most of its divisions.
    outcome: Option<Outcome>,
    undecided: bool,
}

/// Draws the rows of a sweep or of a shard.
pub fn draw(sweep: &Sweep, rows: &[Row]) -> Canvas {
    let mut points: Vec<Point> = rows.iter().map(|row| point(sweep, row)).collect();
    // The converged scheme has no fixed step, so that its results do not depend on dt: one of them is drawn.
    let first_step = |point: &Point| value_of(sweep, "dt", &point.places).is_none_or(|(place, _)| place == 0);
    points.retain(|point| !is_converged(sweep, &point.places) || first_step(point));
    let numeric: Vec<(usize, Vec<f64>)> =
        (0..sweep.axes.0.len()).filter_map(|k| Some((k, numbers(sweep, k)?))).collect();
    let dense = |k: usize| sweep.axes.0[k].values.len() >= DENSE && !sweep.axes.0[k].sampled;
    match &numeric[..] {
        [x, y] if sweep.kind == Kind::Division && sweep.axes.0.len() == 2 && dense(x.0) && dense(y.0) => {
            map_of_outcomes(sweep, &points, [x, y])
        }
        // Curves run along the first dense axis or, without one, along the first numeric axis.
        _ => curves(sweep, &points, numeric.iter().find(|(k, _)| dense(*k)).or(numeric.first())),
    }
}

fn title(sweep: &Sweep, points: &[Point]) -> String {
    let axes = &sweep.axes.0;
    let varied = |parameter: &Parameter| {
        let size = *parameter == Parameter::R0 && !matches!(sweep.kind, Kind::Division | Kind::Pitchfork);
        let activity = *parameter == Parameter::XiS && sweep.kind == Kind::Pitchfork;
        size || activity || axes.iter().any(|axis| axis.target == Target::Field(parameter.name()))
    };
    let known = [Parameter::R0, Parameter::Epsilon, Parameter::XiS].into_iter();
    let cell = Cell { cue: Cue::none(), ..sweep.settings.cell.clone() };
    let mut parts = vec![style::described(&cell, &known.filter(varied).collect::<Vec<_>>())];
    if axes.iter().all(|axis| axis.target != Target::Cue) {
        parts.extend(sweep.cue.as_ref().map(|cue| format!("cue {}", unvaried(cue, sweep))));
    }
    let places = points.first().map_or(&[][..], |point| &point.places);
    parts.push(named(sweep, &held(sweep, points), places));
    parts.retain(|part| !part.is_empty());
    let what = match sweep.kind {
        Kind::Division => "Divisions",
        Kind::Tree => "Lineages",
        Kind::Pitchfork => "Thresholds",
        Kind::Critical => "Critical radii",
    };
    if parts.is_empty() { what.to_owned() } else { format!("{what}: {}", parts.join(", ")) }
}

/// A cue without the numbers varied by an axis, which are shown in the legend or along the axis.
fn unvaried(cue: &Cue, sweep: &Sweep) -> String {
    let number = |axis: &study::Axis| match axis.target {
        Target::CueNumber(parameter) => Some(parameter),
        _ => None,
    };
    style::cue_without(cue, &sweep.axes.0.iter().filter_map(number).collect::<Vec<_>>())
}

/// The values of an axis, if they are numbers.
fn numbers(sweep: &Sweep, axis: usize) -> Option<Vec<f64>> {
    let number = |value: &AxisValue| match value {
        AxisValue::Number(number) => Some(*number),
        AxisValue::Text(_) => None,
    };
    sweep.axes.0.get(axis)?.values.iter().map(number).collect()
}

fn point(sweep: &Sweep, row: &Row) -> Point {
    let results = row.cells.get(sweep.axes.0.len()..).unwrap_or_default();
    let number = |k: usize| results.get(k).and_then(Value::as_f64);
    let (value, sd, outcome) = match sweep.kind {
        Kind::Division if sweep.replicates == 1 => {
            let name = results.first().and_then(Value::as_str);
            (number(1), None, OUTCOMES.into_iter().find(|outcome| Some(outcome.name()) == name))
        }
        Kind::Division => {
            let count = |k: usize| results.get(k).and_then(Value::as_u64).unwrap_or(0);
            let most = (0..3).max_by_key(|k| count(*k)).filter(|k| count(*k) > 0);
            (number(3), number(4), most.map(|k| OUTCOMES[k]))
        }
        Kind::Tree | Kind::Pitchfork | Kind::Critical => (number(0), None, None),
    };
    Point { places: sweep.axes.places(row.index), value, sd, outcome, undecided: row.why.is_some() }
}

/// The label of the values.
fn quantity(kind: Kind) -> &'static str {
    match kind {
        Kind::Division => style::CHI,
        Kind::Tree => "cells of the lineage",
        Kind::Pitchfork => "threshold ξₛ* (κ₀/Lₕ)",
        Kind::Critical => "critical radius (Lₕ)",
    }
}

/// The label of an axis, from the name of its parameter.
fn label(sweep: &Sweep, axis: usize) -> String {
    let Some(axis) = sweep.axes.0.get(axis) else { return "run".to_owned() };
    let none = Cue::none();
    let cue = sweep.cue.as_ref().unwrap_or(&none);
    match axis.target {
        Target::Field("dt") => "time step Δt (τ)".to_owned(),
        Target::Field(name) => name.parse().map_or(axis.name.clone(), |p| style::parameter(p, cue)),
        Target::CueNumber(parameter) => style::parameter(parameter, cue),
        Target::Cue | Target::Seed => axis.name.clone(),
    }
}

fn curves(sweep: &Sweep, points: &[Point], x: Option<&(usize, Vec<f64>)>) -> Canvas {
    let along = x.map_or(0, |(axis, _)| *axis);
    let by = Layout::of(sweep, points, along);
    let (curves, panels) = (grouped(sweep, points, &by.curves), grouped(sweep, points, &by.panels));
    let shown = panels.len().min(PANELS);
    let axis = sweep.axes.0.get(along);
    let words: Vec<String> =
        axis.map_or(vec![String::new()], |axis| axis.values.iter().map(|v| v.text().into()).collect());
    let values = x.map_or_else(|| (0..words.len()).map(|k| k as f64).collect(), |(_, values)| values.clone());
    let across = match x {
        Some(_) => Axis::over(label(sweep, along), values.iter().copied()),
        None => Axis::names(label(sweep, along), words, false),
    };
    let up = upwards(sweep, points, curves.len());
    let mut heading = title(sweep, points);
    if shown < panels.len() {
        heading += &format!("\nThe first {shown} of {} panels; all points are in results.csv", panels.len());
    }
    let columns = if shown > 1 { shown.div_ceil(shown.div_ceil(3)) } else { 1 };
    let size = [WIDTH / columns as f64, if shown > 1 { PANEL } else { CHART }];
    let names = |panel: &Group<'_>| font::wrapped(&panel.name, style::text::TICK, size[0] - MARGINS[0] - MARGINS[1]);
    let lines = panels.iter().take(shown).map(|panel| names(panel).len()).max().unwrap_or(1);
    let room = if shown > 1 { 24.0 + NAME * (lines - 1) as f64 } else { 0.0 };
    let size = [size[0], size[1] + room.max(24.0) - 24.0];
    let below = size[1] * shown.div_ceil(columns) as f64;
    let (mut canvas, top) = titled(WIDTH, below, &heading, &legend(sweep, points, &curves));
    for (k, panel) in panels.iter().take(shown).enumerate() {
        let at = [(k % columns) as f64 * size[0], top + (k / columns) as f64 * size[1]];
        for (line, words) in names(panel).iter().enumerate() {
            let place = [at[0] + MARGINS[0], at[1] + 18.0 + NAME * line as f64];
            canvas.label(Label::new(place, words, style::text::TICK, Anchor::Start, style::INK).bold());
        }
        let size = [size[0], size[1] - room];
        let mut chart = Chart::new(&mut canvas, [at[0], at[1] + room], size, across.clone(), up.clone());
        let place = |point: &Point| values.get(point.places.get(along).copied().unwrap_or(0)).copied().unwrap_or(0.0);
        for (k, curve) in curves.iter().enumerate() {
            let is_here = |point: &&&Point| {
                by.panels.iter().all(|axis| point.places.get(*axis) == panel.points[0].places.get(*axis))
            };
            let here: Vec<&Point> = curve.points.iter().filter(is_here).copied().collect();
            // Points without a value lie below the axis of χ, on a separate line for each curve.
            let baseline = up.range[0] * (k as f64 + 1.0) / (curves.len() as f64 + 1.0);
            let style = (curve.colour, curves.len() < 2, baseline);
            draw_curve(&mut chart, &here, &place, axis.is_some_and(|axis| axis.sampled), style);
        }
    }
    canvas
}

/// The axis of the computed quantity. Points without χ lie in a strip below 0.
fn upwards(sweep: &Sweep, points: &[Point], curves: usize) -> Axis {
    let division = sweep.kind == Kind::Division;
    let heights = points.iter().filter_map(|p| p.value.map(|v| (v, p.sd.unwrap_or(0.0))));
    let mut range = widened(heights.flat_map(|(v, sd)| [v - sd, v + sd]).chain(division.then_some(0.0)), 0.06);
    let without = points.iter().any(|point| is_at_rest(point) || point.undecided);
    if !(division && without) {
        return Axis::new(quantity(sweep.kind), range);
    }
    range[0] = -(0.06 + 0.03 * curves.min(6) as f64) * range[1].max(0.1);
    Axis { strip: Some("no χ"), ..Axis::new(quantity(sweep.kind), range) }
}

fn is_at_rest(point: &Point) -> bool {
    point.outcome == Some(Outcome::Arrested) && point.value.is_none()
}

/// The entries of the curves: all of them, or an even selection if there are many.
fn legend(sweep: &Sweep, points: &[Point], curves: &[Group<'_>]) -> Legend {
    let alone = curves.len() < 2;
    let outcomes = sweep.kind == Kind::Division && alone;
    let has = |outcome| points.iter().any(|p| p.outcome == Some(outcome) && p.value.is_some());
    let (resting, unknown) = (points.iter().any(is_at_rest), points.iter().any(|p| p.undecided));
    let count = if alone { 0 } else { curves.len() };
    let entries = count.min(NAMED);
    let named = (0..entries).map(|k| &curves[if entries < count { k * (count - 1) / (entries - 1) } else { k }]);
    Legend::default()
        .with_all(named.map(|group| (Key::Line(group.colour), group.name.as_str())))
        .with_if(entries < count, Key::Nothing, format!("{entries} of {count} curves are named"))
        .with_if(outcomes && has(Outcome::Symmetric), Key::Point(style::SYMMETRIC, Marker::Disc), "symmetric")
        .with_if(outcomes && has(Outcome::Asymmetric), Key::Point(style::ASYMMETRIC, Marker::Disc), "asymmetric")
        .with_if(resting, Key::Point(if alone { style::FAILED } else { style::INK }, Marker::Square), "stays at rest")
        .with_if(unknown, Key::Point(style::UNDECIDED, Marker::Triangle), "undecided")
}

/// Draws the points of one curve, joined if they are ordered, in a colour or in the colours of their outcomes.
fn draw_curve(
    chart: &mut Chart<'_>,
    points: &[&Point],
    at: &impl Fn(&Point) -> f64,
    sampled: bool,
    (colour, by_outcome, baseline): (Colour, bool, f64),
) {
    if !sampled {
        let mut sorted = points.to_vec();
        sorted.sort_by_cached_key(|item| OrderedFloat(at(item)));
        // Broken at points without a value.
        for piece in sorted.split(|point| point.value.is_none()) {
            let line = piece.iter().filter_map(|p| Some([at(p), p.value?]));
            chart.line(line, Stroke::solid(colour, style::CURVE));
        }
    }
    for point in points {
        let of_outcome = point.outcome.map_or(style::INK, style::outcome);
        dot(chart, at(point), point, if by_outcome { of_outcome } else { colour }, baseline);
    }
}

/// A point of a curve with its standard deviation; a point without a value lies on a base line.
fn dot(chart: &mut Chart<'_>, x: f64, point: &Point, colour: Colour, baseline: f64) {
    match point.value {
        Some(value) => {
            if let Some(sd) = point.sd.filter(|sd| *sd > 0.0) {
                chart.error_bar(x, [value + sd, value - sd], 0.0, 4.0, Stroke::solid(colour, 1.6));
            }
            chart.point([x, value], 4.6, Marker::Disc, colour);
        }
        None if point.undecided => chart.point([x, baseline], 5.5, Marker::Triangle, style::UNDECIDED),
        None if point.outcome == Some(Outcome::Arrested) => chart.point([x, baseline], 5.0, Marker::Square, colour),
        None => {}
    }
}

/// The points of one curve or of one panel.
struct Group<'a> {
    name: String,
    colour: Colour,
    points: Vec<&'a Point>,
}

/// The axes that distinguish curves and the axes that distinguish panels; the axis with most values distinguishes
/// curves.
struct Layout {
    curves: Vec<usize>,
    panels: Vec<usize>,
}

impl Layout {
    /// The layout of curves along the axis `along` and the axes sampled with it.
    fn of(sweep: &Sweep, points: &[Point], along: usize) -> Layout {
        let axes = &sweep.axes.0;
        let sampled = axes.get(along).is_some_and(|axis| axis.sampled);
        let held = held(sweep, points);
        let varies = |k: &usize| *k != along && !(sampled && axes[*k].sampled) && !held.contains(k);
        let others: Vec<usize> = (0..axes.len()).filter(varies).collect();
        if sampled {
            return Layout { curves: others, panels: Vec::new() };
        }
        let most = others.iter().copied().rev().max_by_key(|k| axes[*k].values.len());
        let panels = others.into_iter().filter(|k| Some(*k) != most && axes[*k].values.len() > 1).collect();
        Layout { curves: most.into_iter().collect(), panels }
    }
}

/// The points grouped by the values of some axes; one group without an axis.
fn grouped<'a>(sweep: &Sweep, points: &'a [Point], by: &[usize]) -> Vec<Group<'a>> {
    let key = |point: &Point| -> Vec<usize> { by.iter().filter_map(|k| point.places.get(*k).copied()).collect() };
    let found = statistics::grouped(points.iter().map(|point| (key(point), point)));
    let count = found.len();
    // Ordered values have ordered colours.
    let ordered = by.len() == 1 && numbers(sweep, by[0]).is_some();
    let colour = |k: usize| match (count, ordered || count > style::SERIES.len()) {
        (1, _) => style::INK,
        (_, true) => style::ramp(k, count),
        _ => style::SERIES[k],
    };
    let group = |(k, (_, points)): (usize, (Vec<usize>, Vec<&'a Point>))| {
        // A point of the converged scheme has no step, which others of the group may have.
        let named_by = points.iter().find(|point| !is_converged(sweep, &point.places)).unwrap_or(&points[0]);
        Group { name: named(sweep, by, &named_by.places), colour: colour(k), points }
    };
    found.into_iter().enumerate().map(group).collect()
}

/// The index and the value of a point on the axis of a parameter, if there is such an axis.
fn value_of<'a>(sweep: &'a Sweep, name: &'static str, places: &[usize]) -> Option<(usize, &'a AxisValue)> {
    let mut axes = sweep.axes.0.iter().zip(places);
    let (axis, place) = axes.find(|(axis, _)| axis.target == Target::Field(name))?;
    Some((*place, axis.values.get(*place)?))
}

/// Whether an axis sets the converged scheme for the point; that scheme has no fixed step.
fn is_converged(sweep: &Sweep, places: &[usize]) -> bool {
    value_of(sweep, "scheme", places).is_some_and(|(_, value)| value.text() == "converged")
}

/// Axes with several values, but only one value among the points, as in a part of a sweep.
fn held(sweep: &Sweep, points: &[Point]) -> Vec<usize> {
    let place = |point: &Point, axis: usize| point.places.get(axis).copied();
    let is_held = |axis: &usize| {
        sweep.axes.0[*axis].values.len() > 1
            && points.windows(2).all(|pair| place(&pair[0], *axis) == place(&pair[1], *axis))
    };
    (0..sweep.axes.0.len()).filter(is_held).collect()
}

/// The values of some axes at a point, with the names of the axes except for text values.
fn named(sweep: &Sweep, axes: &[usize], places: &[usize]) -> String {
    let no_step = is_converged(sweep, places);
    let one = |axis: &usize| {
        let (axis, place) = (&sweep.axes.0[*axis], places.get(*axis)?);
        let value = axis.values.get(*place)?.text().into_owned();
        let symbol = match axis.target {
            Target::Field("dt") if no_step => return None,
            _ if matches!(axis.values.first(), Some(AxisValue::Text(_))) => return Some(value),
            Target::Field("dt") => "Δt".to_owned(),
            Target::Field(name) => name.parse().map_or(axis.name.clone(), style::symbol),
            Target::CueNumber(parameter) => style::symbol(parameter),
            Target::Cue | Target::Seed => axis.name.clone(),
        };
        Some(format!("{symbol} = {value}"))
    };
    axes.iter().filter_map(one).collect::<Vec<_>>().join(", ")
}

fn map_of_outcomes(sweep: &Sweep, points: &[Point], [x, y]: [&(usize, Vec<f64>); 2]) -> Canvas {
    let edges = |values: &[f64]| {
        let mut order: Vec<usize> = (0..values.len()).collect();
        order.sort_by_cached_key(|k| OrderedFloat(values[*k]));
        let sorted: Vec<f64> = order.iter().map(|k| values[*k]).collect();
        let mut bounds = vec![[0.0; 2]; values.len()];
        order.iter().zip(bins(&sorted)).for_each(|(k, bin)| bounds[*k] = bin);
        bounds
    };
    let (columns, rows) = (edges(&x.1), edges(&y.1));
    let has = |outcome| points.iter().any(|point| point.outcome == outcome);
    let (unequal, legend) = (has(Some(Outcome::Asymmetric)), Legend::default().with_tiles(has));
    let (mut canvas, top) = titled(WIDTH, CHART, &title(sweep, points), &legend);
    let axis = |k: usize, bins: &[[f64; 2]]| Axis::new(label(sweep, k), widened(bins.iter().flatten().copied(), 0.0));
    let (across, up) = (axis(x.0, &columns), axis(y.0, &rows));
    let width = if unequal { WIDTH - scale::WIDTH } else { WIDTH };
    let mut chart = Chart::new(&mut canvas, [0.0, top], [width, CHART], across, up);
    chart.tiles(points.iter().filter_map(|point| {
        let place = |axis: usize| point.places.get(axis).copied().unwrap_or(0);
        Some((*columns.get(place(x.0))?, *rows.get(place(y.0))?, style::tile(point.outcome, point.value)))
    }));
    if unequal {
        scale::chi(&mut chart);
    }
    canvas
}
