//! The lineage as a drawing.

use super::escape;
use super::summary::TreeSummary;
use super::table::{outcome_name, short};
use crate::division::Outcome;
use crate::lineage::{CellId, Lineage, Side, Tree};
use std::fmt::Write;

/// Most branch ends drawn; of a larger tree the first generations are shown.
const MAX_ENDS: usize = 3000;

const LEFT: f64 = 92.0;
const RIGHT: f64 = 70.0;
const TOP: f64 = 118.0;
const ROW: f64 = 66.0;
/// Least distance of neighbouring branch ends.
const GAP: f64 = 9.0;
/// Least width of the drawing.
const WIDTH: f64 = 1180.0;

/// Founders without a cue take these colours in turn, founders with one (the germline) the greys.
const HUES: [&str; 8] = ["#2f6db5", "#7b5ea7", "#c2568f", "#2a9d6f", "#e08a2c", "#c8423b", "#b8a21a", "#1f9fb4"];
const GREYS: [&str; 4] = ["#2b2f36", "#4c525c", "#6d7480", "#8d95a1"];

/// The colour of each founder.
pub(super) fn colours(lineage: &Lineage) -> Vec<&'static str> {
    let (mut hue, mut grey) = (0, 0);
    (0..lineage.founders.len())
        .map(|k| {
            let (palette, next): (&[&'static str], &mut usize) =
                if lineage.gives_cue(k) { (&GREYS, &mut grey) } else { (&HUES, &mut hue) };
            *next += 1;
            palette[(*next - 1) % palette.len()]
        })
        .collect()
}

/// Positions of the cells that are drawn.
struct Layout {
    /// By node; none if not drawn.
    x: Vec<Option<f64>>,
    width: f64,
    /// The last generation drawn.
    last: u32,
    /// Cells before their daughters.
    order: Vec<CellId>,
}

fn lay_out(tree: &Tree, summary: &TreeSummary) -> Layout {
    // Ends of the tree cut below generation g: the cells of g and the earlier ones without daughters.
    let mut ended = 0;
    let mut last = 0;
    for (g, row) in summary.generations.iter().enumerate() {
        if ended + row.cells > MAX_ENDS {
            break;
        }
        last = g as u32;
        ended += row.ended;
    }
    let mut order = vec![];
    let mut x = vec![None; tree.len()];
    let mut stack = vec![tree.first()];
    while let Some(node) = stack.pop() {
        order.push(node);
        if tree.cell(node).generation < last
            && let Some([left, right]) = tree.daughters(node)
        {
            stack.extend([right, left]);
        }
    }
    let ends = order.iter().filter(|n| tree.cell(**n).generation == last || tree.daughters(**n).is_none()).count();
    let gap = ((WIDTH - LEFT - RIGHT) / ends.max(1) as f64).max(GAP);
    let mut next = LEFT + 0.5 * gap;
    for &node in &order {
        if tree.cell(node).generation == last || tree.daughters(node).is_none() {
            x[node.index()] = Some(next);
            next += gap;
        }
    }
    for &node in order.iter().rev() {
        if x[node.index()].is_none()
            && let Some([left, right]) = tree.daughters(node)
            && let (Some(l), Some(r)) = (x[left.index()], x[right.index()])
        {
            x[node.index()] = Some(0.5 * (l + r));
        }
    }
    Layout { x, width: (next - 0.5 * gap + RIGHT).max(WIDTH), last, order }
}

/// The tree as SVG: one row a generation, discs as wide as their cells, coloured by founder. A full disc divides
/// symmetrically, a ring asymmetrically; an open circle over a bar ended.
pub fn svg(tree: &Tree) -> String {
    let summary = TreeSummary::of(tree);
    let layout = lay_out(tree, &summary);
    let colours = colours(&tree.lineage);
    let height = TOP + ROW * f64::from(layout.last) + 64.0;
    let width = layout.width;
    let mut out = String::with_capacity(400 * layout.order.len() + 4000);
    let _ = writeln!(
        out,
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width:.0} {height:.0}\" width=\"{width:.0}\" height=\"{height:.0}\" font-family=\"Helvetica, Arial, sans-serif\">"
    );
    let _ = writeln!(out, "<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>");
    legend(&mut out, tree, &colours, &layout);
    for (g, row) in summary.generations.iter().enumerate().take(layout.last as usize + 1) {
        let y = TOP + ROW * g as f64;
        let _ = writeln!(
            out,
            "<path d=\"M{:.1} {y:.1}H{:.1}\" stroke=\"#eceef1\"/><text x=\"16\" y=\"{:.1}\" font-size=\"13\" fill=\"#555\">{g}</text><text x=\"{:.1}\" y=\"{:.1}\" font-size=\"12\" fill=\"#555\" text-anchor=\"end\">{}</text>",
            LEFT - 50.0,
            width - RIGHT + 22.0,
            y + 4.5,
            width - 14.0,
            y + 4.5,
            row.cells
        );
    }
    for &node in &layout.order {
        edges(&mut out, tree, node, &layout, &colours);
    }
    for &node in &layout.order {
        disc(&mut out, tree, node, &layout, &colours);
    }
    out.push_str("</svg>\n");
    out
}

