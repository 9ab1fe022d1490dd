//! How well a fit meets measurements of known errors.

use crate::constraints::{Exclusion, Extent, check_constraints};
use furrow_cell::Settings;
use furrow_measured::significance::chi_squared_tail;
use furrow_mechanics::calibration::{CalibrateError, Calibration, Targets, Threshold, ThresholdResidual, calibrate};
use serde::{Serialize, Serializer};
use serde_json::{Map, json};

/// χ² of a fit, with what follows from it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Goodness {
    /// Σ ((computed − measured)/sd)².
    pub chi_squared: f64,
    /// Measurements less fitted numbers; 0 where there are no more measurements than numbers.
    pub degrees_of_freedom: usize,
    /// Probability of a χ² as large if the model were right; `None` without degrees of freedom.
    pub p: Option<f64>,
    /// Birge's factor √(χ²/ν) on the errors of the numbers, 1 at least; `None` without degrees of freedom, where the misfit says
    /// nothing of the errors.
    pub error_scale: Option<f64>,
}

impl Goodness {
    /// The goodness of a fit of `numbers` numbers to `measurements` measurements.
    ///
    /// # Examples
    /// ```
    /// use furrow_analysis::fit::Goodness;
    /// let poor = Goodness::of(91.0, 4, 3);
    /// assert_eq!((poor.degrees_of_freedom, poor.error_scale), (1, Some(91_f64.sqrt())));
    /// assert!(poor.p.unwrap() < 1e-20);
    /// // Errors that were measured do not shrink where the fit is better than they let expect.
    /// assert_eq!(Goodness::of(0.5, 6, 2).error_scale, Some(1.0));
    /// assert_eq!(Goodness::of(0.0, 3, 3).error_scale, None);
    /// ```
    pub fn of(chi_squared: f64, measurements: usize, numbers: usize) -> Goodness {
        let degrees_of_freedom = measurements.saturating_sub(numbers);
        let (p, error_scale) = match degrees_of_freedom {
            0 => (None, None),
            freedom => {
                let factor = (chi_squared / freedom as f64).sqrt().max(1.0);
                (chi_squared_tail(chi_squared, freedom), Some(factor))
            }
        };
        Goodness { chi_squared, degrees_of_freedom, p, error_scale }
    }

    /// The goodness of constants fitted to thresholds, with the tolerances as errors. With other weights the fit is not the one of the
    /// least χ², which alone has a probability.
    fn of_thresholds(targets: &Targets, found: &Calibration) -> Goodness {
        let of = |(given, residual): (&Threshold, &ThresholdResidual)| (residual.relative / given.tolerance).powi(2);
        let chi_squared = targets.thresholds.iter().zip(&found.residuals).map(of).sum();
        let goodness = Goodness::of(chi_squared, found.residuals.len(), found.parameters.len());
        if targets.is_weighted_by_tolerances() { goodness } else { Goodness { p: None, error_scale: None, ..goodness } }
    }
}

impl std::fmt::Display for Goodness {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Goodness { chi_squared, degrees_of_freedom, p, .. } = self;
        write!(f, "χ² = {chi_squared:.2}, degrees of freedom {degrees_of_freedom}")?;
        p.map_or(Ok(()), |p| write!(f, ", p = {p:.1e}"))
    }
}

/// Constants calibrated to thresholds, and what speaks against them.
#[derive(Clone, Debug)]
pub struct CalibrationStudy {
    /// The constants.
    pub found: Calibration,
    /// How well they meet the thresholds, by their tolerances.
    pub goodness: Goodness,
    /// The statements of the targets that they contradict.
    pub excluded: Vec<Exclusion>,
}

impl CalibrationStudy {
    /// Calibrates the unknowns of the targets, from the given constants.
    ///
    /// # Errors
    /// As [`calibrate`].
    pub fn of(
        targets: &Targets,
        Settings { cell, numerics, .. }: &Settings,
    ) -> Result<CalibrationStudy, CalibrateError> {
        let found = calibrate(targets, cell, numerics)?;
        let excluded = check_constraints(targets, &found.cell, numerics, Extent::Within(f64::INFINITY)).excluded;
        Ok(CalibrationStudy { goodness: Goodness::of_thresholds(targets, &found), found, excluded })
    }
}

impl Serialize for CalibrationStudy {
    /// The components of `combinations` are in the order of the parameters.
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let CalibrationStudy { found, goodness, excluded } = self;
        let parameters = found.parameters.iter().map(|(parameter, value)| (parameter.to_string(), json!(value)));
        json!({
            "parameters": parameters.collect::<Map<_, _>>(),
            "residuals": found.residuals,
            "rms": found.rms,
            "goodness": goodness,
            "combinations": found.combinations,
            "iterations": found.iterations,
            "excluded": excluded,
        })
        .serialize(serializer)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use furrow_input::parse_document;

    /// Tolerances of 5 % and 0.2 %: the fit is the one of the least χ², as with weights in their proportion. Other weights have no p.
    #[test]
    fn thresholds_count_by_their_tolerances() {
        let study = |weights: [&str; 2]| {
            let [first, second] = weights;
            let text = format!(
                "Targets(unknowns: [(parameter: p0, start: 0.1)], thresholds: [
                    (r0: 1.64, epsilon: 0.87, xi_s: 27.3, tolerance: 0.05{first}),
                    (r0: 2.22, epsilon: 0.88, xi_s: 21.75, tolerance: 0.002{second})])"
            );
            let targets: Targets = parse_document(&text, "t.ron", "a file of targets", "Targets").unwrap();
            let settings = Settings::load("gao2026", None, None, &["intervals=32".to_owned()]).unwrap();
            CalibrationStudy::of(&targets, &settings).unwrap()
        };
        let [by_tolerance, given, equal] =
            [["", ""], [", weight: 0.04", ", weight: 1"], [", weight: 1", ", weight: 1"]].map(study);
        let [found, expected] = [&by_tolerance, &given].map(|study| study.found.parameters[0].1);
        assert!((found / expected - 1.0).abs() < 1e-9, "{found} {expected}");
        assert!(by_tolerance.goodness.p.is_some() && equal.goodness.p.is_none());
        assert!(by_tolerance.goodness.chi_squared < 0.02 * equal.goodness.chi_squared);
        let squares: f64 = by_tolerance.found.residuals.iter().map(|residual| residual.relative.powi(2)).sum();
        assert!((by_tolerance.found.rms - (0.5 * squares).sqrt()).abs() < 1e-15);
    }
}
