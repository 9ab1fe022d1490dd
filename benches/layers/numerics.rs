//! The block solver: one Newton step of the first time step of a cell of R0 = 2.5, and its parts.

use divan::{Bencher, black_box};
use furrow_bvp::newton::{Newton, NewtonScratch};
use furrow_bvp::{Direction, Solution, System};
use furrow_cell::{Cell, Numerics};
use furrow_mechanics::cortex::observables::positions;
use furrow_mechanics::cortex::symmetry::unfold;
use furrow_mechanics::cortex::{Cortex, Domain};
use furrow_mechanics::equilibria::passive;

struct Step {
    system: System,
    cortex: Cortex,
    y: Solution,
    update: Direction,
}

/// A time step on the full contour, with derivatives, factors and residual at its start.
fn step() -> Step {
    let (cell, numerics) = (Cell::new(2.5), Numerics::default());
    let (half, _) = passive(&cell, &numerics).unwrap();
    let y = unfold(&half);
    let mut cortex = Cortex::new(&cell, Domain::Full, &[]);
    positions(&y, &mut cortex.past);
    cortex.rate = 100.0;
    let mut system = System::new(Cortex::dimensions_for(0), numerics.stages);
    system.evaluate(&mut cortex, &y, &[], true);
    system.condense().unwrap();
    system.factor_blocks(&[]).unwrap();
    let mut update = Direction::default();
    system.solve_own(&mut update);
    Step { system, cortex, y, update }
}

#[divan::bench]
fn residual(bencher: Bencher) {
    let Step { mut system, mut cortex, y, .. } = step();
    bencher.bench_local(|| system.evaluate(&mut cortex, black_box(&y), &[], false));
}

#[divan::bench]
fn residual_and_jacobian(bencher: Bencher) {
    let Step { mut system, mut cortex, y, .. } = step();
    bencher.bench_local(|| system.evaluate(&mut cortex, black_box(&y), &[], true));
}

#[divan::bench]
fn condense(bencher: Bencher) {
    let mut system = step().system;
    bencher.bench_local(|| system.condense());
}

#[divan::bench]
fn factor_blocks(bencher: Bencher) {
    let mut system = step().system;
    bencher.bench_local(|| system.factor_blocks(&[]));
}

#[divan::bench]
fn solve(bencher: Bencher) {
    let Step { mut system, mut update, .. } = step();
    bencher.bench_local(|| system.solve_own(&mut update));
}

/// Condense, factor and solve: the linear algebra of a factorisation.
#[divan::bench]
fn block_solve(bencher: Bencher) {
    let Step { mut system, mut update, .. } = step();
    bencher.bench_local(|| {
        system.condense().unwrap();
        system.factor_blocks(&[]).unwrap();
        system.solve_own(&mut update);
    });
}

#[divan::bench]
fn newton_step(bencher: Bencher) {
    let Step { mut system, mut cortex, y, mut update } = step();
    bencher.bench_local(|| {
        system.evaluate(&mut cortex, black_box(&y), &[], true);
        system.condense().unwrap();
        system.factor_blocks(&[]).unwrap();
        system.solve_own(&mut update);
    });
}

/// A further step with the same factors.
#[divan::bench]
fn chord_step(bencher: Bencher) {
    let Step { mut system, mut cortex, y, mut update } = step();
    bencher.bench_local(|| {
        system.evaluate(&mut cortex, black_box(&y), &[], false);
        system.solve_own(&mut update);
    });
}

/// A whole time step from the last shape.
#[divan::bench]
fn time_step(bencher: Bencher) {
    let Step { mut system, mut cortex, y, .. } = step();
    let (newton, mut scratch) = (Newton { tolerance: 3e-8, ..Newton::default() }, NewtonScratch::default());
    bencher.with_inputs(|| y.clone()).bench_local_values(|mut y| {
        newton.solve(&mut system, &mut scratch, &mut cortex, &mut y, &[], false).unwrap();
        y
    });
}
