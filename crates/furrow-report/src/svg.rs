//! The lineage as a drawing.

use super::summary::{Generation, TreeSummary};
use super::table::{outcome_name, short};
use super::time_axis::{TimeAxis, TimeScale};
use super::{escape, rounded};
use furrow_cell::Cell;
use furrow_lineage::{CellId, CellTimes, Lineage, Side, Tree};
use furrow_mechanics::division::Outcome;
use std::fmt::Write;

/// The measures of a drawing, in its own units.
struct Frame {
    /// Most branch ends drawn; a larger tree is cut after its first generations.
    max_ends: usize,
    left: f64,
    right: f64,
    top: f64,
    bottom: f64,
    /// Distance from one generation to the next.
    row: f64,
    /// Least distance between neighbouring branch ends.
    gap: f64,
    /// Least width of the drawing.
    width: f64,
    /// Radius of the first cell's disc, and the least radius of any disc.
    discs: [f64; 2],
    /// Size of founders' names.
    font: f64,
    /// Whether names show the asymmetry of the division.
    asymmetry: bool,
}

/// A drawing of full width.
static FULL: Frame = Frame {
    max_ends: 3000,
    left: 92.0,
    right: 70.0,
    top: 118.0,
    bottom: 64.0,
    row: 66.0,
    gap: 9.0,
    width: 1180.0,
    discs: [17.0, 1.5],
    font: 13.0,
    asymmetry: true,
};

/// One of several drawings on a page, with fewer ends: more would not be visible at this size.
static SMALL: Frame = Frame {
    max_ends: 600,
    left: 40.0,
    right: 30.0,
    top: 26.0,
    bottom: 16.0,
    row: 30.0,
    gap: 3.0,
    width: 600.0,
    discs: [9.0, 0.8],
    font: 10.0,
    asymmetry: false,
};

/// Founders take these colours in turn: eight hues, then the same hues darker, paler, and darker still.
const HUES: [&str; 32] = [
    "#2f6db5", "#7b5ea7", "#c2568f", "#2a9d6f", "#e08a2c", "#c8423b", "#b8a21a", "#1f9fb4", // as they are
    "#1d4470", "#4c3a68", "#783559", "#1a6145", "#8b561b", "#7c2925", "#726410", "#136370", // darker
    "#7aa2d1", "#ab98c8", "#d893b7", "#77c0a2", "#ebb478", "#dc8682", "#d1c26b", "#70c2cf", // paler
    "#122b48", "#312643", "#4e2239", "#113f2c", "#5a3711", "#501a18", "#4a410a", "#0c4048", // darker still
];
/// P0 to P3 of a nematode, in every scenario: whatever their cues, they are the germline.
const GERMLINE: [(&str, &str); 4] = [("P0", "#2b2f36"), ("P1", "#4c525c"), ("P2", "#6d7480"), ("P3", "#8d95a1")];

/// The colour of each founder, the same in all drawings and distinct for up to 32 founders.
pub fn colours(lineage: &Lineage) -> Vec<&'static str> {
    let mut hues = HUES.into_iter().cycle();
    let grey = |name: &str| GERMLINE.into_iter().find_map(|(founder, grey)| (founder == name).then_some(grey));
    lineage.founders.iter().filter_map(|founder| grey(&founder.name).or_else(|| hues.next())).collect()
}

/// Positions of the cells that are drawn.
struct Layout {
    frame: &'static Frame,
    /// By node; `None` if it is not drawn.
    x: Vec<Option<f64>>,
    width: f64,
    /// The last generation drawn.
    last: u32,
    /// Cells before their daughters.
    order: Vec<CellId>,
    /// Where the first cell is.
    top: f64,
    /// Distance of each node below the first cell.
    down: Vec<f64>,
    /// The largest depth drawn.
    deepest: f64,
    /// The axis of time, if cells are drawn at their births instead of their generations.
    minutes: Option<TimeScale>,
}

