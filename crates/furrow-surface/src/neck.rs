//! Rings of the mesh, including the neck, and the parts of the cell on both sides of it.

use crate::problem::volume_density;
use crate::space::Space;

/// The neck: the shortest ring of the mesh between two longer ones.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Neck {
    /// Coordinate u of the mesh.
    pub u: f64,
    /// Length divided by 2π, in L_h.
    pub radius: f64,
    /// Distance of its centre from the axis, towards +x, in L_h.
    pub offset: f64,
    /// Height z of its centre, in L_h.
    pub height: f64,
    /// Angle between its plane and the plane across the axis, in degrees; positive if it rises towards +x.
    pub tilt: f64,
    /// 4π times the enclosed area divided by the length squared: 1 for a circle, near 0 for a slit.
    pub roundness: f64,
}

/// Points x, z of the ring at u, with its length and twice the enclosed area per radian of φ.
fn ring(space: &Space, surface: &[f64], u: f64) -> Vec<[f64; 4]> {
    let mut functions = Vec::new();
    space.functions(surface, &space.station(u), &mut functions);
    let point = |meridian| {
        let [at, _, along, ..] = space.shape(&functions, meridian);
        let area = at[0] * along[1] - at[1] * along[0];
        [at[0], at[2], along.iter().map(|x| x * x).sum::<f64>().sqrt(), area]
    };
    space.meridians.iter().map(point).collect()
}

/// Length of the ring at u divided by 2π.
pub(crate) fn radius_at(space: &Space, surface: &[f64], u: f64) -> f64 {
    let points = ring(space, surface, u);
    points.iter().map(|[_, _, part, _]| part).sum::<f64>() / points.len() as f64
}

/// Distance from the axis, in L_h, of the centre of the ring at u.
pub(crate) fn offset_at(space: &Space, surface: &[f64], u: f64) -> f64 {
    let points = ring(space, surface, u);
    let length: f64 = points.iter().map(|[_, _, part, _]| part).sum();
    (points.iter().map(|[x, _, part, _]| part * x).sum::<f64>() / length).abs()
}

/// Number of positions between two stations at which the neck is sought.
const REFINEMENTS: usize = 40;

/// The neck of a surface; `None` without a waist.
pub fn neck(space: &Space, surface: &[f64]) -> Option<Neck> {
    let radii: Vec<f64> = space.stations.iter().map(|station| radius_at(space, surface, station.u)).collect();
    // Among several waists, the widening of the rings on both sides decides.
    let widest = |radii: &[f64]| radii.iter().copied().fold(0.0, f64::max);
    let depth = |k: usize| widest(&radii[..k]).min(widest(&radii[k + 1..])) - radii[k];
    let waists = (1..radii.len() - 1).filter(|&k| radii[k] <= radii[k - 1] && radii[k] < radii[k + 1]);
    let k = waists.max_by(|&a, &b| depth(a).total_cmp(&depth(b)))?;
    // Golden-section search between the neighbours.
    let [mut low, mut high] = [space.stations[k - 1].u, space.stations[k + 1].u];
    const SHARE: f64 = 0.381_966_011_250_105;
    for _ in 0..REFINEMENTS {
        let (a, b) = (low + SHARE * (high - low), high - SHARE * (high - low));
        if radius_at(space, surface, a) < radius_at(space, surface, b) { high = b } else { low = a }
    }
    let u = 0.5 * (low + high);
    let points = ring(space, surface, u);
    let sum = |value: &dyn Fn(f64, f64) -> f64| points.iter().map(|[x, z, part, _]| part * value(*x, *z)).sum::<f64>();
    let length = sum(&|_, _| 1.0);
    let (offset, height) = (sum(&|x, _| x) / length, sum(&|_, z| z) / length);
    let slope = sum(&|x, z| (x - offset) * (z - height)) / sum(&|x, _| (x - offset) * (x - offset));
    let area = points.iter().map(|[.., area]| area).sum::<f64>();
    let radius = length / points.len() as f64;
    let roundness = area / points.len() as f64 / (radius * radius);
    Some(Neck { u, radius, offset, height, tilt: slope.atan().to_degrees(), roundness })
}

/// (V_above − V_below)/V for the parts from u above and below the neck.
pub fn asymmetry(space: &Space, surface: &[f64], neck: &Neck) -> f64 {
    let centre = [neck.offset, 0.0, neck.height];
    let mut functions = Vec::new();
    // With the centre of the neck as origin, the cut itself does not contribute to the volume.
    let mut volume = |from: f64, to: f64| {
        let (points, weights) = furrow_bvp::gauss::gauss_rule(5);
        let mut sum = 0.0;
        for (point, weight) in points.iter().zip(&weights) {
            let station = space.station(from + point * (to - from));
            space.functions(surface, &station, &mut functions);
            for meridian in &space.meridians {
                let mut x = space.shape(&functions, meridian);
                x[0].iter_mut().zip(centre).for_each(|(x, c)| *x -= c);
                sum += weight * (to - from) * volume_density(&x) * space.meridian_weight();
            }
        }
        sum
    };
    let width = 1.0 / space.elements as f64;
    let element = crate::splines::element_of(space.elements, neck.u);
    let mut parts = [0.0; 2];
    for k in 0..space.elements {
        let [from, to] = [k as f64 * width, (k + 1) as f64 * width];
        match k.cmp(&element) {
            std::cmp::Ordering::Less => parts[0] += volume(from, to),
            std::cmp::Ordering::Greater => parts[1] += volume(from, to),
            std::cmp::Ordering::Equal => {
                parts[0] += volume(from, neck.u);
                parts[1] += volume(neck.u, to);
            }
        }
    }
    (parts[1] - parts[0]) / (parts[0] + parts[1])
}
