//! How far two filled contours overlap.
//!
//! * \[similarity\] |A∩B|/|A| of a contour A that was measured and B of the model.

use i_overlay::core::fill_rule::FillRule;
use i_overlay::core::overlay_rule::OverlayRule;
use i_overlay::float::single::SingleFloatOverlay;
use nalgebra::Point2;
use ordered_float::OrderedFloat;
use serde::Serialize;

use super::{Contour, signed_area};

/// The overlap of two filled contours as they lie.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Overlap {
    /// |A∩B|/|A|.
    pub similarity: f64,
    /// |A∩B|/|B|.
    pub of_model: f64,
    /// |A∩B|/|A∪B|, which only equal contours have as 1.
    pub jaccard: f64,
}

impl Overlap {
    fn of(area: f64, model: f64, common: f64) -> Overlap {
        Overlap { similarity: common / area, of_model: common / model, jaccard: common / (area + model - common) }
    }
}

/// By the exact areas of polygons.
pub fn overlap(a: &Contour, b: &Contour) -> Overlap {
    // On a grid of 64-bit integers, as in `Contour::new`.
    let common = a.rings().overlay_as::<i64>(&b.rings(), OverlayRule::Intersect, FillRule::NonZero);
    // Outer rings and holes have opposite signs.
    let common: f64 = common.iter().flatten().map(|ring| signed_area(ring)).sum();
    Overlap::of(a.moments().area, b.moments().area, common.abs())
}

/// Counts square pixels of side `pixel` with their centres inside.
pub fn overlap_of_pixels(a: &Contour, b: &Contour, pixel: f64) -> Overlap {
    let [a_ends, b_ends] = [a, b].map(Contour::ends);
    let rows = (a_ends[0].min(b_ends[0]) / pixel).floor() as i64..=(a_ends[1].max(b_ends[1]) / pixel).ceil() as i64;
    let mut counts = [0_i64; 3];
    let mut sweeps = [a, b].map(Sweep::over);
    for row in rows {
        let y = (row as f64 + 0.5) * pixel;
        let [in_a, in_b] = sweeps.each_mut().map(|sweep| columns(sweep.at(y), y, pixel));
        for (count, ranges) in counts.iter_mut().zip([&in_a, &in_b]) {
            *count += ranges.iter().map(|[from, to]| to - from).sum::<i64>();
        }
        for x in &in_a {
            counts[2] += in_b.iter().map(|y| (x[1].min(y[1]) - x[0].max(y[0])).max(0)).sum::<i64>();
        }
    }
    let [a, b, common] = counts.map(|count| count as f64);
    Overlap::of(a, b, common)
}

/// A line that sweeps over a contour. It holds the edges that it crosses, so that a row costs its crossings and not all edges:
/// the outline of a mask has as many edges as its pixels have sides.
struct Sweep {
    /// Edges that it has not come to, the lowest last.
    above: Vec<[Point2<f64>; 2]>,
    crossed: Vec<[Point2<f64>; 2]>,
}

impl Sweep {
    fn over(contour: &Contour) -> Sweep {
        let mut above: Vec<_> = contour.edges().collect();
        above.sort_by_cached_key(|item| OrderedFloat(-lowest(item)));
        Sweep { above, crossed: Vec::new() }
    }

    /// The edges crossed at `y`, which is above all that it was at before.
    fn at(&mut self, y: f64) -> &[[Point2<f64>; 2]] {
        let reached = self.above.iter().rposition(|edge| lowest(edge) > y).map_or(0, |last| last + 1);
        self.crossed.extend(self.above.drain(reached..));
        self.crossed.retain(|[from, to]| (from.y <= y) != (to.y <= y));
        &self.crossed
    }
}

fn lowest([from, to]: &[Point2<f64>; 2]) -> f64 {
    from.y.min(to.y)
}

/// Columns of a row's pixels with their centres inside, as half-open ranges, from the edges that cross the row at `y`.
fn columns(crossing: &[[Point2<f64>; 2]], y: f64, pixel: f64) -> Vec<[i64; 2]> {
    let mut at: Vec<f64> = crossing.iter().map(|[p, q]| p.x + (q.x - p.x) * (y - p.y) / (q.y - p.y)).collect();
    at.sort_by(f64::total_cmp);
    // The centre of column c lies at (c + ½) pixels.
    let first = |x: f64| (x / pixel - 0.5).ceil() as i64;
    at.chunks_exact(2).map(|pair| [first(pair[0]), first(pair[1])]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contour::around;

    fn square(corner: f64, side: f64) -> Contour {
        let [low, high] = [corner, corner + side];
        Contour::new(vec![[low, low], [high, low], [high, high], [low, high]]).unwrap().0
    }

    #[test]
    fn squares_overlap_by_known_areas() {
        // 1 of 4 and 1 of 9, by hand.
        let found = overlap(&square(0.0, 2.0), &square(1.0, 3.0));
        assert!((found.similarity - 0.25).abs() < 1e-7, "{found:?}");
        assert!((found.of_model - 1.0 / 9.0).abs() < 1e-7 && (found.jaccard - 1.0 / 12.0).abs() < 1e-7, "{found:?}");
        let pixels = overlap_of_pixels(&square(0.0, 2.0), &square(1.0, 3.0), 0.01);
        assert_eq!(pixels, Overlap::of(40_000.0, 90_000.0, 10_000.0));
        let apart = overlap(&square(0.0, 1.0), &square(5.0, 1.0));
        assert_eq!((apart.similarity, apart.jaccard), (0.0, 0.0));
    }

    /// A comb of thin teeth has as many edges in each row as there are teeth. Over all rows an edge is met once or twice, not once a row.
    #[test]
    fn the_pixels_of_a_comb_are_counted_in_time_linear_in_its_edges() {
        let (teeth, height) = (200, 400);
        let mut points = Vec::new();
        for tooth in 0..teeth {
            let x = f64::from(4 * tooth);
            let up = (0..=height).map(|k| [x, f64::from(k)]);
            let down = (0..=height).rev().map(|k| [x + 2.0, f64::from(k)]);
            points.extend(up.chain(down));
        }
        points.extend([[f64::from(4 * teeth), -1.0], [-1.0, -1.0]]);
        let (comb, _) = Contour::new(points).unwrap();
        let mut sweep = Sweep::over(&comb);
        let edges = sweep.above.len();
        let met: usize = (0..height).map(|row| sweep.at(f64::from(row) + 0.5).len()).sum();
        assert_eq!(met, (2 * teeth * height) as usize);
        assert!(met <= edges, "{met} of {edges}");
        // Each row crosses all teeth, and the pixels give the exact area.
        let found = overlap_of_pixels(&comb, &square(0.0, 40.0), 1.0);
        let common = (10.0 * 2.0 * 40.0) / 1600.0;
        assert_eq!(found.of_model, common, "{found:?}");
    }

    /// Two circles with centres one radius apart have a lens of 2π/3 − √3/2, which inscribed polygons approach from below.
    #[test]
    fn circles_overlap_in_a_lens() {
        let circle = |x: f64| around(4000, |t| [x + t.cos(), t.sin()]);
        let lens = (2.0 * std::f64::consts::PI / 3.0 - 3.0_f64.sqrt() / 2.0) / std::f64::consts::PI;
        let (left, right) = (circle(0.0), circle(1.0));
        assert!((overlap(&left, &right).similarity - lens).abs() < 2e-6);
        assert!((overlap_of_pixels(&left, &right, 0.01).similarity - lens).abs() < 2e-3);
    }
}
