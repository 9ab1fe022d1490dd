//! Gauss–Jordan elimination of some columns of a matrix.

use multiversion::multiversion;

use super::{LANE, Lane, PivotFailure, pivot_among, subtract_scaled, times};

/// Calls `$body` with `$rows` as arrays of the given number of lanes, known at compile time. It returns the result of an elimination.
macro_rules! with_width {
    ($matrix:expr, $lanes:expr, $rows:ident => $body:expr, [$($l:literal)*]) => {
        match $lanes {
            $($l => { let ($rows, _) = $matrix.as_chunks_mut::<$l>(); $body })*
            // Wider than `Dimensions::check` allows.
            _ => Err(PivotFailure { column: 0, non_finite: true }),
        }
    };
}

pub(super) use with_width;

/// Subtracts multiples of the pivot row from other rows. Their entries in its column become the coefficients for right-hand sides. A
/// loop, since closures of iterators may be compiled separately, for another instruction set.
#[inline(always)]
fn eliminate_from<const L: usize>(rows: &mut [[Lane; L]], pivot: &[Lane; L], [lane, offset]: [usize; 2], scale: f64) {
    for row in rows {
        let factor = row[lane][offset];
        for v in 0..L {
            subtract_scaled(&mut row[v], factor, &pivot[v]);
        }
        row[lane][offset] = -factor * scale;
    }
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
        let best = pivot_among(rows[k..candidates].iter().map(|row| &row[lane][offset]), k)?;
        exchange[k] = best as u8;
        rows.swap(k, best);
        let scale = 1.0 / rows[k][lane][offset];
        reciprocal[k] = scale;
        let mut pivot = rows[k];
        for v in 0..L {
            pivot[v] = times(&pivot[v], &[scale; LANE]);
        }
        let (above, below) = rows.split_at_mut(k);
        eliminate_from(above, &pivot, [lane, offset], scale);
        eliminate_from(&mut below[1..], &pivot, [lane, offset], scale);
        rows[k] = pivot;
        rows[k][lane][offset] = scale;
    }
    Ok(())
}

/// Gauss–Jordan elimination of the first `columns` columns of the row-major `matrix` (`lanes` lanes a row) from all other rows,
/// choosing pivots among the first `candidates` rows (rows past them are never pivots: borders). The eliminated columns are
/// replaced by the operations on right-hand sides b: exchange b_k with b_exchange(k) for every k in turn, take the first
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

/// Inverts a square row-major `matrix` (`lanes` lanes a row) in its place, compiled by itself for every instruction set.
///
/// # Errors
/// If a pivot vanishes or is not finite.
#[multiversion(targets("x86_64+avx+avx2", "aarch64+neon"))]
pub fn invert(
    matrix: &mut [Lane],
    lanes: usize,
    reciprocal: &mut [f64],
    exchange: &mut [u8],
) -> Result<(), PivotFailure> {
    let size = exchange.len();
    eliminate_in_place(matrix, lanes, size, size, reciprocal, exchange)?;
    for (k, other) in exchange.iter().enumerate().rev() {
        let other = *other as usize;
        if other != k {
            for row in matrix.chunks_exact_mut(lanes) {
                row.as_flattened_mut().swap(k, other);
            }
        }
    }
    Ok(())
}
