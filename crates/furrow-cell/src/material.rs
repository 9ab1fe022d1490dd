//! Constants of the cortex and of the shell, with the published preset.

use serde::{Deserialize, Serialize};

/// The treatment of a varying bending rigidity κ(u) in the tangential force balance.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum RigidityGradient {
    /// The full force balance: the term ½(C − C0)²∂_sκ is kept.
    Full,
    /// The paper's formulation: κ is attached to the mesh and the term is omitted.
    Dropped,
}

/// Constants of the cortex, in κ0, L_h and τ. Published values (Table S3) except the gain, which is chosen with the shell.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Material {
    /// Bending rigidity κ, in κ0.
    pub kappa: f64,
    /// Bulk (area) viscosity η_b.
    pub eta_b: f64,
    /// Shear viscosity η_s.
    pub eta_s: f64,
    /// Friction Γ with the surroundings, tangential only.
    pub friction: f64,
    /// Passive tension γ, in κ0/L_h².
    pub tension: f64,
    /// Ratio ξ_b/ξ_s of isotropic to anisotropic activity, constant when ξ_s varies.
    pub xi_ratio: f64,
    /// Activity gain g: the published ξ enters the force balance as gξ.
    pub gain: f64,
    /// The treatment of a varying κ in the tangential balance.
    pub rigidity_gradient: RigidityGradient,
    /// Spontaneous curvature C0, in 1/L_h: the bending energy is ½κ(C − C0)² per area.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub spontaneous_curvature: f64,
    /// Friction Γ_n with the surroundings against motion along the normal, in the unit of Γ.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub normal_friction: f64,
}

fn is_zero(value: &f64) -> bool {
    *value == 0.0
}

impl Material {
    /// The preset `gao2026`: published values, and the gain fitted together with its shell.
    pub const GAO2026: Material = Material {
        kappa: 1.0,
        eta_b: 1.0,
        eta_s: 1.0,
        friction: 1.0,
        tension: 0.0,
        xi_ratio: -0.1,
        gain: 0.4826,
        rigidity_gradient: RigidityGradient::Full,
        spontaneous_curvature: 0.0,
        normal_friction: 0.0,
    };
    /// The preset `gao2026-thresholds`: a gain of ½.
    pub const GAO2026_THRESHOLDS: Material = Material { gain: 0.5, ..Material::GAO2026 };
}

/// Constants of the ellipsoidal shell. The paper does not give them; the presets choose them to satisfy the paper's statements.
///
/// Its half axes are a√(1/f) along the axis of division, b√(1/f) and bf across it, f the flattening, with the same volume for all f.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Shell {
    /// Aspect ratio a/b, a along the axis of division.
    pub aspect: f64,
    /// Strength p0 of its repulsion.
    pub p0: f64,
    /// Width w of its repulsion, relative to the shell.
    pub w: f64,
    /// Thickness of the shell between two plates, relative to the round shell of the same volume; 1 without plates. The plates
    /// are parallel to the axis of division.
    #[serde(rename = "shell_flattening", default = "round", skip_serializing_if = "is_round")]
    pub flattening: f64,
}

fn round() -> f64 {
    1.0
}

fn is_round(flattening: &f64) -> bool {
    *flattening == 1.0
}

impl Shell {
    /// The preset `gao2026`, which satisfies the statements of the paper used in the fit, with thresholds within 1 %.
    pub const GAO2026: Shell = Shell { aspect: 1.505, p0: 0.1, w: 0.138, flattening: 1.0 };
    /// The preset `gao2026-thresholds`, which meets the four printed thresholds within 0.3 %.
    pub const GAO2026_THRESHOLDS: Shell = Shell { aspect: 1.5, p0: 0.123, w: 0.1445, flattening: 1.0 };
}
