//! Which field of the cortex a term of a cue modulates.
//!
//! A new field is one variant here with its name, and its place in `LocalCoefficients`, where the
//! equations take their coefficients from.

/// A coefficient of the equations that a cue can modulate.
///
/// X(u) = X0·(1 + Σ A f(u)) for every field but tension, which is added to: γ(u) = γ0 + Σ A f(u).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Field {
    /// Bending rigidity κ.
    Kappa,
    /// Activity: ξ_s and ξ_b alike.
    Activity,
    /// Anisotropic activity ξ_s alone.
    XiS,
    /// Isotropic activity ξ_b alone.
    XiB,
    /// Bulk viscosity η_b.
    EtaB,
    /// Shear viscosity η_s.
    EtaS,
    /// Viscosity: η_b and η_s alike.
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

    /// Coefficients that have to stay above zero everywhere.
    pub const POSITIVE: [Field; 4] = [Field::Kappa, Field::EtaB, Field::EtaS, Field::Friction];

    /// Its name on the command line and in files.
    pub const fn name(self) -> &'static str {
        const NAMES: [&str; 9] =
            ["kappa", "activity", "xi_s", "xi_b", "eta_b", "eta_s", "viscosity", "friction", "tension"];
        NAMES[self as usize]
    }

    /// Whether it modulates a coefficient of the equations, which is named by its own field.
    pub fn modulates(self, coefficient: Field) -> bool {
        match self {
            Field::Activity => matches!(coefficient, Field::XiS | Field::XiB),
            Field::Viscosity => matches!(coefficient, Field::EtaB | Field::EtaS),
            own => own == coefficient,
        }
    }
}
