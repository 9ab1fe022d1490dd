//! The common style of all pictures.
//!
//! The colours are taken from Okabe & Ito (*Color universal design*, 2008): they are distinguishable with every common
//! colour vision and differ in lightness in print. An outcome has the same colour in every picture.

use furrow_cell::cue::{Field, Quantity, RegulatorQuantity, Width, split_terms};
use furrow_cell::{Cell, Cue, Parameter};
use furrow_mechanics::division::Outcome;

/// Red, green and blue.
pub type Colour = [u8; 3];

const fn rgb(hex: u32) -> Colour {
    [(hex >> 16) as u8, (hex >> 8) as u8, hex as u8]
}

/// Background and rims.
pub(crate) const WHITE: Colour = rgb(0xff_ff_ff);
/// Text, axes and the contours of cells.
pub(crate) const INK: Colour = rgb(0x1a_1a_1a);
/// Secondary text.
pub(crate) const MUTED: Colour = rgb(0x55_55_55);
/// Areas in the background.
pub(crate) const FAINT: Colour = rgb(0xd9_d9_d9);
/// Lines of a grid.
pub(crate) const GRID: Colour = rgb(0xcc_cc_cc);
/// A division into equal daughters.
pub(crate) const SYMMETRIC: Colour = rgb(0x00_72_b2);
/// A division into unequal daughters.
pub(crate) const ASYMMETRIC: Colour = rgb(0xd5_5e_00);
/// A cell that comes to rest undivided.
pub(crate) const FAILED: Colour = rgb(0x99_99_99);
/// An undecided outcome.
pub const UNDECIDED: Colour = rgb(0xf0_e4_42);
/// Results of the model, beside observations.
pub const MODEL: Colour = rgb(0x00_9e_73);
/// Observations.
pub const OBSERVED: Colour = INK;
/// The cue where it raises a field.
pub const CUE_RAISES: Colour = furrow_formats::surface::RAISED;
/// The cue where it lowers a field.
pub const CUE_LOWERS: Colour = furrow_formats::surface::LOWERED;
/// The shell.
pub const SHELL: Colour = rgb(0x8c_8c_8c);
/// The inside of a cell.
pub(crate) const CYTOPLASM: Colour = rgb(0xea_f4_fa);
/// A curve of pitchforks.
pub(crate) const PITCHFORK: Colour = INK;
/// A curve of folds.
pub(crate) const FOLD: Colour = rgb(0xcc_79_a7);

/// The colour of perturbations of azimuthal number m ≥ 1.
pub fn azimuthal(m: usize) -> Colour {
    const COLOURS: [Colour; 4] = [MODEL, ASYMMETRIC, CUE_RAISES, SYMMETRIC];
    COLOURS[m.saturating_sub(1) % COLOURS.len()]
}

/// A factor before a letter, omitted if it is 1.
pub fn factor(m: usize) -> String {
    if m == 1 { String::new() } else { m.to_string() }
}

/// Colours of curves without an order or a fixed meaning.
pub(crate) const SERIES: [Colour; 7] =
    [rgb(0), rgb(0xe6_9f_00), rgb(0x56_b4_e9), rgb(0x00_9e_73), rgb(0xcc_79_a7), rgb(0x00_72_b2), rgb(0xd5_5e_00)];

/// The normal forces, in the order of `NormalForces::parts`: names and colours.
pub(crate) const FORCES: [(&str, Colour); 5] = [
    ("active", rgb(0xcc_79_a7)),
    ("viscous", rgb(0x56_b4_e9)),
    ("elastic", rgb(0x00_9e_73)),
    ("pressure", rgb(0x1a_1a_1a)),
    ("shell", rgb(0xe6_9f_00)),
];

/// Sizes of text, in the units of the canvas.
pub mod text {
    /// A picture's title.
    pub(crate) const TITLE: u32 = 20;
    /// Names of axes.
    pub const LABEL: u32 = 17;
    /// Numbers along axes, legends.
    pub const TICK: u32 = 15;
}

