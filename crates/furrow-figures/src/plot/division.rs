//! A dividing cell: its contour at several times in its shell with the cue, the size asymmetry and the neck over time,
//! and the normal forces along the contour when the furrow is half-way; with a regulator also φ along the contour at
//! these times.

use crate::drawing::cell::{self as drawn, Site};
use crate::drawing::legend::{Key, Legend, titled};
use crate::drawing::panel::{Axis, Chart, widened};
use crate::drawing::regulator::PhiRange;
use crate::drawing::style::{self, FORCES, text};
use crate::drawing::{Anchor, Canvas, Label, Stroke};
use furrow_cell::Cell;
use furrow_mechanics::division::{Division, Outcome, Snapshot, Trajectory};

const WIDTH: f64 = 1160.0;
/// Height of a row of contours.
const CELLS: f64 = 192.0;
/// Height of a chart with its legend, and width of the chart on the left.
const CHART: [f64; 2] = [440.0, 0.45 * WIDTH];
/// Height of the chart of a regulator with its legend.
const CARRIED: f64 = 330.0;
/// Width of a strip along a contour.
const STRIP: f64 = 5.5;
/// Number of contours drawn.
const STILLS: usize = 6;

/// Draws a division.
pub fn draw(cell: &Cell, film: &Trajectory) -> Canvas {
    let title = format!("{}: {}", style::described(cell, &[]), ending(&film.division));
    let stills = stills(film);
    let phi = PhiRange::of(stills.iter().flat_map(|still| &still.places));
    let legend = drawn::cue_legend(&film.cell().cue, film.step(film.times().len().saturating_sub(1)).length, phi);
    let carried = if phi.is_some() { CARRIED } else { 0.0 };
    let (mut canvas, top) = titled(WIDTH, CELLS + 22.0 + CHART[0] + carried, &title, &legend);
    contours(&mut canvas, film.cell(), (&film.wall().contour(), &stills), phi, top);
    let top = top + CELLS + 22.0;
    over_time(&mut canvas, cell, film, top);
    balance(&mut canvas, &half_way(film), top);
    if phi.is_some() {
        regulator(&mut canvas, &stills, top + CHART[0]);
    }
    canvas
}

/// Stills from the first to the last shape, between which the neck closes by equal parts or, if the cell stays at rest,
/// the length of the contour grows by equal parts: a long wait does not hide the changes.
fn stills(film: &Trajectory) -> Vec<Snapshot> {
    let times = film.times();
    let first = film.step(0);
    let widest = |still: &Snapshot| still.places.iter().map(|place| place.r).fold(0.0, f64::max);
    let waist = |still: &Snapshot| still.neck.map_or(widest(still), |neck| neck.radius);
    let progress = |still: &Snapshot| match film.division.outcome() {
        Outcome::Arrested => (still.length / first.length).ln(),
        // At first the cell lengthens without a neck.
        _ => 0.5 * (still.length / first.length).ln() + 1.0 - waist(still) / waist(&first),
    };
    let passed: Vec<f64> = (0..times.len()).map(|k| progress(&film.step(k))).collect();
    let last = times.len().saturating_sub(1);
    let mut stills: Vec<Snapshot> =
        evenly_passed(&times, &passed, STILLS - 1).into_iter().map(|t| film.at(t)).collect();
    stills.push(film.step(last));
    stills
}

/// The cell when its neck is half as wide as the cell was at first; the last shape if it stays at rest.
fn half_way(film: &Trajectory) -> Snapshot {
    let times = film.times();
    let widest = film.step(0).places.iter().map(|place| place.r).fold(0.0, f64::max);
    let narrow = |k: &usize| film.step(*k).neck.is_some_and(|neck| neck.radius < 0.5 * widest);
    film.step((0..times.len()).find(narrow).unwrap_or(times.len().saturating_sub(1)))
}

/// The note in the chart over time of a cell that never has a neck.
pub(super) const NO_NECK: &str = "no neck forms";

/// How a division ended, in words.
pub(super) fn ending(division: &Division) -> String {
    match (division.outcome(), division.chi()) {
        (Outcome::Arrested, _) => "stays at rest".to_owned(),
        (outcome, Some(chi)) => format!("{outcome}, χ = {chi:.3}"),
        (outcome, None) => outcome.to_string(),
    }
}

