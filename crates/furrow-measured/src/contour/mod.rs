//! Closed contours of cells in an axial section: their area, centroid, long axis and furrow, and how far two of them overlap.
//!
//! | file | content |
//! |---|---|
//! | `mod.rs` | a closed contour, its moments, and where it is put so that contours of several sources lie on each other |
//! | [`furrow`] | how deep a contour is furrowed |
//! | [`overlap`] | the similarity index, by exact areas and by pixels |
//! | [`polygons`] | contours in a table of points |
//! | [`mask`] | the contour of a cell in a picture of black and white |
//! | [`series`] | measured contours beside a division's |

pub mod furrow;
pub mod mask;
pub mod overlap;
pub mod polygons;
pub mod series;

use i_overlay::core::fill_rule::FillRule;
use i_overlay::float::simplify::SimplifyShape;
use nalgebra::{Matrix2, Point2, Rotation2, SymmetricEigen, Vector2};
use ordered_float::OrderedFloat;

/// Largest share of its area by which a contour may change when loops are cut off. A larger change is more than a slip of the hand.
const MOST_CUT: f64 = 0.01;
/// The smallest size of a contour, and its largest coordinate: beyond, second moments are lost to underflow or overflow.
const SIZES: [f64; 2] = [1e-60, 1e60];

/// Most points of a contour. The outline of a round cell in the largest mask has 40,000; clipping a million takes seconds.
pub const MOST_POINTS: usize = 1_000_000;

/// A closed contour that does not cross itself, run through anticlockwise. Lengths are in the unit of its source.
///
/// # Examples
/// ```
/// use furrow_measured::contour::Contour;
/// let (square, cut) = Contour::new(vec![[1.0, 1.0], [1.0, 3.0], [3.0, 3.0], [3.0, 1.0]])?;
/// let moments = square.moments();
/// assert_eq!((moments.area, cut), (4.0, 0.0));
/// assert!((moments.centroid.x - 2.0).abs() + (moments.centroid.y - 2.0).abs() < 1e-12);
/// # Ok::<(), furrow_measured::contour::Unusable>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Contour {
    points: Vec<Point2<f64>>,
}

/// Why points are no contour.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Unusable {
    /// Too few.
    #[error("{0} points; a contour has at least 3 that differ")]
    TooFew(usize),
    /// Too many.
    #[error("{MOST_POINTS} points or more; the outline of one cell has fewer")]
    TooMany,
    /// Not finite, or so large that areas are not.
    #[error("a coordinate is not a number below 1e60")]
    NotFinite,
    /// All on a line.
    #[error("it encloses no area")]
    NoArea,
    /// Not one piece.
    #[error("it crosses itself, and {:.1} % of its area is in other loops than the largest; 1 % is let pass", 100.0 * .0)]
    Crosses(f64),
}

/// Area and moments of a filled contour.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moments {
    /// Area.
    pub area: f64,
    /// Centroid.
    pub centroid: Point2<f64>,
    /// Direction of the long axis, along which the second moment is the largest: of unit length, to the right.
    pub long_axis: Vector2<f64>,
    /// Square root of the ratio of the second moments along the long axis and across: of an ellipse the ratio of its axes.
    pub elongation: f64,
}

impl Contour {
    /// The contour through these points, closed from the last to the first, and the share of its area that is cut off with small
    /// loops where it crosses itself.
    ///
    /// # Errors
    /// [`Unusable`].
    pub fn new(points: Vec<[f64; 2]>) -> Result<(Contour, f64), Unusable> {
        if points.len() >= MOST_POINTS {
            return Err(Unusable::TooMany);
        }
        if points.iter().flatten().any(|x| x.is_nan() || x.abs() > SIZES[1]) {
            return Err(Unusable::NotFinite);
        }
        let mut points = points;
        points.dedup();
        while points.len() > 1 && points.first() == points.last() {
            points.pop();
        }
        if points.len() < 3 {
            return Err(Unusable::TooFew(points.len()));
        }
        let size = extent(&points);
        let drawn = signed_area(&points);
        if size < SIZES[0] || drawn.abs() <= 1e-9 * size * size {
            return Err(Unusable::NoArea);
        }
        // By the winding number a loop that runs the other way round is a piece of its own, to be weighed against the largest.
        // Corners are put on a grid of 64-bit integers: with 32 bits, outlines of a few points upon each other took seconds.
        let pieces = points.simplify_shape_as::<i64>(FillRule::NonZero);
        let mut rings: Vec<&Vec<[f64; 2]>> = pieces.iter().flatten().collect();
        rings.sort_by_cached_key(|ring| OrderedFloat(-signed_area(ring).abs()));
        let Some(largest) = rings.first() else { return Err(Unusable::NoArea) };
        let kept = signed_area(largest).abs();
        let rest: f64 = rings[1..].iter().map(|ring| signed_area(ring).abs()).sum();
        let cut = (rest / kept).max((kept - drawn.abs()).abs() / kept);
        // Below the grid of the clipping a difference is rounding.
        let cut = if cut < 1e-7 { 0.0 } else { cut };
        if cut > MOST_CUT {
            return Err(Unusable::Crosses(cut));
        }
        let mut points = if cut > 0.0 { (*largest).clone() } else { points };
        if signed_area(&points) < 0.0 {
            points.reverse();
        }
        Ok((Contour { points: points.into_iter().map(Point2::from).collect() }, cut))
    }

