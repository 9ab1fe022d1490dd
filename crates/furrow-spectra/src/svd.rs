//! Singular values of a small dense matrix, such as the sensitivities of many points to many parameters: which combinations
//! of parameters the points determine, and which they leave open.
//!
//! # References
//! Golub & Van Loan, *Matrix Computations*, 4th ed., Johns Hopkins 2013, § 2.4.

use nalgebra::DMatrix;

/// A = Σ σ u vᵀ, singular values σ from large to small.
#[derive(Clone, Debug, PartialEq)]
pub struct Svd {
    /// σ, as many as the smaller side of the matrix.
    pub values: Vec<f64>,
    /// Left vectors u, one per value; of no meaning where σ = 0.
    pub left: Vec<Vec<f64>>,
    /// Right vectors v, one per column of the matrix; those beyond the values span its kernel.
    pub right: Vec<Vec<f64>>,
}

/// The matrix has entries that are not finite or too large.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the matrix contains NaN or infinity")]
pub struct NoSingularValues;

/// Most iterations for a row.
const MOST_ITERATIONS: usize = 100;

impl Svd {
    /// Decomposes the matrix with these rows, all of the same length. A matrix without entries has no singular values.
    ///
    /// # Errors
    /// [`NoSingularValues`].
    ///
    /// # Examples
    /// ```
    /// use furrow_spectra::Svd;
    /// // Two points that depend only on the sum of two parameters.
    /// let svd = Svd::of_rows(&[vec![3.0, 3.0], vec![4.0, 4.0]])?;
    /// assert!((svd.values[0] - 50.0f64.sqrt()).abs() < 1e-14 && svd.values[1] < 1e-14);
    /// let open = &svd.right[1];
    /// assert!((open[0] + open[1]).abs() < 1e-14);
    /// assert!(Svd::of_rows(&[])?.values.is_empty());
    /// # Ok::<(), furrow_spectra::NoSingularValues>(())
    /// ```
    pub fn of_rows(rows: &[Vec<f64>]) -> Result<Svd, NoSingularValues> {
        let columns = rows.first().map_or(0, Vec::len);
        if rows.iter().flatten().any(|x| !x.is_finite()) {
            return Err(NoSingularValues);
        }
        if columns == 0 {
            return Ok(Svd { values: Vec::new(), left: Vec::new(), right: Vec::new() });
        }
        // Rows of zeros make it at least square, so that all right vectors are computed.
        let (count, height) = (rows.len().min(columns), rows.len().max(columns));
        let filled = DMatrix::from_fn(height, columns, |i, j| rows.get(i).map_or(0.0, |row| row[j]));
        let svd = filled.try_svd(true, true, f64::EPSILON, MOST_ITERATIONS * height).ok_or(NoSingularValues)?;
        let (Some(u), Some(v)) = (svd.u, svd.v_t) else { return Err(NoSingularValues) };
        let values: Vec<f64> = svd.singular_values.iter().take(count).copied().collect();
        if values.iter().any(|value| !value.is_finite()) {
            return Err(NoSingularValues);
        }
        Ok(Svd {
            values,
            left: (0..count).map(|k| (0..rows.len()).map(|i| u[(i, k)]).collect()).collect(),
            right: (0..columns).map(|k| v.row(k).iter().copied().collect()).collect(),
        })
    }
}
