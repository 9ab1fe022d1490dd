//! Divisions with m = 0 alone agree with furrow-mechanics for the same noise.

use furrow_cell::{Cell, Cue, Numerics};
use furrow_mechanics::division::{DivisionInput, divide};
use furrow_surface::division;

use crate::states::within;

/// |χ| and t_end differ by: absolute, relative. `share` is that of the default tolerance in time.
fn differences(cell: Cell, share: f64) -> [f64; 2] {
    let default = Numerics::default();
    let numerics = Numerics { time_tolerance: share * default.time_tolerance, ..default };
    let expected = divide(&DivisionInput::new(cell.clone())).unwrap();
    let input = DivisionInput { numerics, ..DivisionInput::new(cell) };
    let found = division::divide(&input, &mut |_, _| {}).unwrap().division;
    let of = |found: &furrow_mechanics::division::Division| found.chi_signed().unwrap();
    println!(
        "R0 = {}: χ {:.5} and {:.5}, t {:.5} and {:.5}, {} steps, volume off by {:.1e}",
        input.cell.r0,
        of(&found),
        of(&expected),
        found.t_end,
        expected.t_end,
        found.work.steps,
        found.volume_drift,
    );
    within("volume", found.volume_drift, 1e-8);
    [(of(&found) - of(&expected)).abs(), (found.t_end / expected.t_end - 1.0).abs()]
}

#[track_caller]
fn check(cell: Cell, share: f64, allowed: [f64; 2]) {
    let [chi, t_end] = differences(cell, share);
    within("χ", chi, allowed[0]);
    within("t_end", t_end, allowed[1]);
}

#[test]
fn cued_divisions_are_those_of_the_axisymmetric_equations() {
    for r0 in [2.5, 4.0, 5.4] {
        check(Cell::new(r0).with_cue(Cue::published()), 1.0, [0.002, 0.005]);
    }
}

#[test]
fn an_equal_division_is_that_of_the_axisymmetric_equations() {
    check(Cell::new(2.5), 1.0, [0.002, 0.005]);
}

/// It waits at the symmetric saddle: the time to leave it follows from how far the noise has gone in its only step.
#[test]
fn an_unequal_division_is_that_of_the_axisymmetric_equations() {
    check(Cell::new(2.0), 1.0, [0.003, 0.015]);
}

/// Several modes of the early furrow grow.
#[test]
fn a_large_cells_division_is_that_of_the_axisymmetric_equations() {
    check(Cell::new(5.4), 1.0, [0.002, 0.05]);
}

/// The viscosities and the friction are the only constants with a unit of time.
#[test]
fn a_division_does_not_depend_on_the_unit_of_time() {
    let [one, other] = [1.0, 30.0].map(|scale| {
        let mut cell = Cell::new(2.16).with_cue(Cue::published());
        cell.material.eta_b *= scale;
        cell.material.eta_s *= scale;
        cell.material.friction *= scale;
        let usual = Numerics { modes: 2, elements: 28, ..Numerics::default() };
        let numerics = Numerics { first_step: scale * usual.first_step, ..usual };
        let found = division::divide(&DivisionInput { numerics, ..DivisionInput::new(cell) }, &mut |_, _| {});
        let division = found.unwrap().division;
        [division.chi_signed().unwrap(), division.t_end / scale]
    });
    within("χ", (one[0] - other[0]).abs(), 1e-5);
    within("t_end", (one[1] - other[1]).abs(), 1e-5);
}

#[test]
#[ignore = "takes three seconds"]
fn shorter_steps_bring_times_closer() {
    check(Cell::new(2.0), 0.05, [0.002, 0.005]);
    check(Cell::new(5.4), 0.05, [0.002, 0.01]);
}
