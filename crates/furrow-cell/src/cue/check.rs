//! Checks of the numbers of a cue, individually and in combination.

use super::{Coupling, Cue, CueError, Field, ParConstant, Profile, Quantity, RegulatorQuantity, Side};

/// Contour lengths in L_h, from the smallest to the largest cells; they convert a width in L_h to a width in u.
pub(super) const CONTOURS: [f64; 6] = [2.5, 4.0, 7.0, 12.0, 20.0, 40.0];

/// Largest amplitude, strength, turnover and diffusion.
const LARGEST: f64 = 1e4;

/// Smallest diffusion of a regulator; below it the profiles are too narrow for the mesh.
pub const LEAST_DIFFUSION: f64 = 0.05;

/// A full turn, with a margin for the rounding of degrees.
const TURN: f64 = 2.0 * std::f64::consts::PI + 1e-9;

/// Smallest spread of a side, in radians; smaller ones are not resolved by the meridians of a surface.
const NARROWEST_SIDE: f64 = 0.3;
/// Largest spread, which covers the whole circumference.
const WIDEST_SIDE: f64 = 10.0;

/// The first invalid number of a profile and its amplitude, with the allowed values.
fn refused(profile: &Profile, amplitude: f64) -> Option<(Quantity, f64, &'static str)> {
    let range = |low: f64, high, allowed, value| (!(low..=high).contains(&value)).then_some(allowed);
    let of_par = |constant: ParConstant| {
        let value = profile.quantity(Quantity::Par(constant));
        (Quantity::Par(constant), value, value.and_then(|value| constant.refused(value)))
    };
    let [u0, omega] = [Quantity::U0, Quantity::Omega].map(|quantity| profile.quantity(quantity));
    [
        (Quantity::U0, u0, u0.and_then(|u0| range(0.0, 1.0, "from 0 to 1", u0))),
        (Quantity::Omega, omega, profile.refused_width()),
        (Quantity::Amplitude, Some(amplitude), range(-LARGEST, LARGEST, "from -10000 to 10000", amplitude)),
    ]
    .into_iter()
    .chain(ParConstant::ALL.into_iter().map(of_par))
    .find_map(|(quantity, value, allowed)| Some((quantity, value?, allowed?)))
}

/// The condition on an amplitude for 1 + A f to be positive.
fn above_zero(profile: &Profile) -> &'static str {
    match profile.range() {
        [-1.0, _] => "above -1 and below 1",
        _ => "a finite number above -1",
    }
}

/// The first invalid number of a side, by its key, with the allowed values.
fn refused_side(side: &Side) -> Option<(&'static str, f64, &'static str)> {
    let Side { at, spread } = *side;
    if !(-TURN..=TURN).contains(&at) {
        return Some(("at", at, "from -2π to 2π, or in degrees, as 90deg"));
    }
    let fine = (NARROWEST_SIDE..=WIDEST_SIDE).contains(&spread);
    (!fine).then_some(("spread", spread, "from 0.3 to 10, in radians, or in degrees, as 60deg"))
}

/// The smallest and the largest value of A f.
fn values(profile: &Profile, amplitude: f64) -> [f64; 2] {
    let [a, b] = profile.range().map(|f| amplitude * f);
    [a.min(b), a.max(b)]
}

impl RegulatorQuantity {
    /// The allowed values if this value is invalid. The numbers of a source need only be finite.
    pub fn refused(self, value: f64) -> Option<&'static str> {
        let (fine, allowed) = match self {
            RegulatorQuantity::Source(Quantity::Par(constant)) => return constant.refused(value),
            RegulatorQuantity::Source(_) => (value.is_finite(), "a finite number"),
            RegulatorQuantity::Turnover => ((0.0..=LARGEST).contains(&value), "from 0 to 10000, in 1/τ"),
            RegulatorQuantity::Diffusion => (
                (LEAST_DIFFUSION..=LARGEST).contains(&value),
                "from 0.05 to 10000, in L_h²/τ: with less a regulator cannot be resolved",
            ),
            RegulatorQuantity::Strength(_) => (value.abs() <= LARGEST, "from -10000 to 10000"),
            RegulatorQuantity::Half(_) => (value > 0.0 && value <= LARGEST, "above 0 and at most 10000"),
        };
        (!fine).then_some(allowed)
    }
}

impl Cue {
    /// Checks every number, and that positive fields remain positive. A regulator is assumed to be between 0 and its source, as at
    /// rest; flow may take it beyond.
    ///
    /// # Errors
    /// [`CueError`] names the term's field and the number.
    pub fn check(&self) -> Result<(), CueError> {
        for (k, term) in self.terms.iter().enumerate() {
            if let Some((quantity, value, allowed)) = refused(&term.profile, term.amplitude) {
                return Err(CueError::new(self.label(k, quantity.name()), value, allowed));
            }
            if let Some((key, value, allowed)) = term.side.as_ref().and_then(refused_side) {
                return Err(CueError::new(self.label(k, key), value, allowed));
            }
        }
        self.check_regulator()?;
        Field::POSITIVE.into_iter().try_for_each(|coefficient| self.check_positive(coefficient))
    }

