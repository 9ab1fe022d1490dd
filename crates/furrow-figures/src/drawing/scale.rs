//! Colour scales.

use super::canvas::{Anchor, Label, Stroke};
use super::panel::Chart;
use super::style::{self, INK, text};

/// Width of the scale on the right of a chart.
pub const WIDTH: f64 = 96.0;
/// Width of the bar, and its number of shades.
const BAR: f64 = 18.0;
const SHADES: usize = 50;

/// Draws the scale of χ on the right of a chart.
pub fn chi(chart: &mut Chart<'_>) {
    let ([_, top, right, bottom], canvas) = (chart.frame, &mut *chart.canvas);
    let left = right + 16.0;
    let row = |chi: f64| bottom - chi * (bottom - top);
    for k in 0..SHADES {
        let [from, to] = [k, k + 1].map(|k| k as f64 / SHADES as f64);
        // Slightly too high, so that no gap shows; the next shade covers the excess.
        let high = row(from) - row(to) + if k == 0 { 0.0 } else { 0.4 };
        canvas.rectangle([left, row(to)], [BAR, high], style::shade(0.5 * (from + to)), 1.0);
    }
    canvas.frame([left, top, left + BAR, bottom], Stroke::solid(INK, 1.0));
    for fifth in 0..=5 {
        let chi = 0.2 * f64::from(fifth);
        let y = row(chi);
        canvas.polyline(&[[left + BAR, y], [left + BAR + 4.0, y]], Stroke::solid(INK, 1.0));
        canvas.text([left + BAR + 8.0, y + 5.5], &format!("{chi:.1}"), text::TICK, Anchor::Start, INK);
    }
    let at = [left + BAR + 54.0, 0.5 * (top + bottom)];
    canvas.label(Label::new(at, style::CHI, text::LABEL, Anchor::Middle, INK).upwards());
}
