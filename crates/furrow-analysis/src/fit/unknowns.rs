//! The numbers of a cue, and between which values they are searched.

use furrow_cell::cue::{Profile, Quantity, RegulatorQuantity, Width};
use furrow_cell::{Cell, Cue, Parameter};

use crate::constants::{ConstantKind, named};

/// Between which values the numbers of a cue are searched: places, widths in u, widths in L_h, amplitudes and strengths;
/// turnovers, diffusions and half-saturations of a regulator.
const PLACES: [f64; 2] = [0.05, 0.95];
const WIDTHS: [f64; 2] = [0.01, 0.5];
const LENGTHS: [f64; 2] = [0.05, 5.0];
pub(super) const AMPLITUDES: [f64; 2] = [0.005, 2.0];
const TURNOVERS: [f64; 2] = [0.1, 100.0];
const DIFFUSIONS: [f64; 2] = [0.05, 20.0];
const HALVES: [f64; 2] = [0.1, 100.0];
const SATURATING: [f64; 2] = [0.005, 200.0];
/// How a number is searched.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Unknown {
    pub kind: ConstantKind,
    pub limits: [f64; 2],
    /// By its logarithm; else evenly.
    pub logarithmic: bool,
    /// Sign of an amplitude, which the search keeps.
    pub sign: f64,
    /// The class of cells that have it: its name and founders; `None` for all cells.
    pub founders: Option<(String, Vec<usize>)>,
    /// Founders among these that have a number of their own in its place.
    pub except: Vec<usize>,
}

impl Unknown {
    /// Whether cells of a founder have it.
    pub fn is_of(&self, founder: usize) -> bool {
        !self.except.contains(&founder)
            && self.founders.as_ref().is_none_or(|(_, founders)| founders.contains(&founder))
    }

    /// Its name, as `cue[0].amplitude` or `epsilon@somatic`.
    pub fn name(&self) -> String {
        named(self.kind, self.founders.as_ref().map(|(class, _)| class.as_str()))
    }

    pub fn value(&self, share: f64) -> f64 {
        let [from, to] = self.limits;
        let share = share.clamp(0.0, 1.0);
        self.sign * if self.logarithmic { from * (to / from).powf(share) } else { from + share * (to - from) }
    }

    /// The share of the range at which a value lies; `None` outside.
    pub fn share(&self, value: f64) -> Option<f64> {
        let ([from, to], value) = (self.limits, self.sign * value);
        let share =
            if self.logarithmic { (value / from).ln() / (to / from).ln() } else { (value - from) / (to - from) };
        (0.0..=1.0).contains(&share).then_some(share)
    }

    /// The length of the range, by the logarithm where that is searched.
    pub fn length(&self) -> f64 {
        let [from, to] = self.limits;
        if self.logarithmic { (to / from).ln() } else { to - from }
    }

    /// The factor from a derivative by the number to one by its logarithm, where that is searched.
    pub fn scale(&self, share: f64) -> f64 {
        if self.logarithmic { self.value(share) } else { 1.0 }
    }
}

/// The numbers of a cue.
pub(crate) fn unknowns(cue: &Cue) -> Vec<Unknown> {
    let cell = Cell::new(1.0).with_cue(cue.clone());
    let of = |parameter: Parameter| {
        let value = parameter.get(&cell);
        let limits = limits(parameter, cue);
        let logarithmic = limits != PLACES;
        let sign = if logarithmic { value.signum() } else { 1.0 };
        // A turnover of 0 means no turnover.
        let searched = parameter != Parameter::Regulator(RegulatorQuantity::Turnover) || value != 0.0;
        let kind = ConstantKind::Parameter(parameter);
        searched.then_some(Unknown { kind, limits, logarithmic, sign, founders: None, except: Vec::new() })
    };
    Parameter::of_cue(cue).into_iter().filter_map(of).collect()
}

/// Between which values a number of a cue is searched.
fn limits(parameter: Parameter, cue: &Cue) -> [f64; 2] {
    let of_spread = |quantity, profile: Option<Profile>| match (quantity, profile.and_then(|profile| profile.width())) {
        (Quantity::U0, _) => PLACES,
        (Quantity::Omega, Some(Width::Length(_))) => LENGTHS,
        (Quantity::Omega, _) => WIDTHS,
        (Quantity::Amplitude | Quantity::Par(_), _) => AMPLITUDES,
    };
    let source = || cue.regulator().and_then(|regulator| regulator.source).map(|source| source.profile);
    match parameter {
        Parameter::Cue { term, quantity } => of_spread(quantity, cue.terms().get(term).map(|term| term.profile)),
        Parameter::Regulator(RegulatorQuantity::Source(quantity)) => of_spread(quantity, source()),
        Parameter::Regulator(RegulatorQuantity::Turnover) => TURNOVERS,
        Parameter::Regulator(RegulatorQuantity::Diffusion) => DIFFUSIONS,
        Parameter::Regulator(RegulatorQuantity::Half(_)) => HALVES,
        // A coupling that saturates gives less than its strength.
        Parameter::Regulator(RegulatorQuantity::Strength(field))
            if cue.regulator().is_some_and(|of| of.quantity(RegulatorQuantity::Half(field)).is_some()) =>
        {
            SATURATING
        }
        _ => AMPLITUDES,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_number_of_a_regulator_is_searched_in_its_range() {
        let cue: Cue = "tension:gradient,amplitude=-0.3+regulator:step,u0=0.4,omega=-0.3Lh,amplitude=1,turnover=10,diffusion=1,kappa=-0.2,tension=30,tension.half=10"
            .parse()
            .unwrap();
        let cell = Cell::new(1.0).with_cue(cue.clone());
        let found = unknowns(&cue);
        assert_eq!(
            found.iter().map(|unknown| unknown.kind.parameter().unwrap()).collect::<Vec<_>>(),
            Parameter::of_cue(&cue)
        );
        for Unknown { kind, limits: [from, to], logarithmic, sign, .. } in found {
            let parameter = kind.parameter().unwrap();
            let size = sign * parameter.get(&cell);
            assert!(
                (from..=to).contains(&size) && (logarithmic || sign == 1.0),
                "{parameter}: {size} from {from} to {to}"
            );
            // Both ends are allowed.
            for end in [from, to] {
                assert!(parameter.validate(sign * end).is_ok(), "{parameter} = {end}");
            }
        }
        let still = "regulator:none,turnover=0,diffusion=1,activity=0.3".parse().unwrap();
        let names: Vec<String> = unknowns(&still).iter().map(|unknown| unknown.kind.to_string()).collect();
        assert_eq!(names, ["regulator.diffusion", "regulator.activity"]);
    }
}
