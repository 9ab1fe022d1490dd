//! Polarity cues.

use serde::{Deserialize, Serialize};

/// A polarity cue carried by a cell.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Cue {
    /// No cue: both poles alike.
    None,
    /// A band of stiffer cortex, κ(u) = κ·(1 + amplitude · exp(−(u − u0)²/omega²)). The published cue of the germline
    /// is u0 = 0.465, omega = 0.0577, amplitude = 0.1.
    Kappa {
        /// Centre of the band in arclength fraction from the anterior pole, in (0, 1).
        u0: f64,
        /// Width of the band in arclength fraction, positive.
        omega: f64,
        /// Relative stiffening Δκ at the centre, above −1.
        amplitude: f64,
    },
}
