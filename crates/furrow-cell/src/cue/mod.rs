//! Polarity cues as data: a cue is a sum of terms, a term a field, a profile and an amplitude.
//!
//! | file | what it says |
//! |---|---|
//! | `field` | which coefficients of the equations a cue can modulate |
//! | `profile` | how a term is spread along the contour |
//! | `text` | the grammar of the command line: `kappa:band,u0=0.4,omega=0.1,amplitude=0.2` |
//! | `record` | the form in RON and JSON: `kappa(profile: band, u0: 0.4, omega: 0.1, amplitude: 0.2)` |

pub mod field;
pub mod profile;
mod record;
pub mod regulator;
mod text;

pub use field::Field;
pub use profile::{Profile, Quantity, Width};
pub use regulator::{Coupling, Regulator, RegulatorQuantity, Source};
pub use text::split_terms;

use crate::Number;

/// One term of a cue.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Term<D = f64> {
    /// What it modulates.
    pub field: Field,
    /// How it is spread along the contour.
    pub profile: Profile<D>,
    /// Amplitude A: relative to the field's own value, but for tension in κ0/L_h².
    pub amplitude: D,
}

impl<D: Number> Term<D> {
    /// A f, A ∂f/∂u and A ∂²f/∂u² at u on a contour of length `length`.
    pub fn at(&self, u: f64, length: D) -> [D; 3] {
        self.profile.at(u, length).map(|f| f * self.amplitude)
    }
}

impl Term {
    /// A number of it; none for a number that its profile does not have.
    pub fn quantity(mut self, quantity: Quantity) -> Option<f64> {
        self.quantity_mut(quantity).copied()
    }

    /// Where such a number is kept.
    pub fn quantity_mut(&mut self, quantity: Quantity) -> Option<&mut f64> {
        match quantity {
            Quantity::Amplitude => Some(&mut self.amplitude),
            other => self.profile.quantity_mut(other),
        }
    }

    /// The same term with its numbers turned into others, each told which it is.
    pub fn map<E>(&self, mut number: impl FnMut(Quantity, f64) -> E) -> Term<E> {
        Term {
            field: self.field,
            profile: self.profile.map(&mut number),
            amplitude: number(Quantity::Amplitude, self.amplitude),
        }
    }

    /// The term as seen from the other pole, u → 1 − u.
    pub fn mirrored(&self) -> Term {
        let (profile, sign) = self.profile.mirrored();
        Term { field: self.field, profile, amplitude: sign * self.amplitude }
    }
}

/// A polarity cue: what makes one part of the cortex differ from another. Terms add up, X(u) = X0·(1 + Σ A f(u)) for every
/// [`Field`] but tension, to which Σ A f(u) is added. The cue is switched on together with the activity.
///
/// ```
/// use furrow_cell::Cue;
///
/// let cue: Cue = "kappa:u0=0.4,omega=0.1,amplitude=0.1 + tension:gradient,amplitude=0.2".parse()?;
/// assert_eq!(cue.terms().len(), 2);
/// assert_eq!(cue.to_string(), "kappa:band,u0=0.4,omega=0.1,amplitude=0.1+tension:gradient,amplitude=0.2");
/// assert!("activity:band,u0=0.5,omega=0.1,amplitude=0.2".parse::<Cue>()?.is_mirror_symmetric());
/// # Ok::<(), furrow_cell::CueError>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Cue {
    terms: Vec<Term>,
    regulator: Option<Regulator>,
}

/// What is wrong with a cue.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{field} = {value}: must be {allowed}")]
pub struct CueError {
    /// The part of the cue.
    pub field: String,
    /// What it is.
    pub value: String,
    /// What it may be.
    pub allowed: String,
}

impl CueError {
    fn new(field: impl Into<String>, value: impl ToString, allowed: impl Into<String>) -> CueError {
        CueError { field: field.into(), value: value.to_string(), allowed: allowed.into() }
    }
}

impl Cue {
    /// No cue: both poles alike.
    pub const fn none() -> Cue {
        Cue { terms: Vec::new(), regulator: None }
    }

    /// The published cue of the germline: a band of stiffer cortex at u0 = 0.465 with ω = 0.0577 and Δκ = 0.1 (Table S3).
    pub fn published() -> Cue {
        Cue::kappa_band(0.465, 0.0577, 0.1)
    }

    /// κ(u) = κ·(1 + amplitude·exp(−(u − u0)²/omega²)), the kind of cue the paper uses.
    pub fn kappa_band(u0: f64, omega: f64, amplitude: f64) -> Cue {
        let profile = Profile::Band { u0, omega: Width::Fraction(omega) };
        Cue { terms: vec![Term { field: Field::Kappa, profile, amplitude }], regulator: None }
    }

