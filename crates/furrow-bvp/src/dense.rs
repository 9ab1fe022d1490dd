//! Row operations on small dense matrices, four columns at a time.
//!
//! Every block of the collocation system is eliminated by the one kernel here. Rows are arrays of [`Lane`]s of a width
//! fixed at compile time, and factors are kept by columns, so that factorising and solving are both sums of scaled
//! vectors without branches or reductions. The kernels are compiled for several instruction sets and chosen at run time.
//! No fused multiply–add is used and nothing is reordered, so the choice never changes a bit of the result.

use multiversion::multiversion;

/// Four neighbouring columns of one row, or rows of one column.
pub type Lane = [f64; 4];

/// Entries per lane.
pub const LANE: usize = 4;

/// Partial sums of a reduction.
const SUMS: usize = 8;

/// Most lanes in a row of a block.
pub const MAX_LANES: usize = 16;

/// Number of lanes that hold `entries` entries.
pub const fn lanes_for(entries: usize) -> usize {
    entries.div_ceil(LANE)
}

/// Lanes that start on a boundary of 64 bytes: a lane that lies across two cache lines takes twice as long to load, and
/// where an allocation starts is up to chance.
#[derive(Debug, Default)]
pub struct Lanes {
    values: Vec<f64>,
    /// Where the first lane starts, which stays so until the next change of length.
    start: usize,
    len: usize,
}

/// Boundary lanes start on, in bytes.
const BOUNDARY: usize = LANE * size_of::<f64>();

impl Lanes {
    /// Makes room for `len` lanes. What they hold is unspecified (but initialised) after a change of length, zero the
    /// first time.
    pub fn resize(&mut self, len: usize) {
        // Room for the lanes to start up to a lane behind the allocation.
        self.values.resize((len + 1) * LANE, 0.0);
        // The offset may be refused, and is only a matter of speed.
        self.start = Some(self.values.as_ptr().align_offset(BOUNDARY)).filter(|offset| *offset < LANE).unwrap_or(0);
        self.len = len;
    }
}

impl Clone for Lanes {
    fn clone(&self) -> Lanes {
        let mut copy = Lanes::default();
        if self.len > 0 {
            copy.resize(self.len);
            copy.copy_from_slice(self);
        }
        copy
    }
}

impl std::ops::Deref for Lanes {
    type Target = [Lane];

    #[inline(always)]
    fn deref(&self) -> &[Lane] {
        self.values[self.start..self.start + self.len * LANE].as_chunks().0
    }
}

impl std::ops::DerefMut for Lanes {
    #[inline(always)]
    fn deref_mut(&mut self) -> &mut [Lane] {
        self.values[self.start..self.start + self.len * LANE].as_chunks_mut().0
    }
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
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("pivot {column} {}", if *.non_finite { "is not a finite number" } else { "vanishes" })]
pub struct PivotFailure {
    /// Column of the failing pivot.
    pub column: usize,
    /// The best pivot was not a finite number (rather than zero).
    pub non_finite: bool,
}

impl Determinant {
    /// Multiplies by the pivots of a factorised block, given by their reciprocals and the rows exchanged for them.
    pub(crate) fn multiply(&mut self, reciprocal: &[f64], exchange: &[u8]) {
        for (k, (r, e)) in reciprocal.iter().zip(exchange).enumerate() {
            self.log_abs -= r.abs().ln();
            if (*r < 0.0) != (*e as usize != k) {
                self.sign = -self.sign;
            }
        }
    }
}

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
    #[inline(always)]
    pub fn solve(&self, x: &mut [Lane]) {
        let (n, lanes) = (self.size(), lanes_for(self.size()));
        for k in 0..n {
            let flat = x.as_flattened_mut();
            flat.swap(k, self.exchange[k] as usize);
            let value = flat[k];
            subtract_scaled(&mut x[..lanes], value, &self.lower[k * lanes..(k + 1) * lanes]);
        }
        for k in (0..n).rev() {
            let value = x[k / LANE][k % LANE] * self.reciprocal[k];
            x[k / LANE][k % LANE] = value;
            subtract_scaled(&mut x[..lanes], value, &self.upper[k * lanes..(k + 1) * lanes]);
        }
    }

    /// Multiplies the determinant of the block into `det`.
    pub fn multiply_into(&self, det: &mut Determinant) {
        det.multiply(&self.reciprocal, &self.exchange);
    }
}

