//! Sensitivities where the cue follows PAR polarity, so that places and widths of its profiles change with the parameters:
//!
//! * \[P.5 places\] dχ/dp = ∂χ/∂p + Σ ∂χ/∂x · dx/dp, over the places and widths x,
//!
//! with dx/dp as central differences.

use furrow_cell::cue::{Profile, Quantity, RegulatorQuantity};
use furrow_cell::{Cell, Parameter};

use super::run::{Divided, DivisionOptions, Frame, run};
use super::start::Start;
use super::{DivisionError, DivisionInput, Sensitivity};
use crate::polarity::{self, PolarityError};

/// The step of the differences, relative to the parameter; the step by a parameter that is 0.
const STEP: f64 = 1e-3;

/// The numbers of a profile that follow PAR polarity.
const FOLLOWING: [Quantity; 2] = [Quantity::U0, Quantity::Omega];

/// The profiles of a cue, in their places.
type Places = Vec<Option<Profile>>;

/// The division and its derivatives, unless polarity ends next to the value of a parameter.
pub(super) fn divide(input: &DivisionInput, options: DivisionOptions<'_>) -> Divided {
    let refused = |source: PolarityError| DivisionError::Polarity { source };
    let DivisionOptions { mut observer, cancel, parameters: asked } = options;
    let cell = &input.cell;
    let places = polarity::placed(cell).map_err(refused)?;
    let resolved = polarity::with_profiles(cell, &places).map_err(refused)?;
    let own: Vec<Option<Parameter>> = asked.iter().map(|parameter| of_resolved(*parameter, cell, &places)).collect();
    let following: Vec<(usize, Quantity)> = following(cell, &places);
    let numbers = following.iter().map(|(k, quantity)| number(*k, *quantity, cell, &places));
    let parameters: Vec<Parameter> = own.iter().copied().flatten().chain(numbers).collect();
    let input = DivisionInput { cell: resolved, ..input.clone() };
    let mut observed = |frame: Frame<'_>| observer.iter_mut().for_each(|observer| observer(frame));
    let options = DivisionOptions { observer: Some(&mut observed), cancel, parameters: &parameters };
    let (division, by) = run(&input, &Start::Passive, options)?;
    let Some(by) = by else { return Ok((division, None)) };
    let (mut of_own, of_following) = by.split_at(parameters.len() - following.len());
    let mut all = Vec::with_capacity(asked.len());
    for (parameter, own) in asked.iter().zip(own) {
        let mut sum = Sensitivity::default();
        if let (Some(_), [first, rest @ ..]) = (own, of_own) {
            (sum, of_own) = (*first, rest);
        }
        let Some(slopes) = slopes(*parameter, cell, &following).map_err(refused)? else { return Ok((division, None)) };
        slopes.iter().zip(of_following).for_each(|(slope, by)| sum = sum.plus(*slope, by));
        all.push(sum);
    }
    Ok((division, Some(all)))
}

/// The numbers that follow polarity: the index of the profile and the quantity.
fn following(cell: &Cell, places: &Places) -> Vec<(usize, Quantity)> {
    let profiles = cell.cue.profiles().zip(places).enumerate();
    let follows = profiles.filter(|(_, (profile, place))| matches!(profile, Profile::Par { .. }) && place.is_some());
    follows.flat_map(|(k, _)| FOLLOWING.map(|quantity| (k, quantity))).collect()
}

/// A number of a profile as a parameter of the cell with profiles in their places, which may lack terms.
fn number(k: usize, quantity: Quantity, cell: &Cell, places: &Places) -> Parameter {
    match k < cell.cue.terms().len() {
        true => Parameter::Cue { term: places[..k].iter().flatten().count(), quantity },
        false => Parameter::Regulator(RegulatorQuantity::Source(quantity)),
    }
}