/// Width of curves.
pub(crate) const CURVE: f64 = 2.6;
/// Dashes and gaps of unstable shapes.
pub(crate) const DASHED: [f64; 2] = [9.0, 6.0];
/// Dots and gaps of secondary lines.
pub(crate) const DOTTED: [f64; 2] = [2.5, 5.0];

/// The colour of an outcome.
pub fn outcome(outcome: Outcome) -> Colour {
    match outcome {
        Outcome::Symmetric => SYMMETRIC,
        Outcome::Asymmetric => ASYMMETRIC,
        Outcome::Arrested => FAILED,
    }
}

/// The colour of an outcome as an area, paler for smaller χ, so that text and curves on it remain visible. `None` is
/// undecided.
pub(crate) fn tile(outcome: Option<Outcome>, chi: Option<f64>) -> Colour {
    match outcome {
        Some(Outcome::Symmetric) => tint(SYMMETRIC, 0.55),
        Some(Outcome::Asymmetric) => shade(chi.unwrap_or(1.0)),
        Some(Outcome::Arrested) => tint(FAILED, 0.45),
        None => tint(UNDECIDED, 0.8),
    }
}

/// The colour of an asymmetry as an area: nearly white at χ = 0.
pub(crate) fn shade(chi: f64) -> Colour {
    tint(ASYMMETRIC, 0.1 + 0.85 * chi)
}

/// The colour of one of several curves, from a colour map if there are more curves than `hues`.
pub fn series(number: usize, of: usize, hues: &[Colour]) -> Colour {
    if of <= hues.len() { hues[number % hues.len()] } else { ramp(number, of) }
}

/// The colour of one of several ordered values: from the colour map viridis, without its ends.
pub(crate) fn ramp(number: usize, of: usize) -> Colour {
    const VIRIDIS: [Colour; 5] = [rgb(0x44_01_54), rgb(0x3b_52_8b), rgb(0x21_91_8c), rgb(0x5e_c9_62), rgb(0xfd_e7_25)];
    let share = if of < 2 { 0.3 } else { number as f64 / (of - 1) as f64 };
    let place = 4.0 * (0.05 + 0.8 * share);
    let below = (place as usize).min(3);
    mixed(VIRIDIS[below], VIRIDIS[below + 1], place - below as f64)
}

/// One of several greys, from dark to light; a single one has the colour of cells at rest.
pub(crate) fn grey(number: usize, of: usize) -> Colour {
    const ENDS: [Colour; 2] = [rgb(0x4d_4d_4d), rgb(0xc0_c0_c0)];
    if of < 2 { FAILED } else { mixed(ENDS[0], ENDS[1], number as f64 / (of - 1) as f64) }
}

/// A colour between white (0) and itself (1).
pub(crate) fn tint(colour: Colour, share: f64) -> Colour {
    mixed(WHITE, colour, share.clamp(0.0, 1.0))
}

fn mixed(from: Colour, to: Colour, share: f64) -> Colour {
    let part = |k: usize| f64::from(from[k]) + share * (f64::from(to[k]) - f64::from(from[k]));
    [0, 1, 2].map(|k| part(k).round() as u8)
}

/// A cell's parameters for a title: R₀, ε and ξₛ except the `varied` ones, a law of its own, and its cue, if any, without the varied
/// numbers.
pub fn described(cell: &Cell, varied: &[Parameter]) -> String {
    let named =
        [(Parameter::R0, "R₀", cell.r0), (Parameter::Epsilon, "ε", cell.epsilon), (Parameter::XiS, "ξₛ", cell.xi_s)];
    let fixed = named.iter().filter(|(parameter, ..)| !varied.contains(parameter));
    let mut parts: Vec<String> = fixed.map(|(_, symbol, value)| format!("{symbol} = {value}")).collect();
    parts.extend(cell.law.as_ref().map(|law| format!("law {}", law.name())));
    if cell.has_cue() {
        parts.push(format!("cue {}", cue_without(&cell.cue, varied)));
    }
    parts.join(", ")
}

