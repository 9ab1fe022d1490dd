//! Factors of many square matrices of one size, for solves with their transposes.
//!
//! P A = L D U with unit triangular L and U, in the place of A but for D.

use multiversion::multiversion;

use super::{LANE, Lane, MAX_LANES, PivotFailure, lanes_for, pivot_among, subtract_scaled, times};

/// 1 where an entry of a lane stands behind the diagonal, or before it.
const BEHIND: [Lane; LANE] = [[0.0, 1.0, 1.0, 1.0], [0.0, 0.0, 1.0, 1.0], [0.0, 0.0, 0.0, 1.0], [0.0; LANE]];
const BEFORE: [Lane; LANE] = [[0.0; LANE], [1.0, 0.0, 0.0, 0.0], [1.0, 1.0, 0.0, 0.0], [1.0, 1.0, 1.0, 0.0]];

/// Factors of one matrix.
#[derive(Clone, Copy)]
pub struct Factors<'a> {
    /// Rows of L and U, padded to whole lanes.
    pub rows: &'a [Lane],
    /// Reciprocal pivots, padded to whole lanes.
    pub reciprocal: &'a [Lane],
    /// Which entry of P y each entry of y is.
    pub order: &'a [u8],
}

/// Where the factors of one matrix are put.
pub struct FactorsMut<'a> {
    /// See [`Factors`].
    pub rows: &'a mut [Lane],
    pub reciprocal: &'a mut [Lane],
    pub order: &'a mut [u8],
    /// Rows exchanged, for determinants.
    pub exchange: &'a mut [u8],
    /// Solutions for the right-hand sides.
    pub solutions: &'a mut [Lane],
}

/// Lanes of a row of a panel that holds a matrix and right-hand sides of so many lanes.
pub const fn panel_lanes(lanes: usize) -> usize {
    match lanes {
        ..=8 => 8,
        9..=16 => 16,
        _ => 32,
    }
}

/// Factorises the square matrix in the first lanes of `panel`, which has rows of [`panel_lanes`], by elimination with row pivoting, and
/// solves for the right-hand sides behind it. Compiled by itself for every instruction set.
///
/// # Errors
/// If a pivot vanishes or is not finite.
#[multiversion(targets("x86_64+avx+avx2", "aarch64+neon"))]
pub fn factorise(panel: &mut [Lane], out: FactorsMut<'_>) -> Result<(), PivotFailure> {
    let size = out.exchange.len();
    if size == 0 {
        return Ok(());
    }
    match panel_lanes(lanes_for(size) + out.solutions.len() / size) {
        8 => factorise_rows(panel.as_chunks_mut::<8>().0, out),
        16 => factorise_rows(panel.as_chunks_mut::<16>().0, out),
        _ => factorise_rows(panel.as_chunks_mut::<32>().0, out),
    }
}

#[inline(always)]
fn factorise_rows<const R: usize>(panel: &mut [[Lane; R]], out: FactorsMut<'_>) -> Result<(), PivotFailure> {
    let FactorsMut { rows, reciprocal, order, exchange, solutions } = out;
    let (size, lanes) = (exchange.len(), reciprocal.len());
    let panel = &mut panel[..size];
    let sides = solutions.len() / size;
    for first in 0..lanes {
        let (below, at) = (&mut panel[first * LANE..], [first, lanes + sides - first]);
        let (reciprocal, exchange) =
            (&mut reciprocal[first], &mut exchange[first * LANE..size.min((first + 1) * LANE)]);
        // Large matrices are rare: one kernel for all widths does for them.
        match if R == panel_lanes(0) { at[1] } else { 0 } {
            2 => eliminate_lane::<R, 2>(below, at, reciprocal, exchange),
            3 => eliminate_lane::<R, 3>(below, at, reciprocal, exchange),
            4 => eliminate_lane::<R, 4>(below, at, reciprocal, exchange),
            5 => eliminate_lane::<R, 5>(below, at, reciprocal, exchange),
            6 => eliminate_lane::<R, 6>(below, at, reciprocal, exchange),
            7 => eliminate_lane::<R, 7>(below, at, reciprocal, exchange),
            _ => eliminate_lane::<R, 0>(below, at, reciprocal, exchange),
        }?;
    }
    match sides {
        1 => substitute_back::<R, 1>(panel, [lanes, sides], solutions),
        2 => substitute_back::<R, 2>(panel, [lanes, sides], solutions),
        3 => substitute_back::<R, 3>(panel, [lanes, sides], solutions),
        _ => substitute_back::<R, 0>(panel, [lanes, sides], solutions),
    }
    for (row, from) in rows.chunks_exact_mut(lanes).zip(&*panel) {
        for v in 0..lanes {
            row[v] = from[v];
        }
    }
    for (k, place) in order.iter_mut().enumerate() {
        *place = k as u8;
    }
    for (k, other) in exchange.iter().enumerate().rev() {
        order.swap(k, *other as usize);
    }
    Ok(())
}

