//! Row operations on small dense matrices, four columns at a time.
//!
//! Every block of the collocation system is eliminated by the one kernel here. Rows are arrays of [`Lane`]s of a width
//! fixed at compile time, and factors are kept by columns, so that factorising and solving are both sums of scaled
//! vectors without branches or reductions. The kernels are compiled for several instruction sets and chosen at run time.
//! No fused multiply–add is used and nothing is reordered, so the choice never changes a bit of the result.

mod jordan;
mod lu;

use multiversion::multiversion;

pub use jordan::{eliminate_in_place, invert};
pub use lu::Lu;

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
    /// Makes room for `len` lanes. Their values are unspecified (but initialised) after a change of length, zero the
    /// first time.
    pub fn resize(&mut self, len: usize) {
        // Room for the lanes to start up to a lane behind the allocation.
        let entries = (len + 1) * LANE;
        if entries > self.values.capacity() {
            // `Vec::resize` would copy the old values.
            self.values = zeros(entries);
        }
        self.values.resize(entries, 0.0);
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
        // One logarithm serves many pivots.
        let mut product = 1.0;
        for (k, (r, e)) in reciprocal.iter().zip(exchange).enumerate() {
            product *= if *e as usize == k { *r } else { -r };
            if !MODERATE.contains(&product.abs()) {
                self.divide(product);
                product = 1.0;
            }
        }
        self.divide(product);
    }

    fn divide(&mut self, product: f64) {
        self.log_abs -= product.abs().ln();
        if product < 0.0 {
            self.sign = -self.sign;
        }
    }
}

/// Products of pivots that another pivot does not take out of the range of numbers.
const MODERATE: std::ops::Range<f64> = 1e-8..1e8;

/// The place, from `first` on, of the entry of largest size among `entries`, the earliest of equals: size and place are compared as one
/// number, since a processor guesses wrong where branches depend on data.
#[inline(always)]
fn pivot_among<'a>(entries: impl Iterator<Item = &'a f64>, first: usize) -> Result<usize, PivotFailure> {
    const PLACES: u64 = 0xff;
    let (mut largest, mut place) = (0, PLACES - first as u64);
    for entry in entries {
        largest = u64::max(largest, entry.abs().to_bits() & !PLACES | place);
        place -= 1;
    }
    let (size, place) = (f64::from_bits(largest & !PLACES), PLACES - (largest & PLACES));
    if size > 0.0 && size < f64::INFINITY {
        return Ok(place as usize);
    }
    Err(PivotFailure { column: first, non_finite: size.is_nan() || size > 0.0 })
}

/// x times a lane.
#[inline(always)]
fn times(x: &Lane, p: &Lane) -> Lane {
    [x[0] * p[0], x[1] * p[1], x[2] * p[2], x[3] * p[3]]
}

/// x − factor · p. Written out: a loop over a short row is unrolled before it can be vectorised.
#[inline(always)]
fn subtract_scaled(x: &mut Lane, factor: f64, p: &Lane) {
    let ([x0, x1, x2, x3], [p0, p1, p2, p3]) = (*x, *p);
    *x = [x0 - factor * p0, x1 - factor * p1, x2 - factor * p2, x3 - factor * p3];
}

/// Zeros that are cleared at a time: longer parts are cleared by string instructions, which are slow to begin with.
const CLEARED: usize = 128;

/// The given number of zeros, with room for half as many more: meshes grow step by step.
fn zeros(len: usize) -> Vec<f64> {
    let mut v = Vec::with_capacity(len + len / 2);
    while v.len() < len {
        v.resize(len.min(v.len() + CLEARED), 0.0);
    }
    v
}

/// Makes `v` the given number of zeros.
pub fn zeroed(v: &mut Vec<f64>, len: usize) {
    if len > v.capacity() {
        *v = zeros(len);
        return;
    }
    // Most vectors are short and keep their length.
    if v.len() == len && len <= CLEARED {
        return v.fill(0.0);
    }
    v.resize(len, 0.0);
    v.chunks_mut(CLEARED).for_each(|part| part.fill(0.0));
}

