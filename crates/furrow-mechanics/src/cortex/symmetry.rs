//! Symmetry under the mirror u → 1 − u.
//!
//! A mirror-symmetric shape has r, m, T and φ even about the equator u = ½, and z, q, v, j and ψ − π/2 odd (M.14). All
//! other statements about symmetry follow from this table: the conditions at the mirror on the half domain, the
//! components that an antisymmetric perturbation leaves at zero there, and the unfolding of half contours.

use std::f64::consts::FRAC_PI_2;

use furrow_bvp::{Direction, MirrorSymmetric, Solution};

use super::Cortex;
use super::equations::{COMPONENTS, Domain, J, M, PHI, PSI, Q, R, REGULATED, T, V, Z};

/// The even components among n. The last must be a component of the shape: pitchforks are detected by the value of an
/// antisymmetric mode in it.
#[inline(always)]
pub fn even(n: usize) -> &'static [usize] {
    if n == REGULATED { &[PHI, R, M, T] } else { &[R, M, T] }
}

/// The odd components among n, each about its [`CENTRE`].
#[inline(always)]
pub fn odd(n: usize) -> &'static [usize] {
    if n == REGULATED { &[Z, PSI, Q, V, J] } else { &[Z, PSI, Q, V] }
}

/// The values of odd components at the equator of a mirror-symmetric shape.
pub const CENTRE: [f64; REGULATED] = {
    let mut centre = [0.0; REGULATED];
    centre[PSI] = FRAC_PI_2;
    centre
};

impl MirrorSymmetric for Cortex {
    /// Antisymmetric changes of even components vanish at the equator, M.15.
    fn vanishing_at_mirror(&self) -> &[usize] {
        even(self.components())
    }

    /// The tangent angle first: every antisymmetric mode of a waist changes it.
    fn free_at_mirror(&self) -> &[usize] {
        if self.is_regulated() { &[PSI, Q, V, Z, J] } else { &[PSI, Q, V, Z] }
    }
}

/// Turns a state into the state at 1 − u of the mirrored shape.
#[inline(always)]
pub fn mirror(y: &mut [f64]) {
    for &component in odd(y.len()) {
        y[component] = 2.0 * CENTRE[component] - y[component];
    }
}

/// Turns a direction into the antisymmetric direction at 1 − u: even components change sign, odd ones do not.
#[inline(always)]
fn mirror_antisymmetric(y: &mut [f64]) {
    for &component in even(y.len()) {
        y[component] = -y[component];
    }
}

/// The full contour of a mirror-symmetric half.
pub fn unfold(half: &Solution) -> Solution {
    let (n, intervals, mut mesh) = (half.components, half.intervals(), half.mesh.clone());
    mesh.extend(half.mesh[..intervals].iter().rev().map(|u| 1.0 - u));
    let nodes = with_images(&half.nodes, n, intervals, mirror);
    let stages = with_images(&half.stages, n, intervals * half.m, mirror);
    Solution { mesh, nodes, stages, scalars: half.scalars.clone(), ..*half }
}

/// The states of a half contour, followed by the images of the first `points` of them in reverse order.
fn with_images(half: &[f64], components: usize, points: usize, image: fn(&mut [f64])) -> Vec<f64> {
    let mut out = Vec::with_capacity(half.len() + points * components);
    out.extend_from_slice(half);
    for state in half[..points * components].rchunks_exact(components) {
        out.extend_from_slice(state);
        let end = out.len();
        image(&mut out[end - components..]);
    }
    out
}

/// An antisymmetric direction of the half contour on the full one, with `scalars` scalar unknowns that do not change.
pub(crate) fn unfold_antisymmetric(half: &Direction, components: usize, scalars: usize) -> Direction {
    let of = |half: &[f64], centre: usize| {
        with_images(half, components, half.len() / components - centre, mirror_antisymmetric)
    };
    Direction { nodes: of(&half.nodes, 1), stages: of(&half.stages, 0), scalars: vec![0.0; scalars] }
}

/// Whether a mesh of the whole contour has a node at u = ½ and is mirror-symmetric about it, up to rounding.
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
    let split = if full.components == REGULATED { split::<REGULATED> } else { split::<COMPONENTS> };
    split(&full.nodes, &mut even.nodes, &mut odd.nodes);
    split(&full.stages, &mut even.stages, &mut odd.stages);
}

