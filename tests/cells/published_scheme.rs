//! The paper's time step compared with the converged one: at 0.1 τ it loses the growing modes of large cells.

use crate::common::shapes::solve;
use furrow_cell::{Cell, Numerics, Scheme};
use furrow_mechanics::division::{Division, DivisionInput, Outcome, divide};

const GERMLINE: &str = "kappa:band,u0=0.465,omega=0.0577,amplitude=0.1";

fn published(cell: &Cell, dt: f64) -> Division {
    let numerics = Numerics { scheme: Scheme::Published, dt, ..Numerics::default() };
    divide(&DivisionInput { numerics, ..DivisionInput::new(cell.clone()) }).unwrap()
}

/// Beside values of an independent solver with backward Euler at these steps.
#[test]
fn large_cells_divide_equally_at_the_papers_step_alone() {
    let cell = Cell::new(5.4);
    for (dt, chi) in [(0.1, 0.0005), (0.07, 0.708), (0.03, 0.723)] {
        let found = published(&cell, dt).chi().unwrap();
        println!("dt = {dt}: {found} beside {chi}");
        assert!((found - chi).abs() < 0.01, "dt = {dt}: {found}");
    }
    assert_eq!(published(&cell, 0.1).outcome(), Outcome::Symmetric);
    assert!((solve(cell).chi().unwrap() - 0.69).abs() < 0.01);
}

#[test]
fn the_germlines_cue_looks_flatter_at_the_papers_step() {
    for (r0, chi, converged) in [(4.0, 0.182, 0.155), (5.4, 0.2195, 0.209)] {
        let cell = Cell::new(r0).with_cue(GERMLINE.parse().unwrap());
        let (coarse, fine) = (published(&cell, 0.1).chi().unwrap(), published(&cell, 0.01).chi().unwrap());
        println!("R0 = {r0}: {coarse} beside {chi}, {fine} at a tenth of the step");
        assert!((coarse - chi).abs() < 0.005, "R0 = {r0}: {coarse}");
        assert!((fine - converged).abs() < 0.005, "R0 = {r0}: {fine}");
    }
}

/// Of order one, and towards the converged value.
#[test]
fn shorter_steps_converge_in_first_order() {
    let cell = Cell::new(4.0).with_cue(GERMLINE.parse().unwrap());
    let exact = solve(cell.clone()).chi().unwrap();
    let errors = [0.02, 0.01, 0.005].map(|dt| published(&cell, dt).chi().unwrap() - exact);
    println!("{errors:?}");
    assert!(errors.windows(2).all(|e| (1.5..3.0).contains(&(e[0] / e[1]))), "{errors:?}");
}

#[test]
fn small_cells_rest() {
    assert_eq!(published(&Cell::new(1.6), 0.1).outcome(), Outcome::Arrested);
    assert_eq!(published(&Cell::new(2.0), 0.1).outcome(), Outcome::Asymmetric);
}
