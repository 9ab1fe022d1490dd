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

/// Adds Σ_k D_jk (Y_k − y₀) to the stage residuals of one interval (m × n) and writes its node residual
/// y₀ + Σ d_j (Y_j − y₀) − y₁ (n). Components go through in padded groups,
/// of eight or, where these would be half empty, of four.
#[inline(always)]
pub fn differences<S: Shape>(gauss: &Gauss, interval: Interval<'_>, residual: &mut [f64], node: &mut [f64]) {
    let Sizes { n, m, .. } = S::sizes(Dimensions { components: interval.left.len(), ..Dimensions::default() }, gauss.m);
    if n > 8 || n <= 4 {
        in_groups::<4>([n, m], gauss, interval, residual, node);
    } else {
        in_groups::<8>([n, m], gauss, interval, residual, node);
    }
}

#[inline(always)]
fn in_groups<const GROUP: usize>(
    [n, m]: [usize; 2],
    gauss: &Gauss,
    interval: Interval<'_>,
    residual: &mut [f64],
    node: &mut [f64],
) {
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
