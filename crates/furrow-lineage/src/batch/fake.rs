//! Fast stand-ins for divisions, for the tests of this module.

use furrow_bvp::Work;

use furrow_cell::Cell;
use furrow_mechanics::division::{Division, DivisionInput, Ending};

pub fn input(r0: f64) -> DivisionInput {
    DivisionInput::new(Cell::new(r0))
}

/// A stand-in for the solver: cells of radius 8 and more divide equally, cells of 1 to 8 unequally, and smaller cells do not divide. The
/// radii of the daughters add up to the mother's radius.
pub fn divide(input: &DivisionInput) -> Division {
    let r0 = input.cell.r0;
    let chi = if r0 < 8.0 { 0.1 * (8.0 - r0) } else { 0.0 };
    let daughters = [-1.0, 1.0].map(|sign| 0.5 * r0 * (1.0 + sign * chi));
    Division {
        ending: match r0 >= 1.0 {
            false => Ending::Arrested { growth_rate: None },
            true => Ending::Divided { symmetric: chi == 0.0, chi_signed: -chi, u_furrow: 0.5, daughters },
        },
        t_end: 1.0 / r0,
        slow_growth_rate: None,
        neck_offset: None,
        second_neck: None,
        phi: None,
        volume_drift: 1e-12,
        work: Work { steps: 100, rejected: 1, iterations: 300, factorisations: 120, remeshings: 5 },
    }
}
