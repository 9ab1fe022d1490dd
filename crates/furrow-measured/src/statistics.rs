//! Means, boxes, rank sums, rank correlations and straight lines.
//!
//! # References
//! Mann & Whitney, *Ann. Math. Stat.* 18, 50 (1947); Wilcoxon, *Biometrics Bull.* 1, 80 (1945).

use std::collections::{BTreeMap, HashMap};
use std::hash::Hash;

use ordered_float::OrderedFloat;
use serde::Serialize;
use statrs::distribution::{ContinuousCDF, Normal, StudentsT};

/// Items by their keys, in the order in which these appear.
pub fn grouped<K: Clone + Eq + Hash, T>(items: impl IntoIterator<Item = (K, T)>) -> Vec<(K, Vec<T>)> {
    let (mut groups, mut places) = (Vec::<(K, Vec<T>)>::new(), HashMap::new());
    for (key, item) in items {
        let place = *places.entry(key.clone()).or_insert(groups.len());
        match groups.get_mut(place) {
            Some((_, group)) => group.push(item),
            None => groups.push((key, vec![item])),
        }
    }
    groups
}

/// Each different item once, in the order in which these appear.
pub fn distinct<T: PartialEq>(items: impl IntoIterator<Item = T>) -> Vec<T> {
    let mut found = Vec::new();
    for item in items {
        if !found.contains(&item) {
            found.push(item);
        }
    }
    found
}

/// Mean of the values; NaN without values.
pub fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// Fewest values for which a standard deviation is quoted. Another value of the same kind is twenty standard deviations off in one
/// case of 26 if they are of two values, and in one of 300 if they are of three.
pub const SPREAD_FROM: usize = 3;

/// Equal values that were computed differ by less than this share of their size.
const ROUNDING: f64 = 1e-12;

/// Whether values differ by rounding alone, where a value is at least as large as `size`.
fn is_constant(values: &[f64], size: f64) -> bool {
    let [least, most] = [f64::min, f64::max].map(|pick| values.iter().copied().reduce(pick).unwrap_or_default());
    most - least <= ROUNDING * size.max(most.abs()).max(least.abs())
}

/// Whether sorted neighbours differ by rounding alone, beside the largest of all values.
fn same_within(values: &[f64]) -> impl Fn(f64, f64) -> bool + use<> {
    let most = values.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
    move |a, b| (a - b).abs() <= ROUNDING * most
}

/// Sum of the squares of values about their mean; 0 if they differ by rounding alone.
pub fn squares_about_mean(values: &[f64]) -> f64 {
    let mean = mean(values);
    if is_constant(values, 0.0) { 0.0 } else { values.iter().map(|x| (x - mean).powi(2)).sum() }
}

/// Standard deviation of a sample, by n − 1; `None` for fewer than two values.
pub fn sd(values: &[f64]) -> Option<f64> {
    (values.len() > 1).then(|| (squares_about_mean(values) / (values.len() - 1) as f64).sqrt())
}

/// A box with whiskers.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BoxPlot {
    /// Median and the quartiles about it, linear between values.
    pub quartiles: [f64; 3],
    /// The outermost values within three times the interquartile range of the box.
    pub whiskers: [f64; 2],
    /// Values beyond.
    pub outliers: Vec<f64>,
}

/// The box of the values; `None` without values.
pub fn box_plot(values: &[f64]) -> Option<BoxPlot> {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    if sorted.is_empty() {
        return None;
    }
    let quartiles = [0.25, 0.5, 0.75].map(|share| quantile(&sorted, share));
    let reach = 3.0 * (quartiles[2] - quartiles[0]);
    let inside = |x: &&f64| (quartiles[0] - reach..=quartiles[2] + reach).contains(*x);
    let first = sorted.iter().find(inside).copied()?;
    let whiskers = [first, sorted.iter().rev().find(inside).copied()?];
    let outliers = sorted.iter().filter(|x| !inside(x)).copied().collect();
    Some(BoxPlot { quartiles, whiskers, outliers })
}

