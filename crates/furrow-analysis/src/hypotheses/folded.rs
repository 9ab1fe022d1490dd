//! Folded errors: χ has a normal error, and the table has \|χ\| without the sign.
//!
//! * \[F.19 folded\] f(x) = \[φ((x − χ)/σ) + φ((x + χ)/σ)\]/σ for x ≥ 0, with φ the standard normal density.
//!
//! Where χ is large beside σ this is the normal density. Where χ = 0 the mean of x is 0.8 σ: an equal division looks unequal by about
//! the error of its measurement.
//!
//! Replicates of an equal division look like replicates of a slightly unequal one with smaller errors. Errors are therefore estimated
//! with a prior: a cell divides equally with probability ½, else χ is uniform between 0 and 1:
//!
//! * \[F.20 spread\] L(σ) = Π_c ½ \[Π_i f(x_ci \| 0) + ∫₀¹ Π_i f(x_ci \| χ) dχ\],
//!
//! which for χ far from 0 is the restricted likelihood of normal errors.
//!
//! # References
//! Leone, Nelson & Nottingham, *Technometrics* 3, 543 (1961).

use furrow_measured::significance::{normal_quantile, normal_tail};
use furrow_measured::statistics::mean;
use std::f64::consts::{PI, TAU};

use super::noise::{LEAST, highest, log_density};

/// The sum over the lost sign matters for less than this many standard deviations.
const FAR: f64 = 6.0;
/// Reach of integrals over a normal density, and their points within a standard deviation.
const REACH: f64 = 8.0;
const FINENESS: f64 = 4.0;
/// Steps of each search for the largest likelihood.
const STEPS: usize = 30;
/// Most steps to a fixed point, and where they end.
const MOST: usize = 1000;
const ROUNDING: f64 = 1e-13;

/// The second term of F.19, as an addition to the logarithm of the first.
pub(super) fn log_both_signs(x: f64, chi: f64, sd: f64) -> f64 {
    (-2.0 * x * chi / (sd * sd)).exp().ln_1p()
}

/// The mean of the signed value over both signs, by their probabilities.
pub(super) fn over_signs(x: f64, chi: f64, sd: f64) -> f64 {
    x * (x * chi / (sd * sd)).tanh()
}

/// ln Π f(x_i).
fn log_likelihood(values: &[f64], chi: f64, sd: f64) -> f64 {
    values.iter().map(|x| log_density(x - chi, sd) + log_both_signs(*x, chi, sd)).sum()
}

/// The value that `next` leaves as it is, to rounding errors of numbers as large as `scale`.
fn fixed_point(start: f64, scale: f64, next: impl Fn(f64) -> f64) -> f64 {
    let mut found = start;
    for _ in 0..MOST {
        let last = found;
        found = next(last);
        if (found - last).abs() <= ROUNDING * scale {
            break;
        }
    }
    found
}

/// Mean and standard deviation of x.
pub(super) fn moments(chi: f64, sd: f64) -> [f64; 2] {
    let m = chi / sd;
    let mean = sd * (2.0 / PI).sqrt() * (-0.5 * m * m).exp() + chi * (1.0 - 2.0 * normal_tail(m));
    [mean, (chi * chi + sd * sd - mean * mean).max(0.0).sqrt()]
}

/// Fisher's information of x about χ, as a part of the information of the signed value, with χ in units of σ.
pub(super) fn information(m: f64) -> f64 {
    let step = 1.0 / (2.0 * FINENESS);
    let count = (REACH / step) as i32;
    let at = |k: i32| {
        let z = step * f64::from(k);
        let y = m + z;
        (-0.5 * z * z).exp() / TAU.sqrt() * step * (y * (y * m).tanh()).powi(2)
    };
    (-count..=count).map(at).sum::<f64>() - m * m
}

/// A χ² of one degree of freedom for x: its tail probability is the probability of a density no larger than f(x).
pub(super) fn squared_deviation(x: f64, chi: f64, sd: f64) -> f64 {
    let (x, m) = (x / sd, chi / sd);
    let log = |t: f64| -0.5 * (t - m).powi(2) + (-2.0 * t * m).exp().ln_1p();
    let above = |t: f64| normal_tail(t - m) + normal_tail(t + m);
    let below = |t: f64| normal_tail(m - t) - normal_tail(m + t);
    let mode = fixed_point(m, 1.0, |t| m * (t * m).tanh());
    let level = log(x);
    // The other place where the density is the same lies between one where it is smaller and the mode.
    let other = |mut small: f64| {
        let mut large = mode;
        for _ in 0..STEPS {
            let middle = 0.5 * (small + large);
            if log(middle) < level { small = middle } else { large = middle }
        }
        0.5 * (small + large)
    };
    let p = match x >= mode {
        true if log(0.0) >= level => above(x),
        true => above(x) + below(other(0.0)),
        false => below(x) + above(other(2.0 * m + REACH)),
    };
    let z = normal_quantile(0.5 * p.min(1.0));
    // Beyond the smallest number the density alone says how far x lies.
    if z.is_finite() { z * z } else { 2.0 * (log(mode) - level) }
}