fn lay_out(tree: &Tree, summary: &TreeSummary, frame: &'static Frame, axis: TimeAxis) -> Layout {
    // Ends of the tree cut below generation g: the cells of g and the earlier ones without daughters.
    let mut ended = 0;
    let fits = |row: &&Generation| {
        let fits = ended + row.cells <= frame.max_ends;
        ended += row.ended;
        fits
    };
    let last = (summary.generations.iter().take_while(fits).count() as u32).saturating_sub(1);
    let order: Vec<CellId> = tree.depth_first(last).collect();
    let is_end = |node: &CellId| tree.cell(*node).generation == last || tree.daughters(*node).is_none();
    let ends = order.iter().filter(|node| is_end(node)).count();
    let gap = ((frame.width - frame.left - frame.right) / ends.max(1) as f64).max(frame.gap);
    let mut x = vec![None; tree.len()];
    let mut next = frame.left + 0.5 * gap;
    for node in order.iter().filter(|node| is_end(node)) {
        x[node.index()] = Some(next);
        next += gap;
    }
    for &node in order.iter().rev() {
        if x[node.index()].is_none()
            && let Some([left, right]) = tree.daughters(node)
            && let (Some(l), Some(r)) = (x[left.index()], x[right.index()])
        {
            x[node.index()] = Some(0.5 * (l + r));
        }
    }
    let width = (next - 0.5 * gap + frame.right).max(frame.width);
    let deepest = frame.row * f64::from(last);
    let minutes = (axis == TimeAxis::Minutes).then(|| TimeScale::new(tree, &order, deepest)).flatten();
    let down = match &minutes {
        Some(scale) => scale.times.iter().map(|times| scale.at(times.birth_min)).collect(),
        None => tree.cells().map(|id| frame.row * f64::from(tree.cell(id).generation)).collect(),
    };
    Layout { frame, x, width, last, order, top: frame.top, down, deepest, minutes }
}

/// The tree as SVG: one row for each generation, or time downwards with every cell at its birth; discs are as wide as
/// their cells and coloured by founder. A full disc divides symmetrically, a ring asymmetrically; an open circle over a
/// bar does not divide. A tree without a clock has rows of generations.
pub fn svg(tree: &Tree, axis: TimeAxis) -> String {
    let summary = TreeSummary::of(tree);
    let mut layout = lay_out(tree, &summary, &FULL, axis);
    let colours = colours(&tree.lineage);
    let (legend, rows) = legend(tree, &colours, &layout);
    layout.top += LINE * (rows - 1) as f64;
    let (left, right, end) = (FULL.left - 50.0, layout.width - FULL.right + 22.0, layout.width - 14.0);
    let row = |(down, g, cells): (f64, String, usize)| {
        let y = layout.top + down;
        let base = y + 4.5;
        format!(
            r##"<path d="M{left:.1} {y:.1}H{right:.1}" stroke="#eceef1"/><text x="16" y="{base:.1}" font-size="13" fill="#555">{g}</text><text x="{end:.1}" y="{base:.1}" font-size="12" fill="#555" text-anchor="end">{cells}</text>
"##
        )
    };
    let generation = |(g, row): (usize, &Generation)| (FULL.row * g as f64, g.to_string(), row.cells);
    let rows: String = match &layout.minutes {
        Some(scale) => scale.ticks().into_iter().map(row).collect(),
        None => {
            summary.generations.iter().enumerate().take(layout.last as usize + 1).map(generation).map(row).collect()
        }
    };
    let last = last_divisions_drawn(tree, &layout, &colours);
    drawing(tree, &layout, &colours, &(heading(tree, &layout) + &legend + &rows + &last))
}

/// The tree as one of several drawings on a page: without a legend, with generations numbered on the left, in the given
/// colours of its founders.
pub(super) fn small(tree: &Tree, colours: &[&str]) -> String {
    let layout = lay_out(tree, &TreeSummary::of(tree), &SMALL, TimeAxis::Generations);
    let row = |g: u32| {
        let (y, right) = (layout.top + SMALL.row * f64::from(g), layout.width - 6.0);
        let base = y + 3.0;
        format!(
            r##"<path d="M24 {y:.1}H{right:.1}" stroke="#eceef1"/><text x="6" y="{base:.1}" font-size="9" fill="#777">{g}</text>
"##
        )
    };
    drawing(tree, &layout, colours, &(0..=layout.last).map(row).collect::<String>())
}

