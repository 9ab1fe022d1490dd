//! Measured χ of cells with intervals, and each hypothesis as a line; below, what was observed beside χ.

use furrow_analysis::hypotheses::{CellScore, HypothesisTest, OthersScore, Quantity, TestedHypothesis};

use crate::drawing::legend::{Key, Legend, Marker, titled};
use crate::drawing::panel::{Axis, Chart};
use crate::drawing::style::{self, Colour, SERIES};
use crate::drawing::{Canvas, Stroke};

const CHART: f64 = 488.0;
/// Height of a chart of rounds or lifetimes.
const BELOW: f64 = 340.0;
/// How far from a name the first and the last value of a chart below are, as a share of the distance of names.
const ASIDE: f64 = 0.3;
/// Width for each cell, and limits of the width of the picture.
const CELL: f64 = 56.0;
const WIDTHS: [f64; 2] = [900.0, 4000.0];
/// Longest name of a hypothesis in the legend, in characters.
const LONGEST: usize = 60;

/// Draws the test.
pub fn draw(found: &HypothesisTest) -> Canvas {
    let Some(TestedHypothesis { cells, others, .. }) = found.hypotheses.first() else {
        return titled(WIDTHS[0], 0.0, "", &Legend::default()).0;
    };
    let colour = |k: usize| style::series(k, found.hypotheses.len(), &SERIES[1..]);
    let entries = found.hypotheses.iter().enumerate().map(|(k, tested)| (Key::Line(colour(k)), named(tested)));
    let rests = found.hypotheses.iter().any(|tested| !tested.resting.is_empty());
    let legend = Legend::default()
        .with(Key::Point(style::OBSERVED, Marker::Disc), "measured, mean with its 95 % interval")
        .with_all(entries)
        .with_if(rests, Key::Dashes(style::MUTED, style::DASHED), "past a cell that does not divide");
    let most = others.iter().map(|others| others.rows.len()).fold(cells.len(), usize::max);
    let width = (160.0 + CELL * most as f64).clamp(WIDTHS[0], WIDTHS[1]);
    let height = CHART + BELOW * others.len() as f64;
    let (mut canvas, top) = titled(width, height, "Size asymmetry of each cell under the hypotheses", &legend);
    let ends = cells.iter().flat_map(|cell| cell.interval.unwrap_or([cell.measured; 2]));
    let chi = found.hypotheses.iter().flat_map(|tested| tested.cells.iter().filter_map(|cell| cell.chi));
    let [low, high] = ends.chain(chi).fold([0.0, 0.1], |[low, high]: [f64; 2], y| [low.min(y), high.max(y)]);
    let room = 0.06 * (high - low);
    let x = Axis::names("cell that divides", cells.iter().map(|cell| cell.cell.clone()).collect(), false);
    let y = Axis::new(style::CHI, [low - room, high + room]);
    let mut chart = Chart::new(&mut canvas, [0.0, top], [width, CHART], x, y);
    for (k, tested) in found.hypotheses.iter().enumerate() {
        line(&mut chart, &tested.cells, colour(k));
    }
    for (x, CellScore { measured, interval, .. }) in cells.iter().enumerate() {
        if let Some(interval) = interval {
            chart.error_bar(x as f64, *interval, 0.0, 5.0, Stroke::solid(style::OBSERVED, 1.8));
        }
        chart.point([x as f64, *measured], 6.0, Marker::Disc, style::OBSERVED);
    }
    for (k, others) in others.iter().enumerate() {
        let place = [0.0, top + CHART + BELOW * k as f64];
        below(&mut canvas, (place, width), others, found.hypotheses.iter().map(|tested| &tested.others[k]), &colour);
    }
    canvas
}

/// A chart of rounds or lifetimes, observed and in each hypothesis.
fn below<'a>(
    canvas: &mut Canvas,
    (place, width): ([f64; 2], f64),
    observed: &OthersScore,
    hypotheses: impl Iterator<Item = &'a OthersScore> + Clone,
    colour: &dyn Fn(usize) -> Colour,
) {
    let label = match observed.quantity {
        Quantity::Rounds => "mean rounds",
        Quantity::Lifetimes => "lifetime (min)",
    };
    let all = hypotheses.clone().flat_map(|of| of.rows.iter().filter_map(|row| row.model));
    let high = all.chain(observed.rows.iter().map(|row| row.observed)).fold(0.0, f64::max);
    let names = observed.rows.iter().map(|row| row.name.clone()).collect();
    let what = if observed.quantity == Quantity::Rounds { "founder" } else { "founder, and generations below it" };
    let (x, y) = (Axis::names(what, names, false), Axis::new(label, [0.0, 1.06 * high]));
    let mut chart = Chart::new(canvas, place, [width, BELOW], x, y);
    // Side by side, since equal values would hide each other.
    let step = 2.0 * ASIDE / hypotheses.clone().count().max(1) as f64;
    for (x, row) in observed.rows.iter().enumerate() {
        chart.point([x as f64 - ASIDE, row.observed], 6.0, Marker::Disc, style::OBSERVED);
    }
    for (k, of) in hypotheses.enumerate() {
        let aside = step * (k + 1) as f64 - ASIDE;
        let points = of.rows.iter().enumerate().filter_map(|(x, row)| Some([x as f64 + aside, row.model?]));
        chart.points(points, 5.0, Marker::Diamond, colour(k));
    }
}

/// A hypothesis in the legend: its name and its score of left-out embryos.
fn named(tested: &TestedHypothesis) -> String {
    let mut name: String = tested.name.chars().take(LONGEST).collect();
    if name.len() < tested.name.len() {
        name.push('…');
    }
    tested.loo.map_or(name.clone(), |loo| format!("{name} (left out: {loo:+.1})"))
}

/// The line of a hypothesis, dashed across cells that do not divide.
fn line(chart: &mut Chart<'_>, cells: &[CellScore], colour: Colour) {
    let points: Vec<(usize, f64)> = cells.iter().enumerate().filter_map(|(x, cell)| Some((x, cell.chi?))).collect();
    for pair in points.windows(2) {
        let [(a, from), (b, to)] = [pair[0], pair[1]];
        let ends = [[a as f64, from], [b as f64, to]];
        let stroke =
            if b == a + 1 { Stroke::solid(colour, 2.4) } else { Stroke::dashed(style::MUTED, 1.6, style::DASHED) };
        chart.line(ends, stroke);
    }
    chart.points(points.into_iter().map(|(x, chi)| [x as f64, chi]), 5.0, Marker::Diamond, colour);
}
