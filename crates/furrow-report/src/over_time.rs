//! Cells alive over time, as a figure of the page.

use std::cmp::Ordering;
use std::fmt::Write;

use super::escape;
use super::svg::colours;
use furrow_analysis::compare::departure::{self, OverTime};
use furrow_lineage::clock::{alive, last_times};
use furrow_lineage::{CellTimes, Tree};
use ordered_float::OrderedFloat;

/// Size of the figure, and its left, right, top and bottom margins.
const SIZE: [f64; 2] = [860.0, 330.0];
const MARGINS: [f64; 4] = [56.0, 20.0, 14.0, 44.0];
/// Distance between two rows of words, and the approximate width of a letter.
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

    /// On a logarithmic scale.
    fn y(&self, cells: f64) -> f64 {
        let bottom = SIZE[1] - MARGINS[3];
        bottom - cells.max(1.0).ln() / self.most.ln() * (bottom - MARGINS[2])
    }

    /// A line in steps; each point gives a time and the number of cells from then on.
    fn stairs(&self, points: &[(f64, usize)], style: &str) -> String {
        let mut path = String::new();
        for (k, (min, cells)) in points.iter().enumerate() {
            let (x, y) = (self.x(*min), self.y(*cells as f64));
            let _ = if k == 0 { write!(path, "M{x:.1} {y:.1}") } else { write!(path, "H{x:.1}V{y:.1}") };
        }
        format!("<path d=\"{path}\" fill=\"none\" {style}/>\n")
    }
}

/// A section with the cells of a tree over time, and beside them the embryo's cells for *C. elegans*; empty without a
/// clock.
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
    let last = last_times(tree, &times);
    out += &lasts(tree, &scale, &last);
    let origin = tree.time_origin().map_or(String::new(), |origin| escape(&origin.to_string()));
    let is_extrapolated = last.iter().flatten().any(|last| last.lifetime_extrapolated);
    let extrapolated =
        if is_extrapolated { " *: extrapolated, the clock was fitted to cells of other sizes." } else { "" };
    let beside = match embryo {
        None => "",
        Some(_) => {
            " Dashed: the embryo (means of 28 embryos, Jankele, Jelier &amp; Gönczy 2021), as far as all its lifetimes are known. The clock is fitted to it, \
             so that agreement in time is no prediction; which cells there are is."
        }
    };
    format!(
        "<section class=\"card\" id=\"over-time\"><h2>Cells over time</h2>\n<p class=\"small\">Cells alive by the lineage's clock; minute 0 is the {origin}. Marks: the last division \
         among the descendants of each founder.{extrapolated}{beside}</p>\n<div class=\"figure\"><svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {} {}\" width=\"{}\" font-size=\"12\" \
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

/// A mark at a last division, with a name on its right, or on its left where it would leave the figure.
struct Mark {
    x: f64,
    /// Where the name begins and ends.
    name: [f64; 2],
    words: String,
    colour: &'static str,
}

impl Mark {
    /// Whether a row is free for the name: it overlaps no other name there, and no vertical line crosses a name.
    fn fits(&self, row: usize, others: &[(usize, Mark)]) -> bool {
        let [from, to] = self.name;
        others.iter().all(|(of, other)| match row.cmp(of) {
            Ordering::Equal => to + 8.0 < other.name[0].min(other.x) || other.name[1].max(other.x) + 8.0 < from,
            Ordering::Less => !(from..=to).contains(&other.x),
            Ordering::Greater => !(other.name[0]..=other.name[1]).contains(&self.x),
        })
    }
}

/// The last division of each founder, in minutes. Founders with the same minute, such as a founder and its mother,
/// share a mark, in the colour of the founder nearest to the cells.
fn marks(tree: &Tree, scale: &Scale, last: &[Option<CellTimes>]) -> Vec<Mark> {
    let (colours, right) = (colours(&tree.lineage), SIZE[0] - MARGINS[1]);
    let minute = |(k, last): (usize, &Option<CellTimes>)| {
        let CellTimes { division_min, lifetime_extrapolated, .. } = (*last)?;
        Some((division_min?, k, if lifetime_extrapolated { "*" } else { "" }))
    };
    let mut minutes: Vec<(f64, usize, &str)> = last.iter().enumerate().filter_map(minute).collect();
    minutes.sort_by_cached_key(|item| OrderedFloat(item.0));
    let mark = |same: &[(f64, usize, &str)]| {
        let names: Vec<&str> = same.iter().map(|(_, k, _)| tree.lineage.founders[*k].name.as_str()).collect();
        let ((min, _, star), colour) = (same[0], same.last().map_or("#555", |(_, k, _)| colours[*k]));
        let words = format!("{}, {min:.0}{star}", names.join(" "));
        let (x, wide) = (scale.x(min), LETTER * words.chars().count() as f64);
        let from = if x + 4.0 + wide > right { x - 4.0 - wide } else { x + 4.0 };
        Mark { x, name: [from, from + wide], words, colour }
    };
    minutes.chunk_by(|a, b| a.0 == b.0).map(mark).collect()
}

/// The last divisions above the time axis, with names in rows. Names on the right of their marks are placed first, from
/// the last to the first, so that no other line crosses them; then those on the left, starting with the first.
fn lasts(tree: &Tree, scale: &Scale, last: &[Option<CellTimes>]) -> String {
    let (left, mut order): (Vec<Mark>, Vec<Mark>) =
        marks(tree, scale, last).into_iter().partition(|mark| mark.name[0] < mark.x);
    order.reverse();
    order.extend(left);
    let mut placed: Vec<(usize, Mark)> = Vec::new();
    for mark in order {
        let rows = placed.iter().map(|(row, _)| row + 1).max().unwrap_or(0);
        let row = (0..rows).find(|row| mark.fits(*row, &placed)).unwrap_or(rows);
        placed.push((row, mark));
    }
    let bottom = SIZE[1] - MARGINS[3];
    let drawn = |(row, Mark { x, name: [from, _], words, colour }): &(usize, Mark)| {
        let base = bottom - 8.0 - ROW * *row as f64;
        let (top, words) = (base - ROW + 6.0, escape(words));
        format!(
            "<g class=\"founder\" style=\"--of:{colour}\"><path d=\"M{x:.1} {bottom:.1}V{top:.1}\" stroke-width=\"2\"/><text x=\"{from:.1}\" y=\"{base:.1}\" font-size=\"11\">{words}</text></g>\n"
        )
    };
    placed.iter().map(drawn).collect()
}
