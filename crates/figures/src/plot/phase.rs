//! Outcomes over a plane of one parameter and activity, with the exact edges on top of them.

use super::boundary::{FOLD, PITCHFORK};
use crate::batch::phase::{PhaseCell, PhaseOutcome};
use crate::batch::{PhaseDiagram, PhasePlane};
use crate::drawing::legend::{self, Key, Marker};
use crate::drawing::panel::{Axis, Mapping, Panel};
use crate::drawing::style::{self, text};
use crate::drawing::{Anchor, Canvas, Drawing, Stroke};
use crate::shapes::at_rest::Edge;
use crate::shapes::curves::Curve;

const WIDTH: f64 = 940.0;
const HEIGHT: f64 = 660.0;
/// Most values across and upwards that have their χ written in.
const WRITTEN: usize = 13;

/// The bounding curves of a plane, as far as they could be followed.
#[derive(Default)]
pub struct Edges {
    /// Curves of pitchforks.
    pub pitchforks: Vec<Curve>,
    /// Curves of folds.
    pub folds: Vec<Curve>,
}

/// Draws a diagram.
pub fn draw(plane: &PhasePlane, diagram: &PhaseDiagram, edges: &Edges) -> Drawing {
    let mut canvas = Canvas::new(WIDTH, HEIGHT);
    let title =
        super::boundary::title(&plane.cell, plane.parameter).replace("Where division begins", "Outcomes of division");
    canvas.text([24.0, 30.0], &title, text::TITLE, Anchor::Start, style::INK);
    let top = 46.0 + legend::rows(&mut canvas, [24.0, 40.0], WIDTH - 40.0, &entries(diagram, edges));
    let (columns, rows) = (bins(&plane.across), bins(&plane.up));
    let end = |bins: &[[f64; 2]]| {
        let all = || bins.iter().flatten().copied();
        [all().fold(f64::INFINITY, f64::min), all().fold(f64::NEG_INFINITY, f64::max)]
    };
    let x = Axis::new(style::parameter(plane.parameter), end(&columns));
    let y = Axis::new(style::ACTIVITY, end(&rows));
    let panel = Panel::new([0.0, top], [WIDTH, HEIGHT - top], x, y);
    let tiles = |canvas: &mut Canvas, map: &Mapping| {
        for (k, cell) in diagram.cells.iter().enumerate() {
            let (Some([x, x2]), Some([y, y2])) = (columns.get(k / rows.len()), rows.get(k % rows.len())) else {
                continue;
            };
            let (a, b) = (map.point([*x, *y2]), map.point([*x2, *y]));
            // A little wider than they are, so that no light comes through between two.
            canvas.rectangle(a, [b[0] - a[0] + 0.3, b[1] - a[1] + 0.3], &colour(cell), 1.0);
        }
    };
    let map = panel.draw(&mut canvas, &[], tiles);
    curves(&mut canvas, &edges.folds, FOLD, &map);
    curves(&mut canvas, &edges.pitchforks, PITCHFORK, &map);
    if columns.len() <= WRITTEN && rows.len() <= WRITTEN + 2 {
        write_chi(&mut canvas, diagram, &map);
    }
    for column in &diagram.columns {
        for edge in &column.edges {
            // Curves tell the same at every value across.
            let known = if matches!(edge, Edge::Pitchfork { .. }) { &edges.pitchforks } else { &edges.folds };
            if !known.is_empty() {
                continue;
            }
            let (marker, colour) = match edge {
                Edge::Pitchfork { .. } => (Marker::Disc, PITCHFORK),
                _ => (Marker::Diamond, FOLD),
            };
            let at = [column.x, edge.xi_s()];
            if map.holds(at) {
                legend::point(&mut canvas, map.point(at), 5.0, marker, colour);
            }
        }
    }
    canvas.finish()
}