/// Adds a scaled lane.
#[inline(always)]
pub fn add_scaled(target: &mut Lane, factor: f64, source: &Lane) {
    let ([t0, t1, t2, t3], [s0, s1, s2, s3]) = (*target, *source);
    *target = [t0 + factor * s0, t1 + factor * s1, t2 + factor * s2, t3 + factor * s3];
}

/// Adds Σ_k factor_k · column_k to `sums`; column k starts at `columns[k * stride]`. Several lanes at a time: the sums of one alone
/// would wait for each other.
#[inline(always)]
pub fn add_columns(sums: &mut [Lane], factors: &[f64], columns: &[Lane], stride: usize) {
    // Without any column there is nothing behind the first lanes either.
    let behind = |from: usize| columns.get(from..).unwrap_or_default();
    let mut from = 0;
    while from + 4 <= sums.len() {
        add_block::<4>(&mut sums[from..], factors, behind(from), stride);
        from += 4;
    }
    if from + 2 <= sums.len() {
        add_block::<2>(&mut sums[from..], factors, behind(from), stride);
        from += 2;
    }
    if from < sums.len() {
        add_block::<1>(&mut sums[from..], factors, behind(from), stride);
    }
}

/// [`add_columns`] for the first W lanes, with sums in registers.
#[inline(always)]
fn add_block<const W: usize>(sums: &mut [Lane], factors: &[f64], columns: &[Lane], stride: usize) {
    let Some(sums) = sums.first_chunk_mut::<W>() else { return };
    let mut sum = *sums;
    for (k, factor) in factors.iter().enumerate() {
        let column = &columns[k * stride..][..W];
        for v in 0..W {
            add_scaled(&mut sum[v], *factor, &column[v]);
        }
    }
    *sums = sum;
}

/// Adds a multiple of a vector.
#[multiversion(targets("x86_64+avx+avx2", "aarch64+neon"))]
pub fn add_multiple(to: &mut [f64], factor: f64, terms: &[f64]) {
    to.iter_mut().zip(terms).for_each(|(to, term)| *to += factor * term);
}

/// Largest |v|, or NaN if any v is NaN.
#[multiversion(targets("x86_64+avx+avx2", "aarch64+neon"))]
pub fn largest(v: &[f64]) -> f64 {
    // As integers, the bits of positive numbers have the same order, and NaN comes last.
    let mut largest = [0; SUMS];
    let (lanes, rest) = v.as_chunks::<SUMS>();
    for v in lanes {
        for t in 0..SUMS {
            largest[t] = i64::max(largest[t], v[t].abs().to_bits().cast_signed());
        }
    }
    let all = largest.into_iter().chain(rest.iter().map(|v| v.abs().to_bits().cast_signed()));
    f64::from_bits(all.fold(0, i64::max).cast_unsigned())
}

/// Largest |d| / (1 + |v|), or NaN if any d is NaN.
#[multiversion(targets("x86_64+avx+avx2", "aarch64+neon"))]
pub fn weighted_maximum(d: &[f64], v: &[f64]) -> f64 {
    // Compared by their bits, as in `largest`.
    let mut largest = [0; SUMS];
    let (d_lanes, d_rest) = d.as_chunks::<SUMS>();
    let (v_lanes, v_rest) = v.as_chunks::<SUMS>();
    for (d, v) in d_lanes.iter().zip(v_lanes) {
        for t in 0..SUMS {
            largest[t] = i64::max(largest[t], (d[t].abs() / (1.0 + v[t].abs())).to_bits().cast_signed());
        }
    }
    for (d, v) in d_rest.iter().zip(v_rest) {
        largest[0] = i64::max(largest[0], (d.abs() / (1.0 + v.abs())).to_bits().cast_signed());
    }
    f64::from_bits(largest.into_iter().fold(0, i64::max).cast_unsigned())
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
            // With column k of A as right-hand side the solution is the unit vector k.
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