/// The background, all lines, and the discs over them.
fn drawing(tree: &Tree, layout: &Layout, colours: &[&str], behind: &str) -> String {
    let Layout { frame, width, order, .. } = layout;
    let height = layout.top + layout.deepest + frame.bottom;
    let edges = order.iter().map(|node| edges(tree, *node, layout, colours));
    let discs = order.iter().filter_map(|node| disc(tree, *node, layout, colours));
    let cells: String = edges.chain(discs).collect();
    format!(
        r##"<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width:.0} {height:.0}" width="{width:.0}" height="{height:.0}" font-family="Helvetica, Arial, sans-serif">
<rect width="100%" height="100%" fill="#fff"/>
{behind}{cells}</svg>
"##
    )
}

/// Radius of a cell's disc.
fn disc_radius(tree: &Tree, r0: f64, layout: &Layout) -> f64 {
    let largest = tree.cell(tree.first()).r0.max(1e-12);
    let [first, least] = layout.frame.discs;
    (first * r0 / largest).max(least)
}

fn y_of(node: CellId, layout: &Layout) -> f64 {
    layout.top + layout.down[node.index()]
}

/// The largest radius at which a disc is clear of its daughters' discs.
fn room_below(tree: &Tree, node: CellId, layout: &Layout) -> f64 {
    let place = |id: CellId| Some((layout.x[id.index()]?, y_of(id, layout)));
    let away = |daughter: CellId| {
        let ((x, y), (to, down)) = (place(node)?, place(daughter)?);
        Some(0.48 * (to - x).hypot(down - y))
    };
    let room = tree.daughters(node).into_iter().flatten().filter_map(away).fold(f64::INFINITY, f64::min);
    room.max(layout.frame.discs[1])
}

/// The last division of each founder and its descendants, as a line below all of them with its minute. A founder with
/// further founders below it is left out, since its last division is one of theirs.
fn last_divisions_drawn(tree: &Tree, layout: &Layout, colours: &[&str]) -> String {
    let Some(scale) = &layout.minutes else { return String::new() };
    let mut spans: Vec<Option<[f64; 2]>> = layout.x.iter().map(|x| x.map(|x| [x, x])).collect();
    for node in layout.order.iter().rev() {
        let below: Vec<[f64; 2]> =
            tree.daughters(*node).into_iter().flatten().filter_map(|daughter| spans[daughter.index()]).collect();
        if let Some(span) = &mut spans[node.index()] {
            for [from, to] in below {
                *span = [span[0].min(from), span[1].max(to)];
            }
        }
    }
    let line = |(founder, last): (usize, Option<CellTimes>)| {
        let CellTimes { division_min, lifetime_extrapolated, .. } = last?;
        let min = division_min?;
        let extrapolated = if lifetime_extrapolated { ", extrapolated" } else { "" };
        let node = tree.founder_cell(founder)?;
        let names = &tree.lineage.founders;
        let is_mother = names.iter().any(|other| other.mother.as_ref() == Some(&names[founder].name));
        let [from, to] = spans[node.index()].filter(|_| !is_mother && min <= scale.last)?;
        let words = format!("{}: last division, {min:.0} min{extrapolated}", names[founder].name);
        Some(LastDivision {
            from: from - 6.0,
            to: to + 6.0,
            y: layout.top + scale.at(min),
            colour: colours[founder],
            words,
        })
    };
    let mut lines: Vec<LastDivision<'_>> = scale.last_times.iter().copied().enumerate().filter_map(line).collect();
    lines.sort_by(|a, b| a.y.total_cmp(&b.y));
    let mut taken: Vec<[f64; 3]> = Vec::new();
    lines.iter().map(|line| line.drawn(&mut taken)).collect()
}

