//! The results of a sweep: χ, or whatever its kind gives, over its first axis of many numbers (or of any, where none has many), a
//! curve for each value of the other axes; outcomes as a map where two axes are dense.

use serde_json::Value;

use super::phase::bins;
use crate::cell::Cue;
use crate::division::Outcome;
use crate::drawing::legend::{self, Key, Marker};
use crate::drawing::panel::{Axis, Curve, Mapping, Panel, widened};
use crate::drawing::style::{self, text};
use crate::drawing::{Anchor, Canvas, Drawing, Stroke};
use crate::study::{self, AxisValue, Kind, Row, Sweep, Target};

const WIDTH: f64 = 1000.0;
const HEIGHT: f64 = 620.0;
/// Fewest values of an axis that count as dense, and of the second with which curves would be too many.
const DENSE: usize = 8;
/// Most curves that a legend names.
const NAMED: usize = 12;

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

/// Draws the rows of a sweep, be they all of them or those of a part.
pub fn draw(sweep: &Sweep, rows: &[Row]) -> Drawing {
    let points: Vec<Point> = rows.iter().map(|row| point(sweep, row)).collect();
    let numeric: Vec<usize> = (0..sweep.axes.0.len()).filter(|k| numbers(sweep, *k).is_some()).collect();
    let mut canvas = Canvas::new(WIDTH, HEIGHT);
    canvas.text([24.0, 30.0], &title(sweep), text::TITLE, Anchor::Start, style::INK);
    let dense = |k: usize| sweep.axes.0[k].values.len() >= DENSE && !sweep.axes.0[k].sampled;
    match numeric[..] {
        [x, y] if sweep.kind == Kind::Division && sweep.axes.0.len() == 2 && dense(x) && dense(y) => {
            map_of_outcomes(&mut canvas, sweep, &points, [x, y]);
        }
        // Curves run along an axis that has enough values for one, if there is any.
        _ => curves(
            &mut canvas,
            sweep,
            &points,
            numeric.iter().copied().find(|k| dense(*k)).or(numeric.first().copied()),
        ),
    }
    canvas.finish()
}

fn title(sweep: &Sweep) -> String {
    let fixed = |name: &'static str| sweep.axes.0.iter().all(|axis| axis.target != Target::Field(name));
    let cell = &sweep.settings.cell;
    let mut parts = Vec::new();
    if fixed("r0") && matches!(sweep.kind, Kind::Division | Kind::Pitchfork) {
        parts.push(format!("R₀ = {}", cell.r0));
    }
    if fixed("epsilon") {
        parts.push(format!("ε = {}", cell.epsilon));
    }
    if fixed("xi_s") && sweep.kind != Kind::Pitchfork {
        parts.push(format!("ξₛ = {}", cell.xi_s));
    }
    if sweep.axes.0.iter().all(|axis| axis.target != Target::Cue) {
        parts.extend(sweep.cue.as_ref().map(|cue| format!("cue {}", unvaried(cue, sweep))));
    }
    let what = match sweep.kind {
        Kind::Division => "Divisions",
        Kind::Tree => "Lineages",
        Kind::Pitchfork => "Thresholds",
        Kind::Critical => "Critical radii",
    };
    format!("{what}: {}", parts.join(", "))
}

/// A cue without the numbers that an axis varies: these are in the legend or along the axis.
fn unvaried(cue: &Cue, sweep: &Sweep) -> String {
    let text = cue.to_string();
    let key = |axis: &study::Axis| match axis.target {
        Target::CueNumber(parameter) => Some(format!("{}=", parameter.to_string().rsplit('.').next()?)),
        _ => None,
    };
    let varied: Vec<String> = sweep.axes.0.iter().filter_map(key).collect();
    // Of a sum it is not told here which term a number is of.
    if cue.terms().len() != 1 {
        return text;
    }
    let left = text.split(',').filter(|part| !varied.iter().any(|key| part.starts_with(key)));
    left.collect::<Vec<_>>().join(",")
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
            let outcome = match results.first().and_then(Value::as_str) {
                Some("symmetric") => Some(Outcome::Symmetric),
                Some("asymmetric") => Some(Outcome::Asymmetric),
                Some("failed") => Some(Outcome::Failed),
                _ => None,
            };
            (number(1), None, outcome)
        }
        Kind::Division => {
            let all = [Outcome::Symmetric, Outcome::Asymmetric, Outcome::Failed];
            let most = (0..3).max_by_key(|k| results.get(*k).and_then(Value::as_u64).unwrap_or(0));
            let any = (0..3).any(|k| results.get(k).and_then(Value::as_u64).is_some_and(|n| n > 0));
            (number(3), number(4), most.filter(|_| any).map(|k| all[k]))
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
    match axis.target {
        Target::Field(name) => name.parse().map_or(axis.name.clone(), style::parameter),
        _ => axis.name.clone(),
    }
}

