//! How a division ended.

use serde::{Deserialize, Serialize};

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

/// The outcome of one division and the work it took.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Division {
    /// How it ended.
    pub outcome: Outcome,
    /// Size asymmetry χ = |V1 − V2|/V; absent if failed.
    pub chi: Option<f64>,
    /// (V_posterior − V_anterior)/V: positive when the anterior side (u below the furrow) is the smaller.
    pub chi_signed: Option<f64>,
    /// Furrow position in arclength fraction from the anterior pole; absent if failed.
    pub u_furrow: Option<f64>,
    /// Time of pinch-off, or the time at which the shape was found at rest, in τ.
    pub t_end: f64,
    /// Radii R0 of the anterior and the posterior daughter; absent if failed.
    pub daughters: Option<[f64; 2]>,
    /// Leading growth rate of the final state where the outcome is `failed` (negative: stable), in 1/τ.
    pub growth_rate: Option<f64>,
    /// Largest relative deviation of the cell volume over the whole division.
    pub volume_drift: f64,
    /// Accepted time steps.
    pub steps: u32,
    /// Rejected time steps.
    pub rejected: u32,
    /// Newton iterations, counting every linear solve.
    pub newton_iterations: u32,
    /// Factorisations of the Jacobian.
    pub factorisations: u32,
    /// Times the mesh was moved.
    pub remeshings: u32,
}

/// Why a division could not be computed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
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
    #[error("no passive shape found for R0 = {r0}, epsilon = {epsilon} ({reason}); try more mesh intervals")]
    NoPassiveShape {
        /// Radius R0.
        r0: f64,
        /// Confinement ε.
        epsilon: f64,
        /// What the solver said.
        reason: String,
    },
    /// The time step fell below its minimum.
    #[error(
        "time stepping of the cell with R0 = {r0} stalled at t = {t} with step {dt} ({reason}); try more mesh intervals or a smaller time tolerance"
    )]
    Stalled {
        /// Radius R0.
        r0: f64,
        /// Time reached, in τ.
        t: f64,
        /// Last step tried, in τ.
        dt: f64,
        /// What the solver said.
        reason: String,
    },
    /// The cell neither divided nor came to rest in the time allowed.
    #[error("the cell with R0 = {r0} neither divided nor came to rest within t = {t_max}; raise t_max")]
    Undecided {
        /// Radius R0.
        r0: f64,
        /// The limit, in τ.
        t_max: f64,
    },
}
