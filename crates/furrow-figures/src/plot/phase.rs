//! Outcomes over a plane of one parameter and activity, with the exact edges on top of them.

use crate::drawing::legend::{Key, Legend, Marker, titled};
use crate::drawing::panel::{Axis, Chart, bins, widened};
use crate::drawing::style::{self, FOLD, PITCHFORK, WHITE, text};
use crate::drawing::{Anchor, Canvas, Stroke};
use furrow_analysis::Edges;
use furrow_cell::Parameter;
use furrow_lineage::batch::phase::PhaseOutcome;
use furrow_lineage::batch::{PhaseDiagram, PhasePlane};
use furrow_mechanics::division::Outcome;
use furrow_mechanics::equilibria::at_rest::Edge;

const WIDTH: f64 = 940.0;
const CHART: f64 = 588.0;
/// Most values across and upwards that have their χ written in.
const WRITTEN: [usize; 2] = [13, 15];

/// Draws a diagram.
pub fn draw(plane: &PhasePlane, diagram: &PhaseDiagram, edges: &Edges) -> Canvas {
    let title = format!("Outcomes of division, {}", style::described(&plane.cell, &[plane.parameter, Parameter::XiS]));
    let (mut canvas, top) = titled(WIDTH, CHART, &title, &legend(diagram, edges));
    let (columns, rows) = (bins(&plane.across), bins(&plane.up));
    let range = |bins: &[[f64; 2]]| widened(bins.iter().flatten().copied(), 0.0);
    let (x, y) =
        (Axis::new(style::parameter(plane.parameter), range(&columns)), Axis::new(style::ACTIVITY, range(&rows)));
    let mut chart = Chart::new(&mut canvas, [0.0, top], [WIDTH, CHART], x, y);
    chart.tiles(diagram.cells.iter().enumerate().filter_map(|(k, cell)| {
        let colour = style::tile(outcome(cell.outcome), cell.chi);
        Some((*columns.get(k / rows.len())?, *rows.get(k % rows.len())?, colour))
    }));
    for (curves, colour) in [(&edges.folds, FOLD), (&edges.pitchforks, PITCHFORK)] {
        for curve in curves {
            // A white rim is seen on any colour.
            for stroke in [Stroke::solid(WHITE, style::CURVE + 2.6), Stroke::solid(colour, style::CURVE)] {
                chart.line(curve.points.iter().map(|point| [point.value, point.xi_s]), stroke);
            }
        }
    }
    if columns.len() <= WRITTEN[0] && rows.len() <= WRITTEN[1] {
        for cell in &diagram.cells {
            if let (PhaseOutcome::Asymmetric, Some(chi)) = (cell.outcome, cell.chi) {
                let [x, y] = chart.at([cell.x, cell.xi_s]);
                chart.canvas.text([x, y + 5.0], &format!("{chi:.2}"), text::TICK, Anchor::Middle, style::INK);
            }
        }
    }
    for column in &diagram.columns {
        for edge in &column.edges {
            let (known, marker, colour) = match edge {
                Edge::Pitchfork { .. } => (&edges.pitchforks, Marker::Disc, PITCHFORK),
                _ => (&edges.folds, Marker::Diamond, FOLD),
            };
            // A curve shows the same at every value across.
            if known.is_empty() && chart.holds([column.x, edge.xi_s()]) {
                chart.point([column.x, edge.xi_s()], 5.0, marker, colour);
            }
        }
    }
    canvas
}

fn outcome(outcome: PhaseOutcome) -> Option<Outcome> {
    match outcome {
        PhaseOutcome::Symmetric => Some(Outcome::Symmetric),
        PhaseOutcome::Asymmetric => Some(Outcome::Asymmetric),
        PhaseOutcome::Failed => Some(Outcome::Arrested),
        _ => None,
    }
}

fn legend(diagram: &PhaseDiagram, edges: &Edges) -> Legend {
    let mut legend = Legend::default();
    for (found, word) in [
        (PhaseOutcome::Symmetric, "symmetric"),
        (PhaseOutcome::Asymmetric, "asymmetric (χ)"),
        (PhaseOutcome::Failed, "stays at rest"),
        (PhaseOutcome::Undecided, "undecided"),
    ] {
        let shown = diagram.cells.iter().any(|cell| cell.outcome == found);
        legend = legend.with_if(shown, Key::Area(style::tile(outcome(found), Some(0.7))), word);
    }
    let edge = |pitchfork: bool| {
        diagram.columns.iter().flat_map(|c| &c.edges).any(|e| matches!(e, Edge::Pitchfork { .. }) == pitchfork)
    };
    let (pitchforks, folds) = (!edges.pitchforks.is_empty(), !edges.folds.is_empty());
    legend
        .with_if(pitchforks, Key::Line(PITCHFORK), "pitchfork")
        .with_if(!pitchforks && edge(true), Key::Point(PITCHFORK, Marker::Disc), "pitchfork")
        .with_if(folds, Key::Line(FOLD), "fold")
        .with_if(!folds && edge(false), Key::Point(FOLD, Marker::Diamond), "fold")
}
