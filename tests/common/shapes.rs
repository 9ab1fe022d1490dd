//! Cells, their branches and thresholds.

use furrow_cell::{Cell, Numerics};
use furrow_mechanics::division::{Division, DivisionInput, Outcome, divide};
use furrow_mechanics::equilibria::{Branch, BranchOptions, Pitchfork, pitchfork, primary};

/// A cell of the preset in a shell of another size.
pub fn at(r0: f64, epsilon: f64) -> Cell {
    Cell { epsilon, ..Cell::gao2026_thresholds(r0) }
}

/// The division of a cell by the default numerics.
pub fn solve(cell: Cell) -> Division {
    let name = format!("R0 = {}, epsilon = {}, xi_s = {}, {}", cell.r0, cell.epsilon, cell.xi_s, cell.cue);
    divide(&DivisionInput::new(cell)).unwrap_or_else(|error| panic!("{name}: {error}"))
}

/// The whole branch of symmetric shapes of a cell.
pub fn whole(cell: &Cell) -> Branch {
    primary::follow(cell, &Numerics::default(), &BranchOptions::default(), |_| true).unwrap()
}

/// The first pitchfork of a cell.
pub fn first(cell: &Cell) -> Pitchfork {
    pitchfork::first(cell, &Numerics::default(), &BranchOptions::default()).unwrap()
}

/// Checks that a cell comes to rest a little below a threshold and divides a little above it.
pub fn check_threshold(margin: f64, cell: impl Fn(f64) -> Cell) {
    for (factor, rests) in [(1.0 - margin, true), (1.0 + margin, false)] {
        let cell = cell(factor);
        let outcome = solve(cell.clone()).outcome();
        assert_eq!(outcome == Outcome::Arrested, rests, "{factor} of the threshold: {cell:?}");
    }
}

/// Checks that two numbers agree to a relative deviation.
pub fn check_close(found: f64, expected: f64, tolerance: f64) {
    assert!((found / expected - 1.0).abs() < tolerance, "{found} is not {expected} to {tolerance:e}");
}
