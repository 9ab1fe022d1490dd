//! Physical and numerical parameters, with the published preset.

use serde::{Deserialize, Serialize};

/// How a varying bending rigidity κ(u) enters the tangential force balance.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum RigidityGradient {
    /// The full force balance: the term ½C²∂_sκ is kept.
    Full,
    /// The paper's reading: κ is attached to the mesh and the term is dropped.
    Dropped,
}

/// Physical parameters in the units κ0 (energy), L_h = √(η_b/Γ) (length), τ = η_b L_h²/κ0 (time).
///
/// Published values (Table S3) except the three shell constants and the gain, which are not printed in the paper and
/// were recovered from its four printed thresholds.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Physics {
    /// Bending rigidity κ, in κ0.
    pub kappa: f64,
    /// Bulk (area) viscosity η_b of the cortex.
    pub eta_b: f64,
    /// Shear viscosity η_s of the cortex.
    pub eta_s: f64,
    /// Friction Γ with the surroundings, tangential only.
    #[serde(alias = "Gamma")]
    pub friction: f64,
    /// Passive tension γ.
    #[serde(alias = "gamma")]
    pub tension: f64,
    /// Anisotropic activity ξ_s, as published (before the gain), in κ0/L_h.
    #[serde(alias = "xi")]
    pub xi_s: f64,
    /// Ratio ξ_b/ξ_s of isotropic to anisotropic activity, held fixed when ξ_s varies.
    pub xi_ratio: f64,
    /// Activity gain g: the published ξ enters the force balance as gξ.
    #[serde(alias = "g")]
    pub gain: f64,
    /// Aspect ratio a/b of the shell (a along the axis).
    #[serde(alias = "a_over_b")]
    pub aspect: f64,
    /// Strength P0 of the shell's repulsion.
    #[serde(alias = "P0")]
    pub p0: f64,
    /// Width w of the shell's repulsion, relative to the shell.
    pub w: f64,
    /// Radius of the sphere with the volume of the first cell (P0), in L_h.
    pub r0: f64,
    /// Volume of the cell over the volume of its shell, ε.
    #[serde(alias = "eps")]
    pub epsilon: f64,
    /// How a varying κ enters the tangential balance.
    pub rigidity_gradient: RigidityGradient,
}

impl Physics {
    /// The preset `gao2026`: published values with the recovered shell constants a/b = 1.5, P0 = 0.123, w = 0.1445 and
    /// gain ½.
    pub const GAO2026: Physics = Physics {
        kappa: 1.0,
        eta_b: 1.0,
        eta_s: 1.0,
        friction: 1.0,
        tension: 0.0,
        xi_s: 25.0,
        xi_ratio: -0.1,
        gain: 0.5,
        aspect: 1.5,
        p0: 0.123,
        w: 0.1445,
        r0: 5.4,
        epsilon: 0.87,
        rigidity_gradient: RigidityGradient::Full,
    };
}

impl Default for Physics {
    fn default() -> Self {
        Self::GAO2026
    }
}

/// Settings of the discretisation. The defaults are what every published number of furrow is computed with.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Numerics {
    /// Gauss points per mesh interval, 1 to 5.
    pub stages: usize,
    /// Mesh intervals of the full domain u ∈ [0, 1] (even; half of them on the mirror-symmetric half).
    pub intervals: usize,
    /// Local error allowed per time step.
    pub time_tolerance: f64,
    /// Factor on every time step after error control (0.5 halves all of them).
    pub step_factor: f64,
    /// Largest time, in τ, one division may take before it is reported as undecided.
    pub t_max: f64,
    /// A division with |χ| below this is symmetric and its daughters are equal.
    pub chi_symmetric: f64,
}

impl Default for Numerics {
    fn default() -> Self {
        Numerics {
            stages: 4,
            intervals: 48,
            time_tolerance: 5e-5,
            step_factor: 1.0,
            t_max: 10_000.0,
            chi_symmetric: 5e-3,
        }
    }
}
