//! The lineage as a drawing.

use super::escape;
use super::summary::TreeSummary;
use super::table::{outcome_name, short};
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
    let mut last = 0;
    for (g, row) in summary.generations.iter().enumerate() {
        if ended + row.cells > frame.max_ends {
            break;
        }
        last = g as u32;
        ended += row.ended;
    }
    let order: Vec<CellId> = tree.depth_first(last).collect();
    let mut x = vec![None; tree.len()];
    let ends = order.iter().filter(|n| tree.cell(**n).generation == last || tree.daughters(**n).is_none()).count();
    let gap = ((frame.width - frame.left - frame.right) / ends.max(1) as f64).max(frame.gap);
    let mut next = frame.left + 0.5 * gap;
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
    Layout { frame, x, width: (next - 0.5 * gap + frame.right).max(frame.width), last, order }
}

/// The tree as SVG: one row a generation, discs as wide as their cells, coloured by founder. A full disc divides
/// symmetrically, a ring asymmetrically; an open circle over a bar ended.
pub fn svg(tree: &Tree) -> String {
    let summary = TreeSummary::of(tree);
    let layout = lay_out(tree, &summary, &FULL);
    let colours = colours(&tree.lineage);
    let mut out = String::with_capacity(400 * layout.order.len() + 4000);
    begin(&mut out, &layout);
    legend(&mut out, tree, &colours, &layout);
    for (g, row) in summary.generations.iter().enumerate().take(layout.last as usize + 1) {
        let y = FULL.top + FULL.row * g as f64;
        let _ = writeln!(
            out,
            "<path d=\"M{:.1} {y:.1}H{:.1}\" stroke=\"#eceef1\"/><text x=\"16\" y=\"{:.1}\" font-size=\"13\" fill=\"#555\">{g}</text><text x=\"{:.1}\" y=\"{:.1}\" font-size=\"12\" fill=\"#555\" text-anchor=\"end\">{}</text>",
            FULL.left - 50.0,
            layout.width - FULL.right + 22.0,
            y + 4.5,
            layout.width - 14.0,
            y + 4.5,
            row.cells
        );
    }
    cells(&mut out, tree, &layout, &colours);
    out
}

/// The tree as one of several drawings on a page: without a legend, generations numbered on the left, in
/// the given colours of its founders.
pub(super) fn small(tree: &Tree, colours: &[&str]) -> String {
    let layout = lay_out(tree, &TreeSummary::of(tree), &SMALL);
    let mut out = String::with_capacity(300 * layout.order.len() + 1000);
    begin(&mut out, &layout);
    for g in 0..=layout.last {
        let y = SMALL.top + SMALL.row * f64::from(g);
        let _ = writeln!(
            out,
            "<path d=\"M24 {y:.1}H{:.1}\" stroke=\"#eceef1\"/><text x=\"6\" y=\"{:.1}\" font-size=\"9\" fill=\"#777\">{g}</text>",
            layout.width - 6.0,
            y + 3.0
        );
    }
    cells(&mut out, tree, &layout, colours);
    out
}

fn begin(out: &mut String, layout: &Layout) {
    let (width, height) =
        (layout.width, layout.frame.top + layout.frame.row * f64::from(layout.last) + layout.frame.bottom);
    let _ = writeln!(
        out,
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width:.0} {height:.0}\" width=\"{width:.0}\" height=\"{height:.0}\" font-family=\"Helvetica, Arial, sans-serif\">"
    );
    let _ = writeln!(out, "<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>");
}

/// All lines, and the discs over them.
fn cells(out: &mut String, tree: &Tree, layout: &Layout, colours: &[&str]) {
    for &node in &layout.order {
        edges(out, tree, node, layout, colours);
    }
    for &node in &layout.order {
        disc(out, tree, node, layout, colours);
    }
    out.push_str("</svg>\n");
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

fn edges(out: &mut String, tree: &Tree, node: CellId, layout: &Layout, colours: &[&str]) {
    let (Some(pair), Some(x)) = (tree.daughters(node), layout.x[node.index()]) else { return };
    let y = y_of(tree, node, layout);
    for daughter in pair {
        let Some(to) = layout.x[daughter.index()] else { continue };
        let cell = tree.cell(daughter);
        // The line is as strong as the daughter is large.
        let stroke = 0.26 * disc_radius(tree, cell.r0, layout);
        let row = layout.frame.row;
        let down = y + row;
        let (a, b) = (y + 0.42 * row, down - 0.42 * row);
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
    let y = y_of(tree, node, layout);
    let radius = disc_radius(tree, cell.r0, layout);
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
    if let Some(reason) = cell.fate.terminal_reason() {
        let _ = write!(title, "; {reason}");
    }
    let _ = write!(out, "<g><title>{}</title>", escape(&title));
    match (cell.fate.terminal_reason(), cell.fate.outcome()) {
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
    let away = disc_radius(tree, cell.r0, layout) + 5.0;
    let (x, anchor) = if left { (x - away, "end") } else { (x + away, "start") };
    let y = y_of(tree, node, layout) - 5.0;
    let mut line = |y: f64, font: &str, text: &str| {
        // A white copy underneath keeps the text clear of lines.
        let halo = "fill=\"#fff\" stroke=\"#fff\" stroke-width=\"4\" stroke-linejoin=\"round\"";
        for paint in [halo, &format!("fill=\"{colour}\"")] {
            let _ =
                writeln!(out, "<text x=\"{x:.1}\" y=\"{y:.1}\" {font} text-anchor=\"{anchor}\" {paint}>{text}</text>");
        }
    };
    let font = layout.frame.font;
    line(y, &format!("font-size=\"{font}\" font-weight=\"bold\""), &escape(&cell.name));
    let unequal = layout.frame.asymmetry && cell.fate.outcome() == Some(Outcome::Asymmetric);
    if let Some(chi) = cell.fate.chi().filter(|_| unequal) {
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
    let x = layout.width.min(FULL.width) - 470.0;
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
        FULL.top - 20.0,
        layout.width - 14.0,
        FULL.top - 20.0
    );
    let total = tree.cells().next_back().map_or(0, |n| tree.cell(n).generation);
    if total > layout.last {
        let _ = writeln!(
            out,
            "<text x=\"16\" y=\"{:.1}\" font-size=\"12\" fill=\"#a33\">generations {} to {total} are not drawn</text>",
            FULL.top + FULL.row * f64::from(layout.last) + 50.0,
            layout.last + 1
        );
    }
}
