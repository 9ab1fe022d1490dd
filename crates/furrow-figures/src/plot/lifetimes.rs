//! Lifetimes of measured cells beside the model's: over volume and over the time of birth, and the numbers of cells
//! over time.

use crate::drawing::legend::{Key, Legend, Marker, titled};
use crate::drawing::panel::{Axis, Chart, Rows, widened};
use crate::drawing::style::{self, Colour, text};
use crate::drawing::{Anchor, Canvas, Label, Stroke, font};
use furrow_analysis::compare::departure::{Departure, LastDivision, OverTime};
use furrow_analysis::compare::lifetimes::{CellComparison, LifetimesComparison};
use furrow_measured::lifetimes::CellsOverTime;
use furrow_measured::statistics::distinct;
use furrow_measured::volumes::Unit;
use ordered_float::OrderedFloat;

const WIDTH: f64 = 1100.0;
/// Heights of the charts over volume and birth, and of the chart over time.
const CHARTS: [f64; 2] = [430.0, 470.0];
/// Longest time axis, as a multiple of the embryo's known time.
const BEYOND: f64 = 2.5;

/// Draws a table of lifetimes beside a tree; `unit` is the unit of volume.
pub fn draw(found: &LifetimesComparison, unit: Option<Unit>) -> Canvas {
    let founders = coloured(&distinct(found.cells.iter().map(|cell| cell.measured.founder.as_str())));
    let entry = |(name, colour): &(String, Colour)| (Key::Point(*colour, Marker::Disc), format!("{name}, measured"));
    let (alive, any_birth) = (found.over_time.as_ref(), found.over_time.is_some());
    let legend = Legend::default()
        .with_all(founders.iter().map(entry))
        .with_if(found.has_clock, Key::Point(style::MODEL, Marker::Diamond), "the model's, by its clock")
        .with_if(found.slope.is_some(), Key::Line(style::MUTED), "ln lifetime over ln volume, by founder")
        .with_if(any_birth, Key::Line(style::OBSERVED), "cells of the embryo")
        .with_if(alive.is_some_and(|alive| alive.model.is_some()), Key::Line(style::MODEL), "of the model");
    let any_volume = found.cells.iter().any(|cell| cell.volume.is_some());
    let above = if any_volume || any_birth { CHARTS[0] } else { 0.0 };
    let below = if any_birth { CHARTS[1] } else { 0.0 };
    let title = format!("Lifetimes of cells, measured and of {}", found.lineage);
    let (mut canvas, top) = titled(WIDTH, above + below, &title, &legend);
    let share = if any_volume && any_birth { 0.5 * WIDTH } else { WIDTH };
    if any_volume {
        over_volume(&mut canvas, [0.0, top], [share, CHARTS[0]], (found, unit), &founders);
    }
    if any_birth {
        over_birth(&mut canvas, [WIDTH - share, top], [share, CHARTS[0]], found, &founders);
    }
    if let Some(alive) = alive {
        numbers(&mut canvas, [0.0, top + above], alive, found.departure.as_ref());
    }
    canvas
}

/// Founders with their colours: the germline in greys from dark to light, as in drawings of trees.
pub(super) fn coloured(names: &[&str]) -> Vec<(String, Colour)> {
    // Green is reserved for the model.
    let hues = [5, 1, 2, 4, 6, 0].map(|k: usize| style::SERIES[k]);
    let of = |kind: bool| names.iter().copied().filter(|name| name.starts_with('P') == kind).collect::<Vec<_>>();
    let (mut germline, others) = (of(true), of(false));
    germline.sort_unstable();
    let place = |names: &[&str], name: &str| names.iter().position(|other| *other == name);
    let colour = |name: &str| match (place(&germline, name), place(&others, name)) {
        (Some(k), _) => style::grey(k, germline.len()),
        (_, k) => style::series(k.unwrap_or(0), others.len(), &hues),
    };
    names.iter().map(|name| ((*name).to_owned(), colour(name))).collect()
}

fn colour_of(founders: &[(String, Colour)], cell: &CellComparison) -> Colour {
    founders.iter().find(|(name, _)| *name == cell.measured.founder).map_or(style::INK, |(_, colour)| *colour)
}