/// The value below which a share of sorted values lies, linear between them; NaN without values.
fn quantile(sorted: &[f64], share: f64) -> f64 {
    let Some(last) = sorted.len().checked_sub(1) else { return f64::NAN };
    let place = share * last as f64;
    let below = place.floor() as usize;
    sorted[below] + (place - below as f64) * (sorted[(below + 1).min(last)] - sorted[below])
}

/// The median; NaN without values.
pub fn median(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    quantile(&sorted, 0.5)
}

/// How a p value was found.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Method {
    /// By counting all arrangements.
    Exact,
    /// By a distribution that many values approach: the normal one, with ties and continuity corrected for, or Student's t.
    Asymptotic,
}

/// Which of two values is the smaller; `None` if they are equal up to rounding.
pub fn smaller([a, b]: [f64; 2]) -> Option<usize> {
    if same_within(&[a, b])(a, b) { None } else { Some(usize::from(b < a)) }
}

/// A rank-sum test of whether values of one sample tend to be larger than values of another.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct RankSum {
    /// Mann and Whitney's U of the first sample: pairs in which its value is the larger, ties counted half.
    pub u: f64,
    /// Probability of a U as large if both samples were drawn alike.
    pub p: f64,
    /// How it was found.
    pub method: Method,
}

/// Without ties, the test is exact if the smaller sample has at most this number of values.
const EXACT_UP_TO: usize = 8;

/// Wilcoxon's rank-sum test, one-sided: whether values of `a` tend to be larger than those of `b`. Exact where one sample has at
/// most eight values and there are no ties, else asymptotic. `None` if either is empty.
///
/// # Examples
/// ```
/// use furrow_measured::statistics::rank_sum;
/// let test = rank_sum(&[0.41, 0.32, 0.39], &[0.17, 0.18, 0.12, 0.20]).unwrap();
/// // All twelve pairs, which one arrangement of 35 has.
/// assert_eq!((test.u, test.p), (12.0, 1.0 / 35.0));
/// ```
pub fn rank_sum(a: &[f64], b: &[f64]) -> Option<RankSum> {
    let (n_a, n_b) = (a.len(), b.len());
    if n_a == 0 || n_b == 0 {
        return None;
    }
    let mut all: Vec<(f64, bool)> = a.iter().map(|x| (*x, true)).chain(b.iter().map(|x| (*x, false))).collect();
    all.sort_by_cached_key(|item| OrderedFloat(item.0));
    let (mut ranks_of_a, mut ties, mut tied) = (0.0, 0.0, false);
    let mut rank = 0.0;
    let same = same_within(&all.iter().map(|item| item.0).collect::<Vec<_>>());
    for equal in all.chunk_by(|x, y| same(x.0, y.0)) {
        let count = equal.len() as f64;
        // Equal values share the mean of their ranks.
        ranks_of_a += equal.iter().filter(|(_, of_a)| *of_a).count() as f64 * (rank + 0.5 * (count + 1.0));
        rank += count;
        ties += count.powi(3) - count;
        tied |= equal.len() > 1;
    }
    let u = ranks_of_a - 0.5 * (n_a * (n_a + 1)) as f64;
    if n_a.min(n_b) <= EXACT_UP_TO && !tied {
        return Some(RankSum { u, p: exact(u, n_a, n_b), method: Method::Exact });
    }
    let (n, pairs) = ((n_a + n_b) as f64, (n_a * n_b) as f64);
    let variance = pairs / 12.0 * (n + 1.0 - ties / (n * (n - 1.0)));
    // All values are equal, so the samples cannot be distinguished.
    let p = if variance > 0.0 { Normal::standard().sf((u - 0.5 * pairs - 0.5) / variance.sqrt()) } else { 1.0 };
    Some(RankSum { u, p, method: Method::Asymptotic })
}

/// Share of the arrangements of n_a and n_b values with a U of at least `u`.
///
/// U of an arrangement is a sum of n_a numbers from 0 to n_b in rising order, so that there are as many of them as partitions;
/// these are counted by adding one value of `a` after the other to those before.
fn exact(u: f64, n_a: usize, n_b: usize) -> f64 {
    let (few, many) = (n_a.min(n_b), n_a.max(n_b));
    let most = few * many;
    // Coefficients of the Gaussian binomial: products of (1 − q^(many+k)) / (1 − q^k), as probabilities.
    let mut counts = vec![0.0_f64; most + 1];
    counts[0] = 1.0;
    for k in 1..=few {
        for at in (many + k..=most).rev() {
            counts[at] -= counts[at - many - k];
        }
        for at in k..=most {
            counts[at] += counts[at - k];
        }
    }
    let total: f64 = counts.iter().sum();
    counts.iter().enumerate().filter(|(at, _)| *at as f64 >= u).map(|(_, count)| count).sum::<f64>() / total
}