#[inline(always)]
fn subtract_scaled(target: &mut [Lane], factor: f64, source: &[Lane]) {
    for (x, y) in target.iter_mut().zip(source) {
        for t in 0..LANE {
            x[t] -= factor * y[t];
        }
    }
}

/// Row operation of the elimination, a whole lane at a time: one flat loop over short rows is unrolled before it can be
/// vectorised.
#[inline(always)]
fn subtract_row<const L: usize>(row: &mut [Lane; L], factor: f64, pivot: &[Lane; L]) {
    for (x, p) in row.iter_mut().zip(pivot) {
        let before = *x;
        *x = std::array::from_fn(|t| before[t] - factor * p[t]);
    }
}

/// The row with the largest entry in column k, from row k to before `candidates`.
#[inline(always)]
fn pivot_row<const L: usize>(rows: &[[Lane; L]], k: usize, candidates: usize) -> Result<usize, PivotFailure> {
    let (lane, offset) = (k / LANE, k % LANE);
    let mut best = k;
    let mut size = rows[k][lane][offset].abs();
    for (i, row) in (k + 1..).zip(&rows[k + 1..candidates]) {
        let candidate = row[lane][offset].abs();
        if candidate > size {
            size = candidate;
            best = i;
        }
    }
    if size > 0.0 && size < f64::INFINITY {
        return Ok(best);
    }
    Err(PivotFailure { column: k, non_finite: size.is_nan() || size > 0.0 })
}

#[inline(always)]
fn eliminate_rows<const L: usize>(rows: &mut [[Lane; L]], lu: &mut Lu) -> Result<(), PivotFailure> {
    for k in 0..rows.len() {
        let (lane, offset) = (k / LANE, k % LANE);
        let best = pivot_row(rows, k, rows.len())?;
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
            subtract_row(row, factor, &pivot);
        }
    }
    Ok(())
}

/// Calls `$body` with `$rows` as arrays of the given number of lanes, known at compile time.
macro_rules! with_width {
    ($matrix:expr, $lanes:expr, $rows:ident => $body:expr, [$($l:literal)*]) => {
        match $lanes {
            $($l => { let ($rows, _) = $matrix.as_chunks_mut::<$l>(); $body })*
            other => panic!("blocks of {other} lanes are wider than the kernels are built for"),
        }
    };
}

/// Gaussian elimination of a square row-major `matrix` (`lanes` lanes a row), whose factors are left in `lu`.
#[multiversion(targets("x86_64+avx+avx2", "aarch64+neon"))]
fn eliminate(matrix: &mut [Lane], lanes: usize, lu: &mut Lu) -> Result<(), PivotFailure> {
    with_width!(matrix, lanes, rows => eliminate_rows(rows, lu), [1 2 3 4 5 6 7 8])
}

#[inline(always)]
fn eliminate_rows_in_place<const L: usize>(
    rows: &mut [[Lane; L]],
    columns: usize,
    candidates: usize,
    reciprocal: &mut [f64],
    exchange: &mut [u8],
) -> Result<(), PivotFailure> {
    for k in 0..columns {
        let (lane, offset) = (k / LANE, k % LANE);
        let best = pivot_row(rows, k, candidates)?;
        exchange[k] = best as u8;
        rows.swap(k, best);
        let scale = 1.0 / rows[k][lane][offset];
        reciprocal[k] = scale;
        let mut pivot = rows[k];
        pivot.as_flattened_mut().iter_mut().for_each(|x| *x *= scale);
        let (above, rest) = rows.split_at_mut(k);
        let Some((own, below)) = rest.split_first_mut() else { unreachable!("row k is among the rows") };
        for row in above.iter_mut().chain(below) {
            let factor = row[lane][offset];
            subtract_row(row, factor, &pivot);
            row[lane][offset] = -factor * scale;
        }
        *own = pivot;
        own[lane][offset] = scale;
    }
    Ok(())
}