/// The line below a founder and its descendants.
struct LastDivision<'a> {
    from: f64,
    to: f64,
    y: f64,
    colour: &'a str,
    words: String,
}

impl LastDivision<'_> {
    /// Height of a line of words, and an upper bound of the mean width of a letter.
    const LETTER: [f64; 2] = [12.0, 5.6];

    /// The line with its words below it, where they meet no other words: `taken` has the left and the right end and the base of each.
    fn drawn(&self, taken: &mut Vec<[f64; 3]>) -> String {
        let LastDivision { from, to, y, colour, words } = self;
        let [height, letter] = LastDivision::LETTER;
        let left = to - letter * words.chars().count() as f64;
        // The founder has nothing below this line.
        let mut base = y + 21.0;
        while taken.iter().any(|[from, end, at]| left < *end && *from < *to && (base - at).abs() < height) {
            base += height;
        }
        taken.push([left, *to, base]);
        let copy = |paint: &str| {
            let words = escape(words);
            format!(r##"<text x="{to:.1}" y="{base:.1}" font-size="10" text-anchor="end" {paint}>{words}</text>"##)
        };
        let halo = r##"fill="#fff" stroke="#fff" stroke-width="3" stroke-linejoin="round""##;
        let text = copy(halo) + &copy(&format!("fill=\"{colour}\""));
        format!(
            r##"<path d="M{from:.1} {y:.1}H{to:.1}" stroke="{colour}" stroke-width="1.2" stroke-dasharray="5 4"/>{text}
"##
        )
    }
}

fn edges(tree: &Tree, node: CellId, layout: &Layout, colours: &[&str]) -> String {
    let (Some(pair), Some(x)) = (tree.daughters(node), layout.x[node.index()]) else { return String::new() };
    let (y, row) = (y_of(node, layout), layout.frame.row);
    let edge = |daughter: CellId| {
        let (to, cell) = (layout.x[daughter.index()]?, tree.cell(daughter));
        let path = match layout.minutes {
            // A cell's life runs straight down, its division across.
            Some(_) => format!("M{x:.1} {y:.1}V{:.1}H{to:.1}", y_of(daughter, layout)),
            None => {
                let down = y + row;
                let (a, b) = (y + 0.42 * row, down - 0.42 * row);
                format!("M{x:.1} {y:.1}C{x:.1} {a:.1} {to:.1} {b:.1} {to:.1} {down:.1}")
            }
        };
        // The width of the line is proportional to the daughter's radius.
        let (stroke, colour) = (0.26 * disc_radius(tree, cell.r0, layout), colours[cell.founder]);
        Some(format!(
            r##"<path d="{path}" fill="none" stroke="{colour}" stroke-width="{stroke:.2}" stroke-opacity=".55"/>
"##
        ))
    };
    pair.into_iter().filter_map(edge).collect()
}

