//! What bounds division over a parameter: curves of pitchforks and folds in the plane of the parameter and activity, and where
//! the boundary lies at the cell's own activity.

use crate::cell::{Cell, Parameter};
use crate::drawing::legend::{self, Key, Marker};
use crate::drawing::panel::{Axis, Panel, widened};
use crate::drawing::style::{self, text};
use crate::drawing::{Anchor, Canvas, Drawing, Stroke};
use crate::shapes::Criticality;
use crate::shapes::curves::{Curve, CurvePoint};

const WIDTH: f64 = 940.0;
const HEIGHT: f64 = 620.0;
/// Colour of curves of folds.
pub const FOLD: &str = "#cc79a7";
/// Colour of curves of pitchforks.
pub const PITCHFORK: &str = style::INK;

/// What is drawn.
pub struct Boundary<'a> {
    /// The cell, without what varies.
    pub cell: &'a Cell,
    /// What varies.
    pub parameter: Parameter,
    /// Its range.
    pub range: [f64; 2],
    /// The curve of pitchforks; without points where a cue breaks the symmetry.
    pub pitchfork: &'a Curve,
    /// Curves of folds.
    pub folds: &'a [Curve],
    /// Where two folds are born.
    pub cusps: &'a [CurvePoint],
    /// Where the boundary lies at the cell's own activity.
    pub critical: Option<CurvePoint>,
}

/// Draws the curves.
pub fn draw(of: &Boundary<'_>) -> Drawing {
    let mut canvas = Canvas::new(WIDTH, HEIGHT);
    canvas.text([24.0, 30.0], &title(of.cell, of.parameter), text::TITLE, Anchor::Start, style::INK);
    let top = 46.0 + legend::rows(&mut canvas, [24.0, 40.0], WIDTH - 40.0, &entries(of));
    let points = || of.pitchfork.points.iter().chain(of.folds.iter().flat_map(|fold| &fold.points));
    let heights = points().map(|p| p.xi_s).chain(of.critical.map(|p| p.xi_s));
    let across = of.range.into_iter().chain(of.critical.map(|p| p.value));
    let x = Axis::new(style::parameter(of.parameter), widened(across, 0.02));
    let panel = Panel::new([0.0, top], [WIDTH, HEIGHT - top], x, Axis::over(style::ACTIVITY, heights));
    let map = panel.draw(&mut canvas, &[], |_, _| {});
    let on = |point: &CurvePoint| map.point([point.value, point.xi_s]);
    for fold in of.folds {
        let line: Vec<[f64; 2]> = fold.points.iter().chain(fold.cusp().as_ref()).map(on).collect();
        canvas.polyline(&line, Stroke::solid(FOLD, style::CURVE));
    }
    for (kind, piece) in by_criticality(of.pitchfork) {
        let dash = (kind == Some(Criticality::Subcritical)).then_some(style::DOTTED);
        let line: Vec<[f64; 2]> = piece.iter().map(on).collect();
        canvas.polyline(&line, Stroke { colour: PITCHFORK, width: style::CURVE + 0.4, dash });
    }
    for point in &of.pitchfork.degenerate {
        legend::point(&mut canvas, on(point), 6.5, Marker::Ring, PITCHFORK);
    }
    for cusp in of.cusps {
        legend::point(&mut canvas, on(cusp), 6.5, Marker::Diamond, FOLD);
    }
    if let Some(point) = of.critical {
        let at = on(&point);
        let [left, _, _, bottom] = map.frame();
        let thin = Stroke::dashed(style::ASYMMETRIC, 1.4, [4.0, 4.0]);
        canvas.polyline(&[[left, at[1]], at, [at[0], bottom]], thin);
        legend::point(&mut canvas, at, 8.0, Marker::Triangle, style::ASYMMETRIC);
        let word = format!("{:.4} at ξₛ = {}", point.value, trimmed(point.xi_s));
        let right = at[0] > 0.6 * WIDTH;
        let (x, anchor) = if right { (at[0] - 14.0, Anchor::End) } else { (at[0] + 14.0, Anchor::Start) };
        canvas.text([x, at[1] - 12.0], &word, text::LABEL, anchor, style::ASYMMETRIC);
    }
    canvas.finish()
}

/// A number without the noise of its last digits.
fn trimmed(value: f64) -> f64 {
    (value * 1e6).round() * 1e-6
}

/// Which cell, without what varies.
pub fn title(cell: &Cell, parameter: Parameter) -> String {
    let mut parts = Vec::new();
    if parameter != Parameter::R0 {
        parts.push(format!("R₀ = {}", cell.r0));
    }
    if parameter != Parameter::Epsilon {
        parts.push(format!("ε = {}", cell.epsilon));
    }
    if !cell.cue.is_none() {
        parts.push(format!("cue {}", cell.cue));
    }
    format!("Where division begins, {}", parts.join(", "))
}

fn entries(of: &Boundary<'_>) -> Vec<(Key, String)> {
    let is = |kind: Criticality| of.pitchfork.points.iter().any(|point| point.criticality() == Some(kind));
    let mut entries = Vec::new();
    let mut add = |shown: bool, key: Key, word: &str| {
        if shown {
            entries.push((key, word.to_owned()));
        }
    };
    add(is(Criticality::Supercritical), Key::line(PITCHFORK, None), "pitchfork, supercritical");
    add(is(Criticality::Subcritical), Key::line(PITCHFORK, Some(style::DOTTED)), "subcritical");
    add(!of.pitchfork.degenerate.is_empty(), Key::point(PITCHFORK, Marker::Ring), "criticality changes");
    add(!of.folds.is_empty(), Key::line(FOLD, None), "fold");
    add(!of.cusps.is_empty(), Key::point(FOLD, Marker::Diamond), "cusp");
    add(of.critical.is_some(), Key::point(style::ASYMMETRIC, Marker::Triangle), "critical value");
    entries
}

/// A curve of pitchforks in pieces of one criticality, which meet where it changes.
pub fn by_criticality(curve: &Curve) -> Vec<(Option<Criticality>, Vec<CurvePoint>)> {
    let mut found: Vec<(Option<Criticality>, Vec<CurvePoint>)> = Vec::new();
    for point in &curve.points {
        let kind = point.criticality();
        match found.last_mut() {
            Some((same, piece)) if *same == kind => piece.push(*point),
            Some((_, piece)) => {
                // The exact place of the change, if it was located, else the point itself.
                let before = piece.last().map_or(point.value, |last| last.value);
                let between = |p: &&CurvePoint| (p.value - before) * (p.value - point.value) <= 0.0;
                let meeting = curve.degenerate.iter().find(between).copied().unwrap_or(*point);
                piece.push(meeting);
                found.push((kind, vec![meeting, *point]));
            }
            None => found.push((kind, vec![*point])),
        }
    }
    found
}
