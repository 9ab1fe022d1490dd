//! A dividing cell and its parameters.
//!
//! | type | role |
//! |---|---|
//! | [`Cell`] | one cell: R0, ε, ξ_s and a [`Cue`], in a [`Material`] and a [`Shell`] |
//! | [`Material`] | the constants of the cortex: rigidity, viscosities, friction, tension, ratio and gain of activities |
//! | [`Shell`] | the constants of the ellipsoidal shell that confines it |
//! | [`ShellProfile`] | a shell of another profile than the ellipsoid, from a table of r over z |
//! | [`Cue`] | a polarity cue: a sum of [`cue::Term`]s, each a field, a profile and an amplitude, and a [`cue::Regulator`] that flow carries |
//! | [`Law`] | a user-defined law of active stress |
//! | [`Parameter`] | a scalar of a cell by its name, which can be read, set, varied or fitted |
//! | [`Numerics`] | settings of the discretisation |

pub mod cue;
pub mod law;
pub mod material;
pub mod numerics;
pub mod parameter;
pub mod profile;
pub mod settings;
mod value;

pub use cue::{Cue, CueError};
pub use law::Law;
pub use material::{Material, RigidityGradient, Shell};
pub use numerics::{Numerics, Scheme};
pub use parameter::Parameter;
pub use profile::{ShellChoice, ShellProfile};
pub use settings::Settings;

use num_dual::DualNum;
use serde::{Deserialize, Serialize};

/// Number types in which the model can be evaluated: plain numbers, or numbers with derivatives.
pub trait Number: DualNum<Primitive = f64> + Copy {}

impl<D: DualNum<Primitive = f64> + Copy> Number for D {}

/// Radius R0 of the published zygote, in L_h.
pub const ZYGOTE: f64 = 5.4;

/// Allowed radii of cells, in L_h. Outside this range no solutions are found, and volumes suffer from rounding or overflow.
pub const SIZES: std::ops::RangeInclusive<f64> = 1e-6..=1e6;

/// One cell, in the units L_h = √(η_b/Γ) (length), κ0 (energy) and τ = η_b L_h²/κ0 (time).
///
/// It contains everything on which its mechanics depends, so equal cells divide equally. Values are checked when they are read from
/// user input; a `Cell` constructed in code is not checked.
///
/// ```
/// use furrow_cell::Cell;
///
/// let zygote = Cell::new(5.4).with_cue("activity:step,u0=0.4,omega=0.1,amplitude=0.2".parse()?);
/// assert_eq!((zygote.epsilon, zygote.xi_s), (0.87, 25.0));
/// assert!(!zygote.is_mirror_symmetric());
/// assert!(Cell { xi_s: 20.0, ..Cell::new(2.0) }.is_mirror_symmetric());
/// # Ok::<(), furrow_cell::CueError>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Cell {
    /// Radius R0 of the sphere with the cell's volume, in L_h.
    pub r0: f64,
    /// Volume of the cell divided by the volume of its shell, ε.
    pub epsilon: f64,
    /// Anisotropic activity ξ_s, as published (before the gain), in κ0/L_h.
    pub xi_s: f64,
    /// Polarity cue.
    pub cue: Cue,
    /// Constants of the cortex.
    pub material: Material,
    /// Constants of the shell.
    pub shell: Shell,
    /// The law of active stress; `None` is the paper's.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub law: Option<Box<Law>>,
    /// The profile of the shell; `None` is an ellipsoid.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub shell_profile: Option<Box<ShellProfile>>,
}

impl Cell {
    /// A cell of radius `r0` without a cue, with the preset's confinement ε = 0.87, activity ξ_s = 25, material and shell.
    pub const fn new(r0: f64) -> Cell {
        let (material, shell) = (Material::GAO2026, Shell::GAO2026);
        Cell { r0, epsilon: 0.87, xi_s: 25.0, cue: Cue::none(), material, shell, law: None, shell_profile: None }
    }

    /// The same for the preset `gao2026-thresholds`.
    pub const fn gao2026_thresholds(r0: f64) -> Cell {
        let (material, shell) = (Material::GAO2026_THRESHOLDS, Shell::GAO2026_THRESHOLDS);
        Cell { r0, epsilon: 0.87, xi_s: 25.0, cue: Cue::none(), material, shell, law: None, shell_profile: None }
    }

    /// The same cell with a cue.
    pub fn with_cue(self, cue: Cue) -> Cell {
        Cell { cue, ..self }
    }

    /// The same cell in a shell of another profile, with the aspect ratio of its table.
    pub fn with_shell_profile(mut self, profile: ShellProfile) -> Cell {
        ShellChoice::Profile(Box::new(profile)).apply(&mut self);
        self
    }

    /// Whether the poles are equivalent: its shell is mirror-symmetric, and its cue and its law, if any, are even about
    /// u = ½.
    pub fn is_mirror_symmetric(&self) -> bool {
        self.has_even_shell()
            && self.law.as_ref().is_none_or(|law| law.is_mirror_symmetric(self))
            && self.cue.is_even_for(self.law_reads_regulator())
    }

    /// Whether its shell is mirror-symmetric. If not, neither is the passive cell.
    pub fn has_even_shell(&self) -> bool {
        self.shell_profile.as_ref().is_none_or(|profile| profile.is_mirror_symmetric())
    }

    /// Whether its shell and its cue are axisymmetric about the axis of division.
    pub fn has_axis(&self) -> bool {
        self.shell.flattening == 1.0 && !self.cue.is_one_sided()
    }

    /// The mirror image of the cell under u → 1 − u.
    pub fn mirrored(&self) -> Cell {
        let law = self.law.as_ref().map(|law| Box::new(law.mirrored()));
        let shell_profile = self.shell_profile.as_ref().map(|profile| Box::new(profile.mirrored()));
        Cell { cue: self.cue.mirrored(), law, shell_profile, ..self.clone() }
    }

    /// The same cell without activity and without a cue, from which every division starts.
    pub fn passive(&self) -> Cell {
        Cell { xi_s: 0.0, cue: Cue::none(), ..self.clone() }
    }

    /// The cell's cue with the fewest terms: as [`Cue::simplified`], but a regulator that the cell's law uses is always kept.
    pub fn simplified_cue(&self) -> Cue {
        self.cue.simplified_for(self.law_reads_regulator())
    }

    /// Volume 4πR0³/3, in L_h³.
    pub fn volume(&self) -> f64 {
        4.0 / 3.0 * std::f64::consts::PI * self.r0.powi(3)
    }
}
