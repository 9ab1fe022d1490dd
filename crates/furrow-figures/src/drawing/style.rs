//! The one style of all pictures.
//!
//! Colours are those of Okabe & Ito (*Color universal design*, 2008), which are distinguishable with every common colour vision and
//! differ in lightness in print. An outcome has the same colour in every picture.

use furrow_cell::{Cell, Parameter};
use furrow_mechanics::division::Outcome;

/// Red, green and blue.
pub type Colour = [u8; 3];

const fn rgb(hex: u32) -> Colour {
    [(hex >> 16) as u8, (hex >> 8) as u8, hex as u8]
}

/// Background and rims.
pub const WHITE: Colour = rgb(0xff_ff_ff);
/// Text, axes and the contours of cells.
pub const INK: Colour = rgb(0x1a_1a_1a);
/// Text of second rank.
pub const MUTED: Colour = rgb(0x55_55_55);
/// Areas in the background.
pub const FAINT: Colour = rgb(0xd9_d9_d9);
/// Lines of a grid.
pub const GRID: Colour = rgb(0xcc_cc_cc);
/// A division into equal daughters.
pub const SYMMETRIC: Colour = rgb(0x00_72_b2);
/// A division into unequal daughters.
pub const ASYMMETRIC: Colour = rgb(0xd5_5e_00);
/// A cell that comes to rest undivided.
pub const FAILED: Colour = rgb(0x99_99_99);
/// What could not be decided.
pub const UNDECIDED: Colour = rgb(0xf0_e4_42);
/// What the model gives, beside what was observed.
pub const MODEL: Colour = rgb(0x00_9e_73);
/// What was observed.
pub const OBSERVED: Colour = INK;
/// The cue.
pub const CUE: Colour = rgb(0xe6_9f_00);
/// The shell.
pub const SHELL: Colour = rgb(0x8c_8c_8c);
/// The inside of a cell.
pub const CYTOPLASM: Colour = rgb(0xea_f4_fa);
/// A curve of pitchforks.
pub const PITCHFORK: Colour = INK;
/// A curve of folds.
pub const FOLD: Colour = rgb(0xcc_79_a7);

/// Colours of curves without an order or a meaning of their own.
pub const SERIES: [Colour; 7] =
    [rgb(0), rgb(0xe6_9f_00), rgb(0x56_b4_e9), rgb(0x00_9e_73), rgb(0xcc_79_a7), rgb(0x00_72_b2), rgb(0xd5_5e_00)];

/// The normal forces, in the order of `NormalForces::parts`: name and colour.
pub const FORCES: [(&str, Colour); 5] = [
    ("active", rgb(0xcc_79_a7)),
    ("viscous", rgb(0x56_b4_e9)),
    ("elastic", rgb(0x00_9e_73)),
    ("pressure", rgb(0x1a_1a_1a)),
    ("shell", rgb(0xe6_9f_00)),
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
pub fn outcome(outcome: Outcome) -> Colour {
    match outcome {
        Outcome::Symmetric => SYMMETRIC,
        Outcome::Asymmetric => ASYMMETRIC,
        Outcome::Arrested => FAILED,
    }
}

/// The colour of an outcome as an area, paler the less unequal the daughters are, so that what is drawn on it can be seen.
/// `None` is undecided.
pub fn tile(outcome: Option<Outcome>, chi: Option<f64>) -> Colour {
    match outcome {
        Some(Outcome::Symmetric) => tint(SYMMETRIC, 0.55),
        Some(Outcome::Asymmetric) => tint(ASYMMETRIC, 0.25 + 0.5 * chi.unwrap_or(1.0)),
        Some(Outcome::Arrested) => tint(FAILED, 0.45),
        None => tint(UNDECIDED, 0.8),
    }
}

/// The colour of one of several curves: from dark to light where there are more than `hues`.
pub fn series(number: usize, of: usize, hues: &[Colour]) -> Colour {
    if of <= hues.len() { hues[number % hues.len()] } else { ramp(number, of) }
}

/// The colour of one of several values in their order: along the colour map viridis, without its ends.
pub fn ramp(number: usize, of: usize) -> Colour {
    const VIRIDIS: [Colour; 5] = [rgb(0x44_01_54), rgb(0x3b_52_8b), rgb(0x21_91_8c), rgb(0x5e_c9_62), rgb(0xfd_e7_25)];
    let share = if of < 2 { 0.3 } else { number as f64 / (of - 1) as f64 };
    let place = 4.0 * (0.05 + 0.8 * share);
    let below = (place as usize).min(3);
    mixed(VIRIDIS[below], VIRIDIS[below + 1], place - below as f64)
}

/// A colour between white (0) and itself (1).
pub fn tint(colour: Colour, share: f64) -> Colour {
    mixed(WHITE, colour, share.clamp(0.0, 1.0))
}

fn mixed(from: Colour, to: Colour, share: f64) -> Colour {
    let part = |k: usize| f64::from(from[k]) + share * (f64::from(to[k]) - f64::from(from[k]));
    [0, 1, 2].map(|k| part(k).round() as u8)
}

/// What a cell is, for a title: R₀, ε and ξₛ without those that `varied` names, and the cue if it has one.
pub fn described(cell: &Cell, varied: &[Parameter]) -> String {
    let named =
        [(Parameter::R0, "R₀", cell.r0), (Parameter::Epsilon, "ε", cell.epsilon), (Parameter::XiS, "ξₛ", cell.xi_s)];
    let fixed = named.iter().filter(|(parameter, ..)| !varied.contains(parameter));
    let mut parts: Vec<String> = fixed.map(|(_, symbol, value)| format!("{symbol} = {value}")).collect();
    if !cell.cue.is_none() {
        parts.push(format!("cue {}", cell.cue));
    }
    parts.join(", ")
}

/// A time with as many digits as it takes to tell it from another.
pub fn time(t: f64) -> String {
    match t {
        t if t >= 100.0 => format!("{t:.0}"),
        t if t >= 10.0 => format!("{t:.1}"),
        t => format!("{t:.2}"),
    }
}

/// What a parameter is called along an axis, with its unit.
pub fn parameter(parameter: Parameter) -> String {
    match parameter {
        Parameter::R0 => "radius R₀ (Lₕ)".to_owned(),
        Parameter::Epsilon => "volume fraction ε".to_owned(),
        Parameter::XiS => ACTIVITY.to_owned(),
        Parameter::Aspect => "shell, a/b".to_owned(),
        Parameter::W => "shell width w".to_owned(),
        Parameter::P0 => "shell strength p₀".to_owned(),
        Parameter::Gain => "gain g".to_owned(),
        other => other.to_string(),
    }
}

/// The axis of ξ_s.
pub const ACTIVITY: &str = "activity ξₛ (κ₀/Lₕ)";
/// The axis of time.
pub const TIME: &str = "time (τ)";
/// The axis of χ.
pub const CHI: &str = "size asymmetry χ";
