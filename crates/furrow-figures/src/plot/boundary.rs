//! The boundary of division over a parameter: curves of pitchforks and folds in the plane of the parameter and
//! activity, and the boundary's position at the cell's own activity.

use crate::drawing::font;
use crate::drawing::legend::{Key, Legend, Marker, titled};
use crate::drawing::panel::{Axis, Chart, Mark, Rows, widened};
use crate::drawing::style::{self, FOLD, PITCHFORK, text};
use crate::drawing::{Anchor, Canvas, Label, Stroke};
use furrow_analysis::BoundaryStudy;
use furrow_cell::Parameter;
use furrow_mechanics::equilibria::Criticality;
use furrow_mechanics::equilibria::curves::{Curve, CurvePoint};

const WIDTH: f64 = 940.0;
const CHART: f64 = 548.0;

/// Draws the curves.
pub fn draw(of: &BoundaryStudy) -> Canvas {
    let title = format!("Where division begins, {}", style::described(&of.cell, &[of.parameter, Parameter::XiS]));
    let (mut canvas, top) = titled(WIDTH, CHART, &title, &legend(of));
    let bent = || of.bent.iter().flatten().map(|(_, curve)| curve);
    let others = || of.folds.iter().chain(of.azimuthal.iter().flatten().map(|(_, curve)| curve)).chain(bent());
    let points =
        || of.pitchforks.iter().flat_map(|curve| &curve.points).chain(others().flat_map(|curve| &curve.points));
    let place = |point: &CurvePoint| [point.value, point.xi_s];
    let bent_critical = of.bent_critical.as_ref().map(place);
    let critical: Vec<[f64; 2]> = bent_critical.into_iter().chain(of.critical.as_ref().map(place)).collect();
    let heights = points().map(|p| p.xi_s).chain(critical.iter().map(|at| at[1]));
    let across = of.range.into_iter().chain(critical.iter().map(|at| at[0]));
    let x = Axis::new(style::parameter(of.parameter, &of.cell.cue), widened(across, 0.02));
    let mut chart = Chart::new(&mut canvas, [0.0, top], [WIDTH, CHART], x, Axis::over(style::ACTIVITY, heights));
    for fold in &of.folds {
        chart.line(fold.points.iter().chain(fold.cusp().as_ref()).map(place), Stroke::solid(FOLD, style::CURVE));
    }
    for (m, curve) in of.azimuthal.iter().flatten() {
        chart.line(curve.points.iter().map(place), Stroke::solid(style::azimuthal(*m), style::CURVE));
    }
    for (name, curve) in of.bent.iter().flatten() {
        for (kind, piece) in by_criticality(curve) {
            let dash = if kind == Some(Criticality::Subcritical) { style::DOTTED } else { BENT_DASHES };
            chart.line(piece.iter().map(place), Stroke::dashed(bent_colour(name), style::CURVE, dash));
        }
    }
    for (kind, piece) in of.pitchforks.iter().flat_map(by_criticality) {
        let dash = (kind == Some(Criticality::Subcritical)).then_some(style::DOTTED);
        chart.line(piece.iter().map(place), Stroke { colour: PITCHFORK, width: style::CURVE + 0.4, dash });
    }
    let bent_rings =
        of.bent.iter().flatten().flat_map(|(name, curve)| {
            curve.degenerate.iter().map(|point| (place(point), Marker::Ring, bent_colour(name)))
        });
    let rings =
        of.pitchforks.iter().flat_map(|curve| &curve.degenerate).map(|point| (place(point), Marker::Ring, PITCHFORK));
    let cusps = of.cusps.iter().map(|point| (place(point), Marker::Diamond, FOLD));
    let triangles = critical.iter().map(|at| (*at, Marker::Triangle, style::ASYMMETRIC));
    let marks: Vec<Mark> = bent_rings.chain(rings).chain(cusps).chain(triangles).collect();
    // Texts that would run into each other go into different rows.
    let mut rows = Rows::default();
    for point in critical {
        let at = chart.at(point);
        let [left, _, _, bottom] = chart.frame;
        let thin = Stroke::dashed(style::ASYMMETRIC, 1.4, [4.0, 4.0]);
        chart.canvas.polyline(&[[left, at[1]], at, [at[0], bottom]], thin);
        // Rounded, to hide the noise of the last digits.
        let word = format!("{:.4} at ξₛ = {}", point[0], (point[1] * 1e6).round() * 1e-6);
        let right = at[0] > 0.6 * WIDTH;
        let (x, anchor) = if right { (at[0] - 14.0, Anchor::End) } else { (at[0] + 14.0, Anchor::Start) };
        let width = font::width(&word, text::LABEL) + 24.0;
        let row = rows.free(if right { [x - width, x] } else { [x, x + width] });
        let place = [x, at[1] - 12.0 - 22.0 * row as f64];
        chart.canvas.label(Label::new(place, &word, text::LABEL, anchor, style::ASYMMETRIC).over(style::WHITE));
    }
    chart.marks(&marks, 6.5);
    canvas
}

/// Dashes of the curves of bent states.
pub(super) const BENT_DASHES: [f64; 2] = [9.0, 4.0];

/// The colour of a curve of bent states: of the same event with axial symmetry.
pub(super) fn bent_colour(name: &str) -> style::Colour {
    match name {
        "fold" => FOLD,
        "threshold" => style::azimuthal(1),
        _ => PITCHFORK,
    }
}

impl Legend {
    /// The same with the curves of bent states.
    pub(super) fn with_bent<'a>(self, curves: impl IntoIterator<Item = &'a (&'static str, Curve)>) -> Legend {
        self.with_all(curves.into_iter().map(|(name, _)| {
            let key = Key::Dashes(bent_colour(name), BENT_DASHES);
            (key, format!("{name} of bent states"))
        }))
    }
}

fn legend(of: &BoundaryStudy) -> Legend {
    let pitchforks = || of.pitchforks.iter().flat_map(|curve| &curve.points);
    let is = |kind: Criticality| pitchforks().any(|point| point.criticality() == Some(kind));
    let critical = Key::Point(style::ASYMMETRIC, Marker::Triangle);
    let bent = of.bent.iter().flatten().map(|(_, curve)| curve);
    let changes = bent.chain(&of.pitchforks).any(|curve| !curve.degenerate.is_empty());
    Legend::default()
        .with_if(is(Criticality::Supercritical), Key::Line(PITCHFORK), "pitchfork, supercritical")
        .with_if(is(Criticality::Subcritical), Key::Dashes(PITCHFORK, style::DOTTED), "subcritical")
        .with_if(changes, Key::Point(PITCHFORK, Marker::Ring), "criticality changes")
        .with_if(!of.folds.is_empty(), Key::Line(FOLD), "fold")
        .with_if(!of.cusps.is_empty(), Key::Point(FOLD, Marker::Diamond), "cusp")
        .with_if(of.critical.is_some(), critical, "critical value")
        .with_azimuthal(of.azimuthal.iter().flatten())
        .with_bent(of.bent.iter().flatten())
}

/// A curve of pitchforks split where its criticality changes; neighbouring pieces share their end point.
fn by_criticality(curve: &Curve) -> Vec<(Option<Criticality>, Vec<CurvePoint>)> {
    let mut found: Vec<(Option<Criticality>, Vec<CurvePoint>)> = Vec::new();
    for point in &curve.points {
        let kind = point.criticality();
        match found.last_mut() {
            Some((same, piece)) if *same == kind => piece.push(*point),
            Some((_, piece)) => {
                // The located point of the change, or else the curve's own point.
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