/// Eliminates the columns of lane `first` from the rows `below`, which begin with that of the first of them. W lanes are left with it,
/// known at compile time unless 0.
#[inline(always)]
fn eliminate_lane<const R: usize, const W: usize>(
    below: &mut [[Lane; R]],
    at: [usize; 2],
    reciprocal: &mut Lane,
    exchange: &mut [u8],
) -> Result<(), PivotFailure> {
    let size = exchange.len();
    *reciprocal = [0.0; LANE];
    eliminate_column::<R, W, 0>(below, at, reciprocal, exchange)?;
    if size > 1 {
        eliminate_column::<R, W, 1>(below, at, reciprocal, exchange)?;
    }
    if size > 2 {
        eliminate_column::<R, W, 2>(below, at, reciprocal, exchange)?;
    }
    if size > 3 {
        eliminate_column::<R, W, 3>(below, at, reciprocal, exchange)?;
    }
    Ok(())
}

/// Eliminates column O of the lane. Rows keep their multipliers before the diagonal, and are divided by their pivots behind it.
#[inline(always)]
fn eliminate_column<const R: usize, const W: usize, const O: usize>(
    below: &mut [[Lane; R]],
    [first, width]: [usize; 2],
    reciprocal: &mut Lane,
    exchange: &mut [u8],
) -> Result<(), PivotFailure> {
    let width = if W > 0 { W } else { width };
    let k = first * LANE + O;
    let best = pivot_among(below[O..].iter().map(|row| &row[first][O]), k)?;
    exchange[O] = best as u8;
    let (above, below) = below.split_at_mut(O + 1);
    let pivot = &mut above[O];
    if best > k {
        std::mem::swap(pivot, &mut below[best - k - 1]);
    }
    let pivot = &mut pivot[first..][..width];
    let scale = 1.0 / pivot[0][O];
    reciprocal[O] = scale;
    let head = times(&pivot[0], &BEHIND[O]);
    for row in below {
        let row = &mut row[first..][..width];
        let factor = row[0][O] * scale;
        subtract_scaled(&mut row[0], factor, &head);
        row[0][O] = factor;
        for v in 1..width {
            subtract_scaled(&mut row[v], factor, &pivot[v]);
        }
    }
    for t in O + 1..LANE {
        pivot[0][t] *= scale;
    }
    for v in 1..width {
        pivot[v] = times(&pivot[v], &[scale; LANE]);
    }
    Ok(())
}

/// Solves with the upper factor for the right-hand sides in the K lanes behind it, known at compile time unless 0.
#[inline(always)]
fn substitute_back<const R: usize, const K: usize>(
    panel: &[[Lane; R]],
    [lanes, sides]: [usize; 2],
    solutions: &mut [Lane],
) {
    let sides = if K > 0 { K } else { sides };
    for k in (0..panel.len()).rev() {
        let (own, known) = solutions[k * sides..].split_at_mut(sides);
        let mut solution = [[0.0; LANE]; R];
        let solution = &mut solution[..sides];
        solution.copy_from_slice(&panel[k][lanes..][..sides]);
        let upper = &panel[k].as_flattened()[k + 1..panel.len()];
        for (factor, known) in upper.iter().zip(known.chunks_exact(sides)) {
            for v in 0..sides {
                subtract_scaled(&mut solution[v], *factor, &known[v]);
            }
        }
        own.copy_from_slice(solution);
    }
}

