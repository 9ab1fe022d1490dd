//! How a division ended.

use furrow_bvp::{NewtonError, Work};
use serde::{Deserialize, Serialize};

use crate::equilibria::error::CellName;

/// How a division ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Outcome {
    /// Divided into daughters of equal volume (|χ| below the documented tolerance).
    Symmetric,
    /// Divided into unequal daughters.
    Asymmetric,
    /// Came to rest in a stable, undivided shape.
    Failed,
}

impl Outcome {
    /// Its name in files and answers.
    pub fn name(self) -> &'static str {
        match self {
            Outcome::Symmetric => "symmetric",
            Outcome::Asymmetric => "asymmetric",
            Outcome::Failed => "failed",
        }
    }
}

impl std::fmt::Display for Outcome {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.name())
    }
}

/// The outcome of one division and the work it took: the one record of it, in the memo, the store, the tree and answers.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Division {
    /// How it ended.
    pub outcome: Outcome,
    /// Size asymmetry χ = |V1 − V2|/V; absent if failed.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub chi: Option<f64>,
    /// (V_above − V_below)/V of the daughters from u above and below the furrow: positive when the daughter at the pole
    /// u = 0 is the smaller.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub chi_signed: Option<f64>,
    /// Furrow position in arclength fraction from the pole u = 0; absent if failed.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub u_furrow: Option<f64>,
    /// Time of pinch-off, or the time at which the shape was found at rest, in τ.
    pub t_end: f64,
    /// Radii R0 of the daughters from u below and above the furrow, in L_h; absent if failed.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub daughters: Option<[f64; 2]>,
    /// Leading growth rate of the final state where the outcome is `failed`, in 1/τ: negative, stable, except where the
    /// published scheme rests at a shape that grows.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub growth_rate: Option<f64>,
    /// For a cell just above the threshold of division: growth rate σ of the stationary shape at which it waited for longer
    /// than `t_max` allows, in 1/τ. The wait, ln(amplitude after/amplitude before)/σ, is in `t_end`.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub slow_growth_rate: Option<f64>,
    /// Largest relative deviation of the cell volume over the whole division.
    pub volume_drift: f64,
    /// Work it took.
    #[serde(flatten)]
    pub work: Work,
}

impl Division {
    /// Volumes of the daughters from u below and above the furrow, as parts of the mother's; none if it did not divide.
    /// Equal to the last bit where the division is symmetric.
    pub fn shares(&self) -> Option<[f64; 2]> {
        let below = match self.outcome {
            Outcome::Symmetric => 0.5,
            Outcome::Asymmetric => 0.5 * (1.0 - self.chi_signed.or(self.chi)?),
            Outcome::Failed => return None,
        };
        Some([below, 1.0 - below])
    }

    /// The mirror image of the division under u → 1 − u: the division of the mirrored cell.
    pub fn mirrored(&self) -> Division {
        Division {
            chi_signed: self.chi_signed.map(|chi| -chi),
            u_furrow: self.u_furrow.map(|u| 1.0 - u),
            daughters: self.daughters.map(|[below, above]| [above, below]),
            ..self.clone()
        }
    }

    /// The same division with the daughters' radii of a mother of radius `r0`, M.25.
    pub fn with_daughters_of(mut self, r0: f64) -> Division {
        self.daughters = self.shares().map(|shares| shares.map(|share| r0 * share.cbrt()));
        self
    }
}

/// What stopped the time stepping.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum StepFailure {
    /// The equations of a step could not be solved.
    #[error(transparent)]
    Newton(#[from] NewtonError),
    /// Every step was solved, none accurately enough.
    #[error("the local error stays above its tolerance")]
    Inaccurate,
}

/// Why a division could not be computed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum DivisionError {
    /// An input is outside its domain.
    #[error("{field} = {value}: {allowed}")]
    BadInput {
        /// Name of the field.
        field: &'static str,
        /// Its value.
        value: f64,
        /// What is allowed.
        allowed: &'static str,
    },
    /// The passive shape was not found.
    #[error("no passive shape found for {cell} ({source}); {}", cell.advice())]
    NoPassiveShape {
        /// The cell.
        cell: CellName,
        /// What the solver said.
        source: NewtonError,
    },
    /// The shape to start from is not stationary on the mesh of the division.
    #[error("the stationary shape of {cell} is none on the mesh of its division ({source}); try more mesh intervals")]
    NotStationary {
        /// The cell.
        cell: CellName,
        /// What the solver said.
        source: NewtonError,
    },
    /// The time step fell below its minimum.
    #[error(
        "time stepping of the cell with R0 = {r0} stalled at t = {t:.3e} with step {dt:.1e} ({source}); {}",
        advice_on_steps(*r0)
    )]
    Stalled {
        /// Radius R0.
        r0: f64,
        /// Time reached, in τ.
        t: f64,
        /// Last step tried, in τ.
        dt: f64,
        /// What stopped it.
        source: StepFailure,
    },
    /// The cell is too near the threshold of division for its outcome to be told.
    #[error(
        "the cell with R0 = {r0} is at the threshold of division: what grows at {growth_rate:.1e}/τ from its stationary shape leads nowhere; change R0, epsilon or xi_s in the seventh digit"
    )]
    Critical {
        /// Radius R0.
        r0: f64,
        /// Growth rate of the stationary shape, in 1/τ.
        growth_rate: f64,
    },
    /// The cell oscillates: no stationary shape near it is stable, and none of what grows divides it.
    #[error(
        "the cell with R0 = {r0} oscillates with a period of {period:.3} τ: it neither divides nor comes to rest; change R0, epsilon or xi_s by a percent"
    )]
    Oscillates {
        /// Radius R0.
        r0: f64,
        /// The period, in τ.
        period: f64,
    },
    /// The cell moves on without ever repeating itself.
    #[error(
        "the cell with R0 = {r0} still moves at t = {t:.3} τ, after {steps} steps: it neither divides, nor rests, nor repeats itself; lower xi_s or the cue's amplitude"
    )]
    Restless {
        /// Radius R0.
        r0: f64,
        /// Time reached, in τ.
        t: f64,
        /// Steps done.
        steps: usize,
    },
    /// The cell neither divided nor came to rest in the time allowed.
    #[error("the cell with R0 = {r0} neither divided nor came to rest within t = {t_max}; {}", advice_on_rest(*epsilon))]
    Undecided {
        /// Radius R0.
        r0: f64,
        /// Volume fraction ε.
        epsilon: f64,
        /// The limit, in τ.
        t_max: f64,
    },
}

/// Larger cells than this were not found to divide.
const LARGEST: f64 = 100.0;

/// What helps where a time step cannot be solved.
fn advice_on_steps(r0: f64) -> &'static str {
    if r0 > LARGEST {
        "divisions are found of cells of R0 up to 100"
    } else {
        "try more mesh intervals, a larger time_tolerance or a larger step_factor"
    }
}

/// Below this volume fraction the shell may be so wide that its force at the cell is less than rounding.
const WIDE_SHELL: f64 = 0.3;

/// What helps where a cell is not found to be at rest.
fn advice_on_rest(epsilon: f64) -> &'static str {
    if epsilon < WIDE_SHELL {
        "raise epsilon to 0.3: in a shell as wide as this nothing holds the cell in its place"
    } else {
        "raise t_max, or try more mesh intervals"
    }
}
