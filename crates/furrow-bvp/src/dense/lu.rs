//! Triangular factors of a square block.

use multiversion::multiversion;

use super::jordan::with_width;
use super::{Determinant, LANE, Lane, Lanes, PivotFailure, lanes_for, pivot_among, subtract_scaled};

/// Triangular factors of a square block.
#[derive(Clone, Debug, Default)]
pub struct Lu {
    /// Multipliers by columns, zero at and above the pivot; n columns × lanes_for(n).
    lower: Lanes,
    /// Entries above the diagonal by columns, zero at and below the pivot; n columns × lanes_for(n).
    upper: Lanes,
    /// Reciprocal pivots; n.
    reciprocal: Vec<f64>,
    /// Row exchanged with row k; n.
    exchange: Vec<u8>,
}

impl Lu {
    /// Rows and columns of the block.
    pub fn size(&self) -> usize {
        self.reciprocal.len()
    }

    /// Factorises the row-major n × n `matrix` (lanes_for(n) lanes a row), which is overwritten.
    ///
    /// # Errors
    /// If a pivot vanishes or is not finite.
    pub fn factorise(&mut self, matrix: &mut [Lane], n: usize) -> Result<(), PivotFailure> {
        let lanes = lanes_for(n);
        self.lower.resize(n * lanes);
        self.upper.resize(n * lanes);
        self.reciprocal.resize(n, 0.0);
        self.exchange.resize(n, 0);
        eliminate(matrix, lanes, self)
    }

    /// Solves for one right-hand side in place (n entries, padded to whole lanes).
    pub fn solve(&self, x: &mut [Lane]) {
        substitute(self, x);
    }

    /// Multiplies the determinant of the block into `det`.
    pub fn multiply_into(&self, det: &mut Determinant) {
        det.multiply(&self.reciprocal, &self.exchange);
    }
}

#[multiversion(targets("x86_64+avx+avx2", "aarch64+neon"))]
fn substitute(Lu { lower, upper, reciprocal, exchange }: &Lu, x: &mut [Lane]) {
    let (n, lanes) = (reciprocal.len(), lanes_for(reciprocal.len()));
    for k in 0..n {
        let flat = x.as_flattened_mut();
        flat.swap(k, exchange[k] as usize);
        let value = flat[k];
        subtract(&mut x[..lanes], value, &lower[k * lanes..(k + 1) * lanes]);
    }
    for k in (0..n).rev() {
        let value = x[k / LANE][k % LANE] * reciprocal[k];
        x[k / LANE][k % LANE] = value;
        subtract(&mut x[..lanes], value, &upper[k * lanes..(k + 1) * lanes]);
    }
}

#[inline(always)]
fn subtract(target: &mut [Lane], factor: f64, source: &[Lane]) {
    for (x, y) in target.iter_mut().zip(source) {
        subtract_scaled(x, factor, y);
    }
}

#[inline(always)]
fn eliminate_rows<const L: usize>(rows: &mut [[Lane; L]], lu: &mut Lu) -> Result<(), PivotFailure> {
    for k in 0..rows.len() {
        let (lane, offset) = (k / LANE, k % LANE);
        let best = pivot_among(rows[k..].iter().map(|row| &row[lane][offset]), k)?;
        lu.exchange[k] = best as u8;
        rows.swap(k, best);
        let pivot = rows[k];
        let reciprocal = 1.0 / pivot[lane][offset];
        lu.reciprocal[k] = reciprocal;
        let upper = &mut lu.upper[k * L..(k + 1) * L];
        upper.fill([0.0; LANE]);
        for (i, row) in rows.iter().enumerate().take(k) {
            upper[i / LANE][i % LANE] = row[lane][offset];
        }
        let lower = &mut lu.lower[k * L..(k + 1) * L];
        lower.fill([0.0; LANE]);
        for (i, row) in rows.iter_mut().enumerate().skip(k + 1) {
            let factor = row[lane][offset] * reciprocal;
            lower[i / LANE][i % LANE] = factor;
            subtract(row, factor, &pivot);
        }
    }
    Ok(())
}

/// Gaussian elimination of a square row-major `matrix` (`lanes` lanes a row), which leaves its factors in `lu`.
#[multiversion(targets("x86_64+avx+avx2", "aarch64+neon"))]
fn eliminate(matrix: &mut [Lane], lanes: usize, lu: &mut Lu) -> Result<(), PivotFailure> {
    with_width!(matrix, lanes, rows => eliminate_rows(rows, lu), [1 2 3 4 5 6 7 8])
}
