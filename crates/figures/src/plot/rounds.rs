//! Rounds of division of the founders, the model's beside the observed: of one tree, of several scenarios, or over sets of
//! constants; below them how many cells there are in the end.

use crate::drawing::legend::{self, Key, Marker};
use crate::drawing::panel::{Axis, Mapping, Panel, widened};
use crate::drawing::style::{self, text};
use crate::drawing::{Anchor, Canvas, Drawing, Stroke};
use crate::lineage::{Lineage, ObservedRounds, Tree, founder_rounds};
use crate::study::{LineageRanges, Range};

/// Height of the chart of rounds, and of that of cells.
const CHARTS: [f64; 2] = [400.0, 260.0];

/// Fewest, mean and most rounds and terminal cells of a founder, each with a range if it has one.
#[derive(Clone, Copy, Debug)]
struct Bar {
    min: Range,
    mean: Range,
    max: Range,
    terminal: Range,
}

/// What is set side by side for all founders.
struct Set {
    name: String,
    colour: String,
    /// By founder; none that was never born, or of which nothing was observed.
    bars: Vec<Option<Bar>>,
}

fn exactly(value: f64) -> Range {
    Range { p5: value, p50: value, p95: value }
}

/// Draws one tree.
pub fn draw(tree: &Tree) -> Drawing {
    let set = Set { name: "model".to_owned(), colour: style::MODEL.to_owned(), bars: bars(tree, &tree.lineage) };
    picture(&tree.lineage, vec![set])
}

/// Draws scenarios side by side: each under its name, beside what was observed of the first that has any of the founder.
pub fn draw_scenarios(scenarios: &[(&str, &Tree)]) -> Option<Drawing> {
    let (_, first) = scenarios.first()?;
    // Black is what was observed.
    let hues = &style::SERIES[1..];
    let colour = |k: usize| {
        if scenarios.len() <= hues.len() { hues[k % hues.len()].to_owned() } else { style::ramp(k, scenarios.len()) }
    };
    let sets = scenarios.iter().enumerate().map(|(k, (name, tree))| Set {
        name: (*name).to_owned(),
        colour: colour(k),
        bars: bars(tree, &first.lineage),
    });
    Some(picture(&first.lineage, sets.collect()))
}

/// Draws a lineage over sets of constants: medians with the ranges that hold 90 % of the weight.
pub fn draw_ranges(lineage: &Lineage, ranges: &LineageRanges) -> Drawing {
    let bar = |name: &str| {
        let rounds = ranges.founders.iter().find(|founder| founder.name == name)?.rounds?;
        Some(Bar { min: rounds.min, mean: rounds.mean, max: rounds.max, terminal: rounds.terminal })
    };
    let bars = lineage.founders.iter().map(|founder| bar(&founder.name)).collect();
    let name = format!("model, median and 5–95 % of {} sets of constants", ranges.members);
    picture(lineage, vec![Set { name, colour: style::MODEL.to_owned(), bars }])
}

/// The bars of a tree, in the order of another lineage's founders.
fn bars(tree: &Tree, order: &Lineage) -> Vec<Option<Bar>> {
    let rows = founder_rounds(tree);
    let bar = |name: &str| {
        let founder = tree.lineage.founders.iter().position(|founder| founder.name == name)?;
        let rounds = rows.iter().find(|row| row.founder == founder)?.rounds?;
        Some(Bar {
            min: exactly(f64::from(rounds.min)),
            mean: exactly(rounds.mean),
            max: exactly(f64::from(rounds.max)),
            terminal: exactly(f64::from(rounds.terminal)),
        })
    };
    order.founders.iter().map(|founder| bar(&founder.name)).collect()
}

/// What was observed, as far as it is known: a mean alone stands for fewest and most too.
fn observed(of: &ObservedRounds) -> Option<Bar> {
    let (min, max) = (of.min.map(f64::from), of.max.map(f64::from));
    let mean = of.mean.or(min.zip(max).map(|(min, max)| 0.5 * (min + max))).or(min).or(max)?;
    let terminal = of.terminal.map_or(f64::NAN, f64::from);
    Some(Bar {
        min: exactly(min.unwrap_or(mean)),
        mean: exactly(of.mean.unwrap_or(f64::NAN)),
        max: exactly(max.unwrap_or(mean)),
        terminal: exactly(terminal),
    })
}