/// The stars of a p value: n.s. from 0.1 on, *, ** and *** below 0.1, 0.05 and 0.001.
pub fn stars(p: f64) -> &'static str {
    match p {
        p if p < 0.001 => "***",
        p if p < 0.05 => "**",
        p if p < 0.1 => "*",
        _ => "n.s.",
    }
}

/// Spearman's rank correlation.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct RankCorrelation {
    /// Pairs.
    pub n: usize,
    /// The correlation of the ranks, equal values sharing the mean of theirs.
    pub rho: f64,
    /// Probability of a correlation as strong, of either sign, between independent values.
    pub p: f64,
    /// How it was found: by counting for fewer than ten pairs, else by Student's t.
    pub method: Method,
}

/// The ranks of some values from 1, in their order; those that are equal up to rounding share the mean of theirs.
pub fn ranks(values: &[f64]) -> Vec<f64> {
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_by_cached_key(|k| OrderedFloat(values[*k]));
    let mut ranks = vec![0.0; values.len()];
    let mut before = 0.0;
    let same = same_within(values);
    for equal in order.chunk_by(|a, b| same(values[*a], values[*b])) {
        let count = equal.len() as f64;
        equal.iter().for_each(|place| ranks[*place] = before + 0.5 * (count + 1.0));
        before += count;
    }
    ranks
}

/// Spearman's rank correlation of pairs, two-sided; `None` for fewer than three pairs, or if either number is constant.
pub fn rank_correlation(points: &[[f64; 2]]) -> Option<RankCorrelation> {
    let n = points.len();
    let columns = columns(points);
    if columns.iter().any(|values| is_constant(values, 0.0)) {
        return None;
    }
    let [x, y] = columns.map(|values| ranks(&values));
    let middle = 0.5 * (n as f64 + 1.0);
    let sum = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| (a - middle) * (b - middle)).sum::<f64>();
    let varies = sum(&x, &x) * sum(&y, &y);
    if n < 3 || varies <= 0.0 {
        return None;
    }
    let rho = (sum(&x, &y) / varies.sqrt()).clamp(-1.0, 1.0);
    if n <= EXACT_PAIRS_UP_TO {
        return Some(RankCorrelation { n, rho, p: exact_correlation(&x, &y), method: Method::Exact });
    }
    let freedom = n as f64 - 2.0;
    let t = rho.abs() * (freedom / ((1.0 - rho) * (1.0 + rho))).sqrt();
    let p = StudentsT::new(0.0, 1.0, freedom).map_or(f64::NAN, |student| 2.0 * student.sf(t));
    Some(RankCorrelation { n, rho, p, method: Method::Asymptotic })
}

/// With so few pairs a correlation of ranks is tested exactly, ties or not.
const EXACT_PAIRS_UP_TO: usize = 9;

/// Share of the orders of y with Σxy at least as far from its mean.
///
/// Ranks of x are given one after the other to each rank of y that is still free; of the ranks that are given, only the set and the
/// sum count.
fn exact_correlation(x: &[f64], y: &[f64]) -> f64 {
    // Twice a rank is a whole number, also of ties.
    let [x, y] = [x, y].map(|ranks| ranks.iter().map(|rank| (2.0 * rank) as i64).collect::<Vec<_>>());
    let n = x.len();
    let mut sums: Vec<BTreeMap<i64, u64>> = vec![BTreeMap::new(); 1 << n];
    sums[0].insert(0, 1);
    for given in 0..sums.len() {
        let own = std::mem::take(&mut sums[given]);
        let Some(next) = x.get(given.count_ones() as usize) else {
            let (expected, found) =
                (x.iter().sum::<i64>() * y.iter().sum::<i64>(), x.iter().zip(&y).map(|(x, y)| x * y).sum::<i64>());
            // Times n, so that the mean is a whole number too.
            let off = |sum: i64| (n as i64 * sum - expected).abs();
            let as_far = own.iter().filter(|(sum, _)| off(**sum) >= off(found)).map(|(_, ways)| ways).sum::<u64>();
            return as_far as f64 / own.values().sum::<u64>() as f64;
        };
        for free in (0..n).filter(|k| given >> k & 1 == 0) {
            for (sum, ways) in &own {
                *sums[given | 1 << free].entry(sum + next * y[free]).or_default() += ways;
            }
        }
    }
    f64::NAN
}

