//! The results of a sweep: χ, or another quantity, over its first dense axis, with a curve for each value of the other axes;
//! a map of outcomes if two axes are dense.

use std::collections::BTreeSet;

use serde_json::Value;

use crate::drawing::legend::{Key, Legend, Marker, titled};
use crate::drawing::panel::{Axis, Chart, MARGINS, bins, widened};
use crate::drawing::style::{self, Colour};
use crate::drawing::{Anchor, Canvas, Stroke, scale};
use furrow_analysis::{self as study, AxisValue, Kind, Row, Sweep, Target};
use furrow_cell::{Cell, Cue, Parameter};
use furrow_mechanics::division::Outcome;

const WIDTH: f64 = 1000.0;
const CHART: f64 = 548.0;
/// Height of one of several charts, and of the line above it that says what it is of.
const PANEL: [f64; 2] = [420.0, 30.0];
/// Fewest values of an axis that count as dense, and of the second with which curves would be too many.
const DENSE: usize = 8;
/// Most curves of a chart that a legend names; of more there are several charts, if another axis tells them apart.
const NAMED: usize = 12;

/// Outcomes in the order of a sweep's columns of counts.
const OUTCOMES: [Outcome; 3] = [Outcome::Symmetric, Outcome::Asymmetric, Outcome::Arrested];

/// A row as it is drawn.
struct Point {
    /// Places of the axes' values in their lists.
    places: Vec<usize>,
    value: Option<f64>,
    sd: Option<f64>,
    /// What most of its divisions did.
    outcome: Option<Outcome>,
    undecided: bool,
}

/// Draws the rows of a sweep or of a shard.
pub fn draw(sweep: &Sweep, rows: &[Row]) -> Canvas {
    let mut points: Vec<Point> = rows.iter().map(|row| point(sweep, row)).collect();
    // The converged scheme divides alike at all published steps: one of them shows it.
    let first_step = |point: &Point| value_of(sweep, "dt", &point.places).is_none_or(|(place, _)| place == 0);
    points.retain(|point| !is_converged(sweep, &point.places) || first_step(point));
    let numeric: Vec<(usize, Vec<f64>)> =
        (0..sweep.axes.0.len()).filter_map(|k| Some((k, numbers(sweep, k)?))).collect();
    let dense = |k: usize| sweep.axes.0[k].values.len() >= DENSE && !sweep.axes.0[k].sampled;
    match &numeric[..] {
        [x, y] if sweep.kind == Kind::Division && sweep.axes.0.len() == 2 && dense(x.0) && dense(y.0) => {
            map_of_outcomes(sweep, &points, [x, y])
        }
        // Curves run along an axis that has enough values for one, if there is any.
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
    format!("{what}: {}", parts.join(", "))
}

/// A cue without the numbers that an axis varies, which are in the legend or along the axis.
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

/// What the values are called.
fn quantity(kind: Kind) -> &'static str {
    match kind {
        Kind::Division => style::CHI,
        Kind::Tree => "cells of the lineage",
        Kind::Pitchfork => "threshold ξₛ* (κ₀/Lₕ)",
        Kind::Critical => "critical radius (Lₕ)",
    }
}

