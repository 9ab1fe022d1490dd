//! A cell: its contour in its shell, the cue along it.

use super::canvas::{Canvas, Stroke};
use super::style::{CUE, CYTOPLASM, INK, SHELL};
use furrow_cell::Cue;

/// Where a cell is drawn, and how large. Its axis lies across, the anterior pole, u = 1, on the left.
#[derive(Clone, Copy, Debug)]
pub struct Site {
    /// Where the middle of its shell is on the canvas.
    pub centre: [f64; 2],
    /// Units of the canvas for one L_h.
    pub scale: f64,
}

impl Site {
    /// A point (r, z) on the canvas, on the upper side of the axis.
    pub fn point(&self, [r, z]: [f64; 2]) -> [f64; 2] {
        [self.centre[0] + self.scale * z, self.centre[1] - self.scale * r]
    }
}

/// The outline of a contour (r, z) from pole to pole, both sides of the axis.
fn outline(contour: &[[f64; 2]], site: &Site) -> Vec<[f64; 2]> {
    let above = contour.iter().map(|[r, z]| site.point([r.max(0.0), *z]));
    let below = contour.iter().rev().map(|[r, z]| site.point([-r.max(0.0), *z]));
    above.chain(below).collect()
}

/// The shell, half axes along z and across, as a broken line.
pub fn shell(canvas: &mut Canvas, [along, across]: [f64; 2], site: &Site) {
    let points: Vec<[f64; 2]> = (0..=96)
        .map(|k| {
            let (sin, cos) = (k as f64 / 48.0 * std::f64::consts::PI).sin_cos();
            site.point([across * sin, along * cos])
        })
        .collect();
    canvas.polyline(&points, Stroke::dashed(SHELL, 1.4, [5.0, 4.0]));
}

/// The inside of a cell and its contour.
pub fn body(canvas: &mut Canvas, contour: &[[f64; 2]], site: &Site, width: f64) {
    canvas.polygon(&outline(contour, site), CYTOPLASM, 1.0, Some(Stroke::solid(INK, width)));
}

/// How strong a cue is at u on a contour of length `length`, from 0 to 1, relative to where it is strongest.
pub fn strength(cue: &Cue, length: f64) -> impl Fn(f64) -> f64 + '_ {
    let sum = move |u: f64| cue.terms().iter().map(|term| term.at(u, length)[0]).sum::<f64>().abs();
    let largest = (0..=400).map(|k| sum(k as f64 / 400.0)).fold(0.0, f64::max);
    move |u| if largest > 0.0 { (sum(u) / largest).min(1.0) } else { 0.0 }
}

/// The cue, as a strip along the outside of the contour that is as strong as the cue is there. `places` are (u, r, z) from pole
/// to pole.
pub fn cue(canvas: &mut Canvas, cue: &Cue, length: f64, places: &[[f64; 3]], site: &Site, width: f64) {
    if cue.is_none() {
        return;
    }
    let strength = strength(cue, length);
    for side in [1.0, -1.0] {
        for pair in places.windows(2) {
            let ([u, r, z], [u2, r2, z2]) = (pair[0], pair[1]);
            let here = strength(0.5 * (u + u2));
            let (a, b) = (site.point([side * r, z]), site.point([side * r2, z2]));
            let length = (b[0] - a[0]).hypot(b[1] - a[1]);
            if here < 0.08 || length < 1e-6 {
                continue;
            }
            // Outwards of the contour as it is drawn: to the left of its direction above the axis, to the right below.
            let normal = [side * (b[1] - a[1]) / length, -side * (b[0] - a[0]) / length];
            let out = |p: [f64; 2], by: f64| [p[0] - by * normal[0], p[1] - by * normal[1]];
            canvas.polygon(&[out(a, 1.0), out(b, 1.0), out(b, width), out(a, width)], CUE, here, None);
        }
    }
}
