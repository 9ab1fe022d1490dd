//! Floquet multipliers of a periodic orbit, and the bifurcations that they show.
//!
//! A product of many transition matrices keeps only the largest multipliers where disturbances grow by many orders of magnitude on
//! the way. Orthogonal eliminations of the relations Aᵢ yᵢ = Bᵢ y₀ from interval to interval keep more of them (Fairgrieve & Jepson).
//!
//! # References
//! Kuznetsov, *Elements of Applied Bifurcation Theory*, 3rd ed., Springer 2004, ch. 5. Fairgrieve & Jepson, SIAM J. Numer. Anal. 28,
//! 1446 (1991).

pub use nalgebra::Complex;
use nalgebra::{DMatrix, DVector, Schur};

/// The Floquet multipliers of a periodic orbit but for the trivial one.
#[derive(Clone, Debug, PartialEq)]
pub struct Multipliers {
    /// The multiplier next to 1, which belongs to a shift in time. Far from 1 it shows that the others are inaccurate as well; next to 1 it
    /// shows nothing of them where disturbances grow by many orders of magnitude on the way.
    pub trivial: Complex<f64>,
    /// The others, from large to small modulus; complex pairs appear with both signs.
    pub others: Vec<Complex<f64>>,
}

/// The matrix is no monodromy matrix, which is square and has finite entries, or matrices are no transitions of equal size, or the
/// iteration for their eigenvalues does not converge.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "no multipliers of {entries} entries: monodromy and transition matrices are square, of one size and finite, \
    with eigenvalues that QR iterations find"
)]
pub struct NoMultipliers {
    /// Entries of the matrix.
    pub entries: usize,
}

/// How a periodic orbit changes its stability.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CycleBifurcation {
    /// A multiplier passes 1: orbits end, or branch.
    Fold,
    /// A multiplier passes −1: orbits of twice the period branch.
    PeriodDoubling,
    /// A pair of multipliers passes the unit circle: a torus branches.
    Torus,
}

/// Shifts for the multipliers of a pair of matrices: off the unit circle, where the accuracy counts.
const SHIFTS: [f64; 4] = [-0.37, 2.7, 0.41, -2.3];

/// 1/|μ − σ| of multipliers that are as good as infinite.
const SMALLEST: f64 = 1e-100;

/// Most QR iterations for the eigenvalues of a matrix, for every row.
const ITERATIONS: usize = 60;

/// Entries that count as 0 in QR iterations, in rounding errors: next to many equal eigenvalues some never become smaller.
const ZEROS: [f64; 3] = [1.0, 1e2, 1e4];

/// The eigenvalues of a square matrix; `None` if QR iterations do not converge.
pub(crate) fn eigenvalues(matrix: &DMatrix<f64>) -> Option<DVector<Complex<f64>>> {
    let most = ITERATIONS * matrix.nrows();
    let schur = |zero: &f64| Schur::try_new(matrix.clone(), zero * f64::EPSILON, most);
    ZEROS.iter().find_map(schur).map(|schur| schur.complex_eigenvalues())
}

impl CycleBifurcation {
    /// All of them.
    pub const ALL: [CycleBifurcation; 3] =
        [CycleBifurcation::Fold, CycleBifurcation::PeriodDoubling, CycleBifurcation::Torus];

    /// A function of the multipliers μ that changes its sign at the bifurcation: Π(μ − 1), Π(μ + 1) or Π(μ_i μ_j − 1) over pairs. The
    /// last vanishes for two real multipliers μ and 1/μ too, which is no bifurcation.
    pub fn test(self, of: &Multipliers) -> f64 {
        self.factors(of).map(|[factor, _]| factor).product::<Complex<f64>>().re
    }

    /// The same, with every factor divided by its largest possible size 1 + |μ| or 1 + |μ_i μ_j|: large and small multipliers, which
    /// change by orders of magnitude from orbit to orbit, count no more than others.
    pub fn scaled_test(self, of: &Multipliers) -> f64 {
        self.factors(of).map(|[factor, plain]| factor / (1.0 + plain.norm_sqr().sqrt())).product::<Complex<f64>>().re
    }

    /// Pairs of a factor of the test and its μ or μ_i μ_j.
    fn factors(self, of: &Multipliers) -> impl Iterator<Item = [Complex<f64>; 2]> {
        let all = &of.others;
        let (plain, off): (Vec<Complex<f64>>, f64) = match self {
            CycleBifurcation::Fold => (all.clone(), -1.0),
            CycleBifurcation::PeriodDoubling => (all.clone(), 1.0),
            CycleBifurcation::Torus => {
                let pairs = all.iter().enumerate().flat_map(|(i, a)| all[i + 1..].iter().map(move |b| a * b));
                (pairs.collect(), -1.0)
            }
        };
        plain.into_iter().map(move |plain| [plain + off, plain])
    }
}

