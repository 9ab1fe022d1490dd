//! Extreme eigenvalues of a linear map given by its action on vectors.
//!
//! # References
//! Saad, *Numerical Methods for Large Eigenvalue Problems*, SIAM 2011, ch. 6.

use nalgebra::{Complex, DMatrix, Schur};

/// Settings of the Arnoldi iteration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Arnoldi {
    /// Eigenvalues wanted.
    pub wanted: usize,
    /// Largest Krylov dimension.
    pub max_dimension: usize,
    /// Allowed error of an eigenvalue, in the caller's scale.
    pub tolerance: f64,
}

impl Default for Arnoldi {
    fn default() -> Self {
        Arnoldi { wanted: 3, max_dimension: 48, tolerance: 1e-9 }
    }
}

/// Why eigenvalues were not found.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum EigenError {
    /// The small dense problem failed.
    #[error(transparent)]
    Dense(#[from] NoEigenvalues),
    /// Eigenvalues do not reach the requested accuracy.
    #[error("eigenvalues are uncertain by {residual:.1e} in a Krylov space of dimension {dimension}")]
    NotConverged {
        /// Krylov dimension.
        dimension: usize,
        /// Largest residual of the eigenvalues wanted.
        residual: f64,
    },
}

impl Arnoldi {
    /// The eigenvalues of largest modulus of the linear map `apply` (from, to), in the inner product Σ w a b with positive
    /// `weights`; the largest first, complex pairs with both signs. The map may have fewer than wanted.
    ///
    /// # Errors
    /// [`EigenError::NotConverged`] if a residual is above the tolerance in the largest space allowed; an error of `apply`.
    ///
    /// # Examples
    /// ```
    /// use furrow_spectra::{Arnoldi, EigenError, Krylov};
    /// // Eigenvalues 1, 1/2, 1/4, …
    /// let apply = |from: &[f64], to: &mut [f64]| {
    ///     to.iter_mut().zip(from).enumerate().for_each(|(k, (to, from))| *to = 0.5f64.powi(k as i32) * from);
    ///     Ok::<(), EigenError>(())
    /// };
    /// let found = Arnoldi::default().largest(&mut Krylov::default(), &[1.0; 40], apply)?;
    /// for (value, exact) in found.iter().zip([1.0, 0.5, 0.25]) {
    ///     assert!((value.re - exact).abs() < 1e-9 && value.im == 0.0);
    /// }
    /// # Ok::<(), EigenError>(())
    /// ```
    pub fn largest<E: From<NoEigenvalues> + From<EigenError>>(
        &self,
        krylov: &mut Krylov,
        weights: &[f64],
        apply: impl FnMut(&[f64], &mut [f64]) -> Result<(), E>,
    ) -> Result<Vec<RitzValue>, E> {
        let limit = self.max_dimension.min(weights.len());
        let mut worst = f64::INFINITY;
        let found = krylov.run(weights, limit, apply, |values, dimension| {
            let mut values = values.to_vec();
            let modulus = |v: &RitzValue| v.re.hypot(v.im);
            values.sort_by(|a, b| modulus(b).total_cmp(&modulus(a)).then(b.im.total_cmp(&a.im)));
            values.truncate(self.wanted);
            worst = values.iter().map(|v| v.residual).fold(0.0, f64::max);
            (worst <= self.tolerance && (values.len() == self.wanted || dimension == limit)).then_some(values)
        })?;
        found.ok_or_else(|| EigenError::NotConverged { dimension: limit, residual: worst }.into())
    }
}

/// An eigenvalue of the map on the Krylov space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RitzValue {
    /// Real part.
    pub re: f64,
    /// Imaginary part; complex pairs appear with both signs.
    pub im: f64,
    /// Norm of the residual of its Ritz vector of length 1.
    pub residual: f64,
}

/// The eigenvalues of the projected matrix could not be computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the projected matrix of dimension {dimension} has no computable eigenvalues")]
pub struct NoEigenvalues {
    /// Krylov dimension.
    pub dimension: usize,
}

