//! The paper's time step compared with the converged one: its noise lasts one of its steps.

use crate::common::shapes::solve;
use furrow_cell::{Cell, Numerics, Scheme};
use furrow_mechanics::division::{Division, DivisionInput, Outcome, divide};

const GERMLINE: &str = "kappa:band,u0=0.465,omega=0.0577,amplitude=0.1";

fn published(cell: &Cell, dt: f64) -> Division {
    let numerics = Numerics { scheme: Scheme::Published, dt, ..Numerics::default() };
    divide(&DivisionInput { numerics, ..DivisionInput::new(cell.clone()) }).unwrap()
}

/// MotherComparison values of an independent solver with backward Euler at these steps. Its noise lasts for 0.001 τ, and here for one step: what
/// counts is amplitude times length.
#[test]
fn large_cells_divide_as_an_independent_solver_has_it() {
    let cell = Cell::gao2026_thresholds(5.4);
    for (dt, chi) in [(0.07, 0.708), (0.03, 0.723)] {
        let numerics = Numerics { scheme: Scheme::Published, dt, noise: 0.01 * 0.001 / dt, ..Numerics::default() };
        let found = divide(&DivisionInput { numerics, ..DivisionInput::new(cell.clone()) }).unwrap().chi().unwrap();
        println!("dt = {dt}: {found} beside {chi}");
        assert!((found - chi).abs() < 0.015, "dt = {dt}: {found}");
    }
    assert!((solve(cell).chi().unwrap() - 0.69).abs() < 0.01);
}

#[test]
fn the_germlines_cue_looks_flatter_at_a_step_of_a_tenth() {
    for (r0, coarse_chi, converged) in [(4.0, 0.208, 0.155), (5.4, 0.2095, 0.209)] {
        let cell = Cell::gao2026_thresholds(r0).with_cue(GERMLINE.parse().unwrap());
        let (coarse, fine) = (published(&cell, 0.1).chi().unwrap(), published(&cell, 0.01).chi().unwrap());
        println!("R0 = {r0}: {coarse}, {fine} at a tenth of the step");
        assert!((coarse - coarse_chi).abs() < 0.005, "R0 = {r0}: {coarse}");
        assert!((fine - converged).abs() < 0.005, "R0 = {r0}: {fine}");
    }
}

/// The noise lasts as long as the first step: at the published step it smears the upper edge of the unequal divisions.
#[test]
fn a_longer_noise_smears_the_edge_of_unequal_divisions() {
    let chi = |scheme: Scheme| {
        let numerics = Numerics { scheme, ..Numerics::default() };
        let at = |seed: u64| divide(&DivisionInput { numerics, seed, ..DivisionInput::new(Cell::new(2.27)) }).unwrap();
        (0..10).map(|seed| at(seed).chi().unwrap()).collect::<Vec<_>>()
    };
    let spread = |chi: &[f64]| chi.iter().copied().fold(0.0, f64::max) - chi.iter().copied().fold(1.0, f64::min);
    let (sharp, smeared) = (chi(Scheme::Converged), chi(Scheme::Published));
    println!("{sharp:?} {smeared:?}");
    assert!(spread(&smeared) > 3.0 * spread(&sharp), "{sharp:?} {smeared:?}");
}

/// Where Newton's method does not reach the first step from the passive shape, the step is lengthened: a shorter one would have less noise.
#[test]
fn the_noise_lasts_for_one_step_wherever_newtons_method_starts() {
    let chi = |time_tolerance: f64| {
        let numerics = Numerics { scheme: Scheme::Published, time_tolerance, ..Numerics::default() };
        divide(&DivisionInput { numerics, ..DivisionInput::new(Cell::new(3.0)) }).unwrap().chi().unwrap()
    };
    let [usual, strict] = [Numerics::default().time_tolerance, 4e-6].map(chi);
    println!("{usual}, {strict}");
    assert!((usual - strict).abs() < 0.1 * usual, "{usual}, {strict}");
}

/// Of order one, and towards the converged value.
#[test]
fn shorter_steps_converge_in_first_order() {
    let cell = Cell::gao2026_thresholds(4.0).with_cue(GERMLINE.parse().unwrap());
    let exact = solve(cell.clone()).chi().unwrap();
    let errors = [0.02, 0.01, 0.005].map(|dt| published(&cell, dt).chi().unwrap() - exact);
    println!("{errors:?}");
    assert!(errors.windows(2).all(|e| (1.5..3.0).contains(&(e[0] / e[1]))), "{errors:?}");
}

#[test]
fn small_cells_rest() {
    assert_eq!(published(&Cell::gao2026_thresholds(1.6), 0.1).outcome(), Outcome::Arrested);
    assert_eq!(published(&Cell::gao2026_thresholds(2.0), 0.1).outcome(), Outcome::Asymmetric);
}