/// A logarithmic axis with some room at its ends.
pub(super) fn logarithmic(label: &str, values: impl Iterator<Item = f64>) -> Axis {
    let ends = widened(values.map(f64::log10), 0.06).map(|power| 10_f64.powf(power));
    Axis::new(label, ends).logarithmic()
}

/// The lifetime over the measured volume, with a line for each founder, and the model's lifetimes at the same volumes.
fn over_volume(
    canvas: &mut Canvas,
    at: [f64; 2],
    size: [f64; 2],
    (found, unit): (&LifetimesComparison, Option<Unit>),
    founders: &[(String, Colour)],
) {
    let with_volume: Vec<(&CellComparison, f64)> =
        found.cells.iter().filter_map(|cell| Some((cell, cell.volume?))).collect();
    let lifetimes = with_volume.iter().flat_map(|(cell, _)| [Some(cell.measured.mean), cell.model]).flatten();
    let label = format!("measured volume of the cell ({})", unit.map_or("unit of the table", Unit::symbol));
    let x = logarithmic(&label, with_volume.iter().map(|(_, volume)| *volume));
    let y = logarithmic("lifetime (min)", lifetimes);
    let mut chart = Chart::new(canvas, at, size, x, y);
    for (name, colour) in founders {
        let own: Vec<f64> =
            with_volume.iter().filter(|(cell, _)| cell.measured.founder == *name).map(|(_, volume)| *volume).collect();
        let row = found.founders.iter().find(|row| row.founder == *name);
        let Some(line) = row.and_then(|row| row.slope).map(|slope| slope.line) else { continue };
        let [least, most] = widened(own, 0.0);
        let ends = [least, most].map(|volume| [volume, (line.intercept + line.slope * volume.ln()).exp()]);
        chart.line(ends, Stroke::solid(*colour, 1.6));
    }
    draw_cells(&mut chart, &with_volume, founders, [5.0, 3.4]);
}

/// The lifetime over the time of birth.
fn over_birth(
    canvas: &mut Canvas,
    at: [f64; 2],
    size: [f64; 2],
    found: &LifetimesComparison,
    founders: &[(String, Colour)],
) {
    let born: Vec<(&CellComparison, f64)> =
        found.cells.iter().filter_map(|cell| Some((cell, cell.measured.birth?))).collect();
    let lifetimes = born.iter().flat_map(|(cell, _)| [Some(cell.measured.mean), cell.model]).flatten();
    let x = Axis::over("measured birth (min)", born.iter().map(|(_, birth)| *birth));
    let y = logarithmic("lifetime (min)", lifetimes);
    let mut chart = Chart::new(canvas, at, size, x, y);
    draw_cells(&mut chart, &born, founders, [4.0, 2.8]);
}

/// Draws the measured lifetimes of cells, and above them the model's, in discs and diamonds of these sizes.
fn draw_cells(
    chart: &mut Chart<'_>,
    cells: &[(&CellComparison, f64)],
    founders: &[(String, Colour)],
    [disc, diamond]: [f64; 2],
) {
    for (cell, x) in cells {
        chart.point([*x, cell.measured.mean], disc, Marker::Disc, colour_of(founders, cell));
    }
    let modelled = cells.iter().filter_map(|(cell, x)| Some([*x, cell.model?]));
    chart.points(modelled, diamond, Marker::Diamond, style::MODEL);
}