/// A straight line through points.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Line {
    /// Points.
    pub n: usize,
    /// Slope.
    pub slope: f64,
    /// Standard error of the slope.
    pub slope_error: f64,
    /// Intercept; 0 of a line through the origin.
    pub intercept: f64,
    /// Standard error of the intercept; `None` of a line through the origin.
    pub intercept_error: Option<f64>,
    /// Share of the variation that it explains: about the mean, and of a line through the origin about 0; `None` without variation.
    pub r_squared: Option<f64>,
    /// Share of the variation about the mean that it explains; negative for a line through the origin that is worse than the mean.
    pub r_squared_about_mean: Option<f64>,
}

impl Line {
    /// Points less fitted numbers.
    pub fn degrees_of_freedom(&self) -> usize {
        self.n - if self.intercept_error.is_some() { 2 } else { 1 }
    }
}

/// The line of least squares through points (x, y), with an intercept; `None` for fewer than three points or constant x.
pub fn line(points: &[[f64; 2]]) -> Option<Line> {
    line_of(points, [0.0; 2])
}

/// The same if x or y is a logarithm: `sizes` is then 1 instead of 0, since the rounding of a logarithm does not vanish at 0.
pub(crate) fn line_of(points: &[[f64; 2]], sizes: [f64; 2]) -> Option<Line> {
    let [x, y] = columns(points);
    let centre = [mean(&x), mean(&y)];
    if is_constant(&x, sizes[0]) {
        return None;
    }
    if is_constant(&y, sizes[1]) {
        let level: Vec<[f64; 2]> = points.iter().map(|point| [point[0], centre[1]]).collect();
        return least_squares(&level, Some(centre));
    }
    least_squares(points, Some(centre))
}

/// The line of least squares through the origin; `None` for fewer than two points or if all x are 0.
pub fn line_through_origin(points: &[[f64; 2]]) -> Option<Line> {
    least_squares(points, None)
}

/// All x, and all y.
fn columns(points: &[[f64; 2]]) -> [Vec<f64>; 2] {
    [0, 1].map(|k| points.iter().map(|point| point[k]).collect())
}

/// The best line through a centre, or through the origin.
fn least_squares(points: &[[f64; 2]], centre: Option<[f64; 2]>) -> Option<Line> {
    let (n, parameters) = (points.len(), if centre.is_some() { 2 } else { 1 });
    let [x, y] = centre.unwrap_or_default();
    let sum = |of: fn(f64, f64) -> f64| points.iter().map(|p| of(p[0] - x, p[1] - y)).sum::<f64>();
    let (xx, xy, yy) = (sum(|x, _| x * x), sum(|x, y| x * y), sum(|_, y| y * y));
    if n <= parameters || xx <= 0.0 {
        return None;
    }
    let slope = xy / xx;
    // What rounding leaves of a line through all points is no scatter.
    let left = Some(yy - slope * xy).filter(|left| *left > ROUNDING * yy).unwrap_or_default();
    let slope_error = (left / (n - parameters) as f64 / xx).sqrt();
    let r_squared = (yy > 0.0).then(|| slope * xy / yy);
    let about_mean = || Some(squares_about_mean(&columns(points)[1])).filter(|varies| *varies > 0.0);
    let r_squared_about_mean =
        if centre.is_some() { r_squared } else { about_mean().map(|varies| 1.0 - left / varies) };
    let intercept_error = centre.map(|[x, _]| slope_error * (xx / n as f64 + x * x).sqrt());
    Some(Line { n, slope, slope_error, intercept: y - slope * x, intercept_error, r_squared, r_squared_about_mean })
}