fn disc(tree: &Tree, node: CellId, layout: &Layout, colours: &[&str]) -> Option<String> {
    let (x, y) = (layout.x[node.index()]?, y_of(node, layout));
    let cell = tree.cell(node);
    let radius = disc_radius(tree, cell.r0, layout).min(room_below(tree, node, layout));
    let colour = colours[cell.founder];
    let shape = match (cell.fate.terminal_reason(), cell.fate.outcome()) {
        (Some(_), _) => {
            let (left, right, foot) = (x - radius, x + radius, y + radius + 2.5);
            format!(
                r##"r="{radius:.1}" fill="#fff" stroke="{colour}" stroke-width="1"/><path d="M{left:.1} {foot:.1}H{right:.1}" stroke="{colour}" stroke-width="1.6"/>"##
            )
        }
        (None, Some(Outcome::Symmetric)) => format!(r#"r="{radius:.1}" fill="{colour}"/>"#),
        _ => {
            let stroke = 0.42 * radius;
            let ring = radius - 0.5 * stroke;
            format!(r##"r="{ring:.1}" fill="#fff" stroke="{colour}" stroke-width="{stroke:.1}"/>"##)
        }
    };
    let times = layout.minutes.as_ref().map(|scale| scale.times[node.index()]);
    let title = escape(&(title(tree, node) + &times.map_or(String::new(), times_text)));
    let label = if tree.founder_cell(cell.founder) == Some(node) { label(tree, node, layout, colour) } else { None };
    let label = label.unwrap_or_default();
    Some(format!("<g><title>{title}</title><circle cx=\"{x:.1}\" cy=\"{y:.1}\" {shape}</g>\n{label}"))
}

/// The tooltip of a cell.
fn title(tree: &Tree, node: CellId) -> String {
    let (cell, units) = (tree.cell(node), tree.lineage.units());
    let (size, side) = (units.in_micrometres(cell.r0), tree.side(node).map_or("", Side::adjective));
    let outcome = outcome_name(cell.fate.outcome());
    let mut title = format!("{}: {side}R0 = {:.4}{size}, {outcome}", cell.name, cell.r0);
    if tree.has_cue(node) {
        let _ = write!(title, ", cue {}", rounded(&cell.cue.to_string()));
    }
    if let Some(chi) = cell.fate.chi() {
        let _ = write!(title, ", χ = {chi:.4}");
    }
    if let Some(t) = cell.fate.t_end() {
        let _ = write!(title, ", t = {t:.3} τ{}", units.in_minutes(t));
    }
    if let Some(reason) = cell.fate.terminal_reason() {
        let _ = write!(title, "; {reason}");
    }
    title
}

/// The times of birth and division, appended to the title.
fn times_text(CellTimes { birth_min, division_min, lifetime_extrapolated }: CellTimes) -> String {
    let mark = if lifetime_extrapolated { " (extrapolated)" } else { "" };
    let divides = division_min.map_or(String::new(), |min| format!(", divides at {min:.1} min{mark}"));
    format!("; born at {birth_min:.1} min{divides}")
}

/// Widest line of a founder's label.
const LABEL: f64 = 40.0;

/// The side of a founder's label, 1 for the right: away from its mother, unless the next cell is too close on that side
/// only.
fn label_side(tree: &Tree, node: CellId, layout: &Layout, x: f64, wanted: f64) -> f64 {
    let y = y_of(node, layout);
    let beside = |other: &CellId| *other != node && (y_of(*other, layout) - y).abs() < LINE;
    let room = |side: f64| {
        let others = tree.cells().filter(beside).filter_map(|other| layout.x[other.index()]);
        others.map(|other| side * (other - x)).filter(|gap| *gap > 0.0).fold(f64::INFINITY, f64::min)
    };
    let mother = tree.mother(node).and_then(|mother| layout.x[mother.index()]);
    let side = if mother.is_some_and(|mother| x < mother) { -1.0 } else { 1.0 };
    if room(side) < wanted && room(-side) >= wanted { -side } else { side }
}

/// A founder's name beside its disc, with the asymmetry of its division.
fn label(tree: &Tree, node: CellId, layout: &Layout, colour: &str) -> Option<String> {
    let (cell, x) = (tree.cell(node), layout.x[node.index()]?);
    let away = disc_radius(tree, cell.r0, layout) + 5.0;
    let side = label_side(tree, node, layout, x, away + LABEL);
    let (x, anchor) = (x + side * away, if side < 0.0 { "end" } else { "start" });
    let y = y_of(node, layout) - 5.0;
    // A white copy underneath keeps the text clear of lines.
    let halo = r##"fill="#fff" stroke="#fff" stroke-width="4" stroke-linejoin="round""##.to_owned();
    let paints = [halo, format!("fill=\"{colour}\"")];
    let line = |y: f64, font: &str, text: &str| -> String {
        let copy =
            |paint| format!("<text x=\"{x:.1}\" y=\"{y:.1}\" {font} text-anchor=\"{anchor}\" {paint}>{text}</text>\n");
        paints.iter().map(copy).collect()
    };
    let font = format!("font-size=\"{}\" font-weight=\"bold\"", layout.frame.font);
    // In minutes, neighbours can be close below.
    let unequal =
        layout.frame.asymmetry && layout.minutes.is_none() && cell.fate.outcome() == Some(Outcome::Asymmetric);
    let chi = cell.fate.chi().filter(|_| unequal);
    let chi = chi.map_or(String::new(), |chi| line(y + 13.0, "font-size=\"11\"", &format!("χ {chi:.2}")));
    Some(line(y, &font, &escape(&cell.name)) + &chi)
}

/// Height of a line of the legend, and where the first one is.
const LINE: f64 = 21.0;
const LEGEND: f64 = 69.0;

/// The subject of the drawing, and the names of its columns.
fn heading(tree: &Tree, layout: &Layout) -> String {
    let Cell { epsilon, xi_s, .. } = tree.settings.cell;
    let (name, cells, r0) = (escape(&tree.lineage.name), tree.len(), short(tree.cell(tree.first()).r0));
    let (end, top) = (layout.width - 14.0, layout.top - 20.0);
    let index = |letter: &str| format!(r#"<tspan dy="3" font-size="9">{letter}</tspan><tspan dy="-3"> = "#);
    let (of_r, of_xi) = (index("0"), index("s"));
    let origin = tree.time_origin().filter(|_| layout.minutes.is_some());
    let origin = origin.map_or(String::new(), |origin| {
        format!("; cells at their births, minute 0 is the {}", escape(&origin.to_string()))
    });
    let room = if layout.minutes.is_some() { " where there is room" } else { "" };
    let [left_column, right_column] =
        if layout.minutes.is_some() { ["minutes", "cells alive"] } else { ["generation", "cells"] };
    let mut out = format!(
        "<text x=\"16\" y=\"28\" font-size=\"18\" font-weight=\"bold\" fill=\"#222\">{name}</text>\n\
         <text x=\"16\" y=\"47\" font-size=\"12\" fill=\"#555\">{cells} cells; R{of_r}{r0}</tspan>, ε = {epsilon}, ξ{of_xi}{xi_s}</tspan>; \
         discs are as wide as the cells{room}, lines as strong as the daughter is large{origin}</text>\n\
         <text x=\"16\" y=\"{top:.1}\" font-size=\"11\" fill=\"#777\">{left_column}</text><text x=\"{end:.1}\" y=\"{top:.1}\" font-size=\"11\" fill=\"#777\" text-anchor=\"end\">{right_column}</text>\n"
    );
    let total = tree.cells().next_back().map_or(0, |n| tree.cell(n).generation);
    if total > layout.last {
        let (y, from) = (layout.top + layout.deepest + 50.0, layout.last + 1);
        let _ = writeln!(
            out,
            r##"<text x="16" y="{y:.1}" font-size="12" fill="#a33">generations {from} to {total} are not drawn</text>"##
        );
    }
    out
}

/// The founders and kinds of cells that are drawn, in lines no wider than the page, and the number of these lines.
fn legend(tree: &Tree, colours: &[&str], layout: &Layout) -> (String, usize) {
    let drawn = || layout.order.iter().map(|node| tree.cell(*node));
    let born = |founder: &usize| drawn().any(|cell| cell.founder == *founder);
    let founder = |k: usize| (format!(r#"r="5" fill="{}"/>"#, colours[k]), tree.lineage.founders[k].name.as_str());
    let founders: Vec<(String, &str)> = (0..tree.lineage.founders.len()).filter(born).map(founder).collect();
    let ended = || drawn().filter(|cell| cell.fate.terminal_reason().is_some());
    let divides = |equal: bool| {
        let mut divided = drawn().filter(|cell| cell.fate.terminal_reason().is_none());
        divided.any(|cell| (cell.fate.outcome() == Some(Outcome::Symmetric)) == equal)
    };
    let kinds = [
        (divides(true), r##"r="6" fill="#555"/>"##, "divides symmetrically"),
        (divides(false), r##"r="4.7" fill="#fff" stroke="#555" stroke-width="2.6"/>"##, "divides asymmetrically"),
        (
            ended().next().is_some(),
            r##"r="5.5" fill="#fff" stroke="#555"/><path d="M-5.5 8H5.5" stroke="#555" stroke-width="1.6"/>"##,
            "does not divide",
        ),
    ];
    let kinds: Vec<(String, &str)> =
        kinds.into_iter().filter(|(shown, ..)| *shown).map(|(_, shape, word)| (shape.to_owned(), word)).collect();
    let (mut out, mut row) = (String::new(), 0);
    for entries in [founders, kinds].iter().filter(|entries| !entries.is_empty()) {
        let mut x = 16.0;
        for (shape, word) in entries {
            let needed = 32.0 + 7.2 * word.chars().count() as f64;
            if x > 16.0 && x + needed > FULL.width - 16.0 {
                (x, row) = (16.0, row + 1);
            }
            let (at, y, word) = (x + 6.0, LEGEND + LINE * row as f64, escape(word));
            let _ = writeln!(
                out,
                r##"<g transform="translate({at:.1} {y:.1})"><circle {shape}<text x="10" y="4" font-size="12" fill="#333">{word}</text></g>"##
            );
            x += needed;
        }
        row += 1;
    }
    (out, row.max(1))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_of_last_divisions_do_not_meet() {
        let of = |to: f64, y: f64| LastDivision {
            from: to - 40.0,
            to,
            y,
            colour: "#000",
            words: "C: last division, 9 min".into(),
        };
        let mut taken = Vec::new();
        let drawn: Vec<String> =
            [of(200.0, 50.0), of(260.0, 51.0), of(400.0, 52.0)].map(|l| l.drawn(&mut taken)).into();
        // The second gives way to the first; the third is beside both.
        assert_eq!(taken.iter().map(|[.., base]| *base).collect::<Vec<_>>(), [71.0, 84.0, 73.0]);
        assert!(drawn[1].contains(r#"y="84.0""#), "{}", drawn[1]);
    }

    /// The colours of a lineage with the given founders, all with a cue.
    fn of(names: &[String]) -> Vec<&'static str> {
        let founder = |k: usize| {
            let (mother, daughter) = ((k - 1) / 2, if k % 2 == 1 { "larger" } else { "smaller" });
            format!(r#", (name: "{}", mother: "{}", daughter: {daughter}, cue: "c")"#, names[k], names[mother])
        };
        let rest: String = (1..names.len()).map(founder).collect();
        let cue = "cues: { \"c\": \"kappa:u0=0.4,omega=0.1,amplitude=0.1\" }";
        let text = format!(r#"(name: "own", {cue}, founders: [(name: "{}", cue: "c"){rest}])"#, names[0]);
        colours(&Lineage::parse(&text, "own.ron").unwrap())
    }

    #[test]
    fn the_founders_of_any_animal_have_distinct_colours() {
        let names: Vec<String> = (0..31).map(|k| format!("F{k}")).collect();
        let found = of(&names);
        let distinct: std::collections::BTreeSet<&str> = found.iter().copied().collect();
        assert_eq!((found.len(), distinct.len()), (31, 31));
        assert!(GERMLINE.iter().all(|(_, grey)| !distinct.contains(grey)));
        let worm = Lineage::c_elegans().unwrap();
        let germline = worm.founders.iter().zip(colours(&worm)).filter(|(founder, _)| founder.name.starts_with('P'));
        let greys: Vec<bool> = germline.map(|(_, colour)| GERMLINE.iter().any(|(_, grey)| *grey == colour)).collect();
        assert_eq!(greys, [true, true, true, true, false]);
        // Removing a cue changes no colour.
        assert_eq!(colours(&worm.clone().with_cues_replaced("none", &furrow_cell::Cue::none())), colours(&worm));
    }
}