/// A line with a white rim, which is seen on any colour.
fn visible(canvas: &mut Canvas, points: &[[f64; 2]], colour: &str) {
    canvas.polyline(points, Stroke::solid("#ffffff", style::CURVE + 2.6));
    canvas.polyline(points, Stroke::solid(colour, style::CURVE));
}

/// Draws what of the curves lies within the axes.
fn curves(canvas: &mut Canvas, curves: &[Curve], colour: &str, map: &Mapping) {
    for curve in curves {
        let mut piece: Vec<[f64; 2]> = Vec::new();
        for point in &curve.points {
            if map.holds([point.value, point.xi_s]) {
                piece.push(map.point([point.value, point.xi_s]));
            } else {
                visible(canvas, &std::mem::take(&mut piece), colour);
            }
        }
        visible(canvas, &piece, colour);
    }
}

fn write_chi(canvas: &mut Canvas, diagram: &PhaseDiagram, map: &Mapping) {
    for cell in &diagram.cells {
        if let (PhaseOutcome::Asymmetric, Some(chi)) = (cell.outcome, cell.chi) {
            let [x, y] = map.point([cell.x, cell.xi_s]);
            canvas.text([x, y + 5.0], &format!("{chi:.2}"), text::TICK, Anchor::Middle, style::INK);
        }
    }
}

/// The colour of an outcome, lighter the less unequal the daughters are, so that what is drawn on it can be seen.
fn colour(cell: &PhaseCell) -> String {
    match cell.outcome {
        PhaseOutcome::Symmetric => style::tint(style::SYMMETRIC, 0.55),
        PhaseOutcome::Asymmetric => style::tint(style::ASYMMETRIC, 0.25 + 0.5 * cell.chi.unwrap_or(1.0)),
        PhaseOutcome::Failed => style::tint(style::FAILED, 0.45),
        _ => style::tint(style::UNDECIDED, 0.8),
    }
}

fn entries(diagram: &PhaseDiagram, edges: &Edges) -> Vec<(Key, String)> {
    let has = |outcome: PhaseOutcome| diagram.cells.iter().any(|cell| cell.outcome == outcome);
    let edge = |pitchfork: bool| {
        diagram.columns.iter().flat_map(|c| &c.edges).any(|e| matches!(e, Edge::Pitchfork { .. }) == pitchfork)
    };
    let mut entries = Vec::new();
    for (shown, key, word) in [
        (has(PhaseOutcome::Symmetric), Key::area(&style::tint(style::SYMMETRIC, 0.55)), "symmetric"),
        (has(PhaseOutcome::Asymmetric), Key::area(&style::tint(style::ASYMMETRIC, 0.6)), "asymmetric (χ)"),
        (has(PhaseOutcome::Failed), Key::area(&style::tint(style::FAILED, 0.45)), "stays at rest"),
        (has(PhaseOutcome::Undecided), Key::area(style::UNDECIDED), "undecided"),
        (edge(true) && edges.pitchforks.is_empty(), Key::point(PITCHFORK, Marker::Disc), "pitchfork"),
        (!edges.pitchforks.is_empty(), Key::line(PITCHFORK, None), "pitchfork"),
        (edge(false) && edges.folds.is_empty(), Key::point(FOLD, Marker::Diamond), "fold"),
        (!edges.folds.is_empty(), Key::line(FOLD, None), "fold"),
    ] {
        if shown {
            entries.push((key, word.to_owned()));
        }
    }
    entries
}

/// The interval that each of several values stands for: half-way to its neighbours.
pub fn bins(values: &[f64]) -> Vec<[f64; 2]> {
    let half = |a: Option<&f64>, b: f64| a.map(|a| 0.5 * (b - a));
    (0..values.len())
        .map(|k| {
            let here = values[k];
            let before = k.checked_sub(1).and_then(|k| half(values.get(k), here));
            let after = values.get(k + 1).map(|next| 0.5 * (next - here));
            let [before, after] = [before.or(after), after.or(before)].map(|gap| gap.unwrap_or(0.5));
            [here - before, here + after]
        })
        .collect()
}