    /// A sum of terms.
    ///
    /// # Errors
    /// [`CueError`] if a number is not allowed, or if together they bring a field that must be positive to zero.
    pub fn new(terms: Vec<Term>) -> Result<Cue, CueError> {
        Cue::with_regulator(terms, None)
    }

    /// A sum of terms, and what the flow carries.
    ///
    /// # Errors
    /// As of [`Cue::new`], and for numbers of the regulator.
    pub fn with_regulator(terms: Vec<Term>, regulator: Option<Regulator>) -> Result<Cue, CueError> {
        let cue = Cue { terms, regulator };
        cue.check()?;
        Ok(cue)
    }

    /// Its terms.
    pub fn terms(&self) -> &[Term] {
        &self.terms
    }

    /// Its terms, to be changed; what is set is not checked.
    pub fn terms_mut(&mut self) -> &mut [Term] {
        &mut self.terms
    }

    /// What the flow carries.
    pub fn regulator(&self) -> Option<&Regulator> {
        self.regulator.as_ref()
    }

    /// What the flow carries, to be changed; what is set is not checked.
    pub fn regulator_mut(&mut self) -> Option<&mut Regulator> {
        self.regulator.as_mut()
    }

    /// Whether it does nothing: no term, or none with an amplitude.
    pub fn is_none(&self) -> bool {
        *self == Cue::none() || self.simplified() == Cue::none()
    }

    /// Whether it is even about u = ½, so that shapes can be mirror-symmetric and pitchforks stay pitchforks. It is a
    /// property of what the terms do together to each coefficient of the equations, however they are written.
    pub fn is_mirror_symmetric(&self) -> bool {
        let cue = self.simplified();
        let scale: f64 = cue.terms.iter().map(|term| term.amplitude.abs()).sum();
        // Where an odd part would show: beside the places of the terms, and anywhere.
        let mut places: Vec<f64> = (0..32).map(|k| (f64::from(k) + 0.5) / 64.0).collect();
        for length in CONTOURS {
            for term in &cue.terms {
                let (u0, width) = (term.quantity(Quantity::U0), term.profile.width());
                let width = width.map_or(0.1, |omega| omega.in_u(length).abs());
                places.extend([-1.0, 0.0, 0.7].map(|k| u0.unwrap_or(0.0) + k * width));
            }
        }
        let odd = |coefficient: Field, u: f64, length: f64| {
            (cue.sum_at(coefficient, u, length) - cue.sum_at(coefficient, 1.0 - u, length)).abs()
        };
        let even = |coefficient: Field, length: f64| {
            places.iter().all(|&u| odd(coefficient, u.clamp(0.0, 1.0), length) <= EVEN * scale)
        };
        let touched = |coefficient: &Field| cue.terms.iter().any(|term| term.field.modulates(*coefficient));
        let mut coefficients = Field::ALL.into_iter().filter(touched);
        coefficients.all(|coefficient| CONTOURS.into_iter().all(|length| even(coefficient, length)))
    }

    /// Σ A f(u) over the terms that touch a coefficient.
    fn sum_at(&self, coefficient: Field, u: f64, length: f64) -> f64 {
        let touching = self.terms.iter().filter(|term| term.field.modulates(coefficient));
        touching.map(|term| term.at(u, length)[0]).sum()
    }

    /// The cue as seen from the other pole, u → 1 − u.
    pub fn mirrored(&self) -> Cue {
        Cue {
            terms: self.terms.iter().map(Term::mirrored).collect(),
            regulator: self.regulator.as_ref().map(Regulator::mirrored),
        }
    }

    /// The cue with all its amplitudes multiplied by `factor`.
    pub fn scaled(&self, factor: f64) -> Cue {
        Cue {
            terms: self.terms.iter().map(|term| Term { amplitude: factor * term.amplitude, ..*term }).collect(),
            regulator: self.regulator.clone(),
        }
    }

    /// The same cue with as few terms as say it: equal terms are one of their amplitudes together, and what does nothing is
    /// left out.
    pub fn simplified(&self) -> Cue {
        let mut terms: Vec<Term> = Vec::new();
        for term in &self.terms {
            match terms.iter_mut().find(|other| other.field == term.field && other.profile == term.profile) {
                Some(same) => same.amplitude += term.amplitude,
                None => terms.push(*term),
            }
        }
        terms.retain(|term| term.amplitude != 0.0);
        Cue { terms, regulator: self.regulator.clone() }
    }