/// `count` times before the last one, from the first on, between which equal parts of the progress are made; `progress` is given at
/// `times`, and counts where it exceeds all before it.
pub(super) fn evenly_passed(times: &[f64], progress: &[f64], count: usize) -> Vec<f64> {
    let passed: Vec<f64> = progress
        .iter()
        .scan(0.0, |before: &mut f64, p| {
            *before = before.max(*p);
            Some(*before)
        })
        .collect();
    let [.., end] = passed[..] else { return Vec::new() };
    let time = |k: usize| {
        if times.len() < 2 {
            return times[0];
        }
        let wanted = end * k as f64 / count as f64;
        let at = passed.partition_point(|p| *p < wanted).clamp(1, passed.len() - 1);
        let ([a, b], [t, t2]) = ([passed[at - 1], passed[at]], [times[at - 1], times[at]]);
        let share = if b > a { ((wanted - a) / (b - a)).clamp(0.0, 1.0) } else { 1.0 };
        t + share * (t2 - t)
    };
    (0..count).map(time).collect()
}

fn contours(
    canvas: &mut Canvas,
    cell: &Cell,
    (shell, stills): (&[[f64; 2]], &[Snapshot]),
    phi: Option<PhiRange>,
    top: f64,
) {
    let [along, across] = drawn::extent(shell);
    let longest = stills.iter().flat_map(|s| &s.places).map(|p| p.z.abs()).fold(along, f64::max);
    let width = (WIDTH - 40.0) / stills.len().max(1) as f64;
    let scale = (0.46 * width / longest).min(0.42 * (CELLS - 30.0) / across);
    for (k, still) in stills.iter().enumerate() {
        let site = Site { centre: [20.0 + width * (k as f64 + 0.5), top + 0.5 * (CELLS - 24.0)], scale };
        drawn::shell(canvas, shell, &site);
        if k == 0 {
            drawn::poles(canvas, &site, [0.46 * width / scale, across]);
        } else {
            drawn::cue(canvas, (&cell.cue, phi), still, &site, STRIP);
        }
        // The body covers the cue's strips, which lie outside: in a deep furrow they would reach the other side.
        drawn::body(canvas, &still.contour(), &site, 2.0);
        let word = format!("t = {} τ", style::time(still.t));
        canvas.text([site.centre[0], top + CELLS - 6.0], &word, text::TICK, Anchor::Middle, style::MUTED);
    }
}

/// φ along the drawn contours.
fn regulator(canvas: &mut Canvas, stills: &[Snapshot], top: f64) {
    let named = |k: usize| style::ramp(k, stills.len());
    let entry = |(k, still): (usize, &Snapshot)| (Key::Line(named(k)), format!("t = {} τ", style::time(still.t)));
    Legend::default().with_all(stills.iter().enumerate().map(entry)).draw(canvas, [70.0, top + 10.0], WIDTH - 90.0);
    let line = |still: &Snapshot| -> Vec<[f64; 2]> {
        still.places.iter().filter_map(|place| Some([place.u, place.phi?])).collect()
    };
    let lines: Vec<Vec<[f64; 2]>> = stills.iter().map(line).collect();
    let y = Axis::new("regulator φ", widened(lines.iter().flatten().map(|[_, phi]| *phi), 0.08));
    let x = Axis::new("place u", [0.0, 1.0]).reversed();
    let mut chart = Chart::new(canvas, [0.0, top + 40.0], [WIDTH, CARRIED - 40.0], x, y);
    for (k, line) in lines.into_iter().enumerate() {
        chart.line(line, Stroke::solid(named(k), style::CURVE));
    }
    poles(&mut chart);
}

/// The names of the poles under a chart along the contour.
fn poles(chart: &mut Chart<'_>) {
    let [left, _, right, bottom] = chart.frame;
    for (x, pole, anchor) in [(left, drawn::ANTERIOR, Anchor::Start), (right, drawn::POSTERIOR, Anchor::End)] {
        chart.canvas.text([x, bottom + 44.0], pole, text::TICK, anchor, style::MUTED);
    }
}

