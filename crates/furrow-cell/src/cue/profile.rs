//! Profiles of terms of a cue along the contour.
//!
//! A new profile needs a variant here, with its formula and two derivatives, its quantities, its mirror image and its largest
//! slope. CONTRIBUTING.md lists the other files that name profiles.

use serde::{Deserialize, Serialize};

use super::{ParConstant, ParConstants};
use crate::Number;

/// Width of a profile.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Width<D = f64> {
    /// In the arclength fraction u; it scales with the cell.
    Fraction(D),
    /// In L_h; its size is fixed, and in u it is ω/L of the current contour.
    Length(D),
}

impl<D> Width<D> {
    /// The number in its own unit.
    pub fn value(self) -> D {
        match self {
            Width::Fraction(omega) | Width::Length(omega) => omega,
        }
    }

    /// The width with another number, in the same unit.
    pub fn map<E>(self, number: impl FnOnce(D) -> E) -> Width<E> {
        match self {
            Width::Fraction(omega) => Width::Fraction(number(omega)),
            Width::Length(omega) => Width::Length(number(omega)),
        }
    }
}

impl<D: Number> Width<D> {
    /// The width in u on a contour of length `length`.
    pub fn in_u(self, length: D) -> D {
        match self {
            Width::Fraction(omega) => omega,
            Width::Length(omega) => omega / length,
        }
    }
}

/// A profile f(u) along the contour, u from 0 to 1, M.17.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Profile<D = f64> {
    /// f = exp(−(u − u0)²/ω²).
    Band {
        /// Centre.
        u0: D,
        /// Width ω > 0.
        omega: Width<D>,
    },
    /// f = ½(1 + tanh((u − u0)/ω)): 0 below u0 and 1 above it; reversed for ω < 0.
    Step {
        /// Place.
        u0: D,
        /// Width ω ≠ 0.
        omega: Width<D>,
    },
    /// f = 1 − 2u, from 1 at u = 0 to −1 at u = 1.
    Gradient,
    /// The posterior antagonist of PAR polarity on the passive cell, with position and width computed for its size and shell; 0
    /// without polarity. `furrow_mechanics::polarity` replaces it by a step or a band; until then it is 0.
    Par {
        /// Whether it is a band at the edge of the posterior antagonist instead of a step that follows it.
        band: bool,
        /// Whether the posterior pole is at u = 1 instead of u = 0.
        far: bool,
        /// The constants of the chemistry.
        constants: ParConstants,
        /// L_h in µm, if it differs from [`LENGTH_UM`](super::LENGTH_UM).
        length_um: Option<f64>,
    },
}

/// A number of one term of a cue.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Quantity {
    /// Position u0 of the profile.
    U0,
    /// Its width ω, in u or in L_h, as in the term.
    Omega,
    /// Amplitude A.
    Amplitude,
    /// A constant of the PAR polarity that the profile follows.
    Par(ParConstant),
}

impl Quantity {
    /// Position, width and amplitude, without the constants of PAR polarity.
    pub const ALL: [Quantity; 3] = [Quantity::U0, Quantity::Omega, Quantity::Amplitude];

    /// Its name on the command line and in files.
    pub fn name(self) -> &'static str {
        match self {
            Quantity::U0 => "u0",
            Quantity::Omega => "omega",
            Quantity::Amplitude => "amplitude",
            Quantity::Par(constant) => constant.name(),
        }
    }

    /// The quantity with a given name.
    pub fn named(name: &str) -> Option<Quantity> {
        let par = || ParConstant::named(name).map(Quantity::Par);
        Quantity::ALL.into_iter().find(|quantity| quantity.name() == name).or_else(par)
    }
}

/// Smallest width of a profile, in u or in L_h; narrower ones would be lost in the rounding of u.
pub const NARROWEST: f64 = 1e-6;

/// Names of the profiles; the first is the default.
pub const NAMES: [&str; 5] = ["band", "step", "gradient", "par", "par_band"];

impl<D> Profile<D> {
    /// Its name on the command line and in files.
    pub fn name(&self) -> &'static str {
        match self {
            Profile::Band { .. } => NAMES[0],
            Profile::Step { .. } => NAMES[1],
            Profile::Gradient => NAMES[2],
            Profile::Par { band: false, .. } => NAMES[3],
            Profile::Par { band: true, .. } => NAMES[4],
        }
    }

    /// The same profile with converted numbers; the conversion also gets the quantity of each number.
    pub fn map<E>(self, mut number: impl FnMut(Quantity, D) -> E) -> Profile<E> {
        let mut both = |u0, omega: Width<D>| {
            let u0 = number(Quantity::U0, u0);
            (u0, omega.map(|omega| number(Quantity::Omega, omega)))
        };
        match self {
            Profile::Band { u0, omega } => {
                let (u0, omega) = both(u0, omega);
                Profile::Band { u0, omega }
            }
            Profile::Step { u0, omega } => {
                let (u0, omega) = both(u0, omega);
                Profile::Step { u0, omega }
            }
            Profile::Gradient => Profile::Gradient,
            Profile::Par { band, far, constants, length_um } => Profile::Par { band, far, constants, length_um },
        }
    }
}

