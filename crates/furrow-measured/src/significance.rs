//! Probabilities of slopes, of differences of means and of orders.

use std::f64::consts::FRAC_1_SQRT_2;

use serde::Serialize;
use statrs::distribution::{Binomial, ChiSquared, ContinuousCDF, DiscreteCDF, FisherSnedecor, Normal, StudentsT};
use statrs::function::erf::erfc;

use crate::statistics::{Line, line_of, mean, sd};

/// A line with an intercept, and the probability of a slope as far from 0 if y did not depend on x.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Trend {
    /// The line.
    #[serde(flatten)]
    pub line: Line,
    /// Two-sided, by Student's t with n − 2 degrees of freedom; `None` without scatter about the line, and of a [`power`] of two sizes.
    pub p: Option<f64>,
}

/// Volumes within this factor, as of sisters of an equal division, are one size.
const ONE_SIZE: f64 = 1.25;

/// The line of ln y over ln volume; its slope is an exponent. `None` for fewer than three points or constant volumes. A line through two
/// sizes always fits: the error of its slope is then NaN, its p value and its shares of the variation `None`.
pub fn power(points: &[[f64; 2]]) -> Option<Trend> {
    let mut line = line_of(points, [1.0; 2])?;
    let mut volumes: Vec<f64> = points.iter().map(|[ln_volume, _]| *ln_volume).collect();
    volumes.sort_by(f64::total_cmp);
    // The smallest volume of each size: a chain of neighbours is no single size.
    let mut sizes = Vec::new();
    for volume in volumes {
        if sizes.last().is_none_or(|least| volume - least > ONE_SIZE.ln()) {
            sizes.push(volume);
        }
    }
    if sizes.len() < 3 {
        (line.slope_error, line.intercept_error) = (f64::NAN, None);
        (line.r_squared, line.r_squared_about_mean) = (None, None);
    }
    Some(Trend { p: slope_p(&line), line })
}

/// Probability of a slope as far from 0, of either sign, if y did not depend on x; by Student's t. `None` without scatter about the line.
///
/// # Examples
/// ```
/// use furrow_measured::{significance::slope_p, statistics::{line, line_through_origin}};
/// let points = [[1.0, 1.0], [2.0, 3.0], [3.0, 2.0], [4.0, 5.0]];
/// // With two degrees of freedom 1 − t/√(2 + t²).
/// let found = line(&points).unwrap();
/// let t = found.slope / found.slope_error;
/// assert!((slope_p(&found).unwrap() - (1.0 - t / (2.0 + t * t).sqrt())).abs() < 1e-12);
/// // A line through the origin has one more.
/// assert_eq!(line_through_origin(&points).unwrap().degrees_of_freedom(), 3);
/// ```
pub fn slope_p(line: &Line) -> Option<f64> {
    two_sided(line.slope / line.slope_error, line.degrees_of_freedom() as f64)
}

/// Two-sided probability of Student's t with a given number of degrees of freedom; `None` if t is not finite: nothing scatters then.
fn two_sided(t: f64, freedom: f64) -> Option<f64> {
    let t = Some(t.abs()).filter(|t| t.is_finite())?;
    Some((2.0 * StudentsT::new(0.0, 1.0, freedom).ok()?.sf(t)).min(1.0))
}

/// A sample by its number of values, their mean and their standard deviation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// Values.
    pub n: u64,
    /// Mean.
    pub mean: f64,
    /// Standard deviation, by n − 1.
    pub sd: f64,
}

/// Welch's test of whether two means differ: the two-sided p value. None where a sample has fewer than two values, or neither
/// varies.
///
/// # References
/// Welch, *Biometrika* 34, 28 (1947).
pub fn welch(a: Sample, b: Sample) -> Option<f64> {
    if a.n < 2 || b.n < 2 {
        return None;
    }
    let [of_a, of_b] = [a, b].map(|sample| sample.sd.powi(2) / sample.n as f64);
    let both = of_a + of_b;
    let freedom = both.powi(2) / (of_a.powi(2) / (a.n - 1) as f64 + of_b.powi(2) / (b.n - 1) as f64);
    two_sided((a.mean - b.mean) / both.sqrt(), freedom)
}

/// The exact sign test, one-sided: the probability of at least `agree` of `of` if each were a toss of a coin. 1 for `of` = 0.
///
/// # Examples
/// ```
/// // All of four: one in sixteen.
/// assert!((furrow_measured::significance::sign_test(4, 4) - 1.0 / 16.0).abs() < 1e-15);
/// ```
pub fn sign_test(agree: usize, of: usize) -> f64 {
    let below = agree.checked_sub(1).zip(Binomial::new(0.5, of as u64).ok());
    below.map_or(1.0, |(below, tosses)| tosses.sf(below as u64))
}

/// Probability that a standard normal number is as large or larger, to ten digits.
///
/// # Examples
/// ```
/// use furrow_measured::significance::normal_tail;
/// // scipy.stats.norm.sf(1.5)
/// assert!((normal_tail(1.5) - 0.066_807_201_268_858).abs() < 1e-10);
/// ```
pub fn normal_tail(z: f64) -> f64 {
    0.5 * erfc(z * FRAC_1_SQRT_2)
}

