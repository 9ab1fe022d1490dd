//! Polarity cues as data. A cue is a sum of terms and may include a regulator that is advected by the flow. A term has a field, a
//! profile and an amplitude.
//!
//! | file | contents |
//! |---|---|
//! | `field` | the coefficients of the equations that a cue can modulate |
//! | `profile` | profiles of terms along the contour |
//! | `par` | the constants of PAR polarity, which a profile can follow |
//! | `side` | profiles of terms around the axis |
//! | `regulator` | a substance with advection, diffusion and turnover |
//! | `check` | allowed numbers |
//! | `text` | the grammar: `kappa:band,u0=0.4,omega=0.1,amplitude=0.2` |
//! | `regulator_text` | the grammar of a regulator |
//! | `file` | the same text in RON and JSON |
//! | `written` | a cue before conversion, with numbers in µm and seconds |

mod check;
pub mod field;
mod file;
pub mod par;
pub mod profile;
pub mod regulator;
mod regulator_text;
pub mod side;
mod text;
mod written;

pub use field::Field;
pub use par::{LENGTH_UM, ParConstant, ParConstants, SurfaceToVolume, ZYGOTE_SURFACE_TO_VOLUME};
pub use profile::{Profile, Quantity, Width};
pub use regulator::{Coupling, Regulator, RegulatorQuantity, Source};
pub use side::Side;
pub use text::{split_terms, starts_with_field};
pub use written::{Scale, WrittenCue};

pub use check::LEAST_DIFFUSION;

use check::CONTOURS;

use crate::Number;

/// One term of a cue.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Term<D = f64> {
    /// The field that it modulates.
    pub field: Field,
    /// The profile along the contour.
    pub profile: Profile<D>,
    /// Amplitude A: relative to the value of the field, but for tension in κ0/L_h².
    pub amplitude: D,
    /// The side of the axis on which it acts; `None` for an axisymmetric term.
    pub side: Option<Side>,
}

impl<D: Number> Term<D> {
    /// A f, A ∂f/∂u and A ∂²f/∂u² at u on a contour of length `length`.
    pub fn at(&self, u: f64, length: D) -> [D; 3] {
        self.profile.at(u, length).map(|f| f * self.amplitude)
    }

    /// A f at u and the angle `phi` about the axis, in radians.
    pub fn beside(&self, u: f64, phi: f64, length: D) -> D {
        self.at(u, length)[0] * self.side.map_or(1.0, |side| side.share(u, phi))
    }
}

impl Term {
    /// A number of the term; `None` if its profile does not have it.
    pub fn quantity(mut self, quantity: Quantity) -> Option<f64> {
        self.quantity_mut(quantity).copied()
    }

    /// Mutable access to such a number.
    pub(crate) fn quantity_mut(&mut self, quantity: Quantity) -> Option<&mut f64> {
        match quantity {
            Quantity::Amplitude => Some(&mut self.amplitude),
            other => self.profile.quantity_mut(other),
        }
    }

    /// The same term with converted numbers; the conversion also gets the quantity of each number.
    pub fn map<E>(&self, mut number: impl FnMut(Quantity, f64) -> E) -> Term<E> {
        Term {
            field: self.field,
            profile: self.profile.map(&mut number),
            amplitude: number(Quantity::Amplitude, self.amplitude),
            side: self.side,
        }
    }

    /// The mirror image of the term, u → 1 − u.
    pub fn mirrored(&self) -> Term {
        let (profile, sign) = self.profile.mirrored();
        Term { profile, amplitude: sign * self.amplitude, ..*self }
    }
}

