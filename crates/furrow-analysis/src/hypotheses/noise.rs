//! The errors of χ, and the likelihood.
//!
//! Replicates, the divisions of one cell in several embryos, show the errors without any model: about their own mean they have the
//! standard deviation σ, which may grow as cells shrink,
//!
//! * \[F.10 noise by size\] σ(V) = s (V/V₀)^−b,
//!
//! where V is the mother's mean volume and V₀ the geometric mean over cells. The restricted likelihood of the deviations has the
//! maximum s² = Σ S_c (V_c/V₀)^{2b}/ν at given b, with S_c the sum of squares of a cell about her mean and ν = Σ(n_c − 1), and leaves
//! −½ν ln s² + b Σ(n_c − 1) ln(V_c/V₀) to be maximised over b from 0 to 2.
//!
//! # References
//! Patterson & Thompson, *Biometrika* 58, 545 (1971), for restricted likelihood.

use furrow_input::InputError;
use furrow_measured::statistics::{mean, squares_about_mean};
use serde::Serialize;
use std::f64::consts::TAU;

use super::folded;
use super::observations::{Observation, Observations};

/// Where the errors of χ come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum NoiseKind {
    /// The table gives the standard deviation of each χ.
    Given,
    /// One standard deviation for all, of largest likelihood for each hypothesis: it counts among the fitted numbers.
    Common,
    /// From replicates, growing as cells shrink where the table has volumes.
    Replicates,
}

impl NoiseKind {
    /// All of them, with the names that users write.
    pub const NAMED: [(&str, NoiseKind); 3] =
        [("given", NoiseKind::Given), ("common", NoiseKind::Common), ("replicates", NoiseKind::Replicates)];
}

/// The errors of χ.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Noise {
    /// Where they come from.
    pub kind: NoiseKind,
    /// s of replicates; of [`NoiseKind::Common`] the standard deviation within cells, for comparison. `None` without replicates that
    /// differ, and where errors are given.
    pub sd: Option<f64>,
    /// b of replicates; 0 where volumes are not known.
    pub exponent: f64,
    /// ν of replicates.
    pub degrees_of_freedom: usize,
    /// Whether \|χ\| has a folded normal distribution (F.19) in place of a normal one.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub folded: bool,
    /// For each cell ln(V/V₀) over all embryos; 0 where volumes are not known. A part of the rows has the same, so that a cell that
    /// only other rows have keeps her size.
    #[serde(skip)]
    pub(super) sizes: Vec<f64>,
}

/// Standard deviation that scales the misfit of the search where errors are common.
const SCALE: f64 = 0.05;
/// Least standard deviation: a perfect fit has a finite likelihood.
pub(super) const LEAST: f64 = 1e-6;
/// Largest exponent of the noise over size, and steps of the search for it.
const STEEPEST: f64 = 2.0;
const STEPS: usize = 100;
/// A χ of a cell that does not divide is as wrong as this.
pub(crate) const UNDIVIDED: f64 = 1.0;

impl Noise {
    /// The errors of some observations: given ones if all have them, else one common one, unless a kind is asked for. `folded`
    /// ones are errors of the signed χ. Errors name the table, `source`, and the `option` of the kind.
    ///
    /// # Errors
    /// Errors are asked for that the table does not have.
    pub fn of(
        observations: &Observations,
        asked: Option<NoiseKind>,
        folded: bool,
        (source, option): (&str, &str),
    ) -> Result<Noise, InputError> {
        let rows = &observations.rows;
        let given = rows.iter().filter(|row| row.sd.is_some()).count();
        let kind = asked.unwrap_or(if given > 0 { NoiseKind::Given } else { NoiseKind::Common });
        if kind == NoiseKind::Given && given < rows.len() {
            let allowed = "given in every row that is used, or left out with another kind of noise";
            return Err(InputError::not_allowed(source, "chi_sd", format!("{given} of {} rows", rows.len()), allowed));
        }
        let noise = Noise::estimated(rows, sizes(kind, rows, observations.cells.len()), (kind, folded));
        if kind == NoiseKind::Replicates && noise.sd.is_none() {
            let why =
                if noise.degrees_of_freedom == 0 { "was measured in two embryos" } else { "differs between embryos" };
            let allowed = format!("given or common: no cell {why}");
            return Err(InputError::not_allowed(option, "noise", "replicates", allowed));
        }
        Ok(noise)
    }

