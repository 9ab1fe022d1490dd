//! The collocation equations of one interval but for their right-hand sides.

use crate::dimensions::Dimensions;
use crate::gauss::{Gauss, MAX_STAGES};

use super::shape::{Shape, Sizes};

/// Values on one interval.
#[derive(Clone, Copy, Debug)]
pub struct Interval<'a> {
    /// Left node value; n.
    pub left: &'a [f64],
    /// Stage values; m × n.
    pub stages: &'a [f64],
    /// Right node value; n.
    pub right: &'a [f64],
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

/// Adds Σ_k D_jk (Y_k − y₀) to the stage residuals of one interval (m × n) and writes its node residual
/// y₀ + Σ d_j (Y_j − y₀) − y₁ (n).
#[inline(always)]
pub fn differences<S: Shape>(gauss: &Gauss, interval: Interval<'_>, residual: &mut [f64], node: &mut [f64]) {
    let Sizes { n, m, .. } = S::sizes(Dimensions { components: interval.left.len(), ..Dimensions::default() }, gauss.m);
    if (GROUP..=2 * GROUP).contains(&n) {
        in_two_groups([n, m], gauss, interval, residual, node);
    } else {
        in_padded_groups([n, m], gauss, interval, residual, node);
    }
}

/// The first and the last components, in two groups that overlap, so that neither is padded.
#[inline(always)]
fn in_two_groups([n, m]: [usize; 2], gauss: &Gauss, interval: Interval<'_>, residual: &mut [f64], node: &mut [f64]) {
    let Interval { left: y0, stages, right: y1 } = interval;
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
                sums[g][t] += sum[t];
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
    let Interval { left: y0, stages, right: y1 } = interval;
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
                row[t] += sum[t];
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