/// The states of the first half by parity, including a state in the middle.
fn split<const N: usize>(full: &[f64], even: &mut Vec<f64>, odd: &mut Vec<f64>) {
    let points = (full.len() / N).div_ceil(2);
    even.resize(points * N, 0.0);
    odd.resize(points * N, 0.0);
    let parts = even.chunks_exact_mut(N).zip(odd.chunks_exact_mut(N));
    let places = full.chunks_exact(N).zip(full.rchunks_exact(N));
    let mut mirrored = [0.0; N];
    for ((even, odd), (here, there)) in parts.zip(places) {
        mirrored.copy_from_slice(there);
        mirror(&mut mirrored);
        for k in 0..N {
            even[k] = 0.5 * (here[k] + mirrored[k]);
            odd[k] = 0.5 * (here[k] - mirrored[k]);
        }
    }
}

/// Joins two parts split by [`fold`] into a shape that already has the mesh.
pub fn join(even: &Solution, odd: &Direction, full: &mut Solution) {
    full.scalars.clone_from(&even.scalars);
    let join = if full.components == REGULATED { join_states::<REGULATED> } else { join_states::<COMPONENTS> };
    join(&even.nodes, &odd.nodes, &mut full.nodes);
    join(&even.stages, &odd.stages, &mut full.stages);
}

fn join_states<const N: usize>(even: &[f64], odd: &[f64], full: &mut [f64]) {
    let end = full.len() - N;
    let [mut mirrored, mut there] = [[0.0; N]; 2];
    for (i, (even, odd)) in even.chunks_exact(N).zip(odd.chunks_exact(N)).enumerate() {
        mirrored.copy_from_slice(even);
        mirror(&mut mirrored);
        there.copy_from_slice(odd);
        mirror_antisymmetric(&mut there);
        let here = i * N;
        for k in 0..N {
            full[end - here + k] = mirrored[k] + there[k];
            full[here + k] = even[k] + odd[k];
        }
    }
}

#[cfg(test)]
mod tests {
    use furrow_bvp::{Gauss, mesh};

    use super::*;

    fn shape(components: usize) -> Solution {
        Solution::from_fn(&Gauss::new(4).unwrap(), &mesh::uniform(0.0, 1.0, 6), components, &[5.0, 0.3], |u, y| {
            for (k, value) in y.iter_mut().enumerate() {
                *value = (3.0 * u + 0.7 * k as f64).sin() + 0.2 * u * u;
            }
        })
        .unwrap()
    }

    #[test]
    fn parts_of_a_shape_are_its_halves() {
        for components in [COMPONENTS, REGULATED] {
            let whole = shape(components);
            let (mut symmetric, mut antisymmetric) = (whole.clone(), Direction::default());
            fold(&whole, &mut symmetric, &mut antisymmetric);
            assert_eq!(symmetric.mesh, mesh::uniform(0.0, 0.5, 3));
            let mut again = whole.clone();
            again.nodes.fill(f64::NAN);
            again.stages.fill(f64::NAN);
            join(&symmetric, &antisymmetric, &mut again);
            let near = |a: &[f64], b: &[f64]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-15);
            assert!(near(&whole.nodes, &again.nodes) && near(&whole.stages, &again.stages));
            // Without its antisymmetric part the shape is the unfolded symmetric half.
            antisymmetric.scale(0.0);
            join(&symmetric, &antisymmetric, &mut again);
            let unfolded = unfold(&symmetric);
            assert!(near(&unfolded.nodes, &again.nodes) && near(&unfolded.stages, &again.stages));
            // At the mirror, even components vanish in an antisymmetric direction, and odd components have their centre
            // in a symmetric shape.
            fold(&whole, &mut symmetric, &mut antisymmetric);
            let (middle, change) = (symmetric.node(3), &antisymmetric.nodes[3 * components..]);
            assert!(even(components).iter().all(|&k| change[k] == 0.0));
            assert!(odd(components).iter().all(|&k| middle[k] == CENTRE[k]));
            assert_eq!(even(components).len() + odd(components).len(), components);
        }
    }

    #[test]
    fn meshes_without_mirror_symmetry_are_detected() {
        assert!(is_mirrored(&[0.0, 0.1, 0.5, 0.9, 1.0]));
        for mesh in [&[0.0, 0.1, 0.9, 1.0][..], &[0.0, 0.1, 0.5, 0.8, 1.0], &[0.0, 0.4, 1.0]] {
            assert!(!is_mirrored(mesh));
        }
    }
}
