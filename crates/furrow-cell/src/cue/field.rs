//! The fields of the cortex that a term of a cue can modulate.
//!
//! A new field needs a variant with its name here, and a place in `LocalCoefficients`, which provides the coefficients of the
//! equations.

/// A coefficient of the equations that a cue can modulate.
///
/// X(u) = X0·(1 + Σ A f(u)) for every field except tension, for which γ(u) = γ0 + Σ A f(u).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Field {
    /// Bending rigidity κ.
    Kappa,
    /// Activity: both ξ_s and ξ_b.
    Activity,
    /// Only the anisotropic activity ξ_s.
    XiS,
    /// Only the isotropic activity ξ_b.
    XiB,
    /// Bulk viscosity η_b.
    EtaB,
    /// Shear viscosity η_s.
    EtaS,
    /// Viscosity: both η_b and η_s.
    Viscosity,
    /// Friction Γ.
    Friction,
    /// Tension γ, to which A f(u) is added, A in κ0/L_h².
    Tension,
}

impl Field {
    /// Every field.
    pub const ALL: [Field; 9] = {
        use Field::*;
        [Kappa, Activity, XiS, XiB, EtaB, EtaS, Viscosity, Friction, Tension]
    };

    /// Coefficients that must be positive everywhere.
    pub const POSITIVE: [Field; 4] = [Field::Kappa, Field::EtaB, Field::EtaS, Field::Friction];

    /// Its name on the command line and in files.
    pub const fn name(self) -> &'static str {
        const NAMES: [&str; 9] =
            ["kappa", "activity", "xi_s", "xi_b", "eta_b", "eta_s", "viscosity", "friction", "tension"];
        NAMES[self as usize]
    }

    /// Whether it modulates the coefficient of the equations that is denoted by the given field.
    pub fn modulates(self, coefficient: Field) -> bool {
        match self {
            Field::Activity => matches!(coefficient, Field::XiS | Field::XiB),
            Field::Viscosity => matches!(coefficient, Field::EtaB | Field::EtaS),
            own => own == coefficient,
        }
    }
}
