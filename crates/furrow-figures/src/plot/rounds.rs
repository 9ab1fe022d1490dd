//! Rounds of division of the founders, the model's beside the observed ones: for one tree, for several scenarios, or
//! over sets of constants; below them the final numbers of cells.

use crate::drawing::legend::{Key, Legend, Marker, titled};
use crate::drawing::panel::{Axis, Chart, widened};
use crate::drawing::style::{self, Colour, SERIES};
use crate::drawing::{Canvas, Stroke};
use furrow_analysis::{LineageRanges, Range};
use furrow_lineage::{Founder, Lineage, ObservedRounds, Tree, founder_rounds};

/// Heights of the chart of rounds and the chart of cells.
const CHARTS: [f64; 2] = [400.0, 260.0];

/// Fewest, mean and most rounds and terminal cells of a founder, with ranges.
type Bar = [Range; 4];

/// One of the sets drawn side by side for every founder.
struct Set {
    name: String,
    colour: Colour,
    /// By founder; `None` for a founder that was never born or not observed.
    bars: Vec<Option<Bar>>,
}

fn exactly(value: f64) -> Range {
    Range { p5: value, p50: value, p95: value }
}

/// Draws one tree.
pub fn draw(tree: &Tree) -> Canvas {
    let set = Set { name: "model".to_owned(), colour: style::MODEL, bars: bars(tree, &tree.lineage) };
    picture(&tree.lineage, vec![set])
}

/// Draws scenarios side by side under their names, beside the observed counts of the first scenario's lineage.
pub fn draw_scenarios(scenarios: &[(&str, &Tree)]) -> Option<Canvas> {
    let (_, first) = scenarios.first()?;
    let sets = scenarios.iter().enumerate().map(|(k, (name, tree))| Set {
        name: (*name).to_owned(),
        // Black is reserved for observations.
        colour: style::series(k, scenarios.len(), &SERIES[1..]),
        bars: bars(tree, &first.lineage),
    });
    Some(picture(&first.lineage, sets.collect()))
}

/// Draws a lineage over sets of constants: medians, and ranges with 90 % of the weight.
pub fn draw_ranges(lineage: &Lineage, ranges: &LineageRanges) -> Canvas {
    let bar = |founder: &Founder| {
        let rounds = ranges.founders.iter().find(|other| other.name == founder.name)?.rounds?;
        Some([rounds.min, rounds.mean, rounds.max, rounds.terminal])
    };
    let name = format!("model, median and 5–95 % of {} sets of constants", ranges.members);
    picture(lineage, vec![Set { name, colour: style::MODEL, bars: lineage.founders.iter().map(bar).collect() }])
}

/// The bars of a tree, in the order of another lineage's founders.
fn bars(tree: &Tree, order: &Lineage) -> Vec<Option<Bar>> {
    let rows = founder_rounds(tree);
    let bar = |founder: &Founder| {
        let rounds = rows[tree.lineage.founder_named(&founder.name)?]?;
        Some([rounds.min.into(), rounds.mean, rounds.max.into(), rounds.terminal.into()].map(exactly))
    };
    order.founders.iter().map(bar).collect()
}

/// The observed rounds; a mean without fewest and most replaces both.
fn observed(of: &ObservedRounds) -> Option<Bar> {
    let (min, max) = (of.min.map(f64::from), of.max.map(f64::from));
    let mean = of.mean.or(min.zip(max).map(|(min, max)| 0.5 * (min + max))).or(min).or(max)?;
    let terminal = of.terminal.map_or(f64::NAN, f64::from);
    Some([min.unwrap_or(mean), of.mean.unwrap_or(f64::NAN), max.unwrap_or(mean), terminal].map(exactly))
}

fn picture(lineage: &Lineage, mut sets: Vec<Set>) -> Canvas {
    let seen: Vec<Option<Bar>> =
        lineage.founders.iter().map(|founder| founder.observed.as_ref().and_then(observed)).collect();
    if seen.iter().any(Option::is_some) {
        sets.push(Set { name: "observed".to_owned(), colour: style::OBSERVED, bars: seen });
    }
    let names: Vec<String> = lineage.founders.iter().map(|founder| founder.name.clone()).collect();
    let width = (140.0 + names.len() as f64 * (34.0 + 15.0 * sets.len() as f64)).clamp(760.0, 4000.0);
    let entries = sets.iter().map(|set| (Key::Point(set.colour, Marker::Disc), set.name.as_str()));
    let legend = Legend::default().with_all(entries);
    let title = format!(
        "{}: rounds of division from each founder\nbars from the fewest to the most rounds, discs at the mean",
        lineage.name
    );
    let (mut canvas, top) = titled(width, CHARTS[0] + CHARTS[1], &title, &legend);
    let all = || sets.iter().flat_map(|set| set.bars.iter().flatten());
    let most = all().map(|[_, _, max, _]| max.p95).filter(|v| v.is_finite()).fold(1.0, f64::max);
    let (x, rounds) = (Axis::names("", names.clone(), false), Axis::new("rounds", [-0.4, most + 0.8]));
    let mut chart = Chart::new(&mut canvas, [0.0, top], [width, CHARTS[0]], x, rounds);
    each(&sets, |x, colour, [min, mean, max, _]| {
        let ends = [min.p50, max.p50];
        chart.error_bar(x, ends, 0.0, 5.0, Stroke::solid(colour, 3.0));
        chart.line(ends.map(|y| [x, y]), Stroke::solid(colour, 5.0));
        // Ranges of the ends and of the mean, beside the bar.
        for range in [min, mean, max] {
            whisker(&mut chart, x, range, colour);
        }
        if mean.p50.is_finite() {
            chart.point([x, mean.p50], 6.2, Marker::Disc, colour);
        }
    });
    let cells = widened(all().flat_map(|[.., terminal]| [terminal.p5, terminal.p95]), 0.0);
    let cells = Axis::new("terminal cells", [0.7, (1.6 * cells[1]).max(10.0)]).logarithmic();
    let x = Axis::names("founder", names, false);
    let mut chart = Chart::new(&mut canvas, [0.0, top + CHARTS[0]], [width, CHARTS[1]], x, cells);
    each(&sets, |x, colour, [.., terminal]| {
        if terminal.p50.is_finite() && terminal.p50 > 0.0 {
            whisker(&mut chart, x, terminal, colour);
            chart.point([x, terminal.p50], 6.2, Marker::Disc, colour);
        }
    });
    canvas
}

/// Calls `draw` for every bar with its position, sets side by side at their founder, and its colour.
fn each(sets: &[Set], mut draw: impl FnMut(f64, Colour, Bar)) {
    let count = sets.len() as f64;
    for (k, set) in sets.iter().enumerate() {
        let aside = (k as f64 - 0.5 * (count - 1.0)) * 0.7 / count.max(2.0);
        for (founder, bar) in set.bars.iter().enumerate() {
            bar.iter().for_each(|bar| draw(founder as f64 + aside, set.colour, *bar));
        }
    }
}

fn whisker(chart: &mut Chart<'_>, x: f64, range: Range, colour: Colour) {
    if range.p95 > range.p5 {
        chart.error_bar(x, [range.p5, range.p95], 9.0, 3.0, Stroke::solid(colour, 1.8));
    }
}
