//! Outcomes over a plane of one parameter and activity, with the exact edges on top of them.

use super::boundary::{BENT_DASHES, bent_colour};
use crate::drawing::font;
use crate::drawing::legend::{Key, Legend, Marker, titled};
use crate::drawing::panel::{Axis, Chart, bins, widened};
use crate::drawing::style::{self, Colour, FOLD, PITCHFORK, WHITE, text};
use crate::drawing::{Anchor, Canvas, Label, Stroke, scale};
use furrow_analysis::Edges;
use furrow_cell::Parameter;
use furrow_lineage::batch::phase::PhaseOutcome;
use furrow_lineage::batch::{PhaseDiagram, PhasePlane};
use furrow_mechanics::division::Outcome;
use furrow_mechanics::equilibria::at_rest::Edge;
use furrow_mechanics::equilibria::curves::Curve;

const WIDTH: f64 = 940.0;
const CHART: f64 = 588.0;
/// Most columns and rows for which χ is written in the tiles.
const WRITTEN: [usize; 2] = [13, 15];

/// Draws a diagram.
pub fn draw(plane: &PhasePlane, diagram: &PhaseDiagram, edges: &Edges) -> Canvas {
    let title = format!("Outcomes of division, {}", style::described(&plane.cell, &[plane.parameter, Parameter::XiS]));
    let (mut canvas, top) = titled(WIDTH, CHART, &title, &legend(diagram, edges));
    let (columns, rows) = (bins(&plane.across), bins(&plane.up));
    let range = |bins: &[[f64; 2]]| widened(bins.iter().flatten().copied(), 0.0);
    let (x, y) = (
        Axis::new(style::parameter(plane.parameter, &plane.cell.cue), range(&columns)),
        Axis::new(style::ACTIVITY, range(&rows)),
    );
    let unequal = diagram.cells.iter().any(|cell| cell.outcome == PhaseOutcome::Asymmetric);
    let width = if unequal { WIDTH - scale::WIDTH } else { WIDTH };
    let mut chart = Chart::new(&mut canvas, [0.0, top], [width, CHART], x, y);
    chart.tiles(diagram.cells.iter().enumerate().filter_map(|(k, cell)| {
        let colour = style::tile(outcome(cell.outcome), cell.chi);
        Some((*columns.get(k / rows.len())?, *rows.get(k % rows.len())?, colour))
    }));
    for (name, curve) in &edges.bent {
        let at = || curve.points.iter().map(|point| [point.value, point.xi_s]);
        chart.line(at(), Stroke::solid(WHITE, style::CURVE + 2.6));
        chart.line(at(), Stroke::dashed(bent_colour(name), style::CURVE, BENT_DASHES));
    }
    for (curve, colour) in lines(edges) {
        // A white rim is visible on any colour.
        for stroke in [Stroke::solid(WHITE, style::CURVE + 2.6), Stroke::solid(colour, style::CURVE)] {
            chart.line(curve.points.iter().map(|point| [point.value, point.xi_s]), stroke);
        }
    }
    let points = marks(&mut chart, diagram, edges);
    if columns.len() <= WRITTEN[0] && rows.len() <= WRITTEN[1] {
        let lines = lines(edges).map(|(curve, _)| curve.points.iter().map(|p| chart.at([p.value, p.xi_s])).collect());
        let busy: Vec<Vec<[f64; 2]>> = lines.chain(points.into_iter().map(|at| vec![at])).collect();
        for (k, cell) in diagram.cells.iter().enumerate() {
            if let (PhaseOutcome::Asymmetric, Some(chi)) = (cell.outcome, cell.chi) {
                let (column, row) = (columns[k / rows.len()], rows[k % rows.len()]);
                let middle = chart.at([cell.x, cell.xi_s]);
                let tile = [chart.at([column[0], row[1]]), chart.at([column[1], row[0]])];
                number(chart.canvas, chi, middle, tile, &busy);
            }
        }
    }
    if unequal {
        scale::chi(&mut chart);
    }
    canvas
}

/// All curves with their colours.
fn lines(edges: &Edges) -> impl Iterator<Item = (&Curve, Colour)> {
    let coloured = |colour| move |curve| (curve, colour);
    let azimuthal = edges.azimuthal.iter().map(|(m, curve)| (curve, style::azimuthal(*m)));
    let folds = edges.folds.iter().map(coloured(FOLD));
    folds.chain(edges.pitchforks.iter().map(coloured(PITCHFORK))).chain(azimuthal)
}

/// Writes χ in its tile, clear of lines if possible.
fn number(canvas: &mut Canvas, chi: f64, middle: [f64; 2], tile: [[f64; 2]; 2], busy: &[Vec<[f64; 2]>]) {
    let word = format!("{chi:.2}");
    let half = [0.5 * font::width(&word, text::TICK) + 4.0, 10.0];
    let free = |at: &[f64; 2]| {
        let hit = |p: [f64; 2]| (0..2).all(|c| (p[c] - at[c]).abs() < half[c]);
        !busy.iter().any(|line| line.windows(2).any(|ends| near(ends, hit)) || line.first().is_some_and(|p| hit(*p)))
    };
    // The greatest displacement that keeps the number in its tile.
    let reach = [0, 1].map(|c: usize| (0.5 * (tile[1][c] - tile[0][c]).abs() - half[c]).max(0.0));
    let places = STEPS.into_iter().map(|[x, y]| [middle[0] + x * reach[0], middle[1] + y * reach[1]]);
    let at = places.clone().find(free).unwrap_or(middle);
    let label = Label::new([at[0], at[1] + 5.0], &word, text::TICK, Anchor::Middle, style::INK);
    canvas.label(label.over(style::shade(chi)));
}