/// Solves yᵀ A = xᵀ for K matrices of one size, in the place of x but for the order of its entries: y_i is entry `order[i]`. K at a time,
/// since every step of one waits for the one before.
#[inline(always)]
pub fn solve_transposed<const K: usize>(size: usize, of: &[Factors<'_>; K], x: &mut [[Lane; MAX_LANES]; K]) {
    let lanes = lanes_for(size);
    for first in 0..lanes {
        match lanes - first {
            1 => solve_upper::<1, K>(size, of, first, x),
            2 => solve_upper::<2, K>(size, of, first, x),
            3 => solve_upper::<3, K>(size, of, first, x),
            4 => solve_upper::<4, K>(size, of, first, x),
            5 => solve_upper::<5, K>(size, of, first, x),
            _ => solve_upper::<0, K>(size, of, first, x),
        }
    }
    for v in 0..lanes {
        for q in 0..K {
            x[q][v] = times(&x[q][v], &of[q].reciprocal[v]);
        }
    }
    for last in (0..lanes).rev() {
        match last + 1 {
            1 => solve_lower::<1, K>(size, of, last, x),
            2 => solve_lower::<2, K>(size, of, last, x),
            3 => solve_lower::<3, K>(size, of, last, x),
            4 => solve_lower::<4, K>(size, of, last, x),
            5 => solve_lower::<5, K>(size, of, last, x),
            _ => solve_lower::<0, K>(size, of, last, x),
        }
    }
}

/// What the entries of lane `first` take from themselves and from the lanes behind it, W in all, known at compile time unless 0.
#[inline(always)]
fn solve_upper<const W: usize, const K: usize>(
    size: usize,
    of: &[Factors<'_>; K],
    first: usize,
    x: &mut [[Lane; MAX_LANES]; K],
) {
    let lanes = lanes_for(size);
    let width = if W > 0 { W } else { lanes - first };
    for offset in 0..LANE {
        let k = first * LANE + offset;
        if k < size {
            for q in 0..K {
                let (x, row) = (&mut x[q][first..][..width], &of[q].rows[k * lanes + first..][..width]);
                let known = x[0][offset];
                subtract_scaled(&mut x[0], known, &times(&row[0], &BEHIND[offset]));
                for v in 1..width {
                    subtract_scaled(&mut x[v], known, &row[v]);
                }
            }
        }
    }
}

/// What the entries of lane `last` take from themselves and from the lanes before it, W in all, known at compile time unless 0.
#[inline(always)]
fn solve_lower<const W: usize, const K: usize>(
    size: usize,
    of: &[Factors<'_>; K],
    last: usize,
    x: &mut [[Lane; MAX_LANES]; K],
) {
    let lanes = lanes_for(size);
    let width = if W > 0 { W } else { last + 1 };
    for offset in (0..LANE).rev() {
        let k = last * LANE + offset;
        if k < size {
            for q in 0..K {
                let (x, row) = (&mut x[q][..width], &of[q].rows[k * lanes..][..width]);
                let known = x[width - 1][offset];
                subtract_scaled(&mut x[width - 1], known, &times(&row[width - 1], &BEFORE[offset]));
                for v in 0..width - 1 {
                    subtract_scaled(&mut x[v], known, &row[v]);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::Determinant;
    use super::*;

    /// A matrix whose pivots are not on its diagonal, a right-hand side and transposed systems, in lanes that are not full.
    #[test]
    fn sides_and_transposed_systems_are_solved() {
        for size in [1, 3, 4, 6, 26] {
            let entry =
                |i: usize, j: usize| ((i * 7 + j * 3) % 11) as f64 - 5.0 + if i + j + 1 == size { 20.0 } else { 0.0 };
            let x = |i: usize| 1.0 - 0.25 * i as f64;
            let (lanes, stride) = (lanes_for(size), panel_lanes(lanes_for(size) + 1));
            let mut panel = vec![[0.0; LANE]; size * stride];
            for (i, row) in panel.chunks_exact_mut(stride).enumerate() {
                (0..size).for_each(|j| row.as_flattened_mut()[j] = entry(i, j));
                row[lanes][1] = (0..size).map(|j| entry(i, j) * x(j)).sum();
            }
            let [mut rows, mut reciprocal, mut solutions] =
                [size * lanes, lanes, size].map(|count| vec![[f64::NAN; LANE]; count]);
            let mut bytes = [(); 2].map(|()| vec![0; size]);
            let [order, exchange] = &mut bytes;
            let (reciprocal, solutions) = (&mut reciprocal[..], &mut solutions[..]);
            factorise(&mut panel, FactorsMut { rows: &mut rows, reciprocal, order, exchange, solutions }).unwrap();
            for (i, solution) in solutions.iter().enumerate() {
                assert!((solution[1] - x(i)).abs() < 1e-12, "{size}");
            }
            let mut side = [[0.0; LANE]; MAX_LANES];
            (0..size).for_each(|j| side.as_flattened_mut()[j] = (0..size).map(|i| x(i) * entry(i, j)).sum());
            let mut sides = [side; 2];
            solve_transposed(size, &[Factors { rows: &rows, reciprocal, order: &bytes[0] }; 2], &mut sides);
            for side in &sides {
                for i in 0..size {
                    assert!((side.as_flattened()[bytes[0][i] as usize] - x(i)).abs() < 1e-12, "{size}");
                }
            }
            let mut det = Determinant::default();
            det.multiply(&reciprocal.as_flattened()[..size], &bytes[1]);
            if size == 3 {
                let [a, b, c] = [0, 1, 2].map(|i| [0, 1, 2].map(|j| entry(i, j)));
                let minor = |j: usize, k: usize| b[j] * c[k] - b[k] * c[j];
                let exact = a[0] * minor(1, 2) - a[1] * minor(0, 2) + a[2] * minor(0, 1);
                assert!((det.sign * det.log_abs.exp() / exact - 1.0).abs() < 1e-12);
            }
        }
    }
}
