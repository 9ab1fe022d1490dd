//! The one style of all pictures.
//!
//! Colours are those of Okabe & Ito (*Color universal design*, 2008), which are told apart with every common colour vision and
//! differ in lightness in print. An outcome has the same colour in every picture.

use crate::cell::Parameter;
use crate::division::Outcome;

/// Text, axes and the contours of cells.
pub const INK: &str = "#1a1a1a";
/// Text of second rank.
pub const MUTED: &str = "#555555";
/// Grids, frames and what lies behind.
pub const FAINT: &str = "#d9d9d9";
/// A division into equal daughters.
pub const SYMMETRIC: &str = "#0072b2";
/// A division into unequal daughters.
pub const ASYMMETRIC: &str = "#d55e00";
/// A cell that comes to rest undivided.
pub const FAILED: &str = "#999999";
/// What could not be decided.
pub const UNDECIDED: &str = "#f0e442";
/// What the model gives, beside what was observed.
pub const MODEL: &str = "#009e73";
/// What was observed.
pub const OBSERVED: &str = INK;
/// The cue.
pub const CUE: &str = "#e69f00";
/// The shell.
pub const SHELL: &str = "#8c8c8c";
/// The inside of a cell.
pub const CYTOPLASM: &str = "#eaf4fa";

/// Colours of curves that have no order and no meaning of their own.
pub const SERIES: [&str; 7] = ["#000000", "#e69f00", "#56b4e9", "#009e73", "#cc79a7", "#0072b2", "#d55e00"];

/// The normal forces, in the order of `NormalForces::parts`: name and colour.
pub const FORCES: [(&str, &str); 5] = [
    ("active", "#cc79a7"),
    ("viscous", "#56b4e9"),
    ("elastic", "#009e73"),
    ("pressure", "#1a1a1a"),
    ("shell", "#e69f00"),
];

/// Sizes of text, in the units of the canvas.
pub mod text {
    /// A picture's title.
    pub const TITLE: u32 = 20;
    /// Names of axes.
    pub const LABEL: u32 = 17;
    /// Numbers along axes, legends.
    pub const TICK: u32 = 15;
}

/// Width of curves.
pub const CURVE: f64 = 2.6;
/// Dashes and gaps of what is unstable.
pub const DASHED: [f64; 2] = [9.0, 6.0];
/// Dots of what is of second rank.
pub const DOTTED: [f64; 2] = [2.5, 5.0];

/// The colour of an outcome.
pub fn outcome(outcome: Outcome) -> &'static str {
    match outcome {
        Outcome::Symmetric => SYMMETRIC,
        Outcome::Asymmetric => ASYMMETRIC,
        Outcome::Failed => FAILED,
    }
}

/// The colour of one of so many values in their order: from dark to light, without the lightest.
pub fn ramp(number: usize, of: usize) -> String {
    let share = if of < 2 { 0.3 } else { number as f64 / (of - 1) as f64 };
    kuva::plot::ColorMap::Viridis.map(0.05 + 0.8 * share)
}

/// A colour between white (0) and itself (1).
pub fn tint(colour: &str, share: f64) -> String {
    let part = |at: usize| {
        let value = colour.get(at..at + 2).and_then(|hex| u8::from_str_radix(hex, 16).ok()).unwrap_or(0);
        (255.0 + (f64::from(value) - 255.0) * share.clamp(0.0, 1.0)).round() as u8
    };
    format!("#{:02x}{:02x}{:02x}", part(1), part(3), part(5))
}

/// What a parameter is called along an axis, with its unit.
pub fn parameter(parameter: Parameter) -> String {
    match parameter {
        Parameter::R0 => RADIUS.to_owned(),
        Parameter::Epsilon => "volume fraction ε".to_owned(),
        Parameter::XiS => ACTIVITY.to_owned(),
        Parameter::Aspect => "shell, a/b".to_owned(),
        Parameter::W => "shell width w".to_owned(),
        Parameter::P0 => "shell strength p₀".to_owned(),
        Parameter::Gain => "gain g".to_owned(),
        other => other.to_string(),
    }
}

/// The axis of R0.
pub const RADIUS: &str = "radius R₀ (Lₕ)";
/// The axis of ξ_s.
pub const ACTIVITY: &str = "activity ξₛ (κ₀/Lₕ)";
/// The axis of time.
pub const TIME: &str = "time (τ)";
/// The axis of χ.
pub const CHI: &str = "size asymmetry χ";