/// Positions of a number in its tile, the best first, as shares of the way from the middle to the edge.
const STEPS: [[f64; 2]; 13] = [
    [0.0, 0.0],
    [0.0, -0.5],
    [0.0, 0.5],
    [0.0, -1.0],
    [0.0, 1.0],
    [-0.5, -0.5],
    [0.5, -0.5],
    [-0.5, 0.5],
    [0.5, 0.5],
    [-1.0, -1.0],
    [1.0, -1.0],
    [-1.0, 1.0],
    [1.0, 1.0],
];

/// Whether the line between two points meets the region that `hit` describes.
fn near(ends: &[[f64; 2]], hit: impl Fn([f64; 2]) -> bool) -> bool {
    let [a, b] = [ends[0], ends[1]];
    let pieces = (0.5 * (b[0] - a[0]).hypot(b[1] - a[1])).ceil().clamp(1.0, 2000.0) as usize;
    (0..=pieces).map(|k| k as f64 / pieces as f64).any(|s| hit([0, 1].map(|c: usize| a[c] + s * (b[c] - a[c]))))
}

/// Draws the edges of each column that belong to no known curve, and returns their positions.
fn marks(chart: &mut Chart<'_>, diagram: &PhaseDiagram, edges: &Edges) -> Vec<[f64; 2]> {
    let mut drawn = Vec::new();
    for column in &diagram.columns {
        for edge in &column.edges {
            let (lone, marker, colour) = match edge {
                Edge::Pitchfork { .. } => (edges.pitchforks.is_empty(), Marker::Disc, PITCHFORK),
                Edge::BentPitchfork { .. } => (edges.bent.is_empty(), Marker::Disc, PITCHFORK),
                Edge::BentFold { .. } => (edges.bent.is_empty(), Marker::Diamond, FOLD),
                Edge::Hopf { .. } => (true, Marker::Ring, style::INK),
                _ => (edges.folds.is_empty(), Marker::Diamond, FOLD),
            };
            // A known curve shows the edges of every column.
            if lone && chart.holds([column.x, edge.xi_s()]) {
                chart.point([column.x, edge.xi_s()], 5.0, marker, colour);
                drawn.push(chart.at([column.x, edge.xi_s()]));
            }
        }
    }
    drawn
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
    let edge = |is_it: fn(&Edge) -> bool| diagram.columns.iter().flat_map(|column| &column.edges).any(is_it);
    let is_pitchfork = |edge: &Edge| matches!(edge, Edge::Pitchfork { .. });
    let is_hopf = |edge: &Edge| matches!(edge, Edge::Hopf { .. });
    let is_fold = |edge: &Edge| !matches!(edge, Edge::Pitchfork { .. } | Edge::Hopf { .. });
    let (pitchforks, folds) = (!edges.pitchforks.is_empty(), !edges.folds.is_empty());
    Legend::default()
        .with_tiles(|tile| diagram.cells.iter().any(|cell| outcome(cell.outcome) == tile))
        .with_if(pitchforks, Key::Line(PITCHFORK), "pitchfork")
        .with_if(!pitchforks && edge(is_pitchfork), Key::Point(PITCHFORK, Marker::Disc), "pitchfork")
        .with_if(folds, Key::Line(FOLD), "fold")
        .with_if(!folds && edge(is_fold), Key::Point(FOLD, Marker::Diamond), "fold")
        .with_if(edge(is_hopf), Key::Point(style::INK, Marker::Ring), "Hopf point")
        .with_azimuthal(&edges.azimuthal)
        .with_bent(&edges.bent)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_number_gives_way_to_a_line() {
        let tile = [[0.0, 0.0], [120.0, 80.0]];
        let written = |busy: &[Vec<[f64; 2]>]| {
            let mut canvas = Canvas::new(120.0, 80.0);
            number(&mut canvas, 0.25, [60.0, 40.0], tile, busy);
            canvas
                .svg()
                .split("<text x=\"")
                .nth(1)
                .map(|rest| rest.split(" font").next().unwrap_or_default().to_owned())
        };
        let place = |x: f64, y: f64| Some(format!("{x}\" y=\"{y}\""));
        assert_eq!(written(&[]), place(60.0, 45.0));
        // A line across the middle, then a second one just above it.
        let across = |y: f64| vec![[0.0, y], [120.0, y]];
        assert_eq!(written(&[across(40.0)]), place(60.0, 30.0));
        assert_eq!(written(&[across(40.0), across(25.0)]), place(60.0, 60.0));
        // A marker, which is a single point.
        assert_eq!(written(&[vec![[60.0, 40.0]]]), place(60.0, 30.0));
    }
}
