//! Whether two hypotheses are distinguishable.
//!
//! The divisions of each embryo e have a log density under either hypothesis, fitted to the other embryos. With the difference d_e of
//! the two, whole embryos are compared, so that divisions of an embryo need not be independent:
//!
//! * \[F.11 difference\] Δ = Σ_e d_e, with the standard error √n s_d and t = Δ/(√n s_d) on n − 1 degrees of freedom.
//!
//! Two hypotheses are distinguishable if p < 0.05 and \|Δ\| ≥ 1: fits of nearly equal predictions may differ by little in each embryo, but
//! surely. The null hypothesis is that both predict new embryos equally well, whether or not
//! they are nested. A needless free number makes predictions worse, so that k needs no further correction. A difference of this size is
//! significant in 80 of 100 tables with n ≥ (t₀.₉₇₅ + t₀.₈)² s_d²/d̄² embryos, t on n − 1 degrees of freedom, and large enough with 1/\|d̄\|; at
//! least as many as were measured are said to be needed. Where all embryos have the same difference, nothing scatters and there is no test.
//!
//! # References
//! Vuong, *Econometrica* 57, 307 (1989), for tests on differences of log densities; Vehtari, Gelman & Gabry, *Stat. Comput.* 27,
//! 1413 (2017), § 5.1, for differences of left-out data.

use furrow_measured::significance::{needed, paired};
use serde::Serialize;

use super::scores::TestedHypothesis;

/// Pairs with a smaller p are distinguishable.
pub const LEVEL: f64 = 0.05;
/// Differences below this are small: the data are less than e times as probable under one hypothesis as under the other.
pub const LEAST: f64 = 1.0;
/// More embryos than this are not counted.
const MOST: u64 = 1_000_000;
/// Differences with a smaller standard deviation are equal: fits do not end more exactly.
const EQUAL: f64 = 1e-6;

/// Two hypotheses beside each other.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Pair {
    /// The first.
    pub a: String,
    /// The second.
    pub b: String,
    /// Log densities of what was left out, of `a` less of `b`: positive if `a` predicts better; `None` if a part of either is not determined.
    pub delta: Option<f64>,
    /// Its standard error; `None` for fewer than two parts.
    pub se: Option<f64>,
    /// Probability of a difference as large if both predict equally well; `None` if all parts differ alike.
    pub p: Option<f64>,
    /// Whether p is below [`LEVEL`] and the difference at least [`LEAST`].
    pub distinguishable: bool,
    /// Units with which a difference of this size is significant in 80 of 100 tables; `None` if the two are distinguishable already, or
    /// more than a million are needed.
    pub needed: Option<u64>,
}

impl Pair {
    /// Two hypotheses by their log densities of the same parts.
    ///
    /// # Examples
    /// ```
    /// use furrow_analysis::hypotheses::Pair;
    /// let pair = Pair::of(("a", &[1.0, 2.0, 4.0]), ("b", &[0.5, 2.5, 2.0]));
    /// // scipy.stats.ttest_1samp([0.5, -0.5, 2.0], 0).pvalue
    /// assert!((pair.delta.unwrap() - 2.0).abs() < 1e-15 && (pair.p.unwrap() - 0.455_668_946_048_182_7).abs() < 1e-12);
    /// assert_eq!((pair.distinguishable, pair.needed), (false, Some(30)));
    /// ```
    pub fn of((a, parts_a): (&str, &[f64]), (b, parts_b): (&str, &[f64])) -> Pair {
        let differences: Vec<f64> = parts_a.iter().zip(parts_b).map(|(a, b)| a - b).collect();
        let (a, b, count) = (a.to_owned(), b.to_owned(), differences.len() as f64);
        let Some(test) = paired(&differences) else {
            let delta = Some(differences.iter().sum());
            return Pair { a, b, delta, se: None, p: None, distinguishable: false, needed: None };
        };
        let p = test.p.filter(|_| test.error > EQUAL * count.sqrt());
        let distinguishable = p.is_some_and(|p| p < LEVEL) && test.sum.abs() >= LEAST;
        let large = (LEAST * count / test.sum.abs()).ceil().max(count);
        let significant =
            p.filter(|_| !distinguishable).and_then(|_| needed(test.sum / test.error / count.sqrt(), MOST));
        let needed = significant.map(|significant| significant.max(large as u64)).filter(|needed| *needed <= MOST);
        Pair { a, b, delta: Some(test.sum), se: Some(test.error), p, distinguishable, needed }
    }
}

/// Each pair of hypotheses.
pub(super) fn pairs(tested: &[TestedHypothesis]) -> Vec<Pair> {
    let parts = |k: usize| tested[k].loo_parts.iter().copied().collect::<Option<Vec<f64>>>();
    let pair = |(a, b): (usize, usize)| {
        let [name_a, name_b] = [a, b].map(|k| tested[k].name.as_str());
        let found = parts(a).zip(parts(b)).map(|(of_a, of_b)| Pair::of((name_a, &of_a), (name_b, &of_b)));
        found.unwrap_or_else(|| Pair { delta: None, ..Pair::of((name_a, &[]), (name_b, &[])) })
    };
    let others = |a: usize| (a + 1..tested.len()).map(move |b| (a, b));
    (0..tested.len()).flat_map(others).map(pair).collect()
}