/// Gauss–Jordan elimination of the first `columns` columns of the row-major `matrix` (`lanes` lanes a row) from all other rows,
/// choosing pivots among the first `candidates` rows (rows past them are never pivots: borders). The eliminated columns are
/// replaced by what elimination does to right-hand sides b: exchange b_k with b_exchange(k) for every k in turn, take the first
/// `columns` of them by these columns, and keep the other rows' own. A square matrix so becomes its inverse, with columns
/// exchanged.
#[inline(always)]
pub fn eliminate_in_place(
    matrix: &mut [Lane],
    lanes: usize,
    columns: usize,
    candidates: usize,
    reciprocal: &mut [f64],
    exchange: &mut [u8],
) -> Result<(), PivotFailure> {
    if columns == 0 {
        return Ok(());
    }
    with_width!(matrix, lanes, rows => eliminate_rows_in_place(rows, columns, candidates, reciprocal, exchange),
        [1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16])
}

/// Σ a b, in eight partial sums whatever the machine.
#[inline(always)]
pub fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut sum = [0.0; SUMS];
    let ((a, a_rest), (b, b_rest)) = (a.as_chunks::<SUMS>(), b.as_chunks::<SUMS>());
    for (a, b) in a.iter().zip(b) {
        for t in 0..SUMS {
            sum[t] += a[t] * b[t];
        }
    }
    for (t, (a, b)) in a_rest.iter().zip(b_rest).enumerate() {
        sum[t] += a * b;
    }
    ((sum[0] + sum[4]) + (sum[1] + sum[5])) + ((sum[2] + sum[6]) + (sum[3] + sum[7]))
}

/// Makes `v` so many zeros. A kilobyte at a time: more are cleared by string instructions, which are slow to begin with.
pub fn zeroed(v: &mut Vec<f64>, len: usize) {
    v.resize(len, 0.0);
    v.chunks_mut(128).for_each(|part| part.fill(0.0));
}

/// Adds a scaled lane.
#[inline(always)]
pub fn add_scaled(target: &mut Lane, factor: f64, source: &Lane) {
    for t in 0..LANE {
        target[t] += factor * source[t];
    }
}

/// Adds Σ_k factor_k · column_k to `sums`; column k starts at `columns[k * stride]`. Several lanes at a time: the sums of one alone
/// would wait for each other.
#[inline(always)]
pub fn add_columns(sums: &mut [Lane], factors: impl Iterator<Item = f64> + Clone, columns: &[Lane], stride: usize) {
    // Without any column there is nothing behind the first lanes either.
    let behind = |from: usize| columns.get(from..).unwrap_or_default();
    let mut from = 0;
    while from + 4 <= sums.len() {
        add_block::<4>(&mut sums[from..], factors.clone(), behind(from), stride);
        from += 4;
    }
    if from + 2 <= sums.len() {
        add_block::<2>(&mut sums[from..], factors.clone(), behind(from), stride);
        from += 2;
    }
    if from < sums.len() {
        add_block::<1>(&mut sums[from..], factors, behind(from), stride);
    }
}

/// [`add_columns`] for the first W lanes, whose sums are kept in registers.
#[inline(always)]
fn add_block<const W: usize>(sums: &mut [Lane], factors: impl Iterator<Item = f64>, columns: &[Lane], stride: usize) {
    let Some(sums) = sums.first_chunk_mut::<W>() else { return };
    let mut sum = *sums;
    for (factor, column) in factors.zip(columns.chunks(stride)) {
        for (sum, lane) in sum.iter_mut().zip(&column[..W]) {
            add_scaled(sum, factor, lane);
        }
    }
    *sums = sum;
}