impl Multipliers {
    /// Of a monodromy matrix, n × n, row-major.
    ///
    /// # Errors
    /// [`NoMultipliers`].
    ///
    /// # Examples
    /// ```
    /// use furrow_spectra::floquet::{CycleBifurcation, Multipliers};
    /// let found = Multipliers::of(&[1.0, 0.3, 0.0, -0.5])?;
    /// assert_eq!((found.trivial.re, found.others[0].re), (1.0, -0.5));
    /// assert!(found.is_stable() && CycleBifurcation::PeriodDoubling.test(&found) == 0.5);
    /// # Ok::<(), furrow_spectra::floquet::NoMultipliers>(())
    /// ```
    pub fn of(monodromy: &[f64]) -> Result<Multipliers, NoMultipliers> {
        let refused = NoMultipliers { entries: monodromy.len() };
        let n = monodromy.len().isqrt();
        if n == 0 || n * n != monodromy.len() || monodromy.iter().any(|x| !x.is_finite()) {
            return Err(refused);
        }
        let all = eigenvalues(&DMatrix::from_row_slice(n, n, monodromy)).ok_or(refused)?;
        Multipliers::sorted(all.iter().copied()).ok_or(refused)
    }

    /// Of the transitions over the intervals of an orbit from the first to the last, each n × n, row-major. Multipliers of very
    /// different sizes are found side by side. Their errors are rounding errors times the growth of disturbances along the orbit, and may
    /// be larger than the multipliers next to a homoclinic orbit. Multipliers are at most 1e100.
    ///
    /// # Errors
    /// [`NoMultipliers`].
    ///
    /// # Examples
    /// Multipliers 1 and 1/2:
    ///
    /// ```
    /// use furrow_spectra::floquet::Multipliers;
    /// let found = Multipliers::of_transitions(&[vec![1e6, 0.0, 0.0, 1.0], vec![1e-6, 0.0, 0.0, 0.5]])?;
    /// assert!((found.trivial.re - 1.0).abs() < 1e-9 && (found.others[0].re - 0.5).abs() < 1e-15);
    /// # Ok::<(), furrow_spectra::floquet::NoMultipliers>(())
    /// ```
    pub fn of_transitions(transitions: &[Vec<f64>]) -> Result<Multipliers, NoMultipliers> {
        let entries = transitions.iter().map(Vec::len).sum();
        let refused = NoMultipliers { entries };
        let n = transitions.first().map_or(0, Vec::len).isqrt();
        let is_transition = |t: &Vec<f64>| n > 0 && t.len() == n * n && t.iter().all(|x| x.is_finite());
        if transitions.is_empty() || !transitions.iter().all(is_transition) {
            return Err(refused);
        }
        // A y = B y₀ at the node reached, and the pair of the next node from −G y + y′ = 0.
        let (mut a, mut b) = (DMatrix::<f64>::identity(n, n), DMatrix::<f64>::identity(n, n));
        for transition in transitions {
            let mut stacked = DMatrix::zeros(2 * n, n);
            stacked.rows_mut(0, n).copy_from(&a);
            stacked.rows_mut(n, n).copy_from(&-DMatrix::from_row_slice(n, n, transition));
            let mut sides = DMatrix::zeros(2 * n, 2 * n);
            sides.view_mut((0, 0), (n, n)).copy_from(&b);
            sides.view_mut((n, n), (n, n)).fill_with_identity();
            stacked.qr().q_tr_mul(&mut sides);
            a.copy_from(&sides.view((n, n), (n, n)));
            b.copy_from(&sides.view((n, 0), (n, n)));
        }
        Multipliers::of_pair(&a, &b).ok_or(refused)
    }

    /// The roots μ of det(μA − B), as 1/(μ − σ) with the one of a few shifts σ that leaves them smallest.
    fn of_pair(a: &DMatrix<f64>, b: &DMatrix<f64>) -> Option<Multipliers> {
        let shifted = SHIFTS.iter().filter_map(|shift| Some((*shift, (b - *shift * a).lu().solve(a)?)));
        let (shift, inverse) = shifted.min_by(|(_, one), (_, other)| one.norm().total_cmp(&other.norm()))?;
        if inverse.iter().any(|x| !x.is_finite()) {
            return None;
        }
        let value = |w: &Complex<f64>| {
            if w.norm_sqr() < SMALLEST * SMALLEST { Complex::new(SMALLEST.recip(), 0.0) } else { w.inv() + shift }
        };
        Multipliers::sorted(eigenvalues(&inverse)?.iter().map(value))
    }

    /// Of all multipliers, in any order.
    fn sorted(all: impl Iterator<Item = Complex<f64>>) -> Option<Multipliers> {
        let mut others: Vec<Complex<f64>> = all.collect();
        others.sort_by(|a, b| b.norm_sqr().total_cmp(&a.norm_sqr()).then(a.im.total_cmp(&b.im)));
        let distance = |k: &usize| (others[*k] - 1.0).norm_sqr();
        let nearest = (0..others.len()).min_by(|a, b| distance(a).total_cmp(&distance(b)))?;
        Some(Multipliers { trivial: others.remove(nearest), others })
    }

    /// Whether disturbances decay.
    pub fn is_stable(&self) -> bool {
        self.others.iter().all(|m| m.norm_sqr() < 1.0)
    }
}