/// A polarity cue, which makes properties of the cortex vary along the contour. Terms add up: X(u) = X0·(1 + Σ A f(u)) for every
/// [`Field`] except tension, to which Σ A f(u) is added. The cue is switched on together with the activity. The sum may include a
/// [`Regulator`] that is advected by the flow.
///
/// ```
/// use furrow_cell::Cue;
///
/// let cue: Cue = "kappa:u0=0.4,omega=0.1,amplitude=0.1 + tension:gradient,amplitude=0.2".parse()?;
/// assert_eq!(cue.terms().len(), 2);
/// assert_eq!(cue.to_string(), "kappa:band,u0=0.4,omega=0.1,amplitude=0.1+tension:gradient,amplitude=0.2");
/// assert!("activity:band,u0=0.5,omega=0.1,amplitude=0.2".parse::<Cue>()?.is_mirror_symmetric());
/// let carried: Cue = "regulator:step,u0=0.4,omega=0.1,amplitude=1,turnover=10,diffusion=1,activity=0.3".parse()?;
/// assert!(!carried.is_mirror_symmetric() && carried.regulator().is_some());
/// # Ok::<(), furrow_cell::CueError>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Cue {
    terms: Vec<Term>,
    regulator: Option<Regulator>,
}

/// An invalid number or word of a cue.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{field} = {value}: must be {allowed}")]
pub struct CueError {
    /// The part of the cue.
    pub field: String,
    /// Its value.
    pub value: String,
    /// The allowed values.
    pub allowed: String,
}

impl CueError {
    fn new(field: impl Into<String>, value: impl ToString, allowed: impl Into<String>) -> CueError {
        CueError { field: field.into(), value: value.to_string(), allowed: allowed.into() }
    }
}

impl Cue {
    /// No cue: the poles are equivalent.
    pub const fn none() -> Cue {
        Cue { terms: Vec::new(), regulator: None }
    }

    /// The published cue of the germline: a band of stiffer cortex at u0 = 0.465 with ω = 0.0577 and Δκ = 0.1 (Table S3).
    pub fn published() -> Cue {
        Cue::kappa_band(0.465, 0.0577, 0.1)
    }

    /// κ(u) = κ·(1 + amplitude·exp(−(u − u0)²/omega²)), the cue of the paper.
    pub fn kappa_band(u0: f64, omega: f64, amplitude: f64) -> Cue {
        let profile = Profile::Band { u0, omega: Width::Fraction(omega) };
        Cue { terms: vec![Term { field: Field::Kappa, profile, amplitude, side: None }], regulator: None }
    }

    /// A sum of terms.
    ///
    /// # Errors
    /// [`CueError`] if a number is not allowed, or if a field that must be positive is not.
    pub fn new(terms: Vec<Term>) -> Result<Cue, CueError> {
        Cue::with_regulator(terms, None)
    }

    /// A sum of terms, and a regulator that is advected by the flow.
    ///
    /// # Errors
    /// As [`Cue::new`], and for numbers of the regulator.
    pub fn with_regulator(terms: Vec<Term>, regulator: Option<Regulator>) -> Result<Cue, CueError> {
        let cue = Cue { terms, regulator: regulator.map(Regulator::sorted) };
        cue.check()?;
        Ok(cue)
    }

    /// Its terms.
    pub fn terms(&self) -> &[Term] {
        &self.terms
    }

    /// Mutable access to its terms; changes are not checked.
    pub fn terms_mut(&mut self) -> &mut [Term] {
        &mut self.terms
    }

    /// The regulator, if there is one.
    pub fn regulator(&self) -> Option<&Regulator> {
        self.regulator.as_ref()
    }

    /// Mutable access to the regulator; changes are not checked.
    pub fn regulator_mut(&mut self) -> Option<&mut Regulator> {
        self.regulator.as_mut()
    }

    /// Whether all amplitudes of terms and all strengths of couplings are zero. A regulator with a strength acts even without a source,
    /// since flow moves it. [`Cell::has_cue`](crate::Cell::has_cue) also counts a regulator that the cell's law uses.
    pub fn is_none(&self) -> bool {
        *self == Cue::none() || self.simplified() == Cue::none()
    }

    /// Whether it is even about u = ½, so that shapes can be mirror-symmetric and pitchforks persist. The criterion is the
    /// sum of all terms of a field, regardless of the notation.
    pub fn is_mirror_symmetric(&self) -> bool {
        self.is_even_for(false)
    }

