//! Symmetry under the mirror u → 1 − u, stated once.
//!
//! A mirror-symmetric shape has r, m and T even about the equator u = ½, and z, q, v and ψ − π/2 odd (M.14). Everything else
//! about symmetry follows from this table: the conditions at the mirror on the half domain, which components an
//! antisymmetric disturbance leaves at zero there, and how halves unfold.

use std::f64::consts::FRAC_PI_2;

use bvp::{Direction, MirrorSymmetric, Solution};

use super::Cortex;
use super::equations::{COMPONENTS, M, PSI, Q, R, T, V, Z};

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
pub fn mirror(y: &[f64], out: &mut [f64]) {
    out.copy_from_slice(y);
    for component in ODD {
        out[component] = 2.0 * CENTRE[component] - y[component];
    }
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
    let n = half.intervals();
    let mut grid = half.mesh.clone();
    for i in (0..n).rev() {
        grid.push(1.0 - half.mesh[i]);
    }
    let mut mirrored = [0.0; COMPONENTS];
    let mut full = Solution {
        components: COMPONENTS,
        m: half.m,
        mesh: grid,
        nodes: half.nodes.clone(),
        stages: half.stages.clone(),
        scalars: half.scalars.clone(),
    };
    for i in (0..n).rev() {
        mirror(half.node(i), &mut mirrored);
        full.nodes.extend_from_slice(&mirrored);
        for j in (0..half.m).rev() {
            mirror(half.stage(i, j), &mut mirrored);
            full.stages.extend_from_slice(&mirrored);
        }
    }
    full
}

/// An antisymmetric direction of the half contour on the full one, with `scalars` scalar unknowns that it leaves alone.
pub fn unfold_antisymmetric(half: &Direction, scalars: usize) -> Direction {
    let mut full = Direction { nodes: half.nodes.clone(), stages: half.stages.clone(), scalars: vec![0.0; scalars] };
    let nodes = half.nodes.len() / COMPONENTS;
    for i in (0..nodes - 1).rev() {
        full.nodes.extend(mirror_antisymmetric(&half.nodes[i * COMPONENTS..(i + 1) * COMPONENTS]));
    }
    for stage in half.stages.rchunks_exact(COMPONENTS) {
        full.stages.extend(mirror_antisymmetric(stage));
    }
    full
}
