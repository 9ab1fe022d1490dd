//! Symmetry under the mirror u → 1 − u, stated once.
//!
//! A mirror-symmetric shape has r, m and T even about the equator u = ½, and z, q, v and ψ − π/2 odd (M.14). Everything else
//! about symmetry follows from this table: the conditions at the mirror on the half domain, which components an
//! antisymmetric disturbance leaves at zero there, and how halves unfold.

use std::f64::consts::FRAC_PI_2;

use furrow_bvp::{Direction, MirrorSymmetric, Solution};

use super::Cortex;
use super::equations::{COMPONENTS, Domain, M, PSI, Q, R, T, V, Z};

/// Components that are even about the equator.
pub const EVEN: [usize; 3] = [R, M, T];

/// Components that are odd about the equator, each about its [`CENTRE`].
pub const ODD: [usize; 4] = [Z, PSI, Q, V];

/// What odd components are at the equator of a mirror-symmetric shape.
pub const CENTRE: [f64; COMPONENTS] = {
    let mut centre = [0.0; COMPONENTS];
    centre[PSI] = FRAC_PI_2;
    centre
};

impl MirrorSymmetric for Cortex {
    /// Antisymmetric changes of what is even vanish at the equator, M.15.
    fn vanishing_at_mirror(&self) -> &[usize] {
        &EVEN
    }

    /// The tangent angle first: it turns with every antisymmetric mode of a waist.
    fn free_at_mirror(&self) -> &[usize] {
        &[PSI, Q, V, Z]
    }
}

/// The state at 1 − u of the mirrored shape.
pub fn mirror(y: &[f64]) -> [f64; COMPONENTS] {
    let mut out = [0.0; COMPONENTS];
    out.copy_from_slice(y);
    for component in ODD {
        out[component] = 2.0 * CENTRE[component] - y[component];
    }
    out
}

/// A direction at 1 − u that belongs to an antisymmetric one at u: what is even changes sign, what is odd does not.
fn mirror_antisymmetric(y: &[f64]) -> [f64; COMPONENTS] {
    let mut out = [0.0; COMPONENTS];
    out.copy_from_slice(y);
    for component in EVEN {
        out[component] = -out[component];
    }
    out
}

/// The full contour of a mirror-symmetric half.
pub fn unfold(half: &Solution) -> Solution {
    let (n, mut mesh) = (half.intervals(), half.mesh.clone());
    mesh.extend(half.mesh[..n].iter().rev().map(|u| 1.0 - u));
    let (nodes, stages) = (with_images(&half.nodes, n, mirror), with_images(&half.stages, n * half.m, mirror));
    Solution { mesh, nodes, stages, scalars: half.scalars.clone(), ..*half }
}

/// The states of a half, and behind them the images of so many of them, from the last to the first.
fn with_images(half: &[f64], points: usize, image: fn(&[f64]) -> [f64; COMPONENTS]) -> Vec<f64> {
    let images = half[..points * COMPONENTS].rchunks_exact(COMPONENTS).flat_map(image);
    half.iter().copied().chain(images).collect()
}

/// An antisymmetric direction of the half contour on the full one, with `scalars` scalar unknowns that it leaves alone.
pub fn unfold_antisymmetric(half: &Direction, scalars: usize) -> Direction {
    let of = |half: &[f64], centre: usize| with_images(half, half.len() / COMPONENTS - centre, mirror_antisymmetric);
    Direction { nodes: of(&half.nodes, 1), stages: of(&half.stages, 0), scalars: vec![0.0; scalars] }
}

/// Whether a mesh of the whole contour has a node at u = ½ and mirror-symmetric ones about it, but for roundings.
pub fn is_mirrored(mesh: &[f64]) -> bool {
    let pairs = mesh.iter().zip(mesh.iter().rev());
    mesh.len() % 2 == 1 && pairs.take(mesh.len() / 2 + 1).all(|(a, b)| (a + b - 1.0).abs() < 1e-14)
}

/// Splits a shape on a [mirrored](is_mirrored) mesh into its symmetric and its antisymmetric part, on the half of the contour
/// up to u = ½.
pub fn fold(full: &Solution, even: &mut Solution, odd: &mut Direction) {
    let intervals = full.intervals() / 2;
    even.mesh.clear();
    even.mesh.extend_from_slice(&full.mesh[..=intervals]);
    even.mesh[intervals] = Domain::Half.end();
    even.scalars.clone_from(&full.scalars);
    split(&full.nodes, &mut even.nodes, &mut odd.nodes);
    split(&full.stages, &mut even.stages, &mut odd.stages);
}