    /// [`is_mirror_symmetric`](Self::is_mirror_symmetric) for a law that does or does not use φ (`phi`): see
    /// [`simplified_for`](Self::simplified_for).
    pub(crate) fn is_even_for(&self, phi: bool) -> bool {
        if self.follows_par() {
            return false;
        }
        let cue = self.simplified_for(phi);
        if let Some(Source { profile, amplitude }) = cue.regulator.as_ref().and_then(|regulator| regulator.source) {
            // A source is even under the same condition as a term.
            let term = Term { field: Field::Tension, profile, amplitude, side: None };
            if !(Cue { terms: vec![term], regulator: None }).is_mirror_symmetric() {
                return false;
            }
        }
        let scale: f64 = cue.terms.iter().map(|term| term.amplitude.abs()).sum();
        // Points at which an odd part would be visible: near the positions of the terms, and on a grid.
        let mut places: Vec<f64> = (0..32).map(|k| (f64::from(k) + 0.5) / 64.0).collect();
        for length in CONTOURS {
            for term in &cue.terms {
                let (u0, width) = (term.quantity(Quantity::U0), term.profile.width());
                let width = width.map_or(0.1, |omega| omega.in_u(length).abs());
                places.extend([-1.0, 0.0, 0.7].map(|k| u0.unwrap_or(0.0) + k * width));
            }
        }
        let angles = cue.angles();
        let odd = |coefficient: Field, u: f64, phi: f64, length: f64| {
            (cue.sum_at(coefficient, u, phi, length) - cue.sum_at(coefficient, 1.0 - u, phi, length)).abs()
        };
        let even = |coefficient: Field, length: f64| {
            let around = |u: f64| angles.iter().all(|&phi| odd(coefficient, u, phi, length) <= EVEN * scale);
            places.iter().all(|&u| around(u.clamp(0.0, 1.0)))
        };
        let touched = |coefficient: &Field| cue.terms.iter().any(|term| term.field.modulates(*coefficient));
        let mut coefficients = Field::ALL.into_iter().filter(touched);
        coefficients.all(|coefficient| CONTOURS.into_iter().all(|length| even(coefficient, length)))
    }

    /// The profiles of its terms and of the regulator's source.
    pub fn profiles(&self) -> impl Iterator<Item = Profile> {
        let source = self.regulator.iter().filter_map(|regulator| regulator.source.map(|source| source.profile));
        self.terms.iter().map(|term| term.profile).chain(source)
    }

    /// Mutable access to the same profiles; changes are not checked.
    pub fn profiles_mut(&mut self) -> impl Iterator<Item = &mut Profile> {
        let source = self.regulator.iter_mut().filter_map(|regulator| regulator.source.as_mut());
        self.terms.iter_mut().map(|term| &mut term.profile).chain(source.map(|source| &mut source.profile))
    }

    /// Whether a term, or the regulator's source, follows PAR polarity, so that its position depends on the cell.
    pub fn follows_par(&self) -> bool {
        self.profiles().any(|profile| matches!(profile, Profile::Par { .. }))
    }

    /// Whether a term acts on one side of the axis.
    pub fn is_one_sided(&self) -> bool {
        self.terms.iter().any(|term| term.side.is_some() && term.amplitude != 0.0)
    }

    /// Angles at which terms differ most: at the sides and between them.
    fn angles(&self) -> Vec<f64> {
        let sides = self.terms.iter().filter_map(|term| term.side);
        [0.0]
            .into_iter()
            .chain(sides.flat_map(|Side { at, spread }| [at, at + 0.5 * spread, at - 0.5 * spread]))
            .collect()
    }

    /// Σ A f(u) over the terms that modulate a coefficient, at the angle `phi`.
    fn sum_at(&self, coefficient: Field, u: f64, phi: f64, length: f64) -> f64 {
        let touching = self.terms.iter().filter(|term| term.field.modulates(coefficient));
        touching.map(|term| term.beside(u, phi, length)).sum()
    }

    /// The mirror image of the cue, u → 1 − u.
    pub fn mirrored(&self) -> Cue {
        Cue {
            terms: self.terms.iter().map(Term::mirrored).collect(),
            regulator: self.regulator.as_ref().map(Regulator::mirrored),
        }
    }