    /// Checks every number, and that fields which must be positive stay so.
    ///
    /// # Errors
    /// [`CueError`] names the term's field and the number.
    pub fn check(&self) -> Result<(), CueError> {
        for (k, term) in self.terms.iter().enumerate() {
            let range = |low: f64, high, allowed, value| (!(low..=high).contains(&value)).then_some(allowed);
            for (quantity, allowed) in [
                (Quantity::U0, term.quantity(Quantity::U0).and_then(|u0| range(0.0, 1.0, "from 0 to 1", u0))),
                (Quantity::Omega, term.profile.refused_width()),
                (Quantity::Amplitude, range(-LARGEST, LARGEST, "from -10000 to 10000", term.amplitude)),
            ] {
                if let (Some(allowed), Some(value)) = (allowed, term.quantity(quantity)) {
                    return Err(CueError::new(self.label(k, quantity), value, allowed));
                }
            }
        }
        Field::POSITIVE.into_iter().try_for_each(|coefficient| self.check_positive(coefficient))
    }

    /// What errors call a number of term `k`.
    fn label(&self, k: usize, quantity: Quantity) -> String {
        let name = format!("{}.{}", self.terms[k].field.name(), quantity.name());
        if self.terms.len() > 1 { format!("cue[{k}].{name}") } else { name }
    }

    /// Whether 1 + Σ A f stays above 0 for a coefficient that must.
    fn check_positive(&self, coefficient: Field) -> Result<(), CueError> {
        let touching: Vec<usize> =
            (0..self.terms.len()).filter(|&k| self.terms[k].field.modulates(coefficient)).collect();
        let Some(&last) = touching.last() else { return Ok(()) };
        // Profiles keep within their range, whatever their width: a bound that needs no contour. Where it is not enough,
        // terms that lie apart are looked at along contours of all lengths that cells have.
        let bound = |k: &usize| {
            let [low, high] = self.terms[*k].profile.range();
            (self.terms[*k].amplitude * low).min(self.terms[*k].amplitude * high)
        };
        if 1.0 + touching.iter().map(bound).sum::<f64>() > 0.0 {
            return Ok(());
        }
        let lowest =
            1.0 + CONTOURS.into_iter().map(|length| self.lowest(coefficient, length)).fold(f64::INFINITY, f64::min);
        if touching.len() > 1 && lowest > 0.0 {
            return Ok(());
        }
        let allowed = match (touching.len(), self.terms[last].profile.range()) {
            (1, [-1.0, _]) => "above -1 and below 1".to_owned(),
            (1, _) => "a finite number above -1".to_owned(),
            _ => format!(
                "such that {} stays above 0 everywhere; with all terms it falls to {lowest:.3}",
                coefficient.name()
            ),
        };
        Err(CueError::new(self.label(last, Quantity::Amplitude), self.terms[last].amplitude, allowed))
    }

    /// Smallest Σ A f(u) on a contour of length `length`, looked for on a grid, at the places of the terms and between them.
    fn lowest(&self, coefficient: Field, length: f64) -> f64 {
        let mut centres: Vec<f64> = self.terms.iter().filter_map(|term| term.quantity(Quantity::U0)).collect();
        centres.sort_by(f64::total_cmp);
        let between: Vec<f64> = centres.windows(2).map(|pair| 0.5 * (pair[0] + pair[1])).collect();
        let grid = (0..=1000).map(|i| f64::from(i) / 1000.0);
        grid.chain(centres).chain(between).map(|u| self.sum_at(coefficient, u, length)).fold(f64::INFINITY, f64::min)
    }
}

/// Lengths of contours, in L_h, from those of the smallest cells that are asked about to those of the largest: a width in
/// L_h is another width in u on each.
const CONTOURS: [f64; 6] = [2.5, 4.0, 7.0, 12.0, 20.0, 40.0];

/// Odd parts of a cue below this, relative to its amplitudes, are roundings of 1 − u.
const EVEN: f64 = 1e-11;

/// Largest amplitude.
const LARGEST: f64 = 1e4;

#[cfg(test)]
mod tests {
    use super::*;

    fn cue(text: &str) -> Cue {
        text.parse().unwrap_or_else(|e| panic!("{text}: {e}"))
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
    fn steep_places_between_the_points_looked_at_are_seen() {
        let narrow = Profile::Band { u0: 0.4, omega: Width::Fraction(1e-3) };
        let most = (2.0f64).sqrt() * (-0.5f64).exp() / 1e-3;
        assert!((narrow.steepest(0.3, 0.5, 7.0) / most - 1.0).abs() < 1e-12);
        assert!(narrow.steepest(0.5, 0.6, 7.0) < 1e-100);
        assert_eq!(Profile::Gradient.steepest(0.0, 1.0, 7.0), 0.0);
    }
}