/// Argument beyond which tanh is ±1 to the last digit, and quotients of hyperbolic sines would overflow.
const SATURATED: f64 = 20.0;

fn tanh<D: Number>(x: D) -> D {
    if x.re().abs() > SATURATED { D::from(x.re().signum()) } else { x.tanh() }
}

impl<D: Number> Profile<D> {
    /// f, ∂f/∂u and ∂²f/∂u² at u on a contour of length `length`.
    pub fn at(&self, u: f64, length: D) -> [D; 3] {
        match *self {
            Profile::Band { u0, omega } => {
                let inverse = omega.in_u(length).recip();
                let inverse = inverse * inverse;
                let d = -u0 + u;
                let f = (-(d * d * inverse)).exp();
                let slope = d * inverse * -2.0;
                [f, f * slope, f * (slope * slope - inverse * 2.0)]
            }
            Profile::Step { u0, omega } => {
                let inverse = omega.in_u(length).recip();
                let t = tanh((-u0 + u) * inverse);
                let bell = (-(t * t) + 1.0) * inverse;
                [t * 0.5 + 0.5, bell * 0.5, -(t * bell * inverse)]
            }
            Profile::Gradient => [D::from(1.0 - 2.0 * u), D::from(-2.0), D::from(0.0)],
            Profile::Par { .. } => [D::from(0.0); 3],
        }
    }
}

impl Profile {
    /// Its width, if it has one.
    pub fn width(&self) -> Option<Width> {
        match self {
            Profile::Band { omega, .. } | Profile::Step { omega, .. } => Some(*omega),
            Profile::Gradient | Profile::Par { .. } => None,
        }
    }

    /// The allowed widths, if its width is not allowed.
    pub(crate) fn refused_width(&self) -> Option<&'static str> {
        let omega = self.width()?.value();
        let (size, allowed) = match self {
            Profile::Step { .. } => (omega.abs(), "a finite number, 1e-6 or above, or -1e-6 or below for a step down"),
            _ => (omega, "a finite number, 1e-6 or above"),
        };
        (!(size.is_finite() && size >= NARROWEST)).then_some(allowed)
    }

    /// A number of the profile; `None` if it lacks this number.
    pub fn quantity(mut self, quantity: Quantity) -> Option<f64> {
        self.quantity_mut(quantity).copied()
    }

    /// Mutable access to such a number.
    pub(crate) fn quantity_mut(&mut self, quantity: Quantity) -> Option<&mut f64> {
        match (self, quantity) {
            (Profile::Band { u0, .. } | Profile::Step { u0, .. }, Quantity::U0) => Some(u0),
            (Profile::Band { omega, .. } | Profile::Step { omega, .. }, Quantity::Omega) => match omega {
                Width::Fraction(omega) | Width::Length(omega) => Some(omega),
            },
            (Profile::Par { constants, .. }, Quantity::Par(constant)) => constants.slot(constant),
            _ => None,
        }
    }

    /// The profile f(1 − u), and the sign of its amplitude.
    pub fn mirrored(&self) -> (Profile, f64) {
        match *self {
            Profile::Band { u0, omega } => (Profile::Band { u0: 1.0 - u0, omega }, 1.0),
            Profile::Step { u0, omega } => (Profile::Step { u0: 1.0 - u0, omega: omega.map(|omega| -omega) }, 1.0),
            Profile::Gradient => (Profile::Gradient, -1.0),
            Profile::Par { band, far, constants, length_um } => {
                (Profile::Par { band, far: !far, constants, length_um }, 1.0)
            }
        }
    }

    /// Largest |∂f/∂u| in [from, to] on a contour of length `length`, which the mesh must resolve; 0 for a
    /// linear profile, which any mesh resolves.
    pub fn steepest(&self, from: f64, to: f64, length: f64) -> f64 {
        let steep = match *self {
            Profile::Band { u0, omega } => {
                // |f′| is largest at u0 ± ω/√2.
                let shoulder = omega.in_u(length).abs() * std::f64::consts::FRAC_1_SQRT_2;
                [u0 - shoulder, u0 + shoulder]
            }
            Profile::Step { u0, .. } => [u0, u0],
            Profile::Gradient | Profile::Par { .. } => return 0.0,
        };
        let slope = |u: f64| self.at(u, length)[1].abs();
        steep.into_iter().filter(|u| (from..=to).contains(u)).chain([from, to]).map(slope).fold(0.0, f64::max)
    }

    /// The smallest and the largest value of f.
    pub fn range(&self) -> [f64; 2] {
        match self {
            Profile::Band { .. } | Profile::Step { .. } | Profile::Par { .. } => [0.0, 1.0],
            Profile::Gradient => [-1.0, 1.0],
        }
    }
}
