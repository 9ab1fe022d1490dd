//! Floquet multipliers of a periodic orbit, and the bifurcations that they show.
//!
//! # References
//! Kuznetsov, *Elements of Applied Bifurcation Theory*, 3rd ed., Springer 2004, ch. 5.

pub use nalgebra::Complex;
use nalgebra::DMatrix;

/// The Floquet multipliers of a periodic orbit but for the trivial one.
#[derive(Clone, Debug, PartialEq)]
pub struct Multipliers {
    /// The multiplier next to 1, which belongs to a shift in time: its distance from 1 shows the error of the others.
    pub trivial: Complex<f64>,
    /// The others, from large to small modulus; complex pairs appear with both signs.
    pub others: Vec<Complex<f64>>,
}

/// The matrix is no monodromy matrix, which is square and has finite entries.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("no multipliers of {entries} entries: a monodromy matrix is square and finite")]
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

impl CycleBifurcation {
    /// All of them.
    pub const ALL: [CycleBifurcation; 3] =
        [CycleBifurcation::Fold, CycleBifurcation::PeriodDoubling, CycleBifurcation::Torus];

    /// A function of the multipliers μ that changes its sign at the bifurcation: Π(μ − 1), Π(μ + 1) or Π(μ_i μ_j − 1) over pairs. The
    /// last vanishes for two real multipliers μ and 1/μ too, which is no bifurcation.
    pub fn test(self, of: &Multipliers) -> f64 {
        let all = &of.others;
        let product = match self {
            CycleBifurcation::Fold => all.iter().map(|m| m - 1.0).product::<Complex<f64>>(),
            CycleBifurcation::PeriodDoubling => all.iter().map(|m| m + 1.0).product(),
            CycleBifurcation::Torus => {
                let pairs = all.iter().enumerate().flat_map(|(i, a)| all[i + 1..].iter().map(move |b| a * b - 1.0));
                pairs.product()
            }
        };
        product.re
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
        let mut others: Vec<Complex<f64>> =
            DMatrix::from_row_slice(n, n, monodromy).complex_eigenvalues().iter().copied().collect();
        others.sort_by(|a, b| b.norm_sqr().total_cmp(&a.norm_sqr()).then(a.im.total_cmp(&b.im)));
        let distance = |k: &usize| (others[*k] - 1.0).norm_sqr();
        let nearest = (0..n).min_by(|a, b| distance(a).total_cmp(&distance(b))).ok_or(refused)?;
        Ok(Multipliers { trivial: others.remove(nearest), others })
    }

    /// Whether disturbances decay.
    pub fn is_stable(&self) -> bool {
        self.others.iter().all(|m| m.norm_sqr() < 1.0)
    }
}
