//! Row operations on small dense matrices, eight columns at a time.
//!
//! Every block of the collocation system is eliminated by the one kernel here. Rows are slices of [`Lane`]s, so the
//! inner loops have a fixed trip count and compile to vector code; the kernels are compiled for several instruction
//! sets and chosen at run time. No fused multiply–add is used and nothing is reordered, so the choice never changes a
//! bit of the result.

use multiversion::multiversion;

/// Eight neighbouring columns of one row.
pub type Lane = [f64; 8];

/// Columns per lane.
pub const LANE: usize = 8;

/// Number of lanes that hold `columns` columns.
pub const fn lanes_for(columns: usize) -> usize {
    columns.div_ceil(LANE)
}

/// Sign and logarithm of a determinant, as a running product of pivots.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Determinant {
    /// +1, −1 or 0.
    pub sign: f64,
    /// ln |det|.
    pub log_abs: f64,
}

impl Default for Determinant {
    fn default() -> Self {
        Determinant { sign: 1.0, log_abs: 0.0 }
    }
}

/// A pivot was zero or not finite.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PivotFailure {
    /// Column of the failing pivot.
    pub column: usize,
    /// The best pivot was not a finite number (rather than zero).
    pub non_finite: bool,
}

/// Gaussian elimination of the first `columns` columns of the row-major `matrix`, choosing pivots among the first
/// `candidates` rows and eliminating from every row below the pivot (rows past `candidates` are never pivots: borders).
/// Multipliers stay in place of the eliminated entries. `permutation[k]` is the row swapped with row k.
#[multiversion(targets("x86_64+avx512f+avx512vl", "x86_64+avx+avx2", "aarch64+neon"))]
pub fn eliminate(
    matrix: &mut [Lane],
    lanes: usize,
    columns: usize,
    candidates: usize,
    permutation: &mut [u8],
) -> Result<(), PivotFailure> {
    let rows = matrix.len() / lanes;
    for k in 0..columns {
        let (lane, offset) = (k / LANE, k % LANE);
        let mut best = k;
        let mut size = matrix[k * lanes + lane][offset].abs();
        for i in k + 1..candidates {
            let candidate = matrix[i * lanes + lane][offset].abs();
            if candidate > size {
                size = candidate;
                best = i;
            }
        }
        if !(size > 0.0 && size < f64::INFINITY) {
            return Err(PivotFailure { column: k, non_finite: size.is_nan() || size > 0.0 });
        }
        permutation[k] = best as u8;
        if best != k {
            let (upper, lower) = matrix.split_at_mut(best * lanes);
            upper[k * lanes..(k + 1) * lanes].swap_with_slice(&mut lower[..lanes]);
        }
        let (upper, lower) = matrix.split_at_mut((k + 1) * lanes);
        let pivot_row = &upper[k * lanes..];
        let reciprocal = 1.0 / pivot_row[lane][offset];
        for row in lower.chunks_exact_mut(lanes).take(rows - k - 1) {
            let factor = row[lane][offset] * reciprocal;
            if factor != 0.0 {
                // Only the columns right of the pivot may change: the ones left of it hold multipliers.
                for t in offset + 1..LANE {
                    row[lane][t] -= factor * pivot_row[lane][t];
                }
                for (x, p) in row[lane + 1..].iter_mut().zip(&pivot_row[lane + 1..]) {
                    for t in 0..LANE {
                        x[t] -= factor * p[t];
                    }
                }
            }
            row[lane][offset] = factor;
        }
    }
    Ok(())
}

/// Back substitution on the columns at and right of `first_lane` for the upper triangle in the first `n` columns left by
/// [`eliminate`]: afterwards those columns hold the solution.
#[multiversion(targets("x86_64+avx512f+avx512vl", "x86_64+avx+avx2", "aarch64+neon"))]
pub fn back_substitute(matrix: &mut [Lane], lanes: usize, n: usize, first_lane: usize) {
    for k in (0..n).rev() {
        let (upper, lower) = matrix.split_at_mut(k * lanes);
        let row = &mut lower[..lanes];
        let reciprocal = 1.0 / row[k / LANE][k % LANE];
        for x in row[first_lane..].iter_mut() {
            for t in 0..LANE {
                x[t] *= reciprocal;
            }
        }
        for above in upper.chunks_exact_mut(lanes) {
            let factor = above[k / LANE][k % LANE];
            if factor != 0.0 {
                for (x, p) in above[first_lane..].iter_mut().zip(&row[first_lane..]) {
                    for t in 0..LANE {
                        x[t] -= factor * p[t];
                    }
                }
            }
        }
    }
}

