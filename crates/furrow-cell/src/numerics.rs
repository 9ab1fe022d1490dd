//! Settings of the discretisation.

use serde::{Deserialize, Serialize};

/// The time-stepping scheme of a division.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Scheme {
    /// A high-order scheme with error control that includes the growing modes.
    #[default]
    Converged,
    /// Backward Euler with a fixed step after a short start, as in the paper. At 0.1 τ it damps growing modes of large
    /// cells, and a shape with a growth rate above 2/Δt becomes an attractor.
    Published,
}

/// Settings of the discretisation. All published numbers of furrow are computed with the defaults.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Numerics {
    /// Gauss points per mesh interval, 1 to 5.
    pub stages: usize,
    /// Mesh intervals of the full domain u ∈ [0, 1] (even; half of them on the mirror-symmetric half).
    pub intervals: usize,
    /// The time-stepping scheme.
    pub scheme: Scheme,
    /// Fixed step Δt of the published scheme, in τ; steps are shorter if the neck closes faster. The noise lasts for the first
    /// step. The converged scheme does not use it.
    pub dt: f64,
    /// Length of the converged scheme's first step, in τ, during which the noise acts.
    pub first_step: f64,
    /// Allowed local error per time step.
    pub time_tolerance: f64,
    /// Factor on every time step after error control (0.5 halves all of them).
    pub step_factor: f64,
    /// Longest time, in τ, before a division is reported as undecided.
    pub t_max: f64,
    /// Largest coefficient of the noise in the first step. With 0, rounding errors determine the side of an asymmetric division
    /// without a cue.
    pub noise: f64,
    /// Correlation time of the noise, in τ, if it lasts for the whole division; 0 for noise only in the first step,
    /// as in the paper.
    pub noise_time: f64,
    /// A division with |χ| below this is symmetric and its daughters are equal.
    pub chi_symmetric: f64,
    /// Largest azimuthal mode number m of the shape; 0 selects the axisymmetric solver. The shape starts with fewer modes
    /// and uses more as needed.
    pub modes: usize,
    /// Number of elements from pole to pole of a cell without axial symmetry.
    pub elements: usize,
    /// Whether the walls of a furrow of a cell without axial symmetry touch; otherwise they pass through each other.
    pub contact: bool,
}

impl Numerics {
    /// Fewest mesh intervals of a division. Within this limit, cells of R0 from 1.6 to 5.4, with and without a cue, were found to divide
    /// or to come to rest as with the default numerics.
    pub fn least_intervals(&self) -> usize {
        [160, 64, 32].get(self.stages.saturating_sub(1)).copied().unwrap_or(16)
    }

    /// Smallest time tolerance of a division. The error of a full step is estimated from a shortened one, which magnifies rounding
    /// errors; the sixth power was found empirically.
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
