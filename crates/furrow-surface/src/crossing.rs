//! Detection of self-intersections of a surface.
//!
//! A ray from a point of a closed surface into the cell has one more exit than entries. If another wall has passed over the point, the
//! cell overlaps itself there and there are two more exits than entries; the wall of the first exit is the one that has crossed.

use crate::law::{Geometry, Vector};
use crate::space::{Meridian, Space, Station};

/// A triangle with its corners on the surface.
struct Facet {
    corner: Vector<f64>,
    edges: [Vector<f64>; 2],
    across: Vector<f64>,
}

fn dot(a: &Vector<f64>, b: &Vector<f64>) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: &Vector<f64>, b: &Vector<f64>) -> Vector<f64> {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn difference(a: &Vector<f64>, b: &Vector<f64>) -> Vector<f64> {
    std::array::from_fn(|k| a[k] - b[k])
}

impl Facet {
    fn new([a, b, c]: [&Vector<f64>; 3]) -> Facet {
        let edges = [difference(b, a), difference(c, a)];
        Facet { corner: *a, across: cross(&edges[0], &edges[1]), edges }
    }

    /// The intersection of a ray with the facet: the distance, and whether the ray leaves the cell there.
    fn met_by(&self, from: &Vector<f64>, ray: &Vector<f64>) -> Option<(f64, bool)> {
        let slope = dot(&self.across, ray);
        let apart = difference(from, &self.corner);
        let turned = cross(ray, &apart);
        let [a, b] = [dot(&turned, &self.edges[1]) / slope, -dot(&turned, &self.edges[0]) / slope];
        let distance = -dot(&apart, &self.across) / slope;
        (slope != 0.0 && a >= 0.0 && b >= 0.0 && a + b <= 1.0).then_some((distance, slope > 0.0))
    }
}

/// Rings of points of a surface around the axis, from pole to pole.
fn rings(space: &Space, surface: &[f64]) -> Vec<Vec<Vector<f64>>> {
    let around = 2 * space.meridians.len().max(6);
    let angle = |j: usize| std::f64::consts::TAU * (j as f64 + 0.5) / around as f64;
    let meridians: Vec<Meridian> = (0..around).map(|j| space.meridian(angle(j))).collect();
    let mut functions = Vec::new();
    let mut ring = |station: &Station| {
        space.functions(surface, station, &mut functions);
        meridians.iter().map(|meridian| space.shape(&functions, meridian)[0]).collect()
    };
    let [first, last] = [0.0, 1.0].map(|u| space.station(u));
    std::iter::once(&first).chain(&space.stations).chain(std::iter::once(&last)).map(&mut ring).collect()
}

/// Triangles between the rings; those at a pole have no area and no ray intersects them.
fn facets(rings: &[Vec<Vector<f64>>]) -> Vec<Facet> {
    let between = |pair: &[Vec<Vector<f64>>]| -> Vec<Facet> {
        let count = pair[0].len();
        let corner = |row: usize, j: usize| &pair[row][j % count];
        let two = |j: usize| {
            let (a, b, c, d) = (corner(0, j), corner(1, j), corner(1, j + 1), corner(0, j + 1));
            [Facet::new([a, b, c]), Facet::new([a, c, d])]
        };
        (0..count).flat_map(two).collect()
    };
    rings.windows(2).flat_map(between).collect()
}

/// The largest depth by which a wall of the surface has crossed another, in L_h, measured along the normal between points of the
/// quadrature and facets of the same resolution; 0 if the surface does not intersect itself.
pub fn crossing(space: &Space, surface: &[f64]) -> f64 {
    let facets = facets(&rings(space, surface));
    let mut functions = Vec::new();
    let mut deepest: f64 = 0.0;
    for station in &space.stations {
        space.functions(surface, station, &mut functions);
        for meridian in &space.meridians {
            let shape = space.shape(&functions, meridian);
            let inwards = Geometry::new(&shape).normal.map(|n| -n);
            deepest = deepest.max(covered(&facets, &shape[0], &inwards));
        }
    }
    deepest
}

/// Facets closer to a point than this, in L_h, belong to the point itself.
const OWN: f64 = 1e-6;

/// The depth of a point behind the wall that covers it; 0 if it is not covered.
fn covered(facets: &[Facet], from: &Vector<f64>, inwards: &Vector<f64>) -> f64 {
    let times_left = |ray: &Vector<f64>, start: &Vector<f64>| -> (i32, f64) {
        let (mut times, mut first) = (0, f64::INFINITY);
        for (distance, leaves) in facets.iter().filter_map(|facet| facet.met_by(start, ray)) {
            if distance > OWN {
                times += if leaves { 1 } else { -1 };
                first = if leaves { first.min(distance) } else { first };
            }
        }
        (times, first)
    };
    let (times, depth) = times_left(inwards, from);
    if times < 2 {
        return 0.0;
    }
    // A ray through the edge between two facets may be counted twice, so another ray from half the depth is tested.
    let start = std::array::from_fn(|k| from[k] + 0.5 * depth * inwards[k]);
    let (again, _) = times_left(&OTHER, &start);
    if again < 2 { 0.0 } else { depth }
}

/// An arbitrary direction without symmetry.
const OTHER: Vector<f64> = [0.360_3, 0.480_9, 0.799_1];