/// Solves with the factors left by [`eliminate`] (square, n × n) for one right-hand side in place.
pub fn solve_vector(matrix: &[Lane], lanes: usize, n: usize, permutation: &[u8], x: &mut [f64]) {
    forward_vector(matrix, lanes, n, n, permutation, x);
    for k in (0..n).rev() {
        let row = matrix[k * lanes..(k + 1) * lanes].as_flattened();
        let mut sum = x[k];
        for j in k + 1..n {
            sum -= row[j] * x[j];
        }
        x[k] = sum / row[k];
    }
}

/// Applies the row exchanges and multipliers of [`eliminate`] to one right-hand side of `rows` entries.
pub fn forward_vector(matrix: &[Lane], lanes: usize, columns: usize, rows: usize, permutation: &[u8], x: &mut [f64]) {
    // Row exchanges during elimination moved the multipliers along with their rows, so all exchanges come first.
    for k in 0..columns {
        x.swap(k, permutation[k] as usize);
    }
    for i in 1..rows {
        let row = matrix[i * lanes..(i + 1) * lanes].as_flattened();
        let mut sum = x[i];
        for j in 0..columns.min(i) {
            sum -= row[j] * x[j];
        }
        x[i] = sum;
    }
}

/// Multiplies the pivots of a factorised block into a determinant.
pub fn accumulate_determinant(
    matrix: &[Lane],
    lanes: usize,
    columns: usize,
    permutation: &[u8],
    det: &mut Determinant,
) {
    for k in 0..columns {
        let pivot = matrix[k * lanes + k / LANE][k % LANE];
        det.log_abs += pivot.abs().ln();
        if (pivot < 0.0) != (permutation[k] as usize != k) {
            det.sign = -det.sign;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn solves_a_system_and_knows_its_determinant() {
        // A = [[0, 2, 1], [1, 1, 0], [4, 0, 3]] has determinant −10.
        let a = [[0.0, 2.0, 1.0], [1.0, 1.0, 0.0], [4.0, 0.0, 3.0]];
        let x = [1.5, -2.0, 0.25];
        let mut rows = vec![[0.0; 8]; 6];
        for i in 0..3 {
            rows[2 * i][..3].copy_from_slice(&a[i]);
            rows[2 * i + 1][0] = (0..3).map(|j| a[i][j] * x[j]).sum();
        }
        let rhs: Vec<f64> = (0..3).map(|i| rows[2 * i + 1][0]).collect();
        let mut permutation = [0; 3];
        eliminate(&mut rows, 2, 3, 3, &mut permutation).unwrap();
        let mut det = Determinant::default();
        accumulate_determinant(&rows, 2, 3, &permutation, &mut det);
        assert!((det.sign * det.log_abs.exp() + 10.0).abs() < 1e-12);
        let mut y = rhs;
        solve_vector(&rows, 2, 3, &permutation, &mut y);
        back_substitute(&mut rows, 2, 3, 1);
        for i in 0..3 {
            assert!((rows[2 * i + 1][0] - x[i]).abs() < 1e-14);
            assert!((y[i] - x[i]).abs() < 1e-14);
        }
    }

    #[test]
    fn reports_a_zero_and_a_nan_pivot() {
        let mut zero = vec![[0.0; 8]; 2];
        assert_eq!(eliminate(&mut zero, 1, 2, 2, &mut [0; 2]), Err(PivotFailure { column: 0, non_finite: false }));
        let mut nan = vec![[f64::NAN; 8]; 2];
        assert_eq!(eliminate(&mut nan, 1, 2, 2, &mut [0; 2]), Err(PivotFailure { column: 0, non_finite: true }));
    }
}
