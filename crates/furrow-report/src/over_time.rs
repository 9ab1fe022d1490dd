//! Cells alive over time, as a figure of the page.

use std::fmt::Write;

use super::escape;
use super::svg::colours;
use furrow_analysis::compare::departure::{self, OverTime};
use furrow_lineage::Tree;
use furrow_lineage::clock::{alive, last_divisions};

/// Size of the figure, and its left, right, top and bottom margins.
const SIZE: [f64; 2] = [860.0, 330.0];
const MARGINS: [f64; 4] = [56.0, 20.0, 14.0, 44.0];
/// Distance of two rows of words, and about the width of a letter.
const ROW: f64 = 15.0;
const LETTER: f64 = 6.2;

/// Times and numbers of cells on the figure.
struct Scale {
    from: f64,
    to: f64,
    most: f64,
}

impl Scale {
    fn x(&self, min: f64) -> f64 {
        MARGINS[0] + (min - self.from) / (self.to - self.from) * (SIZE[0] - MARGINS[0] - MARGINS[1])
    }

    /// Over logarithms.
    fn y(&self, cells: f64) -> f64 {
        let bottom = SIZE[1] - MARGINS[3];
        bottom - cells.max(1.0).ln() / self.most.ln() * (bottom - MARGINS[2])
    }

    /// A line in steps through times and numbers of cells from then on.
    fn stairs(&self, points: &[(f64, usize)], style: &str) -> String {
        let mut path = String::new();
        for (k, (min, cells)) in points.iter().enumerate() {
            let (x, y) = (self.x(*min), self.y(*cells as f64));
            let _ = if k == 0 { write!(path, "M{x:.1} {y:.1}") } else { write!(path, "H{x:.1}V{y:.1}") };
        }
        format!("<path d=\"{path}\" fill=\"none\" {style}/>\n")
    }
}

/// A section with the cells of a tree over time, those of the embryo beside them for *C. elegans*; empty without a clock.
pub(super) fn section(tree: &Tree) -> String {
    let Some(times) = tree.times() else { return String::new() };
    let model: Vec<(f64, usize)> = alive(&times).iter().map(|alive| (alive.min, alive.cells)).collect();
    let (Some((from, _)), Some((to, _))) = (model.first(), model.last()) else { return String::new() };
    let most = model.iter().map(|(_, cells)| *cells).max().unwrap_or(1) as f64;
    let scale = Scale { from: *from, to: to.max(from + 1.0), most: 4.0 * most.max(4.0) };
    let mut out = axes(&scale);
    out += &scale.stairs(&model, "stroke=\"#2a9d6f\" stroke-width=\"2.2\"");
    let embryo = departure::of_worm(tree).and_then(|found| embryo(&found));
    if let Some(points) = &embryo {
        out += &scale.stairs(points, "stroke=\"currentColor\" stroke-width=\"1.8\" stroke-dasharray=\"6 3\"");
    }
    out += &lasts(tree, &scale, &last_divisions(tree, &times));
    let origin = tree.time_origin().map_or(String::new(), |origin| escape(&origin.to_string()));
    let beside = match embryo {
        None => "",
        Some(_) => {
            " Dashed: the embryo (means of 28 embryos, Jankele, Jelier &amp; Gönczy 2021), as far as all its lifetimes are known. The clock is fitted to it, \
             so that agreement in time is no prediction; which cells there are is."
        }
    };
    format!(
        "<section class=\"card\" id=\"over-time\"><h2>Cells over time</h2>\n<p class=\"small\">Cells alive by the lineage's clock; minute 0 is the {origin}. Marks: the last division \
         among the descendants of each founder.{beside}</p>\n<div class=\"figure\"><svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {} {}\" width=\"{}\" font-size=\"12\" \
         role=\"img\" aria-label=\"Cells alive over time\">\n{out}</svg></div></section>\n",
        SIZE[0], SIZE[1], SIZE[0]
    )
}

/// The embryo's cells, in the minutes of the tree.
fn embryo(found: &OverTime) -> Option<Vec<(f64, usize)>> {
    let (shift, embryo) = (found.shift_min?, &found.measured);
    let known = embryo.over_time.steps.iter().filter(|step| step.min <= embryo.known_until);
    let mut points: Vec<(f64, usize)> = known.map(|step| (step.min - shift, step.cells)).collect();
    let first = points.first()?.0;
    points.insert(0, (first, embryo.over_time.roots.len()));
    points.push((embryo.known_until - shift, points.last()?.1));
    Some(points)
}

