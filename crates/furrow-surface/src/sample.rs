//! A surface sampled for pictures and files.

use crate::law::{Geometry, Vector, active_stress};
use crate::own::Own;
use crate::problem::{Problem, State};
use crate::space::Space;

/// A point of a sampled surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// Fraction s of the mean meridian from the pole u = 0, at which the cue is evaluated.
    pub share: f64,
    /// The point (x, y, z), in L_h.
    pub x: Vector<f64>,
    /// Outward normal.
    pub normal: Vector<f64>,
    /// Mean active tension ½ T^k_k, in κ0/L_h².
    pub tension: f64,
}

/// Samples on `rows` rings from the pole u = 0 to u = 1, including both, and `columns` meridians around the axis, row by row. The
/// density of rings follows the mesh.
pub fn sample(problem: &Problem, state: &State, rows: usize, columns: usize) -> Vec<Sample> {
    let space = &problem.space;
    let place = |j: usize| space.meridian(std::f64::consts::TAU * j as f64 / columns as f64);
    let meridians: Vec<_> = (0..columns).map(place).collect();
    let mean = problem.mean_meridian(&state.surface);
    let mut functions = Vec::new();
    let mut own = Own::of(&problem.constants);
    let mut out = Vec::with_capacity(rows * columns);
    for row in 0..rows {
        // The normal at a pole is taken from a nearby ring.
        let u = (row as f64 / (rows - 1) as f64).clamp(1e-4, 1.0 - 1e-4);
        space.functions(&state.surface, &space.station(u), &mut functions);
        let share = mean.share_at(u);
        let place = problem.place_at(share, mean.length);
        for meridian in &meridians {
            let shape = space.shape(&functions, meridian);
            let geometry = Geometry::new(&shape);
            let active = own.as_mut().and_then(|own| own.at(&place, &geometry, &shape[0]));
            let stress = active.map_or_else(|| active_stress(&place, &geometry), |active| active.stress);
            let metric = [(1, 1), (1, 2), (2, 2)].map(|(a, b)| (0..3).map(|k| shape[a][k] * shape[b][k]).sum::<f64>());
            let tension = 0.5 * (stress[0] * metric[0] + 2.0 * stress[1] * metric[1] + stress[2] * metric[2]);
            out.push(Sample { share, x: shape[0], normal: geometry.normal, tension });
        }
        if row == 0 || row + 1 == rows {
            close(space, &state.surface, row == 0, &mut out, columns);
        }
    }
    out
}

/// Moves the last ring of samples to its pole.
fn close(space: &Space, surface: &[f64], first: bool, out: &mut [Sample], columns: usize) {
    let mut functions = Vec::new();
    space.functions(surface, &space.station(if first { 0.0 } else { 1.0 }), &mut functions);
    let [pole, ..] = space.shape(&functions, &space.meridian(0.0));
    let start = out.len() - columns;
    let ring = &mut out[start..];
    let mean: Vector<f64> = std::array::from_fn(|k| ring.iter().map(|sample| sample.normal[k]).sum());
    let length = mean.iter().map(|x| x * x).sum::<f64>().sqrt();
    let tension = ring.iter().map(|sample| sample.tension).sum::<f64>() / columns as f64;
    ring.fill(Sample { share: if first { 0.0 } else { 1.0 }, x: pole, normal: mean.map(|x| x / length), tension });
}