    /// The cue with the amplitudes of its terms and the strengths of its regulator multiplied by `factor`. The regulator's source
    /// stays the same.
    pub fn scaled(&self, factor: f64) -> Cue {
        Cue {
            terms: self.terms.iter().map(|term| Term { amplitude: factor * term.amplitude, ..*term }).collect(),
            regulator: self.regulator.as_ref().map(|regulator| regulator.scaled(factor)),
        }
    }

    /// The cue of a cell that is not polarised: the regulator, without terms and without a source that differs between the poles.
    /// `None` without a regulator.
    pub fn unpolarised(&self) -> Option<Cue> {
        let alone = Cue { terms: Vec::new(), regulator: self.regulator.clone() };
        let source = alone.regulator()?.source.filter(|_| alone.is_even_for(true));
        Some(Cue { regulator: alone.regulator.map(|regulator| Regulator { source, ..regulator }), ..alone })
    }

    /// The same cue with the fewest terms: equal terms are added, and terms without an effect are omitted.
    pub fn simplified(&self) -> Cue {
        self.simplified_for(false)
    }

    /// [`simplified`](Self::simplified), but if a law uses φ (`phi`), a regulator without fields is kept.
    pub(crate) fn simplified_for(&self, phi: bool) -> Cue {
        let mut terms: Vec<Term> = Vec::new();
        for term in &self.terms {
            match terms
                .iter_mut()
                .find(|other| other.field == term.field && other.profile == term.profile && other.side == term.side)
            {
                Some(same) => same.amplitude += term.amplitude,
                None => terms.push(*term),
            }
        }
        terms.retain(|term| term.amplitude != 0.0);
        Cue { terms, regulator: self.regulator.as_ref().and_then(|regulator| regulator.simplified(phi)) }
    }
}

/// Odd parts of a cue below this, relative to its amplitudes, are rounding errors of 1 − u.
const EVEN: f64 = 1e-11;

#[cfg(test)]
mod tests {
    use super::*;

    fn cue(text: &str) -> Cue {
        text.parse().unwrap_or_else(|e| panic!("{text}: {e}"))
    }

    #[test]
    fn what_is_left_of_a_cue_that_nothing_polarises() {
        let rest = |text: &str| cue(text).unpolarised().map(|cue| cue.to_string());
        let uniform = "regulator:none,turnover=10,diffusion=1,activity=0";
        let even = "regulator:band,u0=0.5,omega=0.1,amplitude=1,turnover=10,diffusion=1,activity=0";
        let odd = "regulator:band,u0=0.4,omega=0.1,amplitude=1,turnover=10,diffusion=1,activity=0";
        assert_eq!(rest("tension:gradient,amplitude=0.2"), None);
        assert_eq!(rest(&format!("tension:gradient,amplitude=0.2+{odd}")), rest(uniform));
        assert_eq!(rest(&format!("tension:gradient,amplitude=0.2+{even}")), Some(cue(even).to_string()));
    }

    #[test]
    fn derivatives_of_profiles_are_those_of_their_values() {
        for profile in [
            Profile::Band { u0: 0.4, omega: Width::Fraction(0.1) },
            Profile::Band { u0: 0.4, omega: Width::Length(0.5) },
            Profile::Step { u0: 0.6, omega: Width::Fraction(-0.2) },
            Profile::Gradient,
        ] {
            for u in [0.1, 0.35, 0.4, 0.62, 0.9] {
                let h = 1e-4;
                let at = |u: f64| profile.at(u, 7.0);
                let [below, here, above] = [at(u - h), at(u), at(u + h)];
                for k in 0..2 {
                    let slope = (above[k] - below[k]) / (2.0 * h);
                    assert!((slope - here[k + 1]).abs() < 1e-4 * (1.0 + slope.abs()), "{profile:?} {u} {k}");
                }
            }
        }
    }