fn axes(scale: &Scale) -> String {
    let steps = (0..6).flat_map(|power| [1.0, 2.0, 5.0].map(|digit| digit * 10_f64.powi(power)));
    let step = steps.into_iter().find(|step| (scale.to - scale.from) / step <= 12.0).unwrap_or(1e6);
    let (bottom, right) = (SIZE[1] - MARGINS[3], SIZE[0] - MARGINS[1]);
    let mut out = String::new();
    for k in (scale.from / step).ceil() as i64..=(scale.to / step).floor() as i64 {
        let (min, base) = (k as f64 * step, bottom + 17.0);
        let (x, words) = (scale.x(min), format!("{min:.0}").replace('-', "\u{2212}"));
        let _ = writeln!(
            out,
            r##"<path d="M{x:.1} {bottom:.1}V{:.1}" stroke="#8883"/><text x="{x:.1}" y="{base:.1}" text-anchor="middle" fill="currentColor">{words}</text>"##,
            MARGINS[2]
        );
    }
    for cells in (0..7).map(|power| 10_f64.powi(power)).filter(|cells| *cells <= scale.most) {
        let (y, from, at) = (scale.y(cells), MARGINS[0], MARGINS[0] - 7.0);
        let base = y + 4.0;
        let _ = writeln!(
            out,
            r##"<path d="M{from:.1} {y:.1}H{right:.1}" stroke="#8883"/><text x="{at:.1}" y="{base:.1}" text-anchor="end" fill="currentColor">{cells:.0}</text>"##
        );
    }
    let (middle, foot, half) = (0.5 * (MARGINS[0] + right), SIZE[1] - 8.0, 0.5 * (MARGINS[2] + bottom));
    let _ = writeln!(
        out,
        r##"<text x="{middle:.1}" y="{foot:.1}" text-anchor="middle" fill="currentColor">time (min)</text><text transform="translate(14 {half:.1}) rotate(-90)" text-anchor="middle" fill="currentColor">cells alive</text>"##
    );
    out
}

/// The last division of each founder above the axis of time, names in rows in which none meets another. Founders with one minute,
/// as a founder and its mother, are named together. The last is the lowest, so that no mark crosses a name behind it.
fn lasts(tree: &Tree, scale: &Scale, last: &[Option<f64>]) -> String {
    let colours = colours(&tree.lineage);
    let mut marks: Vec<(f64, usize)> = last.iter().enumerate().filter_map(|(k, min)| Some(((*min)?, k))).collect();
    marks.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
    let bottom = SIZE[1] - MARGINS[3];
    let (mut out, mut rows): (String, Vec<f64>) = Default::default();
    for same in marks.chunk_by(|a, b| a.0 == b.0) {
        let names: Vec<&str> = same.iter().map(|(_, k)| tree.lineage.founders[*k].name.as_str()).collect();
        // The founder nearest to the cells has the colour.
        let (min, colour) = (same[0].0, same.last().map_or("#555", |(_, k)| colours[*k]));
        let words = format!("{}, {min:.0}", names.join(" "));
        let (x, wide) = (scale.x(min), LETTER * words.chars().count() as f64);
        let is_cut = x + 4.0 + wide > SIZE[0] - MARGINS[1];
        let from = if is_cut { x - 4.0 - wide } else { x + 4.0 };
        let row = rows.iter().position(|start| (from + wide).max(x) + 8.0 < *start).unwrap_or(rows.len());
        if row == rows.len() {
            rows.push(0.0);
        }
        rows[row] = from.min(x);
        let (top, base) = (bottom - 6.0 - ROW * (row + 1) as f64 + 4.0, bottom - 8.0 - ROW * row as f64);
        let words = escape(&words);
        let _ = writeln!(
            out,
            r##"<g class="founder" style="--of:{colour}"><path d="M{x:.1} {bottom:.1}V{top:.1}" stroke-width="2"/><text x="{from:.1}" y="{base:.1}" font-size="11">{words}</text></g>"##
        );
    }
    out
}