/// Radius of a cell's disc.
fn disc_radius(tree: &Tree, r0: f64) -> f64 {
    let largest = tree.cell(tree.first()).r0.max(1e-12);
    (17.0 * r0 / largest).max(1.5)
}

fn y_of(tree: &Tree, node: CellId) -> f64 {
    TOP + ROW * f64::from(tree.cell(node).generation)
}

fn edges(out: &mut String, tree: &Tree, node: CellId, layout: &Layout, colours: &[&str]) {
    let (Some(pair), Some(x)) = (tree.daughters(node), layout.x[node.index()]) else { return };
    let y = y_of(tree, node);
    for daughter in pair {
        let Some(to) = layout.x[daughter.index()] else { continue };
        let cell = tree.cell(daughter);
        // The line is as strong as the daughter is large.
        let stroke = 0.26 * disc_radius(tree, cell.r0);
        let down = y + ROW;
        let (a, b) = (y + 0.42 * ROW, down - 0.42 * ROW);
        let _ = writeln!(
            out,
            "<path d=\"M{x:.1} {y:.1}C{x:.1} {a:.1} {to:.1} {b:.1} {to:.1} {down:.1}\" fill=\"none\" stroke=\"{}\" stroke-width=\"{stroke:.2}\" stroke-opacity=\".55\"/>",
            colours[cell.founder]
        );
    }
}

fn disc(out: &mut String, tree: &Tree, node: CellId, layout: &Layout, colours: &[&str]) {
    let Some(x) = layout.x[node.index()] else { return };
    let cell = tree.cell(node);
    let y = y_of(tree, node);
    let radius = disc_radius(tree, cell.r0);
    let colour = colours[cell.founder];
    let units = tree.lineage.units();
    let size = units.in_micrometres(cell.r0);
    let side = tree.side(node).map_or("", Side::adjective);
    let mut title = format!("{}: {side}R0 = {:.4}{size}, {}", cell.name, cell.r0, outcome_name(cell.fate.outcome()));
    if !cell.cue.is_none() {
        let _ = write!(title, ", cue {}", cell.cue);
    }
    if let Some(chi) = cell.fate.chi() {
        let _ = write!(title, ", χ = {chi:.4}");
    }
    if let Some(t) = cell.fate.t_end() {
        let _ = write!(title, ", t = {t:.3} τ{}", units.in_minutes(t));
    }
    if let Some(reason) = &cell.fate.ended {
        let _ = write!(title, "; {reason}");
    }
    let _ = write!(out, "<g><title>{}</title>", escape(&title));
    match (&cell.fate.ended, cell.fate.outcome()) {
        (Some(_), _) => {
            let (left, right, foot) = (x - radius, x + radius, y + radius + 2.5);
            let _ = write!(
                out,
                "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{radius:.1}\" fill=\"#fff\" stroke=\"{colour}\" stroke-width=\"1\"/><path d=\"M{left:.1} {foot:.1}H{right:.1}\" stroke=\"{colour}\" stroke-width=\"1.6\"/>"
            );
        }
        (None, Some(Outcome::Symmetric)) => {
            let _ = write!(out, "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{radius:.1}\" fill=\"{colour}\"/>");
        }
        _ => {
            let stroke = 0.42 * radius;
            let _ = write!(
                out,
                "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{:.1}\" fill=\"#fff\" stroke=\"{colour}\" stroke-width=\"{stroke:.1}\"/>",
                radius - 0.5 * stroke
            );
        }
    }
    out.push_str("</g>\n");
    if tree.founder_cell(cell.founder) == Some(node) {
        label(out, tree, node, layout, colour);
    }
}