fn curves(canvas: &mut Canvas, sweep: &Sweep, points: &[Point], x: Option<usize>) {
    let along = x.unwrap_or(0);
    let words: Vec<String> = sweep
        .axes
        .0
        .get(along)
        .map_or(vec![String::new()], |axis| axis.values.iter().map(|v| v.text().into()).collect());
    let values = x.and_then(|x| numbers(sweep, x)).unwrap_or_else(|| (0..words.len()).map(|k| k as f64).collect());
    let at = |point: &Point| values.get(point.places.get(along).copied().unwrap_or(0)).copied().unwrap_or(0.0);
    let groups = grouped(sweep, points, along);
    let division = sweep.kind == Kind::Division;
    let heights = points.iter().filter_map(|p| p.value.map(|v| (v, p.sd.unwrap_or(0.0))));
    let mut up = widened(heights.flat_map(|(v, sd)| [v - sd, v + sd]).chain(division.then_some(0.0)), 0.06);
    let resting = points.iter().any(|p| p.outcome == Some(Outcome::Failed) && p.value.is_none());
    let unknown = points.iter().any(|p| p.undecided);
    if division && (resting || unknown) {
        up[0] = -(0.06 + 0.03 * groups.len().min(6) as f64) * up[1].max(0.1);
    }
    let entries = legend_of(&groups, division, resting, unknown);
    let legend_height = legend::rows(canvas, [24.0, 40.0], WIDTH - 40.0, &entries);
    let mut across = Axis::over(label(sweep, along), values.iter().copied());
    if x.is_none() {
        across = across.unnumbered();
    }
    let top = 44.0 + legend_height;
    let panel = Panel::new([0.0, top], [WIDTH, HEIGHT - top], across, Axis::new(quantity(sweep.kind), up));
    let sampled = sweep.axes.0.get(along).is_some_and(|axis| axis.sampled);
    let lines: Vec<Curve> = groups.iter().filter(|_| !sampled).flat_map(|group| group.lines(&at)).collect();
    let map = panel.draw(canvas, &lines, |_, _| {});
    for (k, group) in groups.iter().enumerate() {
        // Each curve has a line of its own for what stays at rest.
        let baseline = up[0] * (k as f64 + 1.0) / (groups.len() as f64 + 1.0);
        for point in &group.points {
            mark(canvas, &map, point, at(point), baseline, if groups.len() > 1 { Some(&group.colour) } else { None });
        }
    }
    if x.is_none() {
        for (k, word) in words.iter().enumerate() {
            let [x, _] = map.point([k as f64, up[0]]);
            canvas.text([x, map.frame()[3] + 22.0], word, text::TICK, Anchor::Middle, style::INK);
        }
    }
}

/// The points of one curve.
struct Group<'a> {
    name: String,
    colour: String,
    points: Vec<&'a Point>,
}

impl Group<'_> {
    /// Its line, broken where there is nothing.
    fn lines(&self, at: &dyn Fn(&Point) -> f64) -> Vec<Curve> {
        let mut sorted = self.points.clone();
        sorted.sort_by(|a, b| at(a).total_cmp(&at(b)));
        let pieces = sorted.split(|point| point.value.is_none());
        let line = |piece: &[&Point]| piece.iter().filter_map(|p| Some([at(p), p.value?])).collect::<Vec<_>>();
        pieces.map(line).filter(|line| line.len() > 1).map(|line| Curve::new(line, &self.colour)).collect()
    }
}

/// The points by the values of all axes but one and those that are sampled with it.
fn grouped<'a>(sweep: &Sweep, points: &'a [Point], along: usize) -> Vec<Group<'a>> {
    let axes = &sweep.axes.0;
    let sampled = axes.get(along).is_some_and(|axis| axis.sampled);
    let others: Vec<usize> = (0..axes.len()).filter(|k| *k != along && !(sampled && axes[*k].sampled)).collect();
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
        (1, _) => style::INK.to_owned(),
        (_, true) => style::ramp(k, count),
        _ => style::SERIES[k % style::SERIES.len()].to_owned(),
    };
    let name = |key: &[usize]| {
        let parts = others.iter().zip(key).map(|(axis, place)| {
            let axis = &axes[*axis];
            let value = axis.values.get(*place).map_or(String::new(), |value| value.text().into_owned());
            if matches!(axis.values.first(), Some(AxisValue::Text(_))) {
                value
            } else {
                format!("{} = {value}", symbol(axis))
            }
        });
        parts.collect::<Vec<_>>().join(", ")
    };
    found
        .into_iter()
        .enumerate()
        .map(|(k, (key, points))| Group { name: name(&key), colour: colour(k), points })
        .collect()
}