/// A parameter as the cell with profiles in their places has it; `None` if it does not act there.
fn of_resolved(parameter: Parameter, cell: &Cell, places: &Places) -> Option<Parameter> {
    let (k, quantity) = match parameter {
        Parameter::Cue { term, quantity } => (term, quantity),
        Parameter::Regulator(RegulatorQuantity::Source(quantity)) => (places.len() - 1, quantity),
        other => return Some(other),
    };
    let acts = !matches!(quantity, Quantity::Par(_)) && places.get(k).is_some_and(Option::is_some);
    acts.then(|| number(k, quantity, cell, places))
}

/// The derivatives of the following numbers by a parameter; `None` where polarity ends.
fn slopes(
    parameter: Parameter,
    cell: &Cell,
    following: &[(usize, Quantity)],
) -> Result<Option<Vec<f64>>, PolarityError> {
    let moves = match parameter {
        Parameter::Cue { quantity, .. } | Parameter::Regulator(RegulatorQuantity::Source(quantity)) => {
            matches!(quantity, Quantity::Par(_))
        }
        Parameter::Regulator(_) | Parameter::XiS => false,
        _ => true,
    };
    if !moves {
        return Ok(Some(vec![0.0; following.len()]));
    }
    let value = parameter.get(cell);
    let step = if value == 0.0 { STEP } else { STEP * value.abs() };
    let beside = |side: f64| -> Result<Option<Vec<f64>>, PolarityError> {
        let mut moved = cell.clone();
        parameter.set(&mut moved, value + side * step);
        let places = polarity::placed(&moved)?;
        Ok(following.iter().map(|(k, quantity)| places[*k]?.quantity(*quantity)).collect())
    };
    let (Some(above), Some(below)) = (beside(1.0)?, beside(-1.0)?) else { return Ok(None) };
    Ok(Some(above.iter().zip(below).map(|(above, below)| (above - below) / (2.0 * step)).collect()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::division::{divide, divide_with};
    use furrow_cell::Numerics;

    /// Derivatives agree with differences of divisions: by size, confinement and constants of the chemistry, which act through the
    /// place alone, and where another term precedes the one that follows polarity.
    #[test]
    fn places_that_follow_polarity_move_with_the_parameters() {
        let numerics = Numerics { time_tolerance: 1e-8, intervals: 96, noise: 0.0, ..Numerics::default() };
        for (cue, names) in [
            ("kappa:par_band,k_pa=1.9,amplitude=0.3", ["r0", "epsilon", "cue.amplitude", "cue.k_pa", "cue.d_a"]),
            (
                "tension:gradient,amplitude=0.1+kappa:par,amplitude=0.2",
                ["r0", "cue.amplitude", "cue[1].amplitude", "cue[1].k_ap", "cue[1].rho_p"],
            ),
        ] {
            let cell = Cell::gao2026_thresholds(4.0).with_cue(cue.parse().unwrap());
            let input = DivisionInput { numerics, ..DivisionInput::new(cell) };
            let parameters = names.map(|name| name.parse::<Parameter>().unwrap());
            let options = DivisionOptions { parameters: &parameters, ..DivisionOptions::default() };
            let (division, found) = divide_with(&input, options).unwrap();
            assert_eq!(division, super::super::divide(&input).unwrap());
            for (parameter, found) in parameters.into_iter().zip(found.unwrap()) {
                let value = parameter.get(&input.cell);
                let at = |amount: f64| {
                    let mut moved = input.clone();
                    parameter.set(&mut moved.cell, value * (1.0 + amount));
                    divide(&moved).unwrap().chi_signed().unwrap()
                };
                // The error of a division, 1e-6, is small beside the change by an amplitude for longer steps alone.
                let step = if parameter.name() == "amplitude" { 2e-2 } else { 2e-3 };
                let expected = (at(step) - at(-step)) / (2.0 * step * value);
                let floor = 3e-4 / value;
                assert!(
                    (found.chi_signed - expected).abs() < 0.01 * expected.abs() + floor,
                    "{cue} {parameter}: {found:?} {expected}"
                );
            }
        }
    }
}
