//! What fits the embryo: the front between its counts and the published thresholds, activities by founder, a cue's χ.

use crate::drawing::legend::{self, Key, Marker};
use crate::drawing::panel::{Axis, Margins, Panel, widened};
use crate::drawing::style::{self, text};
use crate::drawing::{Anchor, Canvas, Drawing, Stroke};
use crate::study::fit::{ChiResidual, FittedConstants, FittedCue, FounderActivity};

const WIDTH: f64 = 900.0;
/// Height of a founder in the chart of activities.
const ROW: f64 = 40.0;

/// Draws the front: how far mean rounds are off over how far the published thresholds are.
pub fn draw_constants(found: &FittedConstants) -> Drawing {
    let mut canvas = Canvas::new(WIDTH, 560.0);
    let name = |(parameter, value): &(_, f64)| format!("{parameter} = {value:.4}");
    let best: Vec<String> = found.best.constants.iter().map(name).collect();
    canvas.text([24.0, 30.0], &format!("Best: {}", best.join(", ")), text::LABEL, Anchor::Start, style::INK);
    let entries = [
        (Key::point(style::MODEL, Marker::Disc), "front".to_owned()),
        (Key::point(style::ASYMMETRIC, Marker::Diamond), "best by the embryo alone".to_owned()),
        (Key::point(style::INK, Marker::Square), "start".to_owned()),
    ];
    let top = 46.0 + legend::rows(&mut canvas, [24.0, 42.0], WIDTH - 40.0, &entries);
    let at = |rms: Option<f64>, rounds: f64| Some([100.0 * rms?, rounds]);
    let front: Vec<[f64; 2]> = found.front.iter().filter_map(|set| at(set.thresholds_rms, set.parts.rounds)).collect();
    let [best, start] = [&found.best, &found.start].map(|set| at(set.thresholds_rms, set.parts.rounds));
    let all = || front.iter().copied().chain(best).chain(start);
    let x = Axis::over("published thresholds, off by (%, root mean square)", all().map(|point| point[0]));
    let y = Axis::over("mean rounds of the founders, off by", all().map(|point| point[1]));
    let map = Panel::new([0.0, top], [WIDTH, 560.0 - top], x, y).draw(&mut canvas, &[], |_, _| {});
    for point in &front {
        legend::point(&mut canvas, map.point(*point), 6.0, Marker::Disc, style::MODEL);
    }
    for (point, marker, colour) in [(best, Marker::Diamond, style::ASYMMETRIC), (start, Marker::Square, style::INK)] {
        if let Some(point) = point {
            legend::point(&mut canvas, map.point(point), 7.0, marker, colour);
        }
    }
    canvas.finish()
}

/// Draws the activities with which each founder has the observed rounds; `xi_s` is that of the run.
pub fn draw_activities(founders: &[FounderActivity], xi_s: f64) -> Drawing {
    let rows = founders.len() as f64;
    let height = 150.0 + ROW * rows;
    let mut canvas = Canvas::new(WIDTH, height);
    let title = "Activity with which each founder has the observed rounds";
    canvas.text([24.0, 30.0], title, text::TITLE, Anchor::Start, style::INK);
    let entries = [
        (Key::area(style::MODEL), "as observed, to half a round".to_owned()),
        (Key::point(style::ASYMMETRIC, Marker::Diamond), "nearest tried, where there is none".to_owned()),
        (Key::line(style::MUTED, Some(style::DASHED)), "of all others".to_owned()),
    ];
    let top = 46.0 + legend::rows(&mut canvas, [24.0, 42.0], WIDTH - 40.0, &entries);
    let ends = founders.iter().flat_map(|f| f.intervals.iter().flatten().copied().chain(f.nearest.map(|(xi, _)| xi)));
    let x = Axis::new(style::ACTIVITY, widened(ends.chain([xi_s]), 0.06));
    let mut panel = Panel::new([0.0, top], [WIDTH, height - top], x, Axis::new("", [0.0, rows]).bare());
    panel.margins = Margins { left: 90.0, ..Margins::default() };
    let map = panel.draw(&mut canvas, &[], |_, _| {});
    let line = [map.point([xi_s, 0.0]), map.point([xi_s, rows])];
    canvas.polyline(&line, Stroke::dashed(style::MUTED, 1.8, style::DASHED));
    for (k, founder) in founders.iter().enumerate() {
        let y = rows - k as f64 - 0.5;
        for [from, to] in &founder.intervals {
            let (a, b) = (map.point([*from, y + 0.28]), map.point([*to, y - 0.28]));
            canvas.rectangle(a, [(b[0] - a[0]).max(3.0), b[1] - a[1]], style::MODEL, 1.0);
        }
        if let (true, Some((xi, _))) = (founder.intervals.is_empty(), founder.nearest) {
            legend::point(&mut canvas, map.point([xi, y]), 6.5, Marker::Diamond, style::ASYMMETRIC);
        }
        let at = [map.frame()[0] - 12.0, map.point([xi_s, y])[1] + 5.0];
        canvas.text(at, &founder.name, text::TICK, Anchor::End, style::INK);
    }
    canvas.finish()
}

/// Draws the measured χ beside those of the cue that fits best, and what nothing was fitted to beside what it predicts.
pub fn draw_cue(found: &FittedCue) -> Drawing {
    let mut canvas = Canvas::new(WIDTH, 520.0);
    let title = format!("Best cue: χ² = {:.1}", found.chi_squared);
    canvas.text([24.0, 30.0], &title, text::TITLE, Anchor::Start, style::INK);
    let entries = [
        (Key::point(style::OBSERVED, Marker::Disc), "measured, mean ± sd".to_owned()),
        (Key::point(style::MODEL, Marker::Diamond), "model".to_owned()),
    ];
    let top = 46.0 + legend::rows(&mut canvas, [24.0, 42.0], WIDTH - 40.0, &entries);
    let all: Vec<(&ChiResidual, bool)> =
        found.residuals.iter().map(|r| (r, true)).chain(found.out_of_sample.iter().map(|r| (r, false))).collect();
    let most = all.iter().flat_map(|(r, _)| [r.measured + r.sd, r.computed.unwrap_or(0.0)]).fold(0.1, f64::max);
    let x =
        Axis::new("division (predicted ones behind the line)", [-0.6, all.len() as f64 - 0.4]).every(1.0).unnumbered();
    let panel = Panel::new([0.0, top], [WIDTH, 520.0 - top], x, Axis::new(style::CHI, [-0.02, 1.08 * most]));
    let map = panel.draw(&mut canvas, &[], |_, _| {});
    let border = found.residuals.len() as f64 - 0.5;
    let line = [map.point([border, 0.0]), map.point([border, 1.05 * most])];
    canvas.polyline(&line, Stroke::dashed(style::MUTED, 1.6, style::DASHED));
    for (k, (residual, _)) in all.iter().enumerate() {
        let (x, r) = (k as f64, residual);
        let ends = [r.measured - r.sd, r.measured + r.sd].map(|y| map.point([x, y]));
        canvas.polyline(&ends, Stroke::solid(style::OBSERVED, 1.8));
        legend::point(&mut canvas, map.point([x, r.measured]), 6.0, Marker::Disc, style::OBSERVED);
        if let Some(chi) = r.computed {
            legend::point(&mut canvas, map.point([x + 0.1, chi]), 6.5, Marker::Diamond, style::MODEL);
        }
        let at = [map.point([x, 0.0])[0], map.frame()[3] + 24.0];
        canvas.text(at, &r.cell, text::TICK, Anchor::Middle, style::INK);
    }
    canvas.finish()
}
