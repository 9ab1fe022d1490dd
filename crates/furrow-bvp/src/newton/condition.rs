//! How much a solution moves when its equations are perturbed.

use crate::dense::weighted_maximum;
use crate::direction::{Direction, Residual};
use crate::linear::System;
use crate::solution::Solution;

/// Perturbations tried. The estimate is a lower bound; signs by chance leave it short by a small factor only.
const SOLVES: u64 = 2;

/// Estimates the condition of the problem at `y`, with the factors in `system`: the largest change |δ|/(1 + |value|) of the
/// solution where the right-hand side changes by at most 1 + |value|, conditions at the ends by at most their largest derivative and
/// others by 1. It is the ‖J⁻¹‖ of the differential equation, which settles as the mesh is refined unless the problem is singular.
pub(super) fn estimate(system: &mut System, y: &Solution) -> f64 {
    let (mut residual, mut change) = (system.zero_residual(), Direction::default());
    if residual.stages.len() != y.stages.len() {
        // Newton has failed before it had factors on this mesh: nothing is known.
        return 0.0;
    }
    let scales = system.scales_of_conditions();
    let estimates = (0..SOLVES).flat_map(|k| {
        perturb(&mut residual, &scales, y, k);
        // Stage values change about as much as the nodes next to them.
        let solved = system.solve_at_nodes(&residual, &mut change);
        let sizes = [(&change.nodes, &y.nodes), (&change.scalars, &y.scalars)].map(|(d, v)| weighted_maximum(d, v));
        if solved.is_ok() { sizes } else { [f64::INFINITY; 2] }
    });
    // A matrix that is singular to rounding gives NaN.
    estimates.fold(0.0, |largest: f64, size| if size.is_nan() { f64::INFINITY } else { largest.max(size) })
}

/// Perturbations of one sign per component on the whole interval, or (from the second on) of a random one per interval.
fn perturb(residual: &mut Residual, scales: &[Vec<f64>; 2], y: &Solution, which: u64) {
    let mut state = 0x9e37_79b9_7f4a_7c15 ^ which;
    let mut sign = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        if state >> 63 == 0 { 1.0 } else { -1.0 }
    };
    let (n, width) = (y.components, y.m * y.components);
    let mut signs: Vec<f64> = (0..n).map(|_| sign()).collect();
    for (i, h) in y.mesh.windows(2).map(|x| x[1] - x[0]).enumerate() {
        if which > 0 {
            signs.fill_with(&mut sign);
        }
        for k in i * width..(i + 1) * width {
            residual.stages[k] = h * signs[k % n] * (1.0 + y.stages[k].abs());
        }
    }
    residual.border.fill_with(&mut sign);
    for (part, scales) in [&mut residual.left, &mut residual.right].into_iter().zip(scales) {
        part.iter_mut().zip(scales).for_each(|(condition, scale)| *condition = scale * sign());
    }
}