/// The size of force that 90 % of the contour stays below: at the neck forces are far larger, and would hide all
/// others.
fn usual(still: &Snapshot) -> f64 {
    let mut sizes: Vec<f64> = (0..=200)
        .filter_map(|k| {
            let at = still.places.partition_point(|place| place.u < k as f64 / 200.0);
            still.places.get(at).map(|place| place.normal.parts().iter().fold(0.0, |m: f64, f| m.max(f.abs())))
        })
        .collect();
    sizes.sort_by(f64::total_cmp);
    1.15 * sizes.get(sizes.len() * 9 / 10).copied().unwrap_or(1.0).max(1e-6)
}

fn over_time(canvas: &mut Canvas, cell: &Cell, film: &Trajectory, top: f64) {
    let times = film.times();
    let (mut neck, mut chi) = (Vec::new(), Vec::new());
    for (k, t) in times.iter().enumerate() {
        let still = film.step(k);
        if let Some(found) = still.neck {
            neck.push([*t, found.radius / cell.r0]);
            chi.push([*t, still.asymmetry.abs()]);
        }
    }
    Legend::default()
        .with_if(!neck.is_empty(), Key::Line(style::SYMMETRIC), "neck radius / R₀")
        .with_if(!chi.is_empty(), Key::Line(style::ASYMMETRIC), "asymmetry χ about the neck")
        .draw(canvas, [70.0, top + 10.0], 560.0);
    let most = neck.iter().chain(&chi).map(|[_, v]| *v).fold(0.5, f64::max);
    let y = Axis::new("neck radius / R₀,  χ", [0.0, 1.08 * most]);
    let x = Axis::new(style::TIME, [0.0, times.last().copied().unwrap_or(1.0)]);
    let mut chart = Chart::new(canvas, [0.0, top + 40.0], [CHART[1], CHART[0] - 40.0], x, y);
    if neck.is_empty() {
        chart.note(NO_NECK);
    }
    for (curve, colour) in [(neck, style::SYMMETRIC), (chi, style::ASYMMETRIC)] {
        chart.line(curve, Stroke::solid(colour, style::CURVE));
    }
}

fn balance(canvas: &mut Canvas, still: &Snapshot, top: f64) {
    let left = CHART[1];
    let entries = FORCES.into_iter().map(|(name, colour)| (Key::Line(colour), name));
    Legend::default().with_all(entries).draw(canvas, [left + 60.0, top + 10.0], WIDTH - left - 50.0);
    let part = |k: usize| still.places.iter().map(move |place| [place.u, place.normal.parts()[k]]);
    let most = usual(still);
    let label = format!("normal force at t = {} τ (κ₀/Lₕ³)", style::time(still.t));
    let y = Axis::new(label, widened([-most, most], 0.08));
    // In the same direction as the contours.
    let x = Axis::new("place u", [0.0, 1.0]).reversed();
    let mut chart = Chart::new(canvas, [left, top + 40.0], [WIDTH - left, CHART[0] - 40.0], x, y);
    chart.line([[0.0, 0.0], [1.0, 0.0]], Stroke::solid(style::MUTED, 1.0));
    let mut beyond = Vec::new();
    for (k, (name, colour)) in FORCES.iter().enumerate() {
        chart.line(part(k), Stroke::solid(*colour, style::CURVE));
        let peak = part(k).map(|[_, f]| f).fold(0.0, |m: f64, f| if f.abs() > m.abs() { f } else { m });
        if peak.abs() > 1.08 * most {
            beyond.push(format!("{name} {peak:+.0}").replace('-', "\u{2212}"));
        }
    }
    if !beyond.is_empty() {
        beyond.insert(0, if still.neck.is_some() { "at the neck" } else { "beyond the axis" }.to_owned());
    }
    poles(&mut chart);
    let [left, top, ..] = chart.frame;
    for (k, line) in beyond.iter().enumerate() {
        let at = [left + 10.0, top + 22.0 + 20.0 * k as f64];
        chart.canvas.label(Label::new(at, line, text::TICK, Anchor::Start, style::MUTED).over(style::WHITE));
    }
}