/// An axis by the name of its parameter.
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
    let axis = sweep.axes.0.get(along);
    let words: Vec<String> =
        axis.map_or(vec![String::new()], |axis| axis.values.iter().map(|v| v.text().into()).collect());
    let values = x.map_or_else(|| (0..words.len()).map(|k| k as f64).collect(), |(_, values)| values.clone());
    let at = |point: &Point| values.get(point.places.get(along).copied().unwrap_or(0)).copied().unwrap_or(0.0);
    let (facet, others) = facets(sweep, points, others(sweep, points, along));
    let groups = grouped(sweep, points, &others);
    let division = sweep.kind == Kind::Division;
    let heights = points.iter().filter_map(|p| p.value.map(|v| (v, p.sd.unwrap_or(0.0))));
    let mut up = widened(heights.flat_map(|(v, sd)| [v - sd, v + sd]).chain(division.then_some(0.0)), 0.06);
    let resting = points.iter().any(|p| p.outcome == Some(Outcome::Arrested) && p.value.is_none());
    let unknown = points.iter().any(|p| p.undecided);
    if division && (resting || unknown) {
        up[0] = -(0.06 + 0.03 * groups.len().min(6) as f64) * up[1].max(0.1);
    }
    let (alone, outcomes) = (groups.len() < 2, division && groups.len() < 2);
    let has = |outcome| points.iter().any(|p| p.outcome == Some(outcome) && p.value.is_some());
    let in_legend = groups.iter().step_by(groups.len().div_ceil(NAMED).max(1)).filter(|_| !alone);
    let legend = in_legend
        .fold(Legend::default(), |legend, group| legend.with(Key::Line(group.colour), group.name.as_str()))
        .with_if(outcomes && has(Outcome::Symmetric), Key::Point(style::SYMMETRIC, Marker::Disc), "symmetric")
        .with_if(outcomes && has(Outcome::Asymmetric), Key::Point(style::ASYMMETRIC, Marker::Disc), "asymmetric")
        .with_if(resting, Key::Point(if alone { style::FAILED } else { style::INK }, Marker::Square), "stays at rest")
        .with_if(unknown, Key::Point(style::UNDECIDED, Marker::Triangle), "undecided");
    let panels: Vec<Option<(usize, usize)>> = match &facet {
        Some((axis, places)) => places.iter().map(|place| Some((*axis, *place))).collect(),
        None => vec![None],
    };
    let [height, above] = if facet.is_some() { PANEL } else { [CHART, 0.0] };
    let all = (height + above) * panels.len() as f64;
    let (mut canvas, top) = titled(WIDTH, all, &title(sweep, points), &legend);
    let y = Axis { least: if division { 0.0 } else { f64::NEG_INFINITY }, ..Axis::new(quantity(sweep.kind), up) };
    for (row, panel) in panels.iter().enumerate() {
        let across = match x {
            Some(_) => Axis::over(label(sweep, along), values.iter().copied()),
            None => Axis::names(label(sweep, along), words.clone(), false),
        };
        let top = top + (height + above) * row as f64 + above;
        let within = |point: &&&Point| panel.is_none_or(|(axis, place)| point.places.get(axis) == Some(&place));
        let first = points.iter().find(|point| within(&point)).filter(|_| panel.is_some());
        if let (Some((axis, _)), Some(first)) = (panel, first) {
            let of = named(sweep, &[*axis], &first.places);
            canvas.bold([MARGINS[0], top - 2.0], &of, style::text::TICK, Anchor::Start, style::INK);
        }
        let mut chart = Chart::new(&mut canvas, [0.0, top], [WIDTH, height], across, y.clone());
        let sampled = axis.is_some_and(|axis| axis.sampled);
        let in_panel = |point: &&&Point| within(point);
        let shown: Vec<(Colour, Vec<&Point>)> = groups
            .iter()
            .map(|group| (group.colour, group.points.iter().filter(in_panel).copied().collect()))
            .collect();
        draw_curves(&mut chart, &shown, &at, (sampled, up[0]));
    }
    canvas
}

/// Draws the points of each curve of a chart, with lines unless they are sampled; those without a value lie from `below` to 0.
fn draw_curves(
    chart: &mut Chart<'_>,
    curves: &[(Colour, Vec<&Point>)],
    at: &dyn Fn(&Point) -> f64,
    (sampled, below): (bool, f64),
) {
    let alone = curves.len() < 2;
    for (colour, points) in curves.iter().filter(|_| !sampled) {
        let mut sorted = points.clone();
        sorted.sort_by(|a, b| at(a).total_cmp(&at(b)));
        // Broken where there is nothing.
        for piece in sorted.split(|point| point.value.is_none()) {
            let line = piece.iter().filter_map(|p| Some([at(p), p.value?]));
            chart.line(line, Stroke::solid(*colour, style::CURVE));
        }
    }
    for (k, (colour, points)) in curves.iter().enumerate() {
        // Points without a value lie below the axis of χ, those of each curve on a line of their own.
        let baseline = below * (k as f64 + 1.0) / (curves.len() as f64 + 1.0);
        for point in points {
            let of_outcome = point.outcome.map_or(style::INK, style::outcome);
            dot(chart, at(point), point, if alone { of_outcome } else { *colour }, baseline);
        }
    }
}

/// The axes that tell curves apart: all but the one along the curves and those that are sampled with it.
fn others(sweep: &Sweep, points: &[Point], along: usize) -> Vec<usize> {
    let axes = &sweep.axes.0;
    let sampled = axes.get(along).is_some_and(|axis| axis.sampled);
    let held = held(sweep, points);
    let varies = |k: &usize| *k != along && !(sampled && axes[*k].sampled) && !held.contains(k);
    (0..axes.len()).filter(varies).collect()
}