/// The states of the first half by parity, one in the middle included.
fn split(full: &[f64], even: &mut Vec<f64>, odd: &mut Vec<f64>) {
    let points = (full.len() / COMPONENTS).div_ceil(2);
    even.resize(points * COMPONENTS, 0.0);
    odd.resize(points * COMPONENTS, 0.0);
    let parts = even.chunks_exact_mut(COMPONENTS).zip(odd.chunks_exact_mut(COMPONENTS));
    let places = full.chunks_exact(COMPONENTS).zip(full.rchunks_exact(COMPONENTS));
    for ((even, odd), (here, there)) in parts.zip(places) {
        let mirrored = mirror(there);
        for k in 0..COMPONENTS {
            even[k] = 0.5 * (here[k] + mirrored[k]);
            odd[k] = 0.5 * (here[k] - mirrored[k]);
        }
    }
}

/// The whole of two parts told apart by [`fold`], into a shape that already has the mesh.
pub fn join(even: &Solution, odd: &Direction, full: &mut Solution) {
    full.scalars.clone_from(&even.scalars);
    join_states(&even.nodes, &odd.nodes, &mut full.nodes);
    join_states(&even.stages, &odd.stages, &mut full.stages);
}

fn join_states(even: &[f64], odd: &[f64], full: &mut [f64]) {
    let end = full.len() - COMPONENTS;
    for (i, (even, odd)) in even.chunks_exact(COMPONENTS).zip(odd.chunks_exact(COMPONENTS)).enumerate() {
        let (mirrored, there) = (mirror(even), mirror_antisymmetric(odd));
        let here = i * COMPONENTS;
        for k in 0..COMPONENTS {
            full[end - here + k] = mirrored[k] + there[k];
            full[here + k] = even[k] + odd[k];
        }
    }
}

#[cfg(test)]
mod tests {
    use furrow_bvp::{Gauss, mesh};

    use super::*;

    fn shape() -> Solution {
        Solution::from_fn(&Gauss::new(4), &mesh::uniform(0.0, 1.0, 6), COMPONENTS, &[5.0, 0.3], |u, y| {
            for (k, value) in y.iter_mut().enumerate() {
                *value = (3.0 * u + 0.7 * k as f64).sin() + 0.2 * u * u;
            }
        })
    }

    #[test]
    fn parts_of_a_shape_are_its_halves() {
        let whole = shape();
        let (mut even, mut odd) = (whole.clone(), Direction::default());
        fold(&whole, &mut even, &mut odd);
        assert_eq!(even.mesh, mesh::uniform(0.0, 0.5, 3));
        let mut again = whole.clone();
        again.nodes.fill(f64::NAN);
        again.stages.fill(f64::NAN);
        join(&even, &odd, &mut again);
        let near = |a: &[f64], b: &[f64]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-15);
        assert!(near(&whole.nodes, &again.nodes) && near(&whole.stages, &again.stages));
        // Without its antisymmetric part it is what the symmetric half unfolds to.
        odd.scale(0.0);
        join(&even, &odd, &mut again);
        assert!(near(&unfold(&even).nodes, &again.nodes) && near(&unfold(&even).stages, &again.stages));
        // What is even vanishes at the mirror in an antisymmetric direction, and what is odd has its centre there in a symmetric shape.
        fold(&whole, &mut even, &mut odd);
        let (even, odd) = (even.node(3), &odd.nodes[3 * COMPONENTS..]);
        assert!(EVEN.iter().all(|&k| odd[k] == 0.0) && ODD.iter().all(|&k| even[k] == CENTRE[k]));
    }

    #[test]
    fn meshes_that_are_not_mirrored_are_told() {
        assert!(is_mirrored(&[0.0, 0.1, 0.5, 0.9, 1.0]));
        for mesh in [&[0.0, 0.1, 0.9, 1.0][..], &[0.0, 0.1, 0.5, 0.8, 1.0], &[0.0, 0.4, 1.0]] {
            assert!(!is_mirrored(mesh));
        }
    }
}
