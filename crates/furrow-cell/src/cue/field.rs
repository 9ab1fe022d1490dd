//! Which field of the cortex a term of a cue modulates.
//!
//! A new field is one variant here with its name, and its place in `LocalCoefficients`, where the
//! equations take their coefficients from.

/// A coefficient of the equations that a cue can modulate.
///
/// X(u) = X0·(1 + Σ A f(u)) for every field but tension, which is added to: γ(u) = γ0 + Σ A f(u).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
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
    pub const ALL: [Field; 9] = [
        Field::Kappa,
        Field::Activity,
        Field::XiS,
        Field::XiB,
        Field::EtaB,
        Field::EtaS,
        Field::Viscosity,
        Field::Friction,
        Field::Tension,
    ];

    /// Its name on the command line and in files.
    pub const fn name(self) -> &'static str {
        match self {
            Field::Kappa => "kappa",
            Field::Activity => "activity",
            Field::XiS => "xi_s",
            Field::XiB => "xi_b",
            Field::EtaB => "eta_b",
            Field::EtaS => "eta_s",
            Field::Viscosity => "viscosity",
            Field::Friction => "friction",
            Field::Tension => "tension",
        }
    }

    /// The coefficients of the equations that it modulates, named by their own fields.
    pub const fn coefficients(self) -> &'static [Field] {
        match self {
            Field::Kappa => &[Field::Kappa],
            Field::Activity => &[Field::XiS, Field::XiB],
            Field::XiS => &[Field::XiS],
            Field::XiB => &[Field::XiB],
            Field::EtaB => &[Field::EtaB],
            Field::EtaS => &[Field::EtaS],
            Field::Viscosity => &[Field::EtaB, Field::EtaS],
            Field::Friction => &[Field::Friction],
            Field::Tension => &[Field::Tension],
        }
    }

    /// Coefficients that have to stay above zero everywhere.
    pub const POSITIVE: [Field; 4] = [Field::Kappa, Field::EtaB, Field::EtaS, Field::Friction];
}