    #[test]
    fn a_mirror_image_is_the_profile_from_the_other_pole() {
        for text in [
            "kappa:u0=0.4,omega=0.1,amplitude=0.1",
            "kappa:step,u0=0.3,omega=0.1,amplitude=0.1",
            "tension:gradient,amplitude=0.4",
            "xi_s:step,u0=0.3,omega=-0.2Lh,amplitude=2",
        ] {
            let cue = cue(text);
            let image = cue.mirrored();
            for u in [0.0, 0.2, 0.45, 0.5, 0.8, 1.0] {
                let [a, b] = [(&cue, u), (&image, 1.0 - u)].map(|(c, u)| c.terms()[0].at(u, 5.0));
                // tanh is odd only up to rounding, and 1 − f of a step is not f at the other side of zero.
                assert!((a[0] - b[0]).abs() < 1e-15 && (a[1] + b[1]).abs() < 1e-13, "{text} {u}: {a:?} {b:?}");
            }
            let again = Cue { terms: [image.mirrored().terms, cue.scaled(-1.0).terms].concat(), regulator: None };
            assert!(again.is_mirror_symmetric(), "{text}");
        }
    }

    #[test]
    fn evenness_is_seen_in_single_terms_and_in_pairs() {
        // Also a top hat, halves of a term, a sum of nothing, and one field said as two.
        for line in include_str!("evenness.txt").lines() {
            let (evenness, text) = line.split_once(' ').unwrap();
            assert_eq!(cue(text).is_mirror_symmetric(), evenness == "even", "{text}");
        }
    }

    #[test]
    fn a_regulator_is_a_part_of_its_cue() {
        let whole = cue(
            "kappa:u0=0.4,omega=0.1,amplitude=0.1+regulator:step,u0=0.25,omega=0.1,amplitude=1,turnover=10,diffusion=1,diluted=false,xi_s=0.5,tension=4,tension.half=2",
        );
        let image = whole.mirrored();
        assert_eq!(
            image.regulator().unwrap().to_string(),
            "regulator:step,u0=0.75,omega=-0.1,amplitude=1,turnover=10,diffusion=1,diluted=false,xi_s=0.5,tension=4,tension.half=2"
        );
        assert_eq!(image.mirrored(), whole);
        // Scaling changes its strengths, not its source.
        let twice = whole.scaled(2.0).to_string();
        assert_eq!(twice, whole.to_string().replace("0.1+", "0.2+").replace("xi_s=0.5,tension=4", "xi_s=1,tension=8"));
        assert!(whole.scaled(0.0).is_none() && !whole.is_none());
        // Order does not matter.
        let text = "regulator:none,turnover=10,diffusion=1,activity=0.3,kappa=0.1";
        assert_eq!(cue(text).to_string(), text.replace("activity=0.3,kappa=0.1", "kappa=0.1,activity=0.3"));
        assert_eq!(
            cue(&format!("{text}+tension:gradient,amplitude=1")),
            cue(&format!("tension:gradient,amplitude=1+{text}"))
        );
        // Flow moves a regulator without a source. A regulator without a strength has no effect.
        assert!(!cue(text).is_none());
        let idle = "regulator:gradient,amplitude=0.5,turnover=10,diffusion=1,activity=0,kappa=0";
        assert!(cue(idle).is_none());
        let plain = cue(&format!("tension:gradient,amplitude=1+{idle}")).simplified();
        assert_eq!(plain, cue("tension:gradient,amplitude=1"));
        let less = cue("regulator:gradient,amplitude=0,turnover=10,diffusion=1,activity=0.3,kappa=0").simplified();
        assert_eq!(less, cue("regulator:none,turnover=10,diffusion=1,activity=0.3"));
    }

    #[test]
    fn fields_stay_above_zero_with_a_regulator_at_rest() {
        for line in include_str!("regulated.txt").lines() {
            let (sign, text) = line.split_once(' ').unwrap();
            assert_eq!(text.parse::<Cue>().is_ok(), sign == "positive", "{text}");
        }
    }

    #[test]
    fn steep_places_between_the_points_looked_at_are_seen() {
        let narrow = Profile::Band { u0: 0.4, omega: Width::Fraction(1e-3) };
        let most = (2.0f64).sqrt() * (-0.5f64).exp() / 1e-3;
        assert!((narrow.steepest(0.3, 0.5, 7.0) / most - 1.0).abs() < 1e-12);
        assert!(narrow.steepest(0.5, 0.6, 7.0) < 1e-100);
        assert_eq!(Profile::Gradient.steepest(0.0, 1.0, 7.0), 0.0);
    }
}
