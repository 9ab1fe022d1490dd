//! Records of stationary shapes, folds and pitchforks, with the keys of files, `--json` and Python.
//!
//! Lengths are in L_h, p in κ0/L_h³, activities in κ0/L_h, growth rates in 1/τ.
#![allow(non_snake_case)]

use serde::Serialize;

use furrow_mechanics::equilibria::{BranchEvent, Criticality, Pitchfork, PointKind, StationaryShape};
use furrow_mechanics::stability::{Parity, Spectrum};

/// A growth rate.
#[derive(Clone, Debug, Serialize)]
pub struct Rate {
    /// Real part.
    pub re: f64,
    /// Imaginary part.
    pub im: f64,
    /// Of its mode: `even`, `odd` or `mixed`.
    pub parity: &'static str,
}

/// A stationary shape and its stability.
#[derive(Clone, Debug, Serialize)]
pub struct StationaryReport {
    /// Contour length.
    pub L: f64,
    /// Pressure.
    pub p: f64,
    /// Elongation, in R0.
    pub H: f64,
    /// Radius at the equator.
    pub r_eq: f64,
    /// Whether no disturbance grows.
    pub stable: bool,
    /// Largest growth rate.
    pub growth_rate: f64,
    /// The rightmost growth rates.
    pub growth_rates: Vec<Rate>,
    /// Activities at which the branch turned back before it came here.
    pub folds_passed: Vec<f64>,
}

impl StationaryReport {
    /// Of a shape and its spectrum.
    pub fn new(shape: &StationaryShape, spectrum: &Spectrum) -> StationaryReport {
        let name = |parity| match parity {
            Parity::Even => "even",
            Parity::Odd => "odd",
            Parity::Mixed => "mixed",
        };
        StationaryReport {
            L: shape.length(),
            p: shape.pressure(),
            H: shape.elongation(),
            r_eq: shape.equator_radius(),
            stable: spectrum.is_stable(),
            growth_rate: spectrum.growth_rate(),
            growth_rates: spectrum.values.iter().map(|v| Rate { re: v.re, im: v.im, parity: name(v.parity) }).collect(),
            folds_passed: shape.folds.clone(),
        }
    }
}

/// A pitchfork by itself.
#[derive(Clone, Debug, Serialize)]
pub struct ThresholdReport {
    /// Threshold ξ_s*.
    pub xi_s: f64,
    /// Whether the asymmetric shapes are stable at first.
    pub criticality: Criticality,
    /// c of ξ_s = ξ_s* + c (u_furrow − ½)² along the asymmetric branch; positive: supercritical.
    pub coefficient: f64,
    /// Elongation, in R0.
    pub H: f64,
    /// Contour length.
    pub L: f64,
    /// Pressure.
    pub p: f64,
    /// Size of the last Newton correction.
    pub residual: f64,
    /// Newton iterations that located it.
    pub iterations: usize,
}

impl ThresholdReport {
    /// Of a pitchfork.
    pub fn new(found: &Pitchfork) -> ThresholdReport {
        ThresholdReport {
            xi_s: found.point.xi_s,
            criticality: found.criticality(),
            coefficient: found.coefficient,
            H: found.point.elongation,
            L: found.point.length,
            p: found.point.pressure,
            residual: found.report.correction,
            iterations: found.report.iterations,
        }
    }
}

/// A fold or a pitchfork on a branch.
#[derive(Clone, Debug, Serialize)]
pub struct EventReport {
    /// Which of the two.
    pub kind: PointKind,
    /// Name of the branch.
    pub branch: &'static str,
    /// Activity.
    pub xi_s: f64,
    /// Elongation, in R0.
    pub H: f64,
    /// Contour length.
    pub L: f64,
    /// Of pitchforks, see [`ThresholdReport::criticality`].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub criticality: Option<Criticality>,
    /// Of pitchforks, see [`ThresholdReport::coefficient`].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub coefficient: Option<f64>,
    /// Of folds: whether ξ_s is largest here along the branch.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub maximum: Option<bool>,
}

impl EventReport {
    /// Of an event on the branch of this name.
    pub fn new(branch: &'static str, event: &BranchEvent) -> EventReport {
        let (point, pitchfork) = (event.point(), event.pitchfork());
        EventReport {
            kind: event.kind(),
            branch,
            xi_s: point.xi_s,
            H: point.elongation,
            L: point.length,
            criticality: pitchfork.map(|p| p.criticality()),
            coefficient: pitchfork.map(|p| p.coefficient),
            maximum: event.fold().map(|fold| fold.maximum),
        }
    }
}
