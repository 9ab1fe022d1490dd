//! Contact of the walls of a furrow.
//!
//! The walls of a furrow that closes from one side touch long before the neck closes. They repel each other as the shell
//! repels the cortex, M.9, as if a shell lay halfway between them: \[S.6 contact\] at distance d along the normal, the pressure is
//! (2P0/(w²b)) exp(−d/λ) with λ = w²b. This introduces no new constant.
//!
//! The opposite wall is located on the ray along the normal, on a surface close to the solution. During the solution both walls are
//! assumed to move towards each other by the same distance, so that only the position of the point itself is unknown.

use std::collections::HashMap;

use crate::law::{Contact, Geometry, Vector};
use crate::problem::Problem;
use crate::space::Space;

/// Walls at a larger distance, in λ, have no effect.
const REACH: f64 = 18.0;
/// Walls that have crossed by more than this, in λ, do not count as in contact.
const CROSSED: f64 = 8.0;
/// Largest cosine between normals of opposite walls.
const FACING: f64 = -0.2;

/// A point of the quadrature: position, normal, and coordinates on the mesh.
#[derive(Clone, Copy, Debug)]
struct Point {
    x: Vector<f64>,
    normal: Vector<f64>,
    u: f64,
    phi: f64,
}

fn dot(a: &Vector<f64>, b: &Vector<f64>) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn points(space: &Space, surface: &[f64]) -> Vec<Point> {
    let mut functions = Vec::new();
    let mut out = Vec::with_capacity(space.stations.len() * space.meridians.len());
    for station in &space.stations {
        space.functions(surface, station, &mut functions);
        for meridian in &space.meridians {
            let shape = space.shape(&functions, meridian);
            let normal = Geometry::new(&shape).normal;
            out.push(Point { x: shape[0], normal, u: station.u, phi: meridian.phi });
        }
    }
    out
}

/// The points near each occupied cube.
struct Cubes {
    width: f64,
    /// Points in a cube and in its neighbours, in a fixed order.
    near: HashMap<[i32; 3], Vec<usize>>,
}

impl Cubes {
    fn new(points: &[Point], width: f64) -> Cubes {
        let mut within: HashMap<[i32; 3], Vec<usize>> = HashMap::new();
        for (k, point) in points.iter().enumerate() {
            within.entry(Cubes::of(&point.x, width)).or_default().push(k);
        }
        let near = within.keys().map(|&[i, j, k]| {
            let around = (0..27).map(|n| [i + n / 9 - 1, j + n / 3 % 3 - 1, k + n % 3 - 1]);
            ([i, j, k], around.filter_map(|cube| within.get(&cube)).flatten().copied().collect())
        });
        Cubes { width, near: near.collect() }
    }

    fn of(x: &Vector<f64>, width: f64) -> [i32; 3] {
        x.map(|x| (x / width).floor() as i32)
    }

    /// The points near a given one.
    fn near(&self, x: &Vector<f64>) -> &[usize] {
        self.near.get(&Cubes::of(x, self.width)).map_or(&[], Vec::as_slice)
    }
}

/// The intersection of the ray from a point along its normal with the surface, from a guess (u, φ): the distance, and the cosine
/// between the two normals.
fn meet(space: &Space, surface: &[f64], from: &Point, mut u: f64, mut phi: f64) -> Option<(f64, f64)> {
    let mut functions = Vec::new();
    let mut distance = 0.0;
    for round in 0..12 {
        space.functions(surface, &space.station(u), &mut functions);
        let shape = space.shape(&functions, &space.meridian(phi));
        let [x, x_u, x_p, ..] = shape;
        let apart: Vector<f64> = std::array::from_fn(|k| x[k] - from.x[k]);
        let geometry = Geometry::new(&shape);
        let cosine = dot(&geometry.normal, &from.normal);
        // x + a x_u + b x_φ = from + d n; the component along the other normal gives d.
        let new = dot(&apart, &geometry.normal) / cosine;
        let rest: Vector<f64> = std::array::from_fn(|k| new * from.normal[k] - apart[k]);
        let [g_uu, g_up, g_pp] = [dot(&x_u, &x_u), dot(&x_u, &x_p), dot(&x_p, &x_p)];
        let [by_u, by_p] = [dot(&rest, &x_u), dot(&rest, &x_p)];
        let determinant = g_uu * g_pp - g_up * g_up;
        let step = [(by_u * g_pp - by_p * g_up) / determinant, (by_p * g_uu - by_u * g_up) / determinant];
        if !(step[0].is_finite() && step[1].is_finite()) {
            return None;
        }
        u = (u + step[0].clamp(-0.05, 0.05)).clamp(1e-6, 1.0 - 1e-6);
        phi += step[1].clamp(-0.3, 0.3);
        let moved = (new - distance).abs();
        distance = new;
        if round > 0 && moved < 1e-7 * (1.0 + distance.abs()) && step[0].abs() < 1e-5 {
            // The other side of a neck is not an opposite wall.
            let same_side = (phi - from.phi).abs() < std::f64::consts::FRAC_PI_2;
            return (same_side && cosine < FACING).then_some((distance, cosine));
        }
    }
    None
}

impl Problem {
    /// λ and the pressure of walls at distance 0.
    pub fn contact_law(&self) -> [f64; 2] {
        let shell = &self.constants.shell;
        let b = shell.inverse_b2.sqrt().recip();
        [b / shell.inverse_w2, shell.shell_force / b]
    }

    /// The walls that the points of a surface may touch, by station × meridian; empty without contact.
    pub fn walls(&self, surface: &[f64]) -> Vec<Contact> {
        let [lambda, pressure] = self.contact_law();
        let points = points(&self.space, surface);
        let spacing = std::f64::consts::PI / self.space.meridians.len() as f64 * self.radius();
        let width = REACH * lambda + spacing;
        let cubes = Cubes::new(&points, width);
        let mut any = false;
        let mut contact = |point: &Point| {
            // Among the points that face this one, select the one closest to the ray.
            let facing = |k: usize| {
                let other = &points[k];
                // Most nearby normals point in the same direction.
                let faces = dot(&point.normal, &other.normal) < FACING;
                if !faces {
                    return None;
                }
                let apart: Vector<f64> = std::array::from_fn(|i| other.x[i] - point.x[i]);
                let along = dot(&apart, &point.normal);
                let off = (dot(&apart, &apart) - along * along).max(0.0).sqrt();
                let near = -CROSSED * lambda < along && along < REACH * lambda && off < 2.0 * spacing;
                let side = (other.phi - point.phi).abs() < std::f64::consts::FRAC_PI_2;
                (near && side).then_some((k, off + along.abs()))
            };
            let nearest = cubes.near(&point.x).iter().filter_map(|k| facing(*k)).min_by(|a, b| a.1.total_cmp(&b.1));
            let (k, _) = nearest?;
            let (distance, _) = meet(&self.space, surface, point, points[k].u, points[k].phi)?;
            (-CROSSED * lambda < distance && distance < REACH * lambda).then(|| {
                any = true;
                Contact { pressure, decay: lambda.recip(), origin: point.x, normal: point.normal, distance }
            })
        };
        let found: Vec<Contact> = points.iter().map(|point| contact(point).unwrap_or_default()).collect();
        if any { found } else { Vec::new() }
    }
}
