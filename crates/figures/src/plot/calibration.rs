//! Thresholds wanted and met, with their tolerances; an ensemble of constants, each by itself and in pairs.

use crate::calibration::{Calibration, Targets};
use crate::drawing::legend::{self, Key, Marker};
use crate::drawing::panel::{Axis, Margins, Panel, widened};
use crate::drawing::style::{self, text};
use crate::drawing::{Anchor, Canvas, Drawing, Stroke};
use crate::study::{Ensemble, Exclusion};

const WIDTH: f64 = 1040.0;
/// Height of a threshold in the chart of deviations.
const ROW: f64 = 46.0;
/// Side of a chart of an ensemble.
const CELL: f64 = 210.0;
/// Bars of a histogram.
const BARS: usize = 14;

/// Draws thresholds: the computed over the given on the left, the deviations with their tolerances on the right.
pub fn draw(targets: &Targets, found: &Calibration, excluded: &[Exclusion]) -> Drawing {
    let rows = found.residuals.len().max(1) as f64;
    let chart = (150.0 + ROW * rows).max(400.0);
    let height = 84.0 + chart + if excluded.is_empty() { 10.0 } else { 34.0 + 24.0 * excluded.len() as f64 };
    let mut canvas = Canvas::new(WIDTH, height);
    let constants: Vec<String> = found.parameters.iter().map(|(p, value)| format!("{p} = {value:.4}")).collect();
    let title = format!("Best fit: {}", constants.join(", "));
    canvas.text([24.0, 30.0], &title, text::TITLE, Anchor::Start, style::INK);
    let entries = [
        (Key::point(style::MODEL, Marker::Disc), "computed".to_owned()),
        (Key::area(style::FAINT), "tolerance".to_owned()),
        (Key::line(style::MUTED, Some(style::DASHED)), "as given".to_owned()),
    ];
    legend::rows(&mut canvas, [24.0, 42.0], WIDTH - 40.0, &entries);
    wanted_and_met(&mut canvas, found, chart);
    deviations(&mut canvas, targets, found, chart);
    for (k, Exclusion { datum, given, computed }) in excluded.iter().enumerate() {
        let line = format!("excluded by {datum}: {given}; computed: {computed}");
        let at = [24.0, 84.0 + chart + 24.0 * (k as f64 + 1.0)];
        canvas.text(at, &line, text::TICK, Anchor::Start, style::ASYMMETRIC);
    }
    canvas.finish()
}

fn wanted_and_met(canvas: &mut Canvas, found: &Calibration, height: f64) {
    let values = found.residuals.iter().flat_map(|r| [r.xi_s, r.computed]);
    let range = widened(values, 0.12);
    let (x, y) = (Axis::new("ξₛ* given (κ₀/Lₕ)", range), Axis::new("ξₛ* computed (κ₀/Lₕ)", range));
    let panel = Panel::new([0.0, 76.0], [430.0, height], x, y);
    let map = panel.draw(canvas, &[], |_, _| {});
    let ends = range.map(|value| map.point([value, value]));
    canvas.polyline(&ends, Stroke::dashed(style::MUTED, 1.6, style::DASHED));
    for r in &found.residuals {
        legend::point(canvas, map.point([r.xi_s, r.computed]), 6.5, Marker::Disc, style::MODEL);
    }
}

fn deviations(canvas: &mut Canvas, targets: &Targets, found: &Calibration, height: f64) {
    let tolerance = |k: usize| 100.0 * targets.thresholds.get(k).map_or(0.0, |threshold| threshold.tolerance);
    let percents = found.residuals.iter().enumerate().flat_map(|(k, r)| {
        let (percent, tolerance) = (100.0 * r.relative, tolerance(k));
        [percent, -percent, tolerance, -tolerance]
    });
    let rows = found.residuals.len() as f64;
    let x = Axis::new("deviation of ξₛ* (%)", widened(percents, 0.15));
    let y = Axis::new("", [0.0, rows]).bare();
    let mut panel = Panel::new([430.0, 76.0], [WIDTH - 430.0, height], x, y);
    panel.margins = Margins { left: 190.0, ..Margins::default() };
    let map = panel.draw(canvas, &[], |canvas, map| {
        for k in 0..found.residuals.len() {
            let y = rows - k as f64;
            let (a, b) = (map.point([-tolerance(k), y - 0.3]), map.point([tolerance(k), y - 0.7]));
            canvas.rectangle(a, [b[0] - a[0], b[1] - a[1]], style::FAINT, 1.0);
        }
    });
    let zero = [map.point([0.0, 0.0]), map.point([0.0, rows])];
    canvas.polyline(&zero, Stroke::dashed(style::MUTED, 1.6, style::DASHED));
    for (k, r) in found.residuals.iter().enumerate() {
        let at = map.point([100.0 * r.relative, rows - k as f64 - 0.5]);
        let from = map.point([0.0, rows - k as f64 - 0.5]);
        canvas.polyline(&[from, at], Stroke::solid(style::MODEL, 2.0));
        legend::point(canvas, at, 6.5, Marker::Disc, style::MODEL);
        let word = format!("R₀ = {}, ε = {}", r.r0, r.epsilon);
        canvas.text([map.frame()[0] - 12.0, at[1] + 5.0], &word, text::TICK, Anchor::End, style::INK);
    }
}