/// The most likely common standard deviation for pairs of x and χ. Where the cell does not divide, the deviation is `undivided`.
pub(super) fn common_sd(pairs: &[(f64, Option<f64>)], undivided: f64) -> f64 {
    let most_likely = |sd: f64| {
        let of = |(x, chi): &(f64, Option<f64>)| match chi {
            Some(chi) => x * x + chi * chi - 2.0 * chi * over_signs(*x, *chi, sd),
            None => undivided * undivided,
        };
        mean(&pairs.iter().map(of).collect::<Vec<_>>()).max(0.0).sqrt().max(LEAST)
    };
    let off = |(x, chi): &(f64, Option<f64>)| chi.map_or(undivided, |chi| x - chi).powi(2);
    let start = mean(&pairs.iter().map(off).collect::<Vec<_>>()).sqrt().max(LEAST);
    fixed_point(start, start, most_likely)
}

/// ln ∫ exp(ln L) d ln σ for a logarithm of a likelihood of `count` values that has its maximum at `sd`.
pub(super) fn over_sd(log_likelihood: impl Fn(f64) -> f64, sd: f64, count: usize) -> f64 {
    let step = 1.0 / (FINENESS * (count as f64).sqrt());
    let top = log_likelihood(sd);
    let side = |way: f64| {
        let at = |k: i32| (log_likelihood(sd * (way * step * f64::from(k)).exp()) - top).exp();
        (1..).map(at).take_while(|share| *share > f64::EPSILON).sum::<f64>()
    };
    top + (step * (1.0 + side(1.0) + side(-1.0))).ln()
}

/// The likelihood of the standard deviation of a cell's values alone, F.20.
fn log_spread(values: &[f64], sd: f64) -> f64 {
    let [small, large] = [log_likelihood(values, 0.0, sd), log_over_chi(values, sd)].map(|log| log - 2.0_f64.ln());
    small.max(large) + (-(small - large).abs()).exp().ln_1p()
}

/// ln ∫ Π f(x_i) dχ from 0 to 1.
fn log_over_chi(values: &[f64], sd: f64) -> f64 {
    let n = values.len() as f64;
    let least = values.iter().fold(f64::INFINITY, |least: f64, x| least.min(*x));
    if least > FAR * sd {
        let middle = mean(values);
        let squares: f64 = values.iter().map(|x| (x - middle).powi(2)).sum();
        return -0.5 * squares / (sd * sd) - (n - 1.0) * (sd * TAU.sqrt()).ln() - 0.5 * n.ln();
    }
    let most = values.iter().fold(0.0, |most: f64, x| most.max(*x));
    let last = (most + REACH * sd / n.sqrt()).min(1.0);
    let count = (last * FINENESS * n.sqrt() / sd).ceil();
    let step = last / count;
    let logs: Vec<f64> = (0..=count as usize).map(|k| log_likelihood(values, step * k as f64, sd)).collect();
    let top = logs.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    // The integrand is even in χ, so that the sum of the trapezoid rule has half of its first value.
    let sum: f64 = logs.iter().map(|log| (log - top).exp()).sum::<f64>() - 0.5 * (logs[0] - top).exp();
    top + (sum * step).ln()
}

/// The most likely s and b of errors s exp(−b size) for the values of cells, with b from 0 to `steepest`; `start` is s of normal
/// errors.
pub(super) fn estimated(cells: &[(Vec<f64>, f64)], steepest: f64, start: f64) -> [f64; 2] {
    let several: Vec<&(Vec<f64>, f64)> = cells.iter().filter(|(values, _)| values.len() > 1).collect();
    let freedom: usize = several.iter().map(|(values, _)| values.len() - 1).sum();
    let likelihood =
        |b: f64, s: f64| several.iter().map(|(values, size)| log_spread(values, s * (-b * size).exp())).sum::<f64>();
    let best = |b: f64| {
        // The upper limit is the error if all cells divide equally.
        let all = several.iter().flat_map(|(values, size)| values.iter().map(move |x| (x * (b * size).exp()).powi(2)));
        let most = (all.sum::<f64>() / freedom as f64).sqrt().max(start) * 2.0;
        let limits = [0.25 * start.max(LEAST), most.max(LEAST)].map(f64::ln);
        highest(|log| likelihood(b, log.exp()), limits, STEPS).exp()
    };
    let b = if steepest > 0.0 { highest(|b| likelihood(b, best(b)), [0.0, steepest], STEPS) } else { 0.0 };
    [best(b), b]
}

/// How far the likelihood of a cell's values lies below its maximum over χ, as a χ² of one degree of freedom.
pub(super) fn deviance(values: &[f64], chi: f64, sd: f64) -> f64 {
    // The fixed point of the mean over both signs climbs to the maximum.
    let over_all = |chi: f64| mean(&values.iter().map(|x| over_signs(*x, chi, sd)).collect::<Vec<_>>());
    let best = fixed_point(mean(values), sd, over_all);
    (2.0 * (log_likelihood(values, best, sd) - log_likelihood(values, chi, sd))).max(0.0)
}

