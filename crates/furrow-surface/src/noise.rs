//! The seeded noise on the activity, which determines the side of asymmetric divisions.

use std::f64::consts::PI;

use furrow_cell::Numerics;
use furrow_mechanics::division::noise::Noise;

use crate::problem::Problem;

/// Largest azimuthal mode number excited by the noise; disturbances of larger m decay.
const EXCITED: usize = 2;

/// The factor 1 + Σ r_nm cos(nπu) cos(mφ) on the activity at every station and meridian, with u the fraction of the contour: the
/// noise of the axisymmetric division with the same seed, n = 1 … 10, and n = 0 … 9 for m = 1 and 2.
/// With `even` only the terms that are even about u = ½ are kept.
pub fn factors(problem: &Problem, surface: &[f64], numerics: &Numerics, seed: u64, even: bool) -> Vec<f64> {
    let mut noise = Noise::new(seed, numerics);
    let sets: Vec<[f64; 10]> = (0..=EXCITED.min(problem.space.modes)).map(|m| noise.set(m)).collect();
    let (speeds, length) = problem.speeds(surface);
    let along = |m: usize, u: f64| -> f64 {
        let first = usize::from(m == 0);
        let terms = sets[m].iter().enumerate().map(|(n, r)| (n + first, r));
        terms.filter(|(n, _)| !even || n % 2 == 0).map(|(n, r)| r * (n as f64 * PI * u).cos()).sum()
    };
    let shares = problem.shares(&speeds, length);
    let rings = shares.iter().map(|u| (0..sets.len()).map(|m| along(m, *u)).collect::<Vec<f64>>());
    let around = |ring: &[f64], phi: f64| {
        1.0 + ring.iter().enumerate().map(|(m, along)| along * (m as f64 * phi).cos()).sum::<f64>()
    };
    rings.flat_map(|ring| problem.space.meridians.iter().map(move |meridian| around(&ring, meridian.phi))).collect()
}
