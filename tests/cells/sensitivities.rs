//! Derivatives of folds and pitchforks by every number of a cue, compared with differences.

use crate::common::shapes::first;
use furrow_cell::cue::Quantity;
use furrow_cell::{Cell, Cue, Numerics, Parameter};
use furrow_mechanics::calibration::sensitivity;
use furrow_mechanics::equilibria::{FoldPoint, StepBudget, curves, primary};

/// Steps of the differences, relative to the number varied: roundings of ξ_s and the fourth order of the differences are both
/// far below the tolerances then.
const STEP: f64 = 2e-4;

fn cue(text: &str) -> Cue {
    text.parse().unwrap()
}

/// Every number of a cell's cue.
fn quantities(cell: &Cell) -> Vec<Parameter> {
    let terms = 0..cell.cue.terms().len();
    let all = terms.flat_map(|term| Quantity::ALL.map(|quantity| Parameter::Cue { term, quantity }));
    all.filter(|parameter| parameter.is_of(cell)).collect()
}

/// The slope of ξ_s by differences of fourth order.
fn difference(cell: &Cell, parameter: Parameter, xi_s: impl Fn(&Cell) -> f64) -> f64 {
    let value = parameter.get(cell);
    let h = STEP * value.abs();
    let at = |steps: f64| {
        let mut moved = cell.clone();
        parameter.set(&mut moved, value + steps * h);
        xi_s(&moved)
    };
    (8.0 * (at(1.0) - at(-1.0)) - (at(2.0) - at(-2.0))) / (12.0 * h)
}

fn fold(cell: &Cell) -> FoldPoint {
    primary::failure_fold(cell, &Numerics::default(), &StepBudget::unlimited()).unwrap()
}

/// The fold that bounds division, of cells with one term of each profile, a width in L_h among them, and with two terms.
#[test]
fn the_failure_fold_moves_with_every_number_of_a_cue() {
    let cues = [
        "kappa:u0=0.465,omega=0.0577,amplitude=0.1",
        "activity:step,u0=0.45,omega=0.15,amplitude=0.05",
        "tension:gradient,amplitude=0.05",
        "kappa:u0=0.46,omega=0.5Lh,amplitude=0.1",
        "xi_s:u0=0.45,omega=0.6Lh,amplitude=0.05+tension:step,u0=0.4,omega=0.1,amplitude=0.02",
    ];
    let mut worst = 0.0f64;
    for text in cues {
        let cell = Cell::gao2026_thresholds(2.2).with_cue(cue(text));
        let found = fold(&cell);
        for parameter in quantities(&cell) {
            let curve = curves::through_fold(&cell, &found, parameter, true).unwrap();
            let slope = curves::curve_point(&curve, None).slope;
            let expected = difference(&cell, parameter, |cell| fold(cell).point.xi_s);
            let error = (slope / expected - 1.0).abs();
            println!("{text}, {parameter}: {slope:.6} {expected:.6}, {error:.1e}");
            worst = worst.max(error);
        }
    }
    println!("largest: {worst:.1e}");
    assert!(worst < 2e-6, "{worst}");
}

/// The pitchfork of an even cue, by the two ways there are to its slope.
#[test]
fn the_pitchfork_moves_with_the_width_and_amplitude_of_an_even_cue() {
    let mut worst = 0.0f64;
    for text in ["kappa:u0=0.5,omega=0.1,amplitude=0.1", "tension:u0=0.5,omega=0.8Lh,amplitude=0.05"] {
        let cell = Cell::gao2026_thresholds(2.2).with_cue(cue(text));
        let found = first(&cell);
        for quantity in [Quantity::Omega, Quantity::Amplitude] {
            let parameter = Parameter::Cue { term: 0, quantity };
            let curve = curves::through_pitchfork(&cell, &found, parameter, true).unwrap();
            let slope = curves::curve_point(&curve, None).slope;
            let again = sensitivity(&cell, &found.shape, parameter).unwrap();
            let expected = difference(&cell, parameter, |cell| first(cell).point.xi_s);
            let errors = [slope, again].map(|slope| (slope / expected - 1.0).abs());
            println!("{text}, {parameter}: {slope:.6} {again:.6} {expected:.6}, {errors:?}");
            worst = errors.into_iter().fold(worst, f64::max);
        }
    }
    println!("largest: {worst:.1e}");
    assert!(worst < 1e-7, "{worst}");
}