/// A cue as text without its varied numbers, which are shown along an axis or in a legend.
pub(crate) fn cue_without(cue: &Cue, varied: &[Parameter]) -> String {
    let text = cue.to_string();
    let left = |(k, term): (usize, &str)| {
        let varies = |part: &&str| {
            let key = part.split('=').next().unwrap_or_default();
            let is = |parameter: &Parameter| match parameter {
                Parameter::Cue { term, .. } => *term == k,
                // The regulator is written after the terms.
                Parameter::Regulator(_) => k == cue.terms().len(),
                _ => false,
            };
            varied.iter().any(|parameter| is(parameter) && parameter.name() == key)
        };
        term.split(',').filter(|part| !varies(part)).collect::<Vec<_>>().join(",")
    };
    split_terms(&text).into_iter().enumerate().map(left).collect::<Vec<_>>().join("+")
}

/// A time with enough digits to distinguish neighbouring times.
pub fn time(t: f64) -> String {
    match t {
        t if t >= 100.0 => format!("{t:.0}"),
        t if t >= 10.0 => format!("{t:.1}"),
        t => format!("{t:.2}"),
    }
}

/// The symbol of a parameter of the cell, and the label of its axis; `None` for numbers of a cue, a regulator or a law.
fn of_cell(parameter: Parameter) -> Option<[&'static str; 2]> {
    Some(match parameter {
        Parameter::R0 => ["R₀", "radius R₀ (Lₕ)"],
        Parameter::Epsilon => ["ε", "volume fraction ε"],
        Parameter::XiS => ["ξₛ", ACTIVITY],
        Parameter::XiRatio => ["isotropic activity", "isotropic over anisotropic activity"],
        Parameter::Aspect => ["a/b", "shell, a/b"],
        Parameter::W => ["w", "shell width w"],
        Parameter::Flattening => ["thickness", "thickness of the shell"],
        Parameter::P0 => ["p₀", "shell strength p₀"],
        Parameter::Gain => ["g", "gain g"],
        Parameter::Kappa => ["κ", "rigidity κ (κ₀)"],
        Parameter::EtaB => ["bulk viscosity"; 2],
        Parameter::EtaS => ["shear viscosity"; 2],
        Parameter::Friction => ["Γ", "friction Γ"],
        Parameter::Tension => ["γ", "tension γ (κ₀/Lₕ²)"],
        Parameter::SpontaneousCurvature => ["C₀", "spontaneous curvature C₀ (1/Lₕ)"],
        Parameter::NormalFriction => ["Γₙ", "normal friction Γₙ"],
        Parameter::Cue { .. } | Parameter::Regulator(_) | Parameter::Law(_) => return None,
    })
}

/// The label of a parameter's axis, with its unit; a number of a cue is described by its term in `cue`.
pub fn parameter(parameter: Parameter, cue: &Cue) -> String {
    match parameter {
        Parameter::Cue { term, quantity } => of_cue(term, quantity, cue),
        Parameter::Regulator(quantity) => of_regulator(quantity, cue),
        Parameter::Law(name) => format!("{} of the law", name.bare()),
        own => of_cell(own).map_or("", |[_, label]| label).to_owned(),
    }
}