fn picture(lineage: &Lineage, mut sets: Vec<Set>) -> Drawing {
    let seen: Vec<Option<Bar>> =
        lineage.founders.iter().map(|founder| founder.observed.as_ref().and_then(observed)).collect();
    if seen.iter().any(Option::is_some) {
        sets.push(Set { name: "observed".to_owned(), colour: style::OBSERVED.to_owned(), bars: seen });
    }
    let founders = lineage.founders.len();
    let width = (140.0 + founders as f64 * (34.0 + 15.0 * sets.len() as f64)).clamp(760.0, 4000.0);
    let entries: Vec<(Key, String)> =
        sets.iter().map(|set| (Key::point(&set.colour, Marker::Disc), set.name.clone())).collect();
    let mut canvas = Canvas::new(width, 110.0 + CHARTS[0] + CHARTS[1] + legend::height(width - 40.0, &entries));
    let title = format!("{}: rounds of division from each founder", lineage.name);
    canvas.text([24.0, 30.0], &title, text::TITLE, Anchor::Start, style::INK);
    let bars = "bars from the fewest to the most rounds, discs at the mean";
    canvas.text([24.0, 54.0], bars, text::TICK, Anchor::Start, style::MUTED);
    let top = 66.0 + legend::rows(&mut canvas, [24.0, 62.0], width - 40.0, &entries);
    let all = || sets.iter().flat_map(|set| set.bars.iter().flatten());
    let most = all().map(|bar| bar.max.p95).filter(|v| v.is_finite()).fold(1.0, f64::max);
    let founder_axis = |label: &str| Axis::new(label, [-0.5, founders as f64 - 0.5]).every(1.0).unnumbered();
    let rounds = Axis::new("rounds", [-0.4, most + 0.8]).every(if most > 14.0 { 4.0 } else { 2.0 });
    let panel = Panel::new([0.0, top], [width, CHARTS[0]], founder_axis(""), rounds);
    let map = panel.draw(&mut canvas, &[], |_, _| {});
    each(&sets, |k, place, set, bar| range_bar(&mut canvas, &map, [k, place], set, bar));
    names(&mut canvas, lineage, &map);
    let cells = widened(all().flat_map(|bar| [bar.terminal.p5, bar.terminal.p95]), 0.0);
    let cells = Axis::new("terminal cells", [0.7, (1.6 * cells[1]).max(10.0)]).logarithmic();
    let panel = Panel::new([0.0, top + CHARTS[0]], [width, CHARTS[1]], founder_axis("founder"), cells);
    let map = panel.draw(&mut canvas, &[], |_, _| {});
    each(&sets, |k, place, set, bar| count(&mut canvas, &map, [k, place], set, bar));
    names(&mut canvas, lineage, &map);
    canvas.finish()
}

/// Every bar with the number of its founder and how far aside of it, in founders, its set stands.
fn each(sets: &[Set], mut draw: impl FnMut(f64, f64, &Set, &Bar)) {
    let count = sets.len() as f64;
    for (k, set) in sets.iter().enumerate() {
        let aside = (k as f64 - 0.5 * (count - 1.0)) * 0.7 / count.max(2.0);
        for (founder, bar) in set.bars.iter().enumerate() {
            if let Some(bar) = bar {
                draw(founder as f64, aside, set, bar);
            }
        }
    }
}

fn range_bar(canvas: &mut Canvas, map: &Mapping, [founder, aside]: [f64; 2], set: &Set, bar: &Bar) {
    let x = founder + aside;
    let at = |y: f64| map.point([x, y]);
    let wide = Stroke::solid(&set.colour, 5.0);
    canvas.polyline(&[at(bar.min.p50), at(bar.max.p50)], wide);
    for end in [bar.min.p50, bar.max.p50] {
        let [x, y] = at(end);
        canvas.polyline(&[[x - 5.0, y], [x + 5.0, y]], Stroke::solid(&set.colour, 3.0));
    }
    // Ranges of the ends, beside the bar itself.
    for range in [bar.min, bar.mean, bar.max] {
        whisker(canvas, at(range.p5), at(range.p95), &set.colour);
    }
    if bar.mean.p50.is_finite() {
        legend::point(canvas, at(bar.mean.p50), 6.2, Marker::Disc, &set.colour);
    }
}

fn whisker(canvas: &mut Canvas, low: [f64; 2], high: [f64; 2], colour: &str) {
    if (low[1] - high[1]).abs() > 0.5 {
        let aside = |[x, y]: [f64; 2]| [x + 9.0, y];
        legend::error_bar(canvas, [aside(low), aside(high)], 3.0, Stroke::solid(colour, 1.8));
    }
}

fn count(canvas: &mut Canvas, map: &Mapping, [founder, aside]: [f64; 2], set: &Set, bar: &Bar) {
    if bar.terminal.p50.is_finite() && bar.terminal.p50 > 0.0 {
        let at = |y: f64| map.point([founder + aside, y]);
        whisker(canvas, at(bar.terminal.p5), at(bar.terminal.p95), &set.colour);
        legend::point(canvas, at(bar.terminal.p50), 6.2, Marker::Disc, &set.colour);
    }
}

/// The names of the founders under a chart.
fn names(canvas: &mut Canvas, lineage: &Lineage, map: &Mapping) {
    let bottom = map.frame()[3];
    for (k, founder) in lineage.founders.iter().enumerate() {
        let [x, _] = map.point([k as f64, 1.0]);
        canvas.text([x, bottom + 24.0], &founder.name, text::TICK, Anchor::Middle, style::INK);
    }
}
