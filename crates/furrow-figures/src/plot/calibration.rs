//! Given and computed thresholds, with their tolerances; an ensemble of constants, singly and in pairs.

use crate::drawing::font;
use crate::drawing::legend::{Key, Legend, Marker, titled};
use crate::drawing::panel::{Axis, Chart, MARGINS, Ticks, widened};
use crate::drawing::style::{self, WHITE, text};
use crate::drawing::{Anchor, Canvas, Stroke};
use furrow_analysis::{Ensemble, Exclusion};
use furrow_cell::Cue;
use furrow_mechanics::calibration::{Calibration, Targets};

const WIDTH: f64 = 1040.0;
/// Width of the chart on the left.
const LEFT: f64 = 430.0;
/// Height of a row in the chart of deviations.
const ROW: f64 = 46.0;
/// Side of a chart of an ensemble.
const CELL: f64 = 210.0;
/// Bars of a histogram.
const BARS: usize = 14;
/// The line of exact agreement with the given values.
const GIVEN: Stroke = Stroke { colour: style::MUTED, width: 1.6, dash: Some(style::DASHED) };

/// Draws thresholds: computed over given values on the left, the deviations with their tolerances on the right.
pub fn draw(targets: &Targets, found: &Calibration, excluded: &[Exclusion]) -> Canvas {
    let chart = (150.0 + ROW * found.residuals.len().max(1) as f64).max(400.0);
    let head = (!excluded.is_empty()).then(|| "Statements that exclude it, and what it gives instead:".to_owned());
    let statement =
        |Exclusion { datum, given, computed }: &Exclusion| style::symbols(&format!("{datum}, {given}: {computed}"));
    let lines = head.into_iter().chain(excluded.iter().map(statement));
    let lines: Vec<String> = lines.flat_map(|line| font::wrapped(&line, text::TICK, WIDTH - 48.0)).collect();
    let below = if lines.is_empty() { 10.0 } else { 34.0 + 24.0 * lines.len() as f64 };
    let constants: Vec<String> =
        found.parameters.iter().map(|(p, value)| format!("{} = {value:.4}", style::symbol(*p))).collect();
    let legend = Legend::default()
        .with(Key::Point(style::MODEL, Marker::Disc), "computed")
        .with_if(targets.thresholds.iter().any(|t| t.tolerance > 0.0), Key::Area(style::FAINT), "tolerance")
        .with(Key::Dashes(style::MUTED, style::DASHED), "as given");
    let title = format!("Best fit: {}", constants.join(", "));
    let (mut canvas, top) = titled(WIDTH, chart + below, &title, &legend);
    let range = widened(found.residuals.iter().flat_map(|r| [r.xi_s, r.computed]), 0.12);
    let (x, y) = (Axis::new("ξₛ* given (κ₀/Lₕ)", range), Axis::new("ξₛ* computed (κ₀/Lₕ)", range));
    let mut left = Chart::new(&mut canvas, [0.0, top], [LEFT, chart], x, y);
    left.line(range.map(|value| [value, value]), GIVEN);
    left.points(found.residuals.iter().map(|r| [r.xi_s, r.computed]), 6.5, Marker::Disc, style::MODEL);
    deviations(&mut canvas, targets, found, [top, chart]);
    for (k, line) in lines.iter().enumerate() {
        let at = [24.0, top + chart + 24.0 * (k as f64 + 1.0)];
        canvas.text(at, line, text::TICK, Anchor::Start, style::ASYMMETRIC);
    }
    canvas
}

