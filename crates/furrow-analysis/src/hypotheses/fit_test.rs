//! Whether a fit meets the measurements.

use furrow_measured::significance::{chi_squared_tail, f_tail};
use furrow_measured::statistics::mean;
use serde::Serialize;

use super::folded;
use super::noise::{Noise, NoiseKind, UNDIVIDED};
use super::observations::{Observation, Observations};

/// Whether the deviations of a fit are larger than the errors explain.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(tag = "test", rename_all = "snake_case")]
pub enum FitTest {
    /// χ² of divisions with known errors.
    ChiSquared {
        /// Σ (deviation/σ)².
        statistic: f64,
        /// Divisions less fitted numbers.
        degrees_of_freedom: usize,
        /// Probability of a χ² as large if the hypothesis were right.
        p: Option<f64>,
    },
    /// Deviations of the cells' means over the spread of replicates.
    LackOfFit {
        /// The ratio F.
        statistic: f64,
        /// Cells less fitted numbers, and replicates less cells.
        degrees_of_freedom: [usize; 2],
        /// Probability of an F as large if the hypothesis were right.
        p: Option<f64>,
    },
}

impl FitTest {
    /// The probability.
    pub fn p(&self) -> Option<f64> {
        let (FitTest::ChiSquared { p, .. } | FitTest::LackOfFit { p, .. }) = self;
        *p
    }
}

/// How far a row lies from χ, squared, in standard deviations.
pub(super) fn squared(noise: &Noise, row: &Observation, chi: f64, sd: f64) -> f64 {
    if noise.folded { folded::squared_deviation(row.chi, chi, sd) } else { ((row.chi - chi) / sd).powi(2) }
}

/// Whether a fit of some numbers meets the measurements: by given errors, or else by the spread of replicates.
pub(super) fn fit_test(
    observations: &Observations,
    noise: &Noise,
    chi: &[Option<f64>],
    fitted: usize,
) -> Option<FitTest> {
    let rows = &observations.rows;
    if noise.kind == NoiseKind::Given {
        let undivided = |sd: f64| (UNDIVIDED / sd).powi(2);
        let off =
            |(row, sd): (&Observation, f64)| chi[row.cell].map_or(undivided(sd), |chi| squared(noise, row, chi, sd));
        let statistic = rows.iter().zip(noise.sds(rows)).map(off).sum();
        let degrees_of_freedom = rows.len().saturating_sub(fitted);
        let p = chi_squared_tail(statistic, degrees_of_freedom);
        return Some(FitTest::ChiSquared { statistic, degrees_of_freedom, p });
    }
    let spread = noise.sd?;
    let of = |cell: usize| {
        let (measured, sd) = (observations.chi_of(cell), spread * noise.shape(cell));
        match chi[cell] {
            Some(chi) if noise.folded => folded::deviance(&measured, chi, sd),
            chi => measured.len() as f64 * (chi.map_or(UNDIVIDED, |chi| mean(&measured) - chi) / sd).powi(2),
        }
    };
    let above = observations.cells.len().saturating_sub(fitted);
    let statistic = (0..observations.cells.len()).map(of).sum::<f64>() / above as f64;
    let degrees_of_freedom = [above, noise.degrees_of_freedom];
    (above > 0).then(|| FitTest::LackOfFit { statistic, degrees_of_freedom, p: f_tail(statistic, degrees_of_freedom) })
}
