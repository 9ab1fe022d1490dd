//! Settings of the discretisation.

use serde::{Deserialize, Serialize};

/// How a division is stepped in time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Scheme {
    /// Steps of high order with error control, which includes the growing modes.
    #[default]
    Converged,
    /// Backward Euler at a fixed step after a short start, the paper's kind of step. At 0.1 τ it damps growing modes of large
    /// cells, and a shape that grows at more than 2/Δt is an attractor.
    Published,
}

/// Settings of the discretisation. The defaults are what every published number of furrow is computed with.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Numerics {
    /// Gauss points per mesh interval, 1 to 5.
    pub stages: usize,
    /// Mesh intervals of the full domain u ∈ [0, 1] (even; half of them on the mirror-symmetric half).
    pub intervals: usize,
    /// How time is stepped.
    pub scheme: Scheme,
    /// Fixed step Δt of the published scheme, in τ; steps follow the neck where that closes faster. The noise lasts for the
    /// first. The converged scheme does not use it.
    pub dt: f64,
    /// Length of the converged scheme's first step, in τ; the noise lasts for it.
    pub first_step: f64,
    /// Local error allowed per time step.
    pub time_tolerance: f64,
    /// Factor on every time step after error control (0.5 halves all of them).
    pub step_factor: f64,
    /// Largest time, in τ, one division may take before it is reported as undecided.
    pub t_max: f64,
    /// Largest coefficient of the noise in the first step. With 0, rounding decides the side of an asymmetric division without
    /// a cue.
    pub noise: f64,
    /// Correlation time of the noise, in τ, if it lasts for the whole division; 0 for noise in the first step alone,
    /// as in the paper.
    pub noise_time: f64,
    /// A division with |χ| below this is symmetric and its daughters are equal.
    pub chi_symmetric: f64,
    /// Largest azimuthal number m of the shape; 0 keeps the axial symmetry, which is another solver. The shape begins with fewer,
    /// and takes more as it needs them.
    pub modes: usize,
    /// Elements from pole to pole of a cell without axial symmetry.
    pub elements: usize,
    /// Whether the walls of a furrow of a cell without axial symmetry touch; otherwise they pass through each other.
    pub contact: bool,
}

impl Numerics {
    /// Least tolerance in time of a division. The error of a full step is estimated from a shortened one, which magnifies rounding;
    /// the sixth power was found by trial.
    pub fn least_time_tolerance(&self) -> f64 {
        1e-9 * (0.5 / self.step_factor).powi(6)
    }
}

impl Default for Numerics {
    fn default() -> Self {
        Numerics {
            stages: 4,
            intervals: 48,
            scheme: Scheme::Converged,
            dt: 0.1,
            first_step: 1e-3,
            time_tolerance: 1.6e-5,
            step_factor: 1.0,
            t_max: 10_000.0,
            noise: 0.01,
            noise_time: 0.0,
            chi_symmetric: 5e-3,
            modes: 0,
            elements: 44,
            contact: true,
        }
    }
}
