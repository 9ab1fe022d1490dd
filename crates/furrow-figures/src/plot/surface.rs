//! A cell that divides without axial symmetry: sections through it and its shell, the neck and χ over time, and how far the neck is from
//! the axis.

use crate::drawing::cell::{self as drawn, Site};
use crate::drawing::legend::{Key, Legend, titled};
use crate::drawing::panel::{Axis, Chart, widened};
use crate::drawing::style::{self, text};
use crate::drawing::{Anchor, Canvas, Stroke};
use furrow_cell::Cell;
use furrow_surface::film::{Film, Observables, Step};

use super::division::{NO_NECK, ending, evenly_passed};

const WIDTH: f64 = 1160.0;
/// Height of the row of sections.
const CELLS: f64 = 192.0;
/// Height of a chart with its legend.
const CHART: f64 = 400.0;
/// Number of sections.
const STILLS: usize = 6;

/// Draws a division without axial symmetry.
pub fn draw(cell: &Cell, film: &Film) -> Canvas {
    let title = format!("{}, without axial symmetry: {}", style::described(cell, &[]), ending(&film.found.division));
    let (mut canvas, top) = titled(WIDTH, CELLS + 46.0 + CHART, &title, &Legend::default());
    let overlaps = sections(&mut canvas, film, top);
    let soft = if overlaps { "; where walls meet, the soft force between them lets them overlap" } else { "" };
    let moves = if film.steps.iter().any(|step| step.shape.neck.is_some()) { "neck moves" } else { "cell bends" };
    let what = &format!("sections by the plane in which the {moves}{soft}");
    canvas.text([0.5 * WIDTH, top + CELLS + 18.0], what, text::TICK, Anchor::Middle, style::MUTED);
    over_time(&mut canvas, cell, film, top + CELLS + 46.0);
    canvas
}

/// Times between which the neck closes, or the mean meridian grows, by equal parts.
fn times(film: &Film) -> Vec<f64> {
    let Some(first) = film.steps.first() else { return Vec::new() };
    let radius = |shape: &Observables| shape.neck.map_or(film.wall.axes[0], |neck| neck.radius);
    let closes = film.found.division.chi().is_some();
    let progress = |step: &Step| {
        let longer = (step.shape.length / first.shape.length).ln();
        if closes { 0.5 * longer + 1.0 - radius(&step.shape) / film.wall.axes[0] } else { longer }
    };
    let times: Vec<f64> = film.steps.iter().map(|step| step.shape.t).collect();
    let passed: Vec<f64> = film.steps.iter().map(progress).collect();
    let mut stills = evenly_passed(&times, &passed, STILLS - 1);
    stills.push(film.end());
    stills
}

/// Draws the sections, and says whether walls overlap in one of them.
fn sections(canvas: &mut Canvas, film: &Film, top: f64) -> bool {
    let mut overlaps = false;
    let width = (WIDTH - 40.0) / STILLS as f64;
    let shell = film.wall.contour();
    let [along, across] = drawn::extent(&shell);
    let scale = (0.46 * width / along).min(0.42 * (CELLS - 30.0) / across);
    // The side of the axis on which the neck ends is drawn below.
    let side = film.steps.iter().rev().find_map(|step| step.shape.neck).map_or(1.0, |neck| -neck.offset.signum());
    for (k, t) in times(film).into_iter().enumerate() {
        let site = Site { centre: [20.0 + width * (k as f64 + 0.5), top + 0.5 * (CELLS - 24.0)], scale };
        drawn::shell(canvas, &shell, &site);
        if k == 0 {
            drawn::poles(canvas, &site, [0.46 * width / scale, across]);
        }
        let outline: Vec<[f64; 2]> = film.at(t).section().iter().map(|[x, z]| site.point([side * x, *z])).collect();
        overlaps |= crosses_itself(&outline);
        canvas.polygon(&outline, style::CYTOPLASM, 1.0, Some(Stroke::solid(style::INK, 2.0)));
        let word = format!("t = {} τ", style::time(t));
        canvas.text([site.centre[0], top + CELLS - 6.0], &word, text::TICK, Anchor::Middle, style::MUTED);
    }
    overlaps
}

/// Whether two sides of a closed line that are not neighbours cross.
fn crosses_itself(line: &[[f64; 2]]) -> bool {
    let side = |k: usize| [line[k], line[(k + 1) % line.len()]];
    let turn = |[a, b]: [[f64; 2]; 2], c: [f64; 2]| (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    let apart = |one: [[f64; 2]; 2], other: [[f64; 2]; 2]| turn(one, other[0]) * turn(one, other[1]) < 0.0;
    let pairs = (0..line.len()).flat_map(|k| (k + 2..line.len()).map(move |j| (side(k), side(j))));
    pairs.into_iter().any(|(one, other)| apart(one, other) && apart(other, one))
}

fn over_time(canvas: &mut Canvas, cell: &Cell, film: &Film, top: f64) {
    let shapes = || film.steps.iter().map(|step| step.shape);
    let necks = || shapes().filter_map(|shape| Some((shape.t, shape.neck?, shape.asymmetry)));
    let curves: [(Vec<[f64; 2]>, style::Colour, &str); 3] = [
        (necks().map(|(t, neck, _)| [t, neck.radius / cell.r0]).collect(), style::SYMMETRIC, "neck radius / R₀"),
        (
            necks().map(|(t, neck, _)| [t, neck.offset.abs() / cell.r0]).collect(),
            style::INK,
            "neck's distance from the axis / R₀",
        ),
        (necks().map(|(t, _, chi)| [t, chi.abs()]).collect(), style::ASYMMETRIC, "asymmetry χ about the neck"),
    ];
    let mut legend = Legend::default();
    for (curve, colour, name) in &curves {
        legend = legend.with_if(!curve.is_empty(), Key::Line(*colour), *name);
    }
    legend.draw(canvas, [70.0, top + 10.0], WIDTH - 90.0);
    let most = curves.iter().flat_map(|(curve, ..)| curve).map(|[_, value]| *value).fold(0.5, f64::max);
    let y = Axis::new("neck radius and distance / R₀,  χ", [0.0, widened([0.0, most], 0.08)[1]]);
    let x = Axis::new(style::TIME, [0.0, film.end()]);
    let mut chart = Chart::new(canvas, [0.0, top + 40.0], [WIDTH, CHART - 40.0], x, y);
    if curves.iter().all(|(curve, ..)| curve.is_empty()) {
        chart.note(NO_NECK);
    }
    for (curve, colour, _) in curves {
        chart.line(curve, Stroke::solid(colour, style::CURVE));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn walls_overlap_where_the_outline_crosses_itself() {
        let furrow = |half: f64| {
            [[-3.0, 0.0], [-half, 0.0], [-half, 2.0], [half, 2.0], [half, 0.0], [3.0, 0.0], [3.0, 4.0], [-3.0, 4.0]]
        };
        assert!(!crosses_itself(&furrow(0.1)));
        // The furrow is open at its bottom, and its walls cross above.
        let crossed = furrow(0.1).map(|[x, y]| if y == 2.0 { [-x, y] } else { [x, y] });
        assert!(crosses_itself(&crossed));
    }
}