/// Reusable workspace of the iteration. [`Arnoldi::largest`] is the simple way to run it.
#[derive(Clone, Debug, Default)]
pub struct Krylov {
    basis: Vec<Vec<f64>>,
    hessenberg: Vec<f64>,
    /// Schur vectors of the last projected matrix, by columns.
    schur: DMatrix<f64>,
    /// Coefficients of the last Ritz vectors in the Schur vectors.
    vectors: Vec<Vec<Complex<f64>>>,
    /// Where the next run starts; anywhere if empty.
    start: Vec<f64>,
}

/// Krylov dimension at which Ritz values are first computed, and the increment to the next.
const LOOKS: [usize; 2] = [10, 4];
/// The same where the start is near the vectors sought.
const NEAR_LOOKS: [usize; 2] = [5, 2];

/// Share of the usual start in one near known vectors: other modes have a part in it too.
const ELSEWHERE: f64 = 1e-3;

impl Krylov {
    /// Iterates `apply` (from, to) in the inner product Σ w a b until `enough` returns a result; `None` if it never does. It gets
    /// the Ritz values at some dimensions and at the last, the `limit` or the dimension of an invariant subspace.
    ///
    /// # Errors
    /// [`NoEigenvalues`] if the eigenvalues of the projected matrix cannot be computed; an error of `apply`.
    ///
    /// # Examples
    /// The largest real eigenvalue of a rotation combined with a decay by 0.9, to 1e-10:
    ///
    /// ```
    /// use furrow_spectra::{Krylov, NoEigenvalues};
    /// let apply = |from: &[f64], to: &mut [f64]| Ok::<(), NoEigenvalues>(to.copy_from_slice(&[-from[1], from[0], 0.9 * from[2]]));
    /// let found = Krylov::default().run(&[1.0; 3], 3, apply, |values, _| {
    ///     values.iter().find(|v| v.im == 0.0 && v.residual < 1e-10).map(|v| v.re)
    /// })?;
    /// assert!((found.unwrap() - 0.9).abs() < 1e-12);
    /// # Ok::<(), NoEigenvalues>(())
    /// ```
    pub fn run<T, E: From<NoEigenvalues>>(
        &mut self,
        weights: &[f64],
        limit: usize,
        mut apply: impl FnMut(&[f64], &mut [f64]) -> Result<(), E>,
        mut enough: impl FnMut(&[RitzValue], usize) -> Option<T>,
    ) -> Result<Option<T>, E> {
        let points = weights.len();
        let stride = limit + 1;
        self.basis.resize(self.basis.len().max(stride), Vec::new());
        self.basis.iter_mut().for_each(|v| v.resize(points, 0.0));
        self.hessenberg.clear();
        self.hessenberg.resize(stride * stride, 0.0);
        let looks = self.set_start(weights);
        for k in 0..limit {
            let (known, new) = self.basis.split_at_mut(k + 1);
            let new = &mut new[0];
            apply(&known[k], new)?;
            let before = weighted_dot(weights, new, new).sqrt();
            // Twice is enough (Kahan).
            for _ in 0..2 {
                for (j, v) in known.iter().enumerate() {
                    let dot = weighted_dot(weights, v, new);
                    self.hessenberg[j * stride + k] += dot;
                    new.iter_mut().zip(v).for_each(|(a, b)| *a -= dot * b);
                }
            }
            let rest = weighted_dot(weights, new, new).sqrt();
            self.hessenberg[(k + 1) * stride + k] = rest;
            // An invariant subspace: all its Ritz values are exact.
            let exhausted = rest <= 1e-14 * before;
            if !exhausted {
                new.iter_mut().for_each(|w| *w /= rest);
            }
            let dimension = k + 1;
            let last = exhausted || dimension == limit;
            if last || (dimension >= looks[0] && (dimension - looks[0]).is_multiple_of(looks[1])) {
                let values = self.ritz(dimension, stride, if exhausted { 0.0 } else { rest })?;
                let found = enough(&values, if last { limit } else { dimension });
                if last || found.is_some() {
                    return Ok(found);
                }
            }
        }
        Ok(None)
    }

