//! How far two filled contours overlap.
//!
//! * \[similarity\] |A∩B|/|A| of a contour A that was measured and B of the model.

use i_overlay::core::fill_rule::FillRule;
use i_overlay::core::overlay_rule::OverlayRule;
use i_overlay::float::single::SingleFloatOverlay;
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

/// By counting the square pixels of a side whose centres lie within.
pub fn overlap_of_pixels(a: &Contour, b: &Contour, pixel: f64) -> Overlap {
    let [a_ends, b_ends] = [a, b].map(Contour::ends);
    let rows = (a_ends[0].min(b_ends[0]) / pixel).floor() as i64..=(a_ends[1].max(b_ends[1]) / pixel).ceil() as i64;
    let mut counts = [0_i64; 3];
    for row in rows {
        let y = (row as f64 + 0.5) * pixel;
        let [in_a, in_b] = [a, b].map(|contour| columns(contour, y, pixel));
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

/// Columns of the pixels of one row whose centres lie within, as half-open ranges.
fn columns(contour: &Contour, y: f64, pixel: f64) -> Vec<[i64; 2]> {
    let crossing = contour.edges().filter(|[from, to]| (from.y <= y) != (to.y <= y));
    let mut at: Vec<f64> = crossing.map(|[p, q]| p.x + (q.x - p.x) * (y - p.y) / (q.y - p.y)).collect();
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

    /// Of two circles whose centres are a radius apart the lens is 2π/3 − √3/2, which inscribed polygons have from below.
    #[test]
    fn circles_overlap_in_a_lens() {
        let circle = |x: f64| around(4000, |t| [x + t.cos(), t.sin()]);
        let lens = (2.0 * std::f64::consts::PI / 3.0 - 3.0_f64.sqrt() / 2.0) / std::f64::consts::PI;
        let (left, right) = (circle(0.0), circle(1.0));
        assert!((overlap(&left, &right).similarity - lens).abs() < 2e-6);
        assert!((overlap_of_pixels(&left, &right, 0.01).similarity - lens).abs() < 2e-3);
    }
}