/// The label of the axis of a number of a cue's term, with the kind of the term and the unit in brackets.
fn of_cue(number: usize, quantity: Quantity, cue: &Cue) -> String {
    const NUMBERS: [&str; 4] = ["first", "second", "third", "fourth"];
    let term = cue.terms().get(number);
    let whose = match NUMBERS.get(number) {
        _ if cue.terms().len() == 1 || (term.is_none() && number == 0) => "the cue".to_owned(),
        Some(number) => format!("the cue's {number} term"),
        None => format!("the cue's term {}", number + 1),
    };
    let (name, unit) = match quantity {
        Quantity::Amplitude => ("amplitude", term.filter(|t| t.field == Field::Tension).map(|_| "κ₀/Lₕ²")),
        Quantity::U0 => ("place u₀", None),
        Quantity::Omega => {
            let length = |width| matches!(width, Width::Length(_)).then_some("Lₕ");
            ("width ω", term.and_then(|t| t.profile.width()).and_then(length))
        }
        Quantity::Par(constant) => (constant.name(), Some(constant.unit())),
    };
    let kind = term.map(|term| format!("{} {}", field(term.field), term.profile.name()));
    let brackets: Vec<String> = kind.into_iter().chain(unit.map(str::to_owned)).collect();
    let brackets = if brackets.is_empty() { String::new() } else { format!(" ({})", brackets.join(", ")) };
    format!("{name} of {whose}{brackets}")
}

/// The label of the axis of a number of a cue's regulator, with its unit in brackets.
fn of_regulator(quantity: RegulatorQuantity, cue: &Cue) -> String {
    let source = cue.regulator().and_then(|regulator| regulator.source);
    match quantity {
        RegulatorQuantity::Turnover => "turnover of the regulator (1/τ)".to_owned(),
        RegulatorQuantity::Diffusion => "diffusion of the regulator (Lₕ²/τ)".to_owned(),
        RegulatorQuantity::Source(Quantity::U0) => "place u₀ of the regulator's source".to_owned(),
        RegulatorQuantity::Source(Quantity::Amplitude) => "amplitude of the regulator's source".to_owned(),
        RegulatorQuantity::Source(Quantity::Omega) => {
            let length =
                source.and_then(|source| source.profile.width()).is_some_and(|w| matches!(w, Width::Length(_)));
            format!("width ω of the regulator's source{}", if length { " (Lₕ)" } else { "" })
        }
        RegulatorQuantity::Source(Quantity::Par(constant)) => {
            format!("{} of the regulator's source ({})", constant.name(), constant.unit())
        }
        RegulatorQuantity::Strength(on) => {
            let unit = if on == Field::Tension { " (κ₀/Lₕ²)" } else { "" };
            format!("coupling of the regulator to {}{unit}", field(on))
        }
        RegulatorQuantity::Half(on) => format!("half-saturation of the coupling to {}", field(on)),
    }
}

/// The symbol of a parameter, for use beside its value.
pub fn symbol(parameter: Parameter) -> String {
    let sign = match parameter {
        Parameter::Regulator(RegulatorQuantity::Turnover) => "k",
        Parameter::Regulator(RegulatorQuantity::Diffusion) => "D",
        Parameter::Cue { quantity, .. } | Parameter::Regulator(RegulatorQuantity::Source(quantity)) => match quantity {
            Quantity::U0 => "u₀",
            Quantity::Omega => "ω",
            Quantity::Amplitude => "amplitude",
            Quantity::Par(constant) => constant.name(),
        },
        Parameter::Regulator(RegulatorQuantity::Strength(on)) => return format!("coupling to {}", field(on)),
        Parameter::Regulator(RegulatorQuantity::Half(on)) => return format!("half-saturation of {}", field(on)),
        Parameter::Law(name) => name.bare(),
        own => of_cell(own).map_or("", |[symbol, _]| symbol),
    };
    sign.to_owned()
}

/// Words of the command line with the symbols of quantities in place of their names. Cues stay as they are typed.
pub(crate) fn symbols(text: &str) -> String {
    const NAMES: [(&str, &str); 5] = [("R0", "R₀"), ("u0", "u₀"), ("epsilon", "ε"), ("xi_s", "ξₛ"), ("chi", "χ")];
    let is_letter = |letter: char| letter.is_alphanumeric() || letter == '_';
    let mut out = String::new();
    let mut rest = text;
    while !rest.is_empty() {
        let end = rest.find(|letter| !is_letter(letter)).unwrap_or(rest.len());
        let (word, after) = rest.split_at(end);
        let typed = after.starts_with(['=', ':']) && !after.starts_with(": ");
        let symbol = NAMES.iter().find(|(name, _)| *name == word && !typed).map(|(_, symbol)| *symbol);
        out.push_str(symbol.unwrap_or(word));
        let next = after.find(is_letter).unwrap_or(after.len());
        out.push_str(&after[..next]);
        rest = &after[next..];
    }
    out
}