    fn check_regulator(&self) -> Result<(), CueError> {
        let Some(regulator) = &self.regulator else { return Ok(()) };
        let not_allowed = |quantity: RegulatorQuantity, value: f64, allowed: &str| {
            Err(CueError::new(format!("regulator.{}", quantity.name()), value, allowed))
        };
        if let Some(source) = &regulator.source {
            let positive = || {
                let negative = regulator.diluted && values(&source.profile, source.amplitude)[0] <= -1.0;
                negative.then(|| (Quantity::Amplitude, source.amplitude, above_zero(&source.profile)))
            };
            if let Some((quantity, value, allowed)) = refused(&source.profile, source.amplitude).or_else(positive) {
                return not_allowed(RegulatorQuantity::Source(quantity), value, allowed);
            }
        }
        for quantity in regulator.quantities() {
            let value = regulator.quantity(quantity).unwrap_or(f64::NAN);
            if let Some(allowed) = quantity.refused(value) {
                return not_allowed(quantity, value, allowed);
            }
        }
        if regulator.couplings.is_empty() {
            return Err(CueError::new("regulator", "(no field)", "given with what it does, as in activity=0.3"));
        }
        // The couplings are in the order of their fields.
        match regulator.couplings.windows(2).find(|pair| pair[0].field == pair[1].field) {
            Some([_, Coupling { field, strength, .. }]) => {
                not_allowed(RegulatorQuantity::Strength(*field), *strength, "given once: it is given twice")
            }
            _ => Ok(()),
        }
    }

    /// The name of a number of term `k` in errors.
    fn label(&self, k: usize, key: &str) -> String {
        let name = format!("{}.{key}", self.terms[k].field.name());
        if self.terms.len() > 1 { format!("cue[{k}].{name}") } else { name }
    }

    /// Whether 1 + Σ A f + Σ B h is positive for a coefficient that must be.
    fn check_positive(&self, coefficient: Field) -> Result<(), CueError> {
        let touching: Vec<usize> =
            (0..self.terms.len()).filter(|&k| self.terms[k].field.modulates(coefficient)).collect();
        let carried = self.carried(coefficient);
        // The range of a profile does not depend on its width, which gives a bound without a contour. If it does not suffice,
        // the sum is evaluated along contours of all lengths that cells have, since terms may not overlap.
        let bound = |k: &usize| values(&self.terms[*k].profile, self.terms[*k].amplitude)[0];
        let least = carried.map_or(0.0, |(least, _)| least);
        if 1.0 + touching.iter().map(bound).sum::<f64>() + least > 0.0 {
            return Ok(());
        }
        let lowest = 1.0
            + CONTOURS.into_iter().map(|length| self.lowest(coefficient, length)).fold(f64::INFINITY, f64::min)
            + least;
        let parts = touching.len() + usize::from(carried.is_some());
        if parts > 1 && lowest > 0.0 {
            return Ok(());
        }
        let everywhere = format!("such that {} stays above 0 everywhere; ", coefficient.name());
        match (carried, touching.last()) {
            (Some((_, Coupling { field, strength, .. })), _) => {
                let allowed = format!("{everywhere}with the regulator at rest it falls to {lowest:.3}");
                Err(CueError::new(format!("regulator.{}", field.name()), strength, allowed))
            }
            (None, Some(&last)) => {
                let allowed = match parts {
                    1 => above_zero(&self.terms[last].profile).to_owned(),
                    _ => format!("{everywhere}with all terms it falls to {lowest:.3}"),
                };
                Err(CueError::new(self.label(last, Quantity::Amplitude.name()), self.terms[last].amplitude, allowed))
            }
            (None, None) => Ok(()),
        }
    }

    /// The smallest value that the regulator adds to a coefficient at rest, and the last coupling that contributes. At rest φ lies
    /// between 0 and the extremes of the source, by the maximum principle.
    fn carried(&self, coefficient: Field) -> Option<(f64, Coupling)> {
        const PLACES: u32 = 256;
        let regulator = self.regulator.as_ref()?;
        let touching = || regulator.couplings.iter().filter(|coupling| coupling.field.modulates(coefficient));
        let last = *touching().next_back()?;
        let [low, high] = regulator.source.map_or([0.0; 2], |source| values(&source.profile, source.amplitude));
        let [low, high] = [low.min(0.0), high.max(0.0)];
        let added = |k: u32| {
            let phi = low + (high - low) * f64::from(k) / f64::from(PLACES);
            touching().map(|coupling| coupling.at(phi)[0]).sum::<f64>()
        };
        Some(((0..=PLACES).map(added).fold(f64::INFINITY, f64::min), last))
    }

    /// Smallest Σ A f(u) on a contour of length `length`, sought on a grid, at the positions of the terms and between them.
    fn lowest(&self, coefficient: Field, length: f64) -> f64 {
        let mut centres: Vec<f64> = self.terms.iter().filter_map(|term| term.quantity(Quantity::U0)).collect();
        centres.sort_by(f64::total_cmp);
        let between: Vec<f64> = centres.windows(2).map(|pair| 0.5 * (pair[0] + pair[1])).collect();
        let grid = (0..=1000).map(|i| f64::from(i) / 1000.0);
        let angles = self.angles();
        let around = |u| angles.iter().map(move |&phi| (u, phi));
        let sums = grid
            .chain(centres)
            .chain(between)
            .flat_map(around)
            .map(|(u, phi)| self.sum_at(coefficient, u, phi, length));
        sums.fold(f64::INFINITY, f64::min)
    }
}