/// A founder's name beside its disc, on the side away from its mother, with the asymmetry of its division.
fn label(out: &mut String, tree: &Tree, node: CellId, layout: &Layout, colour: &str) {
    let cell = tree.cell(node);
    let Some(x) = layout.x[node.index()] else { return };
    let mother = tree.mother(node).and_then(|m| layout.x[m.index()]);
    let left = mother.is_some_and(|m| x < m);
    let away = disc_radius(tree, cell.r0) + 5.0;
    let (x, anchor) = if left { (x - away, "end") } else { (x + away, "start") };
    let y = y_of(tree, node) - 5.0;
    let mut line = |y: f64, font: &str, text: &str| {
        // A white copy underneath keeps the text clear of lines.
        let halo = "fill=\"#fff\" stroke=\"#fff\" stroke-width=\"4\" stroke-linejoin=\"round\"";
        for paint in [halo, &format!("fill=\"{colour}\"")] {
            let _ =
                writeln!(out, "<text x=\"{x:.1}\" y=\"{y:.1}\" {font} text-anchor=\"{anchor}\" {paint}>{text}</text>");
        }
    };
    line(y, "font-size=\"13\" font-weight=\"bold\"", &escape(&cell.name));
    if let Some(chi) = cell.fate.chi().filter(|_| cell.fate.outcome() == Some(Outcome::Asymmetric)) {
        line(y + 13.0, "font-size=\"11\"", &format!("χ {chi:.2}"));
    }
}

fn legend(out: &mut String, tree: &Tree, colours: &[&str], layout: &Layout) {
    let cell = &tree.settings.cell;
    let _ = writeln!(
        out,
        "<text x=\"16\" y=\"28\" font-size=\"18\" font-weight=\"bold\" fill=\"#222\">{}</text><text x=\"16\" y=\"47\" font-size=\"12\" fill=\"#555\">{} cells; R0 = {}, ε = {}, ξ_s = {}</text>",
        escape(&tree.lineage.name),
        tree.len(),
        short(tree.cell(tree.first()).r0),
        cell.epsilon,
        cell.xi_s
    );
    let mut x = 16.0;
    for (founder, colour) in tree.lineage.founders.iter().zip(colours) {
        let _ = writeln!(
            out,
            "<circle cx=\"{:.1}\" cy=\"69\" r=\"5\" fill=\"{colour}\"/><text x=\"{:.1}\" y=\"73\" font-size=\"12\" fill=\"#333\">{}</text>",
            x + 5.0,
            x + 14.0,
            escape(&founder.name)
        );
        x += 32.0 + 8.0 * founder.name.chars().count() as f64;
    }
    let x = layout.width.min(WIDTH) - 470.0;
    let _ = writeln!(
        out,
        "<g font-size=\"12\" fill=\"#333\"><circle cx=\"{:.1}\" cy=\"24\" r=\"6\" fill=\"#555\"/><text x=\"{:.1}\" y=\"28\">divides symmetrically</text>\
         <circle cx=\"{:.1}\" cy=\"24\" r=\"4.7\" fill=\"#fff\" stroke=\"#555\" stroke-width=\"2.6\"/><text x=\"{:.1}\" y=\"28\">asymmetrically</text>\
         <circle cx=\"{:.1}\" cy=\"22\" r=\"5.5\" fill=\"#fff\" stroke=\"#555\"/><path d=\"M{:.1} 30H{:.1}\" stroke=\"#555\" stroke-width=\"1.6\"/><text x=\"{:.1}\" y=\"28\">does not divide</text>\
         <text x=\"{:.1}\" y=\"47\" fill=\"#555\">discs are as wide as the cells; lines as strong as the daughter is large</text></g>",
        x,
        x + 12.0,
        x + 160.0,
        x + 171.0,
        x + 283.0,
        x + 277.5,
        x + 288.5,
        x + 295.0,
        x - 6.0
    );
    let _ = writeln!(
        out,
        "<text x=\"16\" y=\"{:.1}\" font-size=\"11\" fill=\"#777\">generation</text><text x=\"{:.1}\" y=\"{:.1}\" font-size=\"11\" fill=\"#777\" text-anchor=\"end\">cells</text>",
        TOP - 20.0,
        layout.width - 14.0,
        TOP - 20.0
    );
    let total = tree.cells().next_back().map_or(0, |n| tree.cell(n).generation);
    if total > layout.last {
        let _ = writeln!(
            out,
            "<text x=\"16\" y=\"{:.1}\" font-size=\"12\" fill=\"#a33\">generations {} to {total} are not drawn</text>",
            TOP + ROW * f64::from(layout.last) + 50.0,
            layout.last + 1
        );
    }
}