/// The name of a field that a cue changes.
pub fn field(field: Field) -> &'static str {
    match field {
        Field::Kappa => "rigidity",
        Field::XiS => "activity ξₛ",
        Field::XiB => "isotropic activity",
        Field::EtaB => "bulk viscosity",
        Field::EtaS => "shear viscosity",
        Field::Activity | Field::Viscosity | Field::Friction | Field::Tension => field.name(),
    }
}

/// The axis of ξ_s.
pub(crate) const ACTIVITY: &str = "activity ξₛ (κ₀/Lₕ)";
/// The axis of time.
pub(crate) const TIME: &str = "time (τ)";
/// The axis of χ.
pub const CHI: &str = "size asymmetry χ";

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_become_symbols_and_cues_stay() {
        for (words, expected) in [
            (
                "a[0], subcritical at R0 = 1.64, epsilon = 0.87: chi 0.7",
                "a[0], subcritical at R₀ = 1.64, ε = 0.87: χ 0.7",
            ),
            ("furrow at u0 at R0 = 5, kappa:band,u0=0.4: u", "furrow at u₀ at R₀ = 5, kappa:band,u0=0.4: u"),
            ("xi_s: no χ", "ξₛ: no χ"),
        ] {
            assert_eq!(symbols(words), expected);
        }
    }

    #[test]
    fn a_number_of_a_cue_is_named_by_its_term() {
        let cue: Cue = "tension:gradient,amplitude=0.3+kappa:band,u0=0.465,omega=0.3Lh,amplitude=0.1".parse().unwrap();
        let called = |name: &str, cue: &Cue| parameter(name.parse().unwrap(), cue);
        for (name, expected) in [
            ("cue.amplitude", "amplitude of the cue's first term (tension gradient, κ₀/Lₕ²)"),
            ("cue[1].amplitude", "amplitude of the cue's second term (rigidity band)"),
            ("cue[1].omega", "width ω of the cue's second term (rigidity band, Lₕ)"),
            ("friction", "friction Γ"),
        ] {
            assert_eq!(called(name, &cue), expected);
        }
        let carried: Cue = "tension:gradient,amplitude=0.3+regulator:band,u0=0.4,omega=0.3Lh,amplitude=1,turnover=10,diffusion=1,tension=2"
            .parse()
            .unwrap();
        for (name, expected) in [
            ("regulator.turnover", "turnover of the regulator (1/τ)"),
            ("regulator.omega", "width ω of the regulator's source (Lₕ)"),
            ("regulator.tension", "coupling of the regulator to tension (κ₀/Lₕ²)"),
        ] {
            assert_eq!(called(name, &carried), expected);
        }
        let left =
            cue_without(&carried, &["regulator.amplitude", "regulator.tension"].map(|name| name.parse().unwrap()));
        assert_eq!(left, "tension:gradient,amplitude=0.3+regulator:band,u0=0.4,omega=0.3Lh,turnover=10,diffusion=1");
        assert_eq!(called("cue.u0", &Cue::published()), "place u₀ of the cue (rigidity band)");
        assert_eq!(called("cue.amplitude", &Cue::none()), "amplitude of the cue");
        let varied = ["cue[1].amplitude".parse().unwrap(), Parameter::R0];
        let left = described(&Cell { cue, ..Cell::new(2.0) }, &varied);
        let expected = "cue tension:gradient,amplitude=0.3+kappa:band,u0=0.465,omega=0.3Lh";
        assert!(left.ends_with(expected) && !left.contains("R₀"), "{left}");
    }
}
