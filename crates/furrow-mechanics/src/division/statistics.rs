//! Statistics of several divisions of one kind of cell.

use super::{Division, Outcome};

/// Counts of outcomes, and χ over the cells that divided.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub struct Statistics {
    /// Divisions into equal daughters.
    pub symmetric: usize,
    /// Divisions into unequal daughters.
    pub asymmetric: usize,
    /// Cells that came to rest undivided.
    pub failed: usize,
    /// Mean of χ; `None` if no cell divided.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub chi_mean: Option<f64>,
    /// Sample standard deviation of χ; 0 for a single division.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub chi_sd: Option<f64>,
}

impl Statistics {
    /// Of the given divisions.
    pub fn of<'a>(divisions: impl IntoIterator<Item = &'a Division>) -> Statistics {
        let mut out = Statistics::default();
        let mut chi = Vec::new();
        for division in divisions {
            match division.outcome() {
                Outcome::Symmetric => out.symmetric += 1,
                Outcome::Asymmetric => out.asymmetric += 1,
                Outcome::Arrested => out.failed += 1,
            }
            chi.extend(division.chi());
        }
        if !chi.is_empty() {
            let n = chi.len() as f64;
            let mean = chi.iter().sum::<f64>() / n;
            let squares: f64 = chi.iter().map(|v| (v - mean).powi(2)).sum();
            out.chi_mean = Some(mean);
            out.chi_sd = Some(if chi.len() > 1 { (squares / (n - 1.0)).sqrt() } else { 0.0 });
        }
        out
    }
}
