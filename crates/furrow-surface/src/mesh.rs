//! Distribution of the mesh along the surface: the density of rings along the mean meridian, and the weights of S.5.

use crate::law::Geometry;
use crate::problem::Problem;
use crate::space::{Meridian, Space, Station};
use crate::splines::DEGREE;

/// The density of rings and the resulting weights.
#[derive(Clone, Debug)]
pub struct Mesh {
    /// Coefficients of the density ρ = (1/L) ds/du of the mean meridian; by spline.
    pub density: Vec<f64>,
    /// a, ∂_ua, b and c of S.5 at every station.
    pub weights: Vec<[f64; 4]>,
}

impl Mesh {
    /// Equidistant rings.
    pub fn uniform(space: &Space) -> Mesh {
        Mesh { density: vec![1.0; space.splines()], weights: vec![[1.0, 0.0, 0.0, 0.0]; space.stations.len()] }
    }

    /// The fraction of the mean meridian from the pole u = 0 to every station.
    pub fn shares(&self, space: &Space) -> Vec<f64> {
        // The integral of a spline of degree 4, by an exact rule, over the part of the element before the station.
        let (points, weights) = furrow_bvp::gauss::gauss_rule(3);
        let mut before = 0.0;
        let mut element = 0;
        let width = 1.0 / space.elements as f64;
        let mut out = Vec::with_capacity(space.stations.len());
        let density = |element: usize, u: f64| {
            let basis = crate::splines::local_values(space.elements, element, u);
            basis.iter().enumerate().map(|(r, b)| b[0] * self.density[element + r]).sum::<f64>()
        };
        let integral = |element: usize, until: f64| {
            let start = element as f64 * width;
            let at = |(c, w): (&f64, &f64)| w * density(element, start + c * (until - start));
            points.iter().zip(&weights).map(at).sum::<f64>() * (until - start)
        };
        for station in &space.stations {
            while element < station.element {
                before += integral(element, (element + 1) as f64 * width);
                element += 1;
            }
            out.push(before + integral(element, station.u));
        }
        let all = before + integral(element, 1.0);
        out.iter_mut().for_each(|share| *share /= all);
        out
    }

    /// Sets the weights for a surface near the solution, with a mean meridian of length `length`. They are divided by the
    /// viscosity, so that S.5 relates to the velocities in S.4 in the same way at every unit of time.
    pub fn follow(&mut self, space: &Space, surface: &[f64], length: f64, viscosity: f64) {
        let mut functions = Vec::new();
        self.weights.clear();
        for station in &space.stations {
            let [mut density, mut slope] = [0.0; 2];
            for (r, basis) in station.basis.iter().enumerate() {
                density += basis[0] * self.density[station.element + r];
                slope += basis[1] * self.density[station.element + r];
            }
            space.functions(surface, station, &mut functions);
            let radius = ring(space, &functions);
            let rings = RINGS * (length / radius).powi(2) * density;
            let held = AXIS * (2.0 * station.u - 1.0).powi(8) * density;
            let weights = [1.0 / density, -slope / (density * density), rings, held];
            self.weights.push(weights.map(|weight| weight / viscosity));
        }
    }
}

/// The mean radius of a ring, (mean |X_φ|²)^½.
pub fn ring(space: &Space, functions: &[[f64; 3]]) -> f64 {
    let squares = space.harmonics.iter().zip(functions).map(|(harmonic, f)| harmonic.turning() * f[0] * f[0]);
    squares.sum::<f64>().sqrt()
}

/// Strength with which rings are drawn towards circles, relative to the tension of meridians. With 1, deep furrows tangle the mesh.
const RINGS: f64 = 3.0;

/// Strength with which the centres of rings at the poles are drawn to the axis, relative to the tension of the mesh: the square of a
/// wave number on a contour of length 1.
const AXIS: f64 = 1000.0;

/// Weight of curvature relative to arclength in the density of rings.
const CURVATURE: f64 = 4.0;

/// Number of smoothing passes over the stations.
const PASSES: usize = 100;

impl Problem {
    /// The density of rings that equidistributes arclength and the turning of the steepest meridian.
    pub fn wanted_density(&self, surface: &[f64]) -> Vec<f64> {
        let space = &self.space;
        let (speeds, length) = self.speeds(surface);
        let mut functions = Vec::new();
        let steepest = |station: &Station| {
            space.functions(surface, station, &mut functions);
            let bend = |meridian: &Meridian| {
                let x = space.shape(&functions, meridian);
                let geometry = Geometry::new(&x);
                (geometry.curvature[0] / x[1].iter().map(|x| x * x).sum::<f64>()).abs()
            };
            space.meridians.iter().map(bend).fold(0.0, f64::max)
        };
        let bends: Vec<f64> = space.stations.iter().map(steepest).collect();
        let mut monitor: Vec<f64> =
            bends.iter().map(|bend| 1.0 + CURVATURE * length / std::f64::consts::TAU * bend).collect();
        for _ in 0..PASSES {
            let last = monitor.len() - 1;
            let at = |k: usize| 0.25 * (monitor[k.saturating_sub(1)] + 2.0 * monitor[k] + monitor[(k + 1).min(last)]);
            monitor = (0..=last).map(at).collect();
        }
        // The integral of the monitor over arclength up to every station.
        let mut sum = 0.0;
        let pieces =
            monitor.iter().zip(&speeds).zip(&space.stations).map(|((m, speed), station)| m * speed * station.weight);
        let until: Vec<f64> = pieces
            .map(|piece| {
                sum += piece;
                sum - 0.5 * piece
            })
            .collect();
        let splines = space.splines();
        // The mean of a spline's knots, at which its coefficient equals the function's value to second order.
        let place = |spline: usize| {
            let knots = (1..=DEGREE).map(|k| (spline + k).saturating_sub(DEGREE).min(space.elements));
            knots.sum::<usize>() as f64 / (DEGREE * space.elements) as f64
        };
        let density = |spline: usize| {
            let wanted = place(spline) * sum;
            let k = until.partition_point(|value| *value < wanted).clamp(1, until.len() - 1);
            let share = ((wanted - until[k - 1]) / (until[k] - until[k - 1])).clamp(0.0, 1.0);
            sum / (length * (monitor[k - 1] + share * (monitor[k] - monitor[k - 1])))
        };
        (0..splines).map(density).collect()
    }
}