    fn estimated(rows: &[Observation], sizes: Vec<f64>, (kind, folded): (NoiseKind, bool)) -> Noise {
        let of_cell = |cell: usize| rows.iter().filter(move |row| row.cell == cell);
        let of = |cell: usize| {
            let chi: Vec<f64> = of_cell(cell).map(|row| row.chi).collect();
            (chi.len().saturating_sub(1), squares_about_mean(&chi))
        };
        let within: Vec<(usize, f64)> = (0..sizes.len()).map(of).collect();
        let degrees_of_freedom = within.iter().map(|(freedom, _)| freedom).sum();
        let none = |sizes| Noise { kind, sd: None, exponent: 0.0, degrees_of_freedom, folded, sizes };
        // Replicates that are all equal say nothing of errors.
        if kind == NoiseKind::Given || within.iter().all(|(_, squares)| *squares == 0.0) {
            return none(sizes);
        }
        let variance = |exponent: f64| {
            let of = |((_, squares), size): (&(usize, f64), &f64)| squares * (2.0 * exponent * size).exp();
            within.iter().zip(&sizes).map(of).sum::<f64>() / degrees_of_freedom as f64
        };
        let weighted: f64 = within.iter().zip(&sizes).map(|((freedom, _), size)| *freedom as f64 * size).sum();
        let likelihood = |b: f64| b * weighted - 0.5 * degrees_of_freedom as f64 * variance(b).ln();
        // Replicates of one size do not determine how errors grow.
        let replicated: Vec<f64> =
            within.iter().zip(&sizes).filter(|((freedom, _), _)| *freedom > 0).map(|(_, size)| *size).collect();
        let steepest = if squares_about_mean(&replicated) > 0.0 { STEEPEST } else { 0.0 };
        let exponent = if steepest > 0.0 { highest(likelihood, [0.0, steepest], STEPS) } else { 0.0 };
        let sd = variance(exponent).sqrt().max(LEAST);
        let [sd, exponent] = if folded {
            let values = |cell: usize| of_cell(cell).map(|row| row.chi).collect();
            let cells: Vec<(Vec<f64>, f64)> =
                sizes.iter().enumerate().map(|(cell, size)| (values(cell), *size)).collect();
            folded::estimated(&cells, steepest, sd)
        } else {
            [sd, exponent]
        };
        Noise { sd: Some(sd), exponent, ..none(sizes) }
    }

    /// (V/V₀)^−b of a cell.
    pub(crate) fn shape(&self, cell: usize) -> f64 {
        (-self.exponent * self.sizes[cell]).exp()
    }

    /// The errors of some of the rows, of the same kind.
    pub(crate) fn of_part(&self, rows: &[Observation]) -> Noise {
        Noise::estimated(rows, self.sizes.clone(), (self.kind, self.folded))
    }

    /// The standard deviation of each row; of a common one those that scale the search.
    pub(crate) fn sds(&self, rows: &[Observation]) -> Vec<f64> {
        let of = |row: &Observation| match self.kind {
            NoiseKind::Given => row.sd.unwrap_or(SCALE),
            NoiseKind::Common => SCALE,
            NoiseKind::Replicates => self.sd.unwrap_or(SCALE) * self.shape(row.cell),
        };
        rows.iter().map(of).collect()
    }

    /// The standard deviation of each of `rows`. A common one is the most likely one for the rows `all`, given χ of the cells.
    pub(crate) fn fitted(&self, rows: &[Observation], all: &[Observation], chi: &[Option<f64>]) -> Vec<f64> {
        match (self.kind, self.folded) {
            (NoiseKind::Common, false) => vec![common_sd(&residuals(all, chi)); rows.len()],
            (NoiseKind::Common, true) => {
                let pairs: Vec<(f64, Option<f64>)> = all.iter().map(|row| (row.chi, chi[row.cell])).collect();
                vec![folded::common_sd(&pairs, UNDIVIDED); rows.len()]
            }
            _ => self.sds(rows),
        }
    }

    /// The logarithm of the density of each row, where its cell has the χ of `chi`.
    pub(crate) fn log_densities(&self, rows: &[Observation], chi: &[Option<f64>], sds: &[f64]) -> Vec<f64> {
        rows.iter().zip(sds).map(|(row, sd)| self.log_density(row, chi[row.cell], *sd)).collect()
    }