    /// Lets the next run, and only that, start near Ritz vectors of the last one, which are named by their places among its values. It
    /// then needs fewer dimensions if its map is nearly the same. A run over vectors of another length starts as usual.
    pub fn start_near(&mut self, which: &[usize]) {
        self.start.clear();
        self.start.resize(self.basis.first().map_or(0, Vec::len), 0.0);
        for vector in which.iter().filter_map(|&place| self.vectors.get(place)) {
            let norm = squared(vector).sqrt();
            for (row, v) in self.basis.iter().enumerate().take(self.schur.nrows()) {
                // Of complex vectors the real part.
                let coefficient = entry(&self.schur, vector, row).re / norm;
                self.start.iter_mut().zip(v).for_each(|(to, v)| *to += coefficient * v);
            }
        }
    }

    /// The first vector of the basis, of length 1; returns at which dimensions Ritz values are computed.
    fn set_start(&mut self, weights: &[f64]) -> [usize; 2] {
        let (near, first) = (std::mem::take(&mut self.start), &mut self.basis[0]);
        // The start vector needs a part in every smooth mode, and must be the same in every run.
        let mut seed = 0x9e37_79b9_7f4a_7c15u64;
        for w in first.iter_mut() {
            seed = seed.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            *w = (seed >> 11) as f64 / (1u64 << 52) as f64 - 1.0;
        }
        let length = |v: &[f64]| weighted_dot(weights, v, v).sqrt();
        let near = Some(near).filter(|near| near.len() == weights.len() && length(near) > 0.0);
        if let Some(near) = &near {
            let share = ELSEWHERE * length(near) / length(first);
            first.iter_mut().zip(near).for_each(|(w, near)| *w = near + share * *w);
        }
        let norm = length(first);
        first.iter_mut().for_each(|w| *w /= norm);
        if near.is_some() { NEAR_LOOKS } else { LOOKS }
    }

    /// The Ritz values of the first k vectors; `rest` is the length of the next one before normalisation. Their vectors are kept.
    fn ritz(&mut self, k: usize, stride: usize, rest: f64) -> Result<Vec<RitzValue>, NoEigenvalues> {
        let failed = NoEigenvalues { dimension: k };
        let projected = DMatrix::<f64>::from_fn(k, k, |i, j| self.hessenberg[i * stride + j]);
        if projected.iter().any(|entry| !entry.is_finite()) {
            return Err(failed);
        }
        let (q, t) = Schur::try_new(projected, f64::EPSILON, MOST_ITERATIONS * k).ok_or(failed)?.unpack();
        let mut out = Vec::with_capacity(k);
        self.vectors.clear();
        self.schur = q;
        let mut end = 0;
        while end < k {
            end += width_from(&t, end);
            let (value, vector) = eigenpair(&t, end);
            let norm = squared(&vector);
            if !(value.re.is_finite() && value.im.is_finite() && norm.is_finite()) {
                return Err(failed);
            }
            let residual = rest * (entry(&self.schur, &vector, k - 1).norm_sqr() / norm).sqrt();
            let signs: &[f64] = if value.im == 0.0 { &[1.0] } else { &[1.0, -1.0] };
            for sign in signs {
                out.push(RitzValue { re: value.re, im: sign * value.im, residual });
                self.vectors.push(vector.clone());
            }
        }
        Ok(out)
    }
}

/// Σ |x|².
fn squared(vector: &[Complex<f64>]) -> f64 {
    vector.iter().map(Complex::norm_sqr).sum()
}

/// An entry of a Ritz vector, from its coefficients in the Schur vectors q.
fn entry(q: &DMatrix<f64>, vector: &[Complex<f64>], row: usize) -> Complex<f64> {
    vector.iter().enumerate().map(|(c, x)| x * q[(row, c)]).sum()
}

/// Most iterations for one eigenvalue of a projected matrix.
const MOST_ITERATIONS: usize = 60;

/// Size of the diagonal block of a real Schur form T that begins at `i`: 2 if it holds a complex pair.
fn width_from(t: &DMatrix<f64>, i: usize) -> usize {
    1 + usize::from(i + 1 < t.nrows() && t[(i + 1, i)] != 0.0)
}