fn deviations(canvas: &mut Canvas, targets: &Targets, found: &Calibration, [top, height]: [f64; 2]) {
    let tolerance = |k: usize| 100.0 * targets.thresholds.get(k).map_or(0.0, |threshold| threshold.tolerance);
    let percents = found.residuals.iter().enumerate().flat_map(|(k, r)| {
        let (percent, tolerance) = (100.0 * r.relative, tolerance(k));
        [percent, -percent, tolerance, -tolerance]
    });
    let x = Axis::new("deviation of ξₛ* (%)", widened(percents, 0.15));
    let names = found.residuals.iter().map(|r| format!("R₀ = {}, ε = {}", r.r0, r.epsilon)).collect();
    let y = Axis::names("", names, true);
    let [low, high] = y.range;
    let mut chart =
        Chart::within(canvas, [LEFT, top], [WIDTH - LEFT, height], [190.0, MARGINS[1], MARGINS[2], MARGINS[3]], x, y);
    for (k, r) in found.residuals.iter().enumerate() {
        let y = k as f64;
        chart.area([-tolerance(k), y - 0.2], [tolerance(k), y + 0.2], 0.0, style::FAINT, 1.0);
        chart.line([[0.0, y], [100.0 * r.relative, y]], Stroke::solid(style::MODEL, 2.0));
    }
    chart.line([[0.0, low], [0.0, high]], GIVEN);
    let points = found.residuals.iter().enumerate().map(|(k, r)| [100.0 * r.relative, k as f64]);
    chart.points(points, 6.5, Marker::Disc, style::MODEL);
}

/// Draws an ensemble: the weighted distribution of each constant, and the members over every pair of constants, with
/// larger discs for larger weights.
pub fn draw_ensemble(found: &Ensemble) -> Canvas {
    let count = found.parameters.len();
    let side = CELL * count as f64;
    let title = format!(
        "{} admissible sets of constants\nworth {:.1} independent ones; discs by weight",
        found.members.len(),
        found.effective_sample_size
    );
    let (mut canvas, top) = titled(side.max(460.0) + 90.0, side + 60.0, &title, &Legend::default());
    let range = |k: usize| widened(found.members.iter().filter_map(|member| member.values.get(k).copied()), 0.08);
    let named = |k: usize, shown: bool| {
        let label =
            found.parameters.get(k).filter(|_| shown).map_or(String::new(), |p| style::parameter(*p, &Cue::none()));
        Axis { numbered: shown, ticks: Ticks::About(4), ..Axis::new(label, range(k)) }
    };
    // Labels of axes extend beyond the square of their chart.
    let margins = [MARGINS[0], 12.0, 12.0, MARGINS[3]];
    for row in 0..count {
        for column in 0..=row {
            let x = named(column, row + 1 == count);
            let bare = Axis { ticks: Ticks::Names(Vec::new()), ..Axis::new("", [0.0, 1.12]) };
            let y = if row == column { bare } else { named(row, column == 0) };
            let at = [10.0 + CELL * column as f64, top - 12.0 + CELL * row as f64];
            let size = [CELL + margins[0] - 6.0, CELL + margins[3] - 6.0];
            let mut chart = Chart::within(&mut canvas, at, size, margins, x, y);
            if row == column {
                histogram(&mut chart, range(row), found, row);
            } else {
                pair(&mut chart, found, [column, row]);
            }
        }
    }
    canvas
}

fn histogram(chart: &mut Chart<'_>, [low, high]: [f64; 2], found: &Ensemble, constant: usize) {
    let width = (high - low) / BARS as f64;
    let mut bars = [0.0; BARS];
    for member in &found.members {
        let Some(value) = member.values.get(constant) else { continue };
        bars[(((value - low) / width) as usize).min(BARS - 1)] += member.weight;
    }
    let tallest = bars.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
    for (k, weight) in bars.iter().enumerate() {
        let x = low + width * k as f64;
        chart.area([x, 0.0], [x + 0.95 * width, weight / tallest], 0.0, style::MODEL, 0.75);
    }
}

fn pair(chart: &mut Chart<'_>, found: &Ensemble, [x, y]: [usize; 2]) {
    let largest = found.members.iter().map(|member| member.weight).fold(f64::MIN_POSITIVE, f64::max);
    for member in &found.members {
        if let (Some(x), Some(y)) = (member.values.get(x), member.values.get(y)) {
            let radius = 1.6 + 4.4 * (member.weight / largest).sqrt();
            let at = chart.at([*x, *y]);
            chart.canvas.disc(at, radius, style::MODEL, 0.55, Some(Stroke::solid(WHITE, 0.5)));
        }
    }
}
