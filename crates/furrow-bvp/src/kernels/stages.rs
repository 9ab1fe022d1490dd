//! Residuals of the collocation equations, and products of their Jacobian.

use crate::dimensions::{Dimensions, MAX_UNKNOWNS};
use crate::direction::{Direction, Residual};
use crate::gauss::{Gauss, MAX_STAGES};
use crate::solution::Solution;

use super::condense::{Condensed, part, part_mut};
use super::shape::{Shape, Sizes};

/// Values on one interval of width h.
#[derive(Clone, Copy)]
struct Interval<'a> {
    h: f64,
    /// Left node value; n.
    left: &'a [f64],
    /// Stage values; m × n.
    stages: &'a [f64],
    /// Right node value; n.
    right: &'a [f64],
}

impl<'a> Interval<'a> {
    #[inline(always)]
    fn new(i: usize, h: f64, [nodes, stages]: [&'a [f64]; 2], Sizes { n, m, .. }: Sizes) -> Interval<'a> {
        let (left, right) = nodes[i * n..(i + 2) * n].split_at(n);
        Interval { h, left, stages: part(stages, i, m * n), right }
    }
}

/// Computes the residuals of `y` at the stages and nodes of all intervals. On entry, `out` contains f at the stages.
#[inline(always)]
pub fn residuals<S: Shape>(gauss: &Gauss, y: &Solution, out: &mut Residual) {
    let sizes = S::sizes(Dimensions { components: y.components, ..Dimensions::default() }, gauss.m);
    for (i, ends) in y.mesh.windows(2).enumerate() {
        let interval = Interval::new(i, ends[1] - ends[0], [&y.nodes, &y.stages], sizes);
        let rows = part_mut(&mut out.stages, i, sizes.m * sizes.n);
        differences(sizes, gauss, interval, rows, part_mut(&mut out.nodes, i, sizes.n));
    }
}

/// Adds J δ at the stages and nodes to `out`; the scalar unknowns of δ are left out.
#[inline(always)]
pub fn apply<S: Shape>(condensed: &Condensed, gauss: &Gauss, direction: &Direction, out: &mut Residual) {
    let sizes = condensed.sizes::<S>();
    let Sizes { n, m, .. } = sizes;
    let mut scratch = [0.0; (MAX_STAGES + 1) * MAX_UNKNOWNS];
    let (rows, node) = scratch[..(m + 1) * n].split_at_mut(m * n);
    for i in 0..condensed.intervals() {
        let interval = Interval::new(i, condensed.h[i], [&direction.nodes, &direction.stages], sizes);
        for k in 0..m * n {
            let f = part(part(&condensed.fy, i, m * n * n), k, n);
            let y = part(interval.stages, k / n, n);
            let mut sum = f[0] * y[0];
            for c in 1..n {
                sum += f[c] * y[c];
            }
            rows[k] = sum;
        }
        differences(sizes, gauss, interval, rows, node);
        let (to, to_node) = (part_mut(&mut out.stages, i, m * n), part_mut(&mut out.nodes, i, n));
        for k in 0..m * n {
            to[k] += rows[k];
        }
        for k in 0..n {
            to_node[k] += node[k];
        }
    }
}

/// Components that are treated at once.
const GROUP: usize = 4;

/// The components of two groups that begin at `from`. A loop, since closures may be compiled separately, for another instruction set.
#[inline(always)]
fn two_groups(of: &[f64], from: [usize; 2]) -> [[f64; GROUP]; 2] {
    let mut out = [[0.0; GROUP]; 2];
    for g in 0..2 {
        out[g].copy_from_slice(&of[from[g]..from[g] + GROUP]);
    }
    out
}

/// Multiplies f at the stages of one interval (m × n) by −h, adds Σ_k D_jk (Y_k − y₀), and writes the node residual
/// y₀ + Σ d_j (Y_j − y₀) − y₁ (n).
#[inline(always)]
fn differences(
    Sizes { n, m, .. }: Sizes,
    gauss: &Gauss,
    interval: Interval<'_>,
    residual: &mut [f64],
    node: &mut [f64],
) {
    if (GROUP..=2 * GROUP).contains(&n) {
        in_two_groups([n, m], gauss, interval, residual, node);
    } else {
        in_padded_groups([n, m], gauss, interval, residual, node);
    }
}

/// The first and the last components, in two groups that overlap, so that neither is padded.
#[inline(always)]
fn in_two_groups([n, m]: [usize; 2], gauss: &Gauss, interval: Interval<'_>, residual: &mut [f64], node: &mut [f64]) {
    let Interval { h, left: y0, stages, right: y1 } = interval;
    let (d_matrix, d) = (&gauss.d_matrix[..m * m], &gauss.d[..m]);
    let groups = [0, n - GROUP];
    let starts = two_groups(y0, groups);
    let mut difference = [[[0.0; GROUP]; 2]; MAX_STAGES];
    for j in 0..m {
        let y = two_groups(&stages[j * n..(j + 1) * n], groups);
        for g in 0..2 {
            for t in 0..GROUP {
                difference[j][g][t] = y[g][t] - starts[g][t];
            }
        }
    }
    let mut end = [[0.0; GROUP]; 2];
    for j in 0..m {
        let row = &mut residual[j * n..(j + 1) * n];
        // Both are read before either is written: they share components.
        let mut sums = two_groups(row, groups);
        for g in 0..2 {
            let mut sum = [0.0; GROUP];
            for k in 0..m {
                for t in 0..GROUP {
                    sum[t] += d_matrix[j * m + k] * difference[k][g][t];
                }
            }
            for t in 0..GROUP {
                sums[g][t] = sums[g][t] * -h + sum[t];
                end[g][t] += d[j] * difference[j][g][t];
            }
        }
        for g in 0..2 {
            row[groups[g]..groups[g] + GROUP].copy_from_slice(&sums[g]);
        }
    }
    let right = two_groups(y1, groups);
    for g in 0..2 {
        for t in 0..GROUP {
            node[groups[g] + t] = end[g][t] + (starts[g][t] - right[g][t]);
        }
    }
}

#[inline(always)]
fn in_padded_groups([n, m]: [usize; 2], gauss: &Gauss, interval: Interval<'_>, residual: &mut [f64], node: &mut [f64]) {
    let Interval { h, left: y0, stages, right: y1 } = interval;
    let (d_matrix, d) = (&gauss.d_matrix[..m * m], &gauss.d[..m]);
    for from in (0..n).step_by(GROUP) {
        let width = (n - from).min(GROUP);
        let mut difference = [[0.0; GROUP]; MAX_STAGES];
        for j in 0..m {
            let y = &stages[j * n + from..j * n + from + width];
            for t in 0..width {
                difference[j][t] = y[t] - y0[from + t];
            }
        }
        let mut end = [0.0; GROUP];
        for j in 0..m {
            let mut sum = [0.0; GROUP];
            for k in 0..m {
                for t in 0..GROUP {
                    sum[t] += d_matrix[j * m + k] * difference[k][t];
                }
            }
            let row = &mut residual[j * n + from..j * n + from + width];
            for t in 0..width {
                row[t] = row[t] * -h + sum[t];
            }
            for t in 0..GROUP {
                end[t] += d[j] * difference[j][t];
            }
        }
        for t in 0..width {
            node[from + t] = end[t] + (y0[from + t] - y1[from + t]);
        }
    }
}
