//! The lineage as a drawing.

use super::escape;
use super::summary::{Generation, TreeSummary};
use super::table::{outcome_name, short};
use furrow_cell::Cell;
use furrow_lineage::{CellId, Lineage, Side, Tree};
use furrow_mechanics::division::Outcome;
use std::fmt::Write;

/// The measures of a drawing, in its own units.
struct Frame {
    /// Most branch ends drawn; of a larger tree the first generations are shown.
    max_ends: usize,
    left: f64,
    right: f64,
    top: f64,
    bottom: f64,
    /// From one generation to the next.
    row: f64,
    /// Least distance of neighbouring branch ends.
    gap: f64,
    /// Least width of the drawing.
    width: f64,
    /// Radius of the first cell's disc, and the least of any.
    discs: [f64; 2],
    /// Size of founders' names.
    font: f64,
    /// Whether names show the asymmetry of the division.
    asymmetry: bool,
}

/// A page wide.
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

/// One of several on a page, with fewer ends: more would not be visible at this size.
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

/// Founders without a cue take these colours in turn, founders with one (the germline) the greys.
const HUES: [&str; 8] = ["#2f6db5", "#7b5ea7", "#c2568f", "#2a9d6f", "#e08a2c", "#c8423b", "#b8a21a", "#1f9fb4"];
const GREYS: [&str; 4] = ["#2b2f36", "#4c525c", "#6d7480", "#8d95a1"];

/// The colour of each founder, in all drawings.
pub fn colours(lineage: &Lineage) -> Vec<&'static str> {
    let (mut hues, mut greys) = (HUES.into_iter().cycle(), GREYS.into_iter().cycle());
    let colour = |k: usize| if lineage.gives_cue(k) { greys.next() } else { hues.next() };
    (0..lineage.founders.len()).filter_map(colour).collect()
}

/// Positions of the cells that are drawn.
struct Layout {
    frame: &'static Frame,
    /// By node; none if not drawn.
    x: Vec<Option<f64>>,
    width: f64,
    /// The last generation drawn.
    last: u32,
    /// Cells before their daughters.
    order: Vec<CellId>,
}

fn lay_out(tree: &Tree, summary: &TreeSummary, frame: &'static Frame) -> Layout {
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
    Layout { frame, x, width: (next - 0.5 * gap + frame.right).max(frame.width), last, order }
}

/// The tree as SVG: one row a generation, discs as wide as their cells, coloured by founder. A full disc divides
/// symmetrically, a ring asymmetrically; an open circle over a bar ended.
pub fn svg(tree: &Tree) -> String {
    let summary = TreeSummary::of(tree);
    let layout = lay_out(tree, &summary, &FULL);
    let colours = colours(&tree.lineage);
    let (left, right, end) = (FULL.left - 50.0, layout.width - FULL.right + 22.0, layout.width - 14.0);
    let row = |(g, row): (usize, &Generation)| {
        let (y, cells) = (FULL.top + FULL.row * g as f64, row.cells);
        let base = y + 4.5;
        format!(
            r##"<path d="M{left:.1} {y:.1}H{right:.1}" stroke="#eceef1"/><text x="16" y="{base:.1}" font-size="13" fill="#555">{g}</text><text x="{end:.1}" y="{base:.1}" font-size="12" fill="#555" text-anchor="end">{cells}</text>
"##
        )
    };
    let rows: String = summary.generations.iter().enumerate().take(layout.last as usize + 1).map(row).collect();
    drawing(tree, &layout, &colours, &(legend(tree, &colours, &layout) + &rows))
}

/// The tree as one of several drawings on a page: without a legend, generations numbered on the left, in
/// the given colours of its founders.
pub(super) fn small(tree: &Tree, colours: &[&str]) -> String {
    let layout = lay_out(tree, &TreeSummary::of(tree), &SMALL);
    let row = |g: u32| {
        let (y, right) = (SMALL.top + SMALL.row * f64::from(g), layout.width - 6.0);
        let base = y + 3.0;
        format!(
            r##"<path d="M24 {y:.1}H{right:.1}" stroke="#eceef1"/><text x="6" y="{base:.1}" font-size="9" fill="#777">{g}</text>
"##
        )
    };
    drawing(tree, &layout, colours, &(0..=layout.last).map(row).collect::<String>())
}

