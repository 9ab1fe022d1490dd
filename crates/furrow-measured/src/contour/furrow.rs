//! How deep a contour is furrowed.

use super::Contour;

/// Places along the long axis at which the width is taken.
const PLACES: usize = 400;
/// Least share of the area beyond a furrow on either side: a smaller one is roughness of a pole, not a daughter.
const LEAST_BEYOND: f64 = 0.05;

/// The furrow of a contour.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Furrow {
    /// 1 − w/W: w is the width at the furrow, W the smaller of the largest widths on the two sides. 0 for a convex contour, 1
    /// where the cell is cut through.
    pub depth: f64,
    /// Its place along the long axis.
    pub at: f64,
}

/// The furrow of a contour with its long axis along the second coordinate: the narrowest place relative to the widths on both
/// sides of it.
pub fn furrow(upright: &Contour) -> Furrow {
    let ends = upright.ends();
    let step = (ends[1] - ends[0]) / PLACES as f64;
    let place = |k: usize| ends[0] + (k as f64 + 0.5) * step;
    let mut widths = [0.0; PLACES];
    for [from, to] in upright.edges() {
        let (low, high) = (from.y.min(to.y), from.y.max(to.y));
        let first = ((low - ends[0]) / step - 0.5).ceil().max(0.0) as usize;
        for (k, width) in widths.iter_mut().enumerate().skip(first) {
            let y = place(k);
            if y >= high {
                break;
            }
            // A ring that runs anticlockwise goes up on the right and down on the left.
            let x = from.x + (to.x - from.x) * (y - from.y) / (to.y - from.y);
            *width += if to.y > from.y { x } else { -x };
        }
    }
    let area: f64 = widths.iter().sum();
    let mut beyond = 0.0;
    let mut deepest = Furrow { depth: 0.0, at: 0.5 * (ends[0] + ends[1]) };
    let mut widest_above = widths;
    for k in (0..PLACES - 1).rev() {
        widest_above[k] = widest_above[k].max(widest_above[k + 1]);
    }
    let mut widest_below = 0.0_f64;
    for (k, width) in widths.iter().enumerate() {
        beyond += width;
        widest_below = widest_below.max(*width);
        let share = beyond / area;
        if !(LEAST_BEYOND..=1.0 - LEAST_BEYOND).contains(&share) {
            continue;
        }
        let depth = 1.0 - width / widest_below.min(widest_above[k]);
        if depth > deepest.depth {
            deepest = Furrow { depth, at: place(k) };
        }
    }
    deepest
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contour::around;

    #[test]
    fn an_ellipse_has_none() {
        let ellipse = around(500, |t| [2.0 * t.cos(), 3.0 * t.sin()]);
        assert!(furrow(&ellipse).depth < 1e-3);
    }

    /// Two circles, and between them a band as wide as half a radius: 1 − ½·½.
    #[test]
    fn a_dumbbell_has_one() {
        let half: Vec<[f64; 2]> = (0..=600)
            .map(|k| {
                let z = 3.0 - 6.0 * k as f64 / 600.0;
                let circle = (1.0 - (z.abs() - 2.0).powi(2)).max(0.0).sqrt();
                [if z.abs() < 2.0 { circle.max(0.25) } else { circle }, z]
            })
            .collect();
        let other = half.iter().rev().map(|p| [-p[0], p[1]]);
        let (dumbbell, _) = Contour::new(half.iter().copied().chain(other).collect()).unwrap();
        let found = furrow(&dumbbell);
        assert!((found.depth - 0.75).abs() < 1e-3 && found.at.abs() < 1.1, "{found:?}");
    }
}