/// Draws an ensemble: the weighted distribution of each constant, and the members by every two of them, larger discs for more
/// weight.
pub fn draw_ensemble(found: &Ensemble) -> Drawing {
    let count = found.parameters.len();
    let side = CELL * count as f64;
    let mut canvas = Canvas::new(side.max(460.0) + 90.0, side + 130.0);
    let title = format!("{} admissible sets of constants", found.members.len());
    canvas.text([24.0, 30.0], &title, text::TITLE, Anchor::Start, style::INK);
    let worth = format!("worth {:.1} independent ones; discs by weight", found.effective_sample_size);
    canvas.text([24.0, 54.0], &worth, text::TICK, Anchor::Start, style::MUTED);
    let values = |k: usize| found.members.iter().filter_map(move |member| member.values.get(k).copied());
    let name = |k: usize| found.parameters.get(k).map_or(String::new(), |p| style::parameter(*p));
    for row in 0..count {
        for column in 0..=row {
            let at = [84.0 + CELL * column as f64, 70.0 + CELL * row as f64];
            let last = row + 1 == count;
            let mut x = Axis::new(if last { name(column) } else { String::new() }, widened(values(column), 0.08));
            let first = column == 0 && row > 0;
            let mut y = Axis::new(if first { name(row) } else { String::new() }, widened(values(row), 0.08));
            if row == column {
                y = Axis::new("", [0.0, 1.12]).bare();
            }
            (x.numbered, y.numbered) = (last, first);
            (x.ticks, y.ticks) = (4, 5);
            // Names of axes hang out of the square of their chart.
            let margins = Margins { left: 84.0, right: 12.0, top: 12.0, bottom: 62.0 };
            let size = [CELL + margins.left - 6.0, CELL + margins.bottom - 6.0];
            let mut panel = Panel::new([at[0] - margins.left + 12.0, at[1] - margins.top], size, x, y);
            panel.margins = margins;
            if row == column {
                histogram(&mut canvas, &panel, found, row)
            } else {
                pair(&mut canvas, &panel, found, [column, row])
            }
        }
    }
    canvas.finish()
}

fn histogram(canvas: &mut Canvas, panel: &Panel, found: &Ensemble, constant: usize) {
    let [low, high] = panel.x.range;
    let mut bars = [0.0; BARS];
    for member in &found.members {
        let Some(value) = member.values.get(constant) else { continue };
        let bar = ((value - low) / (high - low) * BARS as f64) as usize;
        bars[bar.min(BARS - 1)] += member.weight;
    }
    let tallest = bars.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
    panel.draw(canvas, &[], |canvas, map| {
        for (k, weight) in bars.iter().enumerate() {
            let width = (high - low) / BARS as f64;
            let x = low + width * k as f64;
            let (a, b) = (map.point([x, weight / tallest]), map.point([x + width, 0.0]));
            canvas.rectangle(a, [b[0] - a[0] - 0.8, b[1] - a[1]], style::MODEL, 0.75);
        }
    });
}

fn pair(canvas: &mut Canvas, panel: &Panel, found: &Ensemble, [x, y]: [usize; 2]) {
    let map = panel.draw(canvas, &[], |_, _| {});
    let largest = found.members.iter().map(|member| member.weight).fold(f64::MIN_POSITIVE, f64::max);
    for member in &found.members {
        if let (Some(x), Some(y)) = (member.values.get(x), member.values.get(y)) {
            let radius = 1.6 + 4.4 * (member.weight / largest).sqrt();
            canvas.disc(map.point([*x, *y]), radius, style::MODEL, 0.55, Some(Stroke::solid("#ffffff", 0.5)));
        }
    }
}