/// What is behind the tree, all lines, and the discs over them.
fn drawing(tree: &Tree, layout: &Layout, colours: &[&str], behind: &str) -> String {
    let Layout { frame, width, last, order, .. } = layout;
    let height = frame.top + frame.row * f64::from(*last) + frame.bottom;
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

fn y_of(tree: &Tree, node: CellId, layout: &Layout) -> f64 {
    layout.frame.top + layout.frame.row * f64::from(tree.cell(node).generation)
}

fn edges(tree: &Tree, node: CellId, layout: &Layout, colours: &[&str]) -> String {
    let (Some(pair), Some(x)) = (tree.daughters(node), layout.x[node.index()]) else { return String::new() };
    let (y, row) = (y_of(tree, node, layout), layout.frame.row);
    let down = y + row;
    let (a, b) = (y + 0.42 * row, down - 0.42 * row);
    let edge = |daughter: CellId| {
        let (to, cell) = (layout.x[daughter.index()]?, tree.cell(daughter));
        // The line is as strong as the daughter is large.
        let (stroke, colour) = (0.26 * disc_radius(tree, cell.r0, layout), colours[cell.founder]);
        Some(format!(
            r##"<path d="M{x:.1} {y:.1}C{x:.1} {a:.1} {to:.1} {b:.1} {to:.1} {down:.1}" fill="none" stroke="{colour}" stroke-width="{stroke:.2}" stroke-opacity=".55"/>
"##
        ))
    };
    pair.into_iter().filter_map(edge).collect()
}

fn disc(tree: &Tree, node: CellId, layout: &Layout, colours: &[&str]) -> Option<String> {
    let (x, y) = (layout.x[node.index()]?, y_of(tree, node, layout));
    let cell = tree.cell(node);
    let radius = disc_radius(tree, cell.r0, layout);
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
    let title = escape(&title(tree, node));
    let label = if tree.founder_cell(cell.founder) == Some(node) { label(tree, node, layout, colour) } else { None };
    let label = label.unwrap_or_default();
    Some(format!("<g><title>{title}</title><circle cx=\"{x:.1}\" cy=\"{y:.1}\" {shape}</g>\n{label}"))
}

/// What a pointer over a cell shows.
fn title(tree: &Tree, node: CellId) -> String {
    let (cell, units) = (tree.cell(node), tree.lineage.units());
    let (size, side) = (units.in_micrometres(cell.r0), tree.side(node).map_or("", Side::adjective));
    let outcome = outcome_name(cell.fate.outcome());
    let mut title = format!("{}: {side}R0 = {:.4}{size}, {outcome}", cell.name, cell.r0);
    if !cell.cue.is_none() {
        let _ = write!(title, ", cue {}", cell.cue);
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

/// A founder's name beside its disc, on the side away from its mother, with the asymmetry of its division.
fn label(tree: &Tree, node: CellId, layout: &Layout, colour: &str) -> Option<String> {
    let (cell, x) = (tree.cell(node), layout.x[node.index()]?);
    let mother = tree.mother(node).and_then(|m| layout.x[m.index()]);
    let away = disc_radius(tree, cell.r0, layout) + 5.0;
    let (x, anchor) = if mother.is_some_and(|m| x < m) { (x - away, "end") } else { (x + away, "start") };
    let y = y_of(tree, node, layout) - 5.0;
    // A white copy underneath keeps the text clear of lines.
    let halo = r##"fill="#fff" stroke="#fff" stroke-width="4" stroke-linejoin="round""##.to_owned();
    let paints = [halo, format!("fill=\"{colour}\"")];
    let line = |y: f64, font: &str, text: &str| -> String {
        let copy =
            |paint| format!("<text x=\"{x:.1}\" y=\"{y:.1}\" {font} text-anchor=\"{anchor}\" {paint}>{text}</text>\n");
        paints.iter().map(copy).collect()
    };
    let font = format!("font-size=\"{}\" font-weight=\"bold\"", layout.frame.font);
    let unequal = layout.frame.asymmetry && cell.fate.outcome() == Some(Outcome::Asymmetric);
    let chi = cell.fate.chi().filter(|_| unequal);
    let chi = chi.map_or(String::new(), |chi| line(y + 13.0, "font-size=\"11\"", &format!("χ {chi:.2}")));
    Some(line(y, &font, &escape(&cell.name)) + &chi)
}

fn legend(tree: &Tree, colours: &[&str], layout: &Layout) -> String {
    let Cell { epsilon, xi_s, .. } = tree.settings.cell;
    let (name, cells, r0) = (escape(&tree.lineage.name), tree.len(), short(tree.cell(tree.first()).r0));
    let mut out = format!(
        r##"<text x="16" y="28" font-size="18" font-weight="bold" fill="#222">{name}</text><text x="16" y="47" font-size="12" fill="#555">{cells} cells; R0 = {r0}, ε = {epsilon}, ξ_s = {xi_s}</text>
"##
    );
    let mut x = 16.0;
    for (founder, colour) in tree.lineage.founders.iter().zip(colours) {
        let (disc, text, name) = (x + 5.0, x + 14.0, escape(&founder.name));
        let _ = writeln!(
            out,
            r##"<circle cx="{disc:.1}" cy="69" r="5" fill="{colour}"/><text x="{text:.1}" y="73" font-size="12" fill="#333">{name}</text>"##
        );
        x += 32.0 + 8.0 * founder.name.chars().count() as f64;
    }
    let x = layout.width.min(FULL.width) - 470.0;
    let [full, ring, ring_text, open, bar, bar_end, open_text, below] =
        [12.0, 160.0, 171.0, 283.0, 277.5, 288.5, 295.0, -6.0].map(|along| x + along);
    let (end, top) = (layout.width - 14.0, FULL.top - 20.0);
    let _ = writeln!(
        out,
        "<g font-size=\"12\" fill=\"#333\"><circle cx=\"{x:.1}\" cy=\"24\" r=\"6\" fill=\"#555\"/><text x=\"{full:.1}\" y=\"28\">divides symmetrically</text>\
         <circle cx=\"{ring:.1}\" cy=\"24\" r=\"4.7\" fill=\"#fff\" stroke=\"#555\" stroke-width=\"2.6\"/><text x=\"{ring_text:.1}\" y=\"28\">asymmetrically</text>\
         <circle cx=\"{open:.1}\" cy=\"22\" r=\"5.5\" fill=\"#fff\" stroke=\"#555\"/><path d=\"M{bar:.1} 30H{bar_end:.1}\" stroke=\"#555\" stroke-width=\"1.6\"/><text x=\"{open_text:.1}\" y=\"28\">does not divide</text>\
         <text x=\"{below:.1}\" y=\"47\" fill=\"#555\">discs are as wide as the cells; lines as strong as the daughter is large</text></g>\n\
         <text x=\"16\" y=\"{top:.1}\" font-size=\"11\" fill=\"#777\">generation</text><text x=\"{end:.1}\" y=\"{top:.1}\" font-size=\"11\" fill=\"#777\" text-anchor=\"end\">cells</text>"
    );
    let total = tree.cells().next_back().map_or(0, |n| tree.cell(n).generation);
    if total > layout.last {
        let (y, from) = (FULL.top + FULL.row * f64::from(layout.last) + 50.0, layout.last + 1);
        let _ = writeln!(
            out,
            r##"<text x="16" y="{y:.1}" font-size="12" fill="#a33">generations {from} to {total} are not drawn</text>"##
        );
    }
    out
}