    /// The logarithm of the density of a row, where its cell has this χ.
    pub(crate) fn log_density(&self, row: &Observation, chi: Option<f64>, sd: f64) -> f64 {
        let signs = chi.filter(|_| self.folded).map_or(0.0, |chi| folded::log_both_signs(row.chi, chi, sd));
        log_density(residual(row, chi), sd) + signs
    }

    /// The derivative of the logarithm of a row's density by χ, and Fisher's information about χ.
    pub(super) fn score(&self, row: &Observation, chi: f64, sd: f64) -> [f64; 2] {
        let [measured, share] = match self.folded {
            true => [folded::over_signs(row.chi, chi, sd), folded::information(chi / sd)],
            false => [row.chi, 1.0],
        };
        [measured - chi, share].map(|of| of / (sd * sd))
    }

    /// The sum of these.
    pub(crate) fn log_likelihood(&self, rows: &[Observation], chi: &[Option<f64>], sds: &[f64]) -> f64 {
        self.log_densities(rows, chi, sds).into_iter().sum()
    }
}

/// ln(V/V₀) of each cell; 0 where a row has no volume, and where errors do not depend on size.
fn sizes(kind: NoiseKind, rows: &[Observation], cells: usize) -> Vec<f64> {
    if kind != NoiseKind::Replicates || rows.iter().any(|row| row.volume.is_none()) {
        return vec![0.0; cells];
    }
    let logarithm = |cell: usize| {
        let volumes: Vec<f64> = rows.iter().filter(|row| row.cell == cell).filter_map(|row| row.volume).collect();
        mean(&volumes).ln()
    };
    let logarithms: Vec<f64> = (0..cells).map(logarithm).collect();
    let middle = mean(&logarithms);
    logarithms.into_iter().map(|logarithm| logarithm - middle).collect()
}

/// Residuals of rows by χ of the cells.
pub(super) fn residuals(rows: &[Observation], chi: &[Option<f64>]) -> Vec<f64> {
    rows.iter().map(|row| residual(row, chi[row.cell])).collect()
}

fn residual(row: &Observation, chi: Option<f64>) -> f64 {
    chi.map_or(UNDIVIDED, |chi| row.chi - chi)
}

/// The common standard deviation of largest likelihood.
pub fn common_sd(residuals: &[f64]) -> f64 {
    mean(&residuals.iter().map(|residual| residual * residual).collect::<Vec<_>>()).sqrt().max(LEAST)
}

/// The logarithm of the normal density of a residual.
///
/// # Examples
/// ```
/// use furrow_analysis::hypotheses::noise::log_density;
/// // scipy.stats.norm.logpdf(0.03, scale=0.02)
/// assert!((log_density(0.03, 0.02) - 1.868_084_472_223_473).abs() < 1e-12);
/// ```
pub fn log_density(residual: f64, sd: f64) -> f64 {
    -0.5 * ((residual / sd).powi(2) + (TAU * sd * sd).ln())
}

/// Akaike's criterion for small samples; `None` for n ≤ k + 1, unless nothing was fitted: −2 ln L then has no bias.
///
/// # Examples
/// ```
/// use furrow_analysis::hypotheses::noise::aicc;
/// assert_eq!(aicc(-3.0, 2, 10), Some(2.0 * 2.0 + 6.0 + 12.0 / 7.0));
/// assert_eq!((aicc(-3.0, 2, 3), aicc(-3.0, 0, 1)), (None, Some(6.0)));
/// ```
pub fn aicc(log_likelihood: f64, numbers: usize, data: usize) -> Option<f64> {
    let (k, left) = (numbers as f64, data as f64 - numbers as f64 - 1.0);
    let correction = if numbers == 0 { Some(0.0) } else { (left > 0.0).then(|| 2.0 * k * (k + 1.0) / left) };
    correction.map(|correction| 2.0 * k - 2.0 * log_likelihood + correction)
}

/// Where a function with one maximum in an interval is largest, after `steps` golden sections.
pub(super) fn highest(of: impl Fn(f64) -> f64, [mut low, mut high]: [f64; 2], steps: usize) -> f64 {
    let share = 0.5 * (5.0_f64.sqrt() - 1.0);
    let ends = [low, high];
    for _ in 0..steps {
        let [a, b] = [high - share * (high - low), low + share * (high - low)];
        if of(a) >= of(b) { high = b } else { low = a }
    }
    let inside = 0.5 * (low + high);
    // A maximum at an end of the interval is only neared.
    ends.into_iter().fold(inside, |best, end| if of(end) >= of(best) { end } else { best })
}