#[cfg(test)]
mod tests {
    use rand_mt::Mt64;

    use super::*;
    use crate::ensemble::normal;

    fn close(found: f64, expected: f64, within: f64) {
        assert!((found - expected).abs() < within * expected.abs().max(1.0), "{found} {expected}");
    }

    /// Beside `scipy.stats.foldnorm`, its largest likelihoods by `minimize_scalar` and integrals by the trapezoid rule.
    #[test]
    fn densities_and_estimates_are_those_of_scipy() {
        let log = |x: f64, chi: f64, sd: f64| log_likelihood(&[x], chi, sd);
        close(log(0.03, 0.01, 0.02), 2.6944977502062257, 1e-12);
        close(log(0.2, 0.16, 0.03), 1.6987304752264207, 1e-12);
        for (chi, expected) in
            [(0.01, [0.01791186229605224, 0.01338526014268166]), (0.0, [0.015957691216057307, 0.012056205499781739])]
        {
            moments(chi, 0.02).into_iter().zip(expected).for_each(|(found, expected)| close(found, expected, 1e-10));
        }
        for (m, expected) in
            [(0.0, 0.0), (0.3, 0.1535897203893635), (1.0, 0.7339116723954431), (3.0, 0.9992239657193949)]
        {
            close(information(m), expected, 1e-9);
        }
        let pairs = [(0.01, 0.0), (0.03, 0.02), (0.015, 0.0), (0.16, 0.17), (0.2, 0.18)].map(|(x, chi)| (x, Some(chi)));
        close(common_sd(&pairs, 1.0), 0.013629002174562302, 1e-8);
        let cells =
            [vec![0.01, 0.03, 0.015, 0.004], vec![0.16, 0.2, 0.17], vec![0.05, 0.02, 0.06]].map(|values| (values, 0.0));
        let [s, b] = estimated(&cells, 0.0, 0.014);
        close(s, 0.029962434948806668, 1e-6);
        assert_eq!(b, 0.0);
        close(cells.iter().map(|(values, _)| log_spread(values, s)).sum(), 20.90094157076375, 1e-6);
        close(deviance(&cells[0].0, 0.03, 0.02), 4.1948663800116, 1e-8);
        close(deviance(&cells[2].0, 0.03, 0.02), 1.2611563187524375, 1e-8);
        // Far from 0 it is the one of normal errors.
        close(deviance(&cells[1].0, 0.15, 0.01), 3.0 * ((0.53 / 3.0 - 0.15) / 0.01_f64).powi(2), 1e-8);
    }

    /// Beside integrals of the density of `scipy.stats.foldnorm` over all places where it is smaller.
    #[test]
    fn deviations_have_the_probability_of_a_density_as_small() {
        for (x, m, expected) in [
            (1.5, 0.0, 2.25),
            (2.5, 1.2, 2.7556993889541324),
            (0.1, 1.2, 0.6574728329051802),
            (0.2, 3.0, 7.777518256926146),
            (4.5, 3.0, 2.250157491510089),
            (0.3, 1.5, 1.211859060149303),
        ] {
            close(squared_deviation(0.02 * x, 0.02 * m, 0.02), expected, 2e-5);
        }
        // Beyond all tails.
        close(squared_deviation(1.0, 0.0, 0.02), 2500.0, 1e-3);
        assert_eq!(squared_deviation(0.0, 0.0, 0.02), 0.0);
        // One value of twenty lies beyond 3.841, wherever the true χ lies.
        let mut random = Mt64::new(4);
        for m in [0.0, 0.7, 1.5, 4.0] {
            let far =
                (0..10_000).filter(|_| squared_deviation((m + normal(&mut random)).abs(), m, 1.0) > 3.841).count();
            assert!((420..=580).contains(&far), "{m}: {far}");
        }
    }

    /// Replicates of equal and of unequal cells give the errors and their growth as cells shrink. In small cells χ = 0.06 cannot be
    /// distinguished from 0, which makes the estimated errors a tenth too large.
    #[test]
    fn errors_are_found_from_replicates() {
        let mut random = Mt64::new(9);
        let cell = |k: usize| {
            let size = (k % 5) as f64 - 2.0;
            let (chi, sd) = ([0.2, 0.0, 0.06][k % 3], 0.03 * (-0.4 * size).exp());
            ((0..10).map(|_| (chi + sd * normal(&mut random)).abs()).collect::<Vec<f64>>(), size)
        };
        let cells: Vec<(Vec<f64>, f64)> = (0..40).map(cell).collect();
        let [s, b] = estimated(&cells, 2.0, 0.02);
        assert!((s - 0.03).abs() < 0.005 && (b - 0.4).abs() < 0.1, "{s} {b}");
    }
}