/// Where there are too many curves for one chart, the axis with a chart for each of its places; with the axes that are left.
fn facets(sweep: &Sweep, points: &[Point], others: Vec<usize>) -> (Option<(usize, Vec<usize>)>, Vec<usize>) {
    let curves = grouped(sweep, points, &others).len();
    if curves <= NAMED || others.len() < 2 {
        return (None, others);
    }
    let places = |axis: usize| {
        let all: BTreeSet<usize> = points.iter().filter_map(|point| point.places.get(axis).copied()).collect();
        all.into_iter().collect::<Vec<usize>>()
    };
    // The fewest charts that leave few enough curves in each.
    let enough = |axis: &&usize| curves.div_ceil(places(**axis).len().max(1)) <= NAMED;
    let few = others.iter().filter(enough).min_by_key(|axis| places(**axis).len());
    match few.copied().filter(|axis| places(*axis).len() <= NAMED) {
        Some(axis) => (Some((axis, places(axis))), others.into_iter().filter(|other| *other != axis).collect()),
        None => (None, others),
    }
}

/// A point of a curve, with its standard deviation; one without a value on a base line.
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

/// The points of one curve.
struct Group<'a> {
    name: String,
    colour: Colour,
    points: Vec<&'a Point>,
}

/// The points by their values on some axes.
fn grouped<'a>(sweep: &Sweep, points: &'a [Point], others: &[usize]) -> Vec<Group<'a>> {
    let mut found: Vec<(Vec<usize>, Vec<&Point>)> = Vec::new();
    for point in points {
        let key: Vec<usize> = others.iter().filter_map(|k| point.places.get(*k).copied()).collect();
        match found.iter_mut().find(|(known, _)| *known == key) {
            Some((_, members)) => members.push(point),
            None => found.push((key, vec![point])),
        }
    }
    let count = found.len();
    // What has an order has colours in an order.
    let ordered = others.len() == 1 && numbers(sweep, others[0]).is_some();
    let colour = |k: usize| match (count, ordered || count > style::SERIES.len()) {
        (1, _) => style::INK,
        (_, true) => style::ramp(k, count),
        _ => style::SERIES[k],
    };
    let group = |(k, (_, points)): (usize, (Vec<usize>, Vec<&'a Point>))| Group {
        name: named(sweep, others, &points[0].places),
        colour: colour(k),
        points,
    };
    found.into_iter().enumerate().map(group).collect()
}

/// The place and the value of a point on the axis of a parameter, if there is one.
fn value_of<'a>(sweep: &'a Sweep, name: &'static str, places: &[usize]) -> Option<(usize, &'a AxisValue)> {
    let mut axes = sweep.axes.0.iter().zip(places);
    let (axis, place) = axes.find(|(axis, _)| axis.target == Target::Field(name))?;
    Some((*place, axis.values.get(*place)?))
}

/// Whether an axis says that a point is solved by the converged scheme, which has no fixed step.
fn is_converged(sweep: &Sweep, places: &[usize]) -> bool {
    value_of(sweep, "scheme", places).is_some_and(|(_, value)| value.text() == "converged")
}

/// The axes of several values of which the points have one: those of a part of a sweep.
fn held(sweep: &Sweep, points: &[Point]) -> Vec<usize> {
    let place = |point: &Point, axis: usize| point.places.get(axis).copied();
    let is_held = |axis: &usize| {
        sweep.axes.0[*axis].values.len() > 1
            && points.windows(2).all(|pair| place(&pair[0], *axis) == place(&pair[1], *axis))
    };
    (0..sweep.axes.0.len()).filter(is_held).collect()
}

/// The values of some axes at a point, each with the axis's name unless it is a word.
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
        order.sort_by(|a, b| values[*a].total_cmp(&values[*b]));
        let sorted: Vec<f64> = order.iter().map(|k| values[*k]).collect();
        let mut bounds = vec![[0.0; 2]; values.len()];
        order.iter().zip(bins(&sorted)).for_each(|(k, bin)| bounds[*k] = bin);
        bounds
    };
    let (columns, rows) = (edges(&x.1), edges(&y.1));
    let has = |outcome| points.iter().any(|point| point.outcome == Some(outcome));
    let (unequal, undecided) = (has(Outcome::Asymmetric), points.iter().any(|point| point.outcome.is_none()));
    let area = |outcome, chi| Key::Area(style::tile(outcome, chi));
    let legend = Legend::default()
        .with_if(has(Outcome::Symmetric), area(Some(Outcome::Symmetric), None), "symmetric")
        .with_if(unequal, area(Some(Outcome::Asymmetric), Some(0.7)), "asymmetric, χ by shade")
        .with_if(has(Outcome::Arrested), area(Some(Outcome::Arrested), None), "stays at rest")
        .with_if(undecided, area(None, None), "undecided");
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
        let [_, top, right, bottom] = chart.frame;
        scale::chi(chart.canvas, [right, top, bottom]);
    }
    canvas
}