/// Largest |d| / (1 + |v|), NaN if any d is not a number. Quotients are compared by products, of which a processor makes ten in
/// the time of a division.
#[multiversion(targets("x86_64+avx+avx2", "aarch64+neon"))]
pub fn weighted_maximum(d: &[f64], v: &[f64]) -> f64 {
    let (mut above, mut below, mut poison) = ([0.0; SUMS], [1.0; SUMS], [0.0; SUMS]);
    let (d_lanes, d_rest) = d.as_chunks::<SUMS>();
    let (v_lanes, v_rest) = v.as_chunks::<SUMS>();
    for (d, v) in d_lanes.iter().zip(v_lanes) {
        for t in 0..SUMS {
            let (size, scale) = (d[t].abs(), 1.0 + v[t].abs());
            let larger = size * below[t] > above[t] * scale;
            above[t] = if larger { size } else { above[t] };
            below[t] = if larger { scale } else { below[t] };
            poison[t] += size * 0.0;
        }
    }
    let mut largest = 0.0f64;
    for t in 0..SUMS {
        largest = largest.max(above[t] / below[t]);
    }
    for (d, v) in d_rest.iter().zip(v_rest) {
        let e = d.abs() / (1.0 + v.abs());
        largest = largest.max(e);
        poison[0] += e * 0.0;
    }
    if poison.iter().any(|p| p.is_nan()) { f64::NAN } else { largest }
}

/// [`eliminate_in_place`] of a square matrix, compiled by itself for every instruction set.
#[multiversion(targets("x86_64+avx+avx2", "aarch64+neon"))]
pub fn eliminate_square_in_place(
    matrix: &mut [Lane],
    lanes: usize,
    reciprocal: &mut [f64],
    exchange: &mut [u8],
) -> Result<(), PivotFailure> {
    let size = reciprocal.len();
    eliminate_in_place(matrix, lanes, size, size, reciprocal, exchange)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Has determinant −10 and needs a row exchanged.
    const A: [[f64; 3]; 3] = [[0.0, 2.0, 1.0], [1.0, 1.0, 0.0], [4.0, 0.0, 3.0]];

    fn padded() -> [Lane; 3] {
        A.map(|row| std::array::from_fn(|k| if k < 3 { row[k] } else { 0.0 }))
    }

    #[test]
    fn factors_solve_and_give_the_determinant() {
        let x = [1.5, -2.0, 0.25];
        let mut rhs = [[0.0; LANE]];
        for i in 0..3 {
            rhs[0][i] = (0..3).map(|j| A[i][j] * x[j]).sum();
        }
        let (mut lu, mut det) = (Lu::default(), Determinant::default());
        lu.factorise(&mut padded(), 3).unwrap();
        lu.multiply_into(&mut det);
        assert!((det.sign * det.log_abs.exp() + 10.0).abs() < 1e-12);
        lu.solve(&mut rhs);
        for i in 0..3 {
            assert!((rhs[0][i] - x[i]).abs() < 1e-14);
        }
    }

    #[test]
    fn elimination_in_place_leaves_the_inverse_with_columns_exchanged() {
        let mut rows = padded();
        let (mut reciprocal, mut exchange) = ([0.0; 3], [0; 3]);
        eliminate_in_place(&mut rows, 1, 3, 3, &mut reciprocal, &mut exchange).unwrap();
        let mut det = Determinant::default();
        det.multiply(&reciprocal, &exchange);
        assert!((det.sign * det.log_abs.exp() + 10.0).abs() < 1e-12);
        for k in 0..3 {
            // Column k of A is the right-hand side whose solution is the unit vector k.
            let mut b = A.map(|row| row[k]);
            for (j, other) in exchange.iter().enumerate() {
                b.swap(j, *other as usize);
            }
            for (i, row) in rows.iter().enumerate() {
                let x: f64 = (0..3).map(|j| row[j] * b[j]).sum();
                assert!((x - if i == k { 1.0 } else { 0.0 }).abs() < 1e-14);
            }
        }
    }

    #[test]
    fn reports_a_zero_and_a_nan_pivot() {
        for (entry, non_finite) in [(0.0, false), (f64::NAN, true)] {
            let failure = Lu::default().factorise(&mut [[entry; LANE]; 2], 2).unwrap_err();
            assert_eq!(failure, PivotFailure { column: 0, non_finite });
        }
    }

    #[test]
    fn a_nan_is_not_lost_in_the_maximum() {
        let (d, v) = ([0.5; 19], [1.0; 19]);
        assert_eq!(weighted_maximum(&d, &v), 0.25);
        for place in [3, 17] {
            let mut d = d;
            d[place] = f64::NAN;
            assert!(weighted_maximum(&d, &v).is_nan());
        }
    }
}