/// The standard normal number below which a number lies with probability `p`; not finite for a `p` of 0 or 1.
///
/// # Examples
/// ```
/// use furrow_measured::significance::normal_quantile;
/// // scipy.stats.norm.ppf(0.025)
/// assert!((normal_quantile(0.025) + 1.959_963_984_540_054).abs() < 1e-9);
/// ```
pub fn normal_quantile(p: f64) -> f64 {
    Normal::standard().inverse_cdf(p)
}

/// Probability of a χ² as large or larger; `None` without degrees of freedom.
///
/// # Examples
/// ```
/// use furrow_measured::significance::chi_squared_tail;
/// // With two degrees of freedom e^(−χ²/2).
/// assert!((chi_squared_tail(3.0, 2).unwrap() - (-1.5_f64).exp()).abs() < 1e-14);
/// assert_eq!(chi_squared_tail(0.0, 0), None);
/// ```
pub fn chi_squared_tail(chi_squared: f64, degrees_of_freedom: usize) -> Option<f64> {
    Some(ChiSquared::new(degrees_of_freedom as f64).ok()?.sf(chi_squared)).filter(|p| !p.is_nan())
}

/// Probability of a ratio of variances as large or larger, with the degrees of freedom of its numerator and of its denominator;
/// `None` without them.
///
/// # Examples
/// ```
/// use furrow_measured::significance::f_tail;
/// // With two degrees of freedom in the numerator (1 + 2F/ν)^(−ν/2).
/// assert!((f_tail(3.0, [2, 4]).unwrap() - 2.5_f64.powi(-2)).abs() < 1e-12);
/// assert_eq!(f_tail(3.0, [2, 0]), None);
/// ```
pub fn f_tail(ratio: f64, [above, below]: [usize; 2]) -> Option<f64> {
    let distribution = FisherSnedecor::new(above as f64, below as f64).ok()?;
    Some(distribution.sf(ratio)).filter(|p| !p.is_nan())
}

/// Whether the mean of some values differs from 0.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct PairedTest {
    /// Sum of the values.
    pub sum: f64,
    /// Its standard error, √n times the standard deviation of the values.
    pub error: f64,
    /// Two-sided, by Student's t with n − 1 degrees of freedom; `None` if the values do not scatter.
    pub p: Option<f64>,
}

/// Student's paired test of whether differences have the mean 0; `None` for fewer than two.
///
/// # References
/// Student, *Biometrika* 6, 1 (1908).
pub fn paired(differences: &[f64]) -> Option<PairedTest> {
    let (count, sum) = (differences.len() as f64, mean(differences) * differences.len() as f64);
    let error = sd(differences)? * count.sqrt();
    Some(PairedTest { sum, error, p: two_sided(sum / error, count - 1.0) })
}

/// Sample size at which a t test at the level 0.05 has a power of 80 %, for a given `ratio` of mean to standard deviation: the least
/// n ≥ 2 with (t₀.₉₇₅ + t₀.₈)² ≤ n ratio², on n − 1 degrees of freedom. `None` above `most`.
///
/// # Examples
/// ```
/// use furrow_measured::significance::needed;
/// // math.ceil(statsmodels.stats.power.TTestPower().solve_power(1 / 0.9, alpha=0.05, power=0.8)); normal quantiles give 7.
/// assert_eq!(needed(1.0 / 0.9, 1_000), Some(9));
/// ```
pub fn needed(ratio: f64, most: u64) -> Option<u64> {
    let is_enough = |n: u64| {
        let student = StudentsT::new(0.0, 1.0, (n - 1) as f64).ok();
        student.is_some_and(|t| t.inverse_cdf(0.975) + t.inverse_cdf(0.8) <= (n as f64).sqrt() * ratio.abs())
    };
    let (mut few, mut enough) = (1, Some(most).filter(|most| is_enough(*most))?);
    while enough - few > 1 {
        let middle = few + (enough - few) / 2;
        if is_enough(middle) { enough = middle } else { few = middle }
    }
    Some(enough)
}

/// The interval that holds the mean of what values were drawn from in 95 of 100 samples, by Student's t; `None` for fewer than two
/// values.
///
/// # Examples
/// ```
/// use furrow_measured::significance::mean_interval;
/// // With one degree of freedom t is tan(0.475π) = 12.706.
/// let [low, high] = mean_interval(&[1.0, 3.0]).unwrap();
/// assert!((high - 2.0 - 12.706_204_736).abs() < 1e-8 && (high + low - 4.0).abs() < 1e-12);
/// ```
pub fn mean_interval(values: &[f64]) -> Option<[f64; 2]> {
    let (middle, spread) = (mean(values), sd(values)?);
    let count = values.len() as f64;
    let reach = StudentsT::new(0.0, 1.0, count - 1.0).ok()?.inverse_cdf(0.975) * spread / count.sqrt();
    Some([middle - reach, middle + reach])
}