/// The eigenvalue of the diagonal block of a real Schur form T that ends before `end`, with Im λ ≥ 0, and its eigenvector without the
/// zeros from `end` on: (T − λ) x = 0, solved upwards block by block.
fn eigenpair(t: &DMatrix<f64>, end: usize) -> (Complex<f64>, Vec<Complex<f64>>) {
    let real = |value: f64| Complex::new(value, 0.0);
    let last = end - 1;
    let mut x = vec![real(0.0); end];
    let mut row = last;
    let value = if last > 0 && t[(last, last - 1)] != 0.0 {
        row = last - 1;
        let (half, mean) = (0.5 * (t[(row, row)] - t[(last, last)]), 0.5 * (t[(row, row)] + t[(last, last)]));
        let value = Complex::new(mean, (-(half * half + t[(row, last)] * t[(last, row)])).max(0.0).sqrt());
        (x[row], x[last]) = (real(t[(row, last)]), value - t[(row, row)]);
        value
    } else {
        x[last] = real(1.0);
        real(t[(last, last)])
    };
    // Equal eigenvalues are taken to be this far apart.
    let least = f64::EPSILON * t.amax().max(f64::MIN_POSITIVE);
    let away = |d: Complex<f64>, least: f64| if d.norm_sqr() < least * least { real(least) } else { d };
    while row > 0 {
        let below = row;
        let rest = |i: usize, x: &[Complex<f64>]| -(below..end).map(|c| x[c] * t[(i, c)]).sum::<Complex<f64>>();
        if row > 1 && t[(row - 1, row - 2)] != 0.0 {
            row -= 2;
            let (b, c) = (t[(row, row + 1)], t[(row + 1, row)]);
            let (a, d) = (t[(row, row)] - value, t[(row + 1, row + 1)] - value);
            let (first, second) = (rest(row, &x), rest(row + 1, &x));
            let determinant = away(a * d - b * c, least * least.sqrt());
            (x[row], x[row + 1]) = ((first * d - second * b) / determinant, (a * second - first * c) / determinant);
        } else {
            row -= 1;
            x[row] = rest(row, &x) / away(t[(row, row)] - value, least);
        }
    }
    (value, x)
}

/// Σ w a b, in four partial sums, which do not wait for each other.
fn weighted_dot(weights: &[f64], a: &[f64], b: &[f64]) -> f64 {
    let mut sums = [0.0; 4];
    let ((w, w_rest), (a, a_rest), (b, b_rest)) = (weights.as_chunks::<4>(), a.as_chunks::<4>(), b.as_chunks::<4>());
    for ((w, a), b) in w.iter().zip(a).zip(b) {
        for (t, sum) in sums.iter_mut().enumerate() {
            *sum += w[t] * a[t] * b[t];
        }
    }
    let rest: f64 = w_rest.iter().zip(a_rest).zip(b_rest).map(|((w, a), b)| w * a * b).sum();
    (sums[0] + sums[2]) + (sums[1] + sums[3]) + rest
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A rotation block and decaying modes have a known complex pair and known real eigenvalues.
    #[test]
    fn finds_real_and_complex_eigenvalues() {
        let size = 60;
        let apply = |from: &[f64], to: &mut [f64]| {
            (to[0], to[1]) = (0.9 * from[0] - 0.4 * from[1], 0.4 * from[0] + 0.9 * from[1]);
            for k in 2..size {
                to[k] = 0.7 / (k * k) as f64 * from[k];
            }
            Ok::<(), NoEigenvalues>(())
        };
        let found = Krylov::default()
            .run(&vec![0.5; size], 40, apply, |values, _| {
                let mut values = values.to_vec();
                values.sort_by(|a, b| b.re.total_cmp(&a.re).then(b.im.total_cmp(&a.im)));
                (values.iter().take(3).all(|v| v.residual < 1e-11)).then_some(values)
            })
            .unwrap()
            .unwrap();
        for (value, [re, im]) in found.iter().zip([[0.9, 0.4], [0.9, -0.4], [0.175, 0.0], [0.7 / 9.0, 0.0]]) {
            assert!((value.re - re).hypot(value.im - im) < 1e-10, "{value:?}");
        }
    }

    #[test]
    fn an_invariant_subspace_ends_the_iteration() {
        let mut applied = 0;
        let apply = |from: &[f64], to: &mut [f64]| {
            applied += 1;
            to.copy_from_slice(from);
            Ok::<(), NoEigenvalues>(())
        };
        let values = Krylov::default().run(&[1.0; 8], 6, apply, |values, _| Some(values.to_vec())).unwrap().unwrap();
        assert_eq!((applied, values.len()), (1, 1));
        assert!((values[0].re - 1.0).abs() < 1e-14);
    }
}