/// What an axis is called before its value.
fn symbol(axis: &crate::study::Axis) -> &str {
    match axis.target {
        Target::Field("r0") => "R₀",
        Target::Field("epsilon") => "ε",
        Target::Field("xi_s") => "ξₛ",
        _ => &axis.name,
    }
}

fn legend_of(groups: &[Group<'_>], division: bool, resting: bool, unknown: bool) -> Vec<(Key, String)> {
    let mut entries = Vec::new();
    if groups.len() > 1 {
        let step = groups.len().div_ceil(NAMED);
        for group in groups.iter().step_by(step) {
            entries.push((Key::line(&group.colour, None), group.name.clone()));
        }
    } else if division {
        entries.push((Key::point(style::SYMMETRIC, Marker::Disc), "symmetric".to_owned()));
        entries.push((Key::point(style::ASYMMETRIC, Marker::Disc), "asymmetric".to_owned()));
    }
    if resting {
        entries.push((Key::point(style::FAILED, Marker::Square), "stays at rest".to_owned()));
    }
    if unknown {
        entries.push((Key::point(style::UNDECIDED, Marker::Triangle), "undecided".to_owned()));
    }
    entries
}

/// A point with its standard deviation; what has no value stands below the axis of χ.
fn mark(canvas: &mut Canvas, map: &Mapping, point: &Point, x: f64, baseline: f64, colour: Option<&str>) {
    let Some(value) = point.value else {
        if point.undecided {
            legend::point(canvas, map.point([x, baseline]), 5.5, Marker::Triangle, style::UNDECIDED);
        } else if point.outcome == Some(Outcome::Failed) {
            legend::point(canvas, map.point([x, baseline]), 5.0, Marker::Square, colour.unwrap_or(style::FAILED));
        }
        return;
    };
    let own = point.outcome.map_or(style::INK, style::outcome);
    let colour = colour.unwrap_or(own);
    let at = map.point([x, value]);
    if let Some(sd) = point.sd.filter(|sd| *sd > 0.0) {
        let ends = [value + sd, value - sd].map(|value| map.point([x, value]));
        legend::error_bar(canvas, ends, 4.0, Stroke::solid(colour, 1.6));
    }
    legend::point(canvas, at, 4.6, Marker::Disc, colour);
}

fn map_of_outcomes(canvas: &mut Canvas, sweep: &Sweep, points: &[Point], [x, y]: [usize; 2]) {
    let (Some(across), Some(up)) = (numbers(sweep, x), numbers(sweep, y)) else { return };
    let edges = |values: &[f64]| {
        let mut order: Vec<usize> = (0..values.len()).collect();
        order.sort_by(|a, b| values[*a].total_cmp(&values[*b]));
        let sorted: Vec<f64> = order.iter().map(|k| values[*k]).collect();
        let mut bounds = vec![[0.0; 2]; values.len()];
        order.iter().zip(bins(&sorted)).for_each(|(k, bin)| bounds[*k] = bin);
        bounds
    };
    let (columns, rows) = (edges(&across), edges(&up));
    let entries = [
        (Key::area(&style::tint(style::SYMMETRIC, 0.55)), "symmetric".to_owned()),
        (Key::area(&style::tint(style::ASYMMETRIC, 0.35)), "asymmetric, χ = 0.2".to_owned()),
        (Key::area(&style::tint(style::ASYMMETRIC, 0.65)), "χ = 0.8".to_owned()),
        (Key::area(&style::tint(style::FAILED, 0.45)), "stays at rest".to_owned()),
    ];
    legend::rows(canvas, [24.0, 40.0], WIDTH - 40.0, &entries);
    let range = |bins: &[[f64; 2]]| widened(bins.iter().flatten().copied(), 0.0);
    let axis = |k: usize, bins: &[[f64; 2]]| Axis::new(label(sweep, k), range(bins));
    let panel = Panel::new([0.0, 76.0], [WIDTH, HEIGHT - 76.0], axis(x, &columns), axis(y, &rows));
    panel.draw(canvas, &[], |canvas, map| {
        for point in points {
            let place = |axis: usize| point.places.get(axis).copied().unwrap_or(0);
            let (Some([x, x2]), Some([y, y2])) = (columns.get(place(x)), rows.get(place(y))) else { continue };
            let colour = match point.outcome {
                Some(Outcome::Symmetric) => style::tint(style::SYMMETRIC, 0.55),
                Some(Outcome::Asymmetric) => style::tint(style::ASYMMETRIC, 0.25 + 0.5 * point.value.unwrap_or(1.0)),
                Some(Outcome::Failed) => style::tint(style::FAILED, 0.45),
                None => style::UNDECIDED.to_owned(),
            };
            let (a, b) = (map.point([*x, *y2]), map.point([*x2, *y]));
            canvas.rectangle(a, [b[0] - a[0] + 0.3, b[1] - a[1] + 0.3], &colour, 1.0);
        }
    });
}