/// The numbers of cells over time.
fn numbers(canvas: &mut Canvas, at: [f64; 2], over_time: &OverTime, departure: Option<&Departure>) {
    let OverTime { measured, model, last_divisions, .. } = over_time;
    let first = measured.over_time.steps.first().map_or(0.0, |step| step.min);
    let known = measured.known_until;
    let of_model = model.iter().flat_map(|model| &model.steps);
    let last = of_model.map(|step| step.min).fold(known, f64::max).min(known + (BEYOND - 1.0) * (known - first));
    let room = 0.03 * (last - first);
    let range = [first - room, last + room];
    let highest = [Some(measured.over_time.at(known)), model.as_ref().map(|model| model.at(range[1]))];
    let highest = highest.into_iter().flatten().max().unwrap_or(1) as f64;
    // Room above the curves for text.
    let y = Axis::new("cells alive", [1.0, 6.0 * highest]).logarithmic();
    let mut chart = Chart::new(canvas, at, [WIDTH, CHARTS[1]], Axis::new("time (min of the table)", range), y);
    let upright =
        |chart: &mut Chart<'_>, min: f64, stroke: Stroke| chart.line([[min, 1.0], [min, 6.0 * highest]], stroke);
    upright(&mut chart, known, Stroke::dashed(style::MUTED, 1.4, style::DOTTED));
    let mut marks = vec![(known, "table complete up to here".to_owned(), style::MUTED)];
    let leaves = departure.and_then(|departure| departure.lasting.or(departure.first));
    if let Some(leaves) = leaves {
        upright(&mut chart, leaves.min, Stroke::dashed(style::ASYMMETRIC, 1.6, style::DASHED));
        let words = format!("numbers apart: {} and {} cells", leaves.cells, leaves.model);
        marks.push((leaves.min, words, style::ASYMMETRIC));
    }
    for (min, names) in joined(last_divisions).into_iter().filter(|(min, _)| *min <= range[1]) {
        let [x, bottom] = chart.at([min, 1.0]);
        chart.canvas.polyline(&[[x, bottom], [x, bottom - 12.0]], Stroke::solid(style::MODEL, 2.4));
        marks.push((min, format!("last of {names}"), style::MODEL));
    }
    if let Some(model) = model {
        chart.line(stairs(model, range), Stroke::solid(style::MODEL, 2.2));
    }
    chart.line(stairs(&measured.over_time, [range[0], known]), Stroke::solid(style::OBSERVED, 2.2));
    write_marks(&mut chart, marks);
}

/// Founders by the time of their last division; founders with the same time share an entry.
fn joined(last: &[LastDivision]) -> Vec<(f64, String)> {
    let mut sorted: Vec<&LastDivision> = last.iter().collect();
    sorted.sort_by_cached_key(|item| OrderedFloat(item.min));
    let names = |of: &[&LastDivision]| of.iter().map(|last| last.founder.as_str()).collect::<Vec<_>>().join(", ");
    sorted.chunk_by(|a, b| a.min == b.min).map(|of| (of[0].min, names(of))).collect()
}

/// The corners of a step function.
fn stairs(over_time: &CellsOverTime, [from, to]: [f64; 2]) -> Vec<[f64; 2]> {
    let mut corners = vec![[from, over_time.at(from) as f64]];
    for step in over_time.steps.iter().filter(|step| step.min > from && step.min <= to) {
        corners.extend([[step.min, (step.cells - 1) as f64], [step.min, step.cells as f64]]);
    }
    corners.push([to, over_time.at(to) as f64]);
    corners
}

/// Distance between two rows of text.
const ROW: f64 = 19.0;

/// Writes text at the top of a chart, each beside its time and in the first row where it overlaps no other.
fn write_marks(chart: &mut Chart<'_>, mut marks: Vec<(f64, String, Colour)>) {
    marks.sort_by_cached_key(|item| OrderedFloat(item.0));
    let [left, top, right, _] = chart.frame;
    let mut rows = Rows::default();
    for (min, words, colour) in marks {
        let (x, width) = (chart.at([min, 1.0])[0], font::width(&words, text::TICK));
        // Text that would leave the chart is written to the left of its time, as is the text of the departure.
        let from =
            if x + 6.0 + width > right || colour == style::ASYMMETRIC { (x - 6.0 - width).max(left) } else { x + 6.0 };
        let at = [from, top + 18.0 + ROW * rows.free([from, from + width]) as f64];
        chart.canvas.label(Label::new(at, &words, text::TICK, Anchor::Start, colour).over(style::WHITE));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_founders_of_the_worm_have_different_colours() {
        let found = coloured(&["AB", "P2", "EMS", "E", "MS", "P3", "C", "D", "P4"]);
        let mut colours: Vec<Colour> = found.iter().map(|(_, colour)| *colour).collect();
        colours.sort_unstable();
        colours.dedup();
        assert_eq!(colours.len(), 9, "{found:?}");
    }
}