    /// Its points.
    pub fn points(&self) -> &[Point2<f64>] {
        &self.points
    }

    /// Least and largest second coordinate.
    pub fn ends(&self) -> [f64; 2] {
        let along = self.points.iter().map(|point| point.y);
        along.fold([f64::INFINITY, f64::NEG_INFINITY], |[least, most], y| [least.min(y), most.max(y)])
    }

    /// Its edges, each from a point to the next.
    pub fn edges(&self) -> impl Iterator<Item = [Point2<f64>; 2]> + '_ {
        let next = self.points.iter().cycle().skip(1);
        self.points.iter().zip(next).map(|(from, to)| [*from, *to])
    }

    /// Area, centroid and second moments of the enclosed area, exactly: sums over its edges, by Green's theorem.
    pub fn moments(&self) -> Moments {
        // About one of its own points, so that a contour far from the origin loses no digits.
        let about = self.points[0];
        let (mut area, mut first, mut second) = (0.0, Vector2::zeros(), Matrix2::zeros());
        for edge in self.edges() {
            let [p, q] = edge.map(|point| point - about);
            let cross = p.x * q.y - q.x * p.y;
            area += cross / 2.0;
            first += (p + q) * (cross / 6.0);
            let mixed = p * q.transpose();
            second += (p * p.transpose() + q * q.transpose() + (mixed + mixed.transpose()) / 2.0) * (cross / 12.0);
        }
        let mean = first / area;
        let eigen = SymmetricEigen::new(second / area - mean * mean.transpose());
        let (long, short) = if eigen.eigenvalues[0] >= eigen.eigenvalues[1] { (0, 1) } else { (1, 0) };
        let axis: Vector2<f64> = eigen.eigenvectors.column(long).into_owned();
        let right = if axis.x < 0.0 || (axis.x == 0.0 && axis.y < 0.0) { -axis } else { axis };
        let elongation = (eigen.eigenvalues[long] / eigen.eigenvalues[short].max(f64::MIN_POSITIVE)).sqrt();
        Moments { area, centroid: about + mean, long_axis: right, elongation }
    }

    /// The contour with its centroid in the origin and its long axis along the second coordinate, as the model's axis lies.
    pub fn upright(&self) -> Contour {
        let Moments { centroid, long_axis, .. } = self.moments();
        let turn = Rotation2::rotation_between(&long_axis, &Vector2::y());
        self.map(|point| Point2::from(turn * (point - centroid)))
    }

    /// Turned by half a turn about the origin.
    pub fn turned(&self) -> Contour {
        self.map(|point| -point)
    }

    /// Lengths times a factor above 0.
    pub fn scaled(&self, factor: f64) -> Contour {
        self.map(|point| point * factor)
    }

    fn map(&self, point: impl Fn(&Point2<f64>) -> Point2<f64>) -> Contour {
        Contour { points: self.points.iter().map(point).collect() }
    }

    fn rings(&self) -> Vec<[f64; 2]> {
        self.points.iter().map(|point| [point.x, point.y]).collect()
    }
}

/// The area within a ring, positive if it runs anticlockwise.
fn signed_area(ring: &[[f64; 2]]) -> f64 {
    let about = ring.first().copied().unwrap_or_default();
    let next = ring.iter().cycle().skip(1);
    let cross =
        |(p, q): (&[f64; 2], &[f64; 2])| (p[0] - about[0]) * (q[1] - about[1]) - (q[0] - about[0]) * (p[1] - about[1]);
    ring.iter().zip(next).map(cross).sum::<f64>() / 2.0
}

/// The larger side of the box around points.
fn extent(points: &[[f64; 2]]) -> f64 {
    let side = |k: usize| {
        let along = points.iter().map(|p| p[k]);
        along.clone().fold(f64::NEG_INFINITY, f64::max) - along.fold(f64::INFINITY, f64::min)
    };
    side(0).max(side(1))
}

/// Points at `count` angles around a cell, for tests.
#[cfg(test)]
pub(crate) fn around(count: u32, at: impl Fn(f64) -> [f64; 2]) -> Contour {
    let angles = (0..count).map(|k| f64::from(k) / f64::from(count) * std::f64::consts::TAU);
    Contour::new(angles.map(at).collect()).unwrap().0
}
