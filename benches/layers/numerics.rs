//! The block solver: one Newton step of the first time step of a cell of R0 = 2.5, and its parts.

use divan::{Bencher, black_box};
use furrow_bvp::newton::{Newton, NewtonScratch};
use furrow_bvp::{BoundaryValueProblem, Direction, Solution, System};
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
    let (cell, numerics) = (Cell::gao2026_thresholds(2.5), Numerics::default());
    let (half, _) = passive(&cell, &numerics).unwrap();
    let y = unfold(&half);
    let mut cortex = Cortex::new(&cell, Domain::Full, &[]);
    positions(&y, &mut cortex.past);
    cortex.rate = 100.0;
    let mut system = System::new(cortex.dimensions(), numerics.stages);
    system.factorise(&mut cortex, &y, &[]).unwrap();
    let mut update = Direction::default();
    system.solve_own(&mut update).unwrap();
    Step { system, cortex, y, update }
}

impl Step {
    fn evaluate(&mut self, with_derivatives: bool) {
        self.system.evaluate(&mut self.cortex, black_box(&self.y), &[], with_derivatives).unwrap();
    }

    /// The linear algebra of a factorisation.
    fn solve_blocks(&mut self) {
        self.system.condense().unwrap();
        self.system.factor_blocks(&[]).unwrap();
        self.system.solve_own(&mut self.update).unwrap();
    }
}

/// A name and the code to time.
type Part = (&'static str, fn(&mut Step));

/// Parts of a Newton step. A chord step is a further one with the same factors.
const PARTS: [Part; 8] = [
    ("residual", |step| step.evaluate(false)),
    ("residual and Jacobian", |step| step.evaluate(true)),
    ("condense", |step| step.system.condense().unwrap()),
    ("factor blocks", |step| step.system.factor_blocks(&[]).unwrap()),
    ("solve", |step| step.system.solve_own(&mut step.update).unwrap()),
    ("condense, factor and solve", Step::solve_blocks),
    ("Newton step", |step| {
        step.evaluate(true);
        step.solve_blocks();
    }),
    ("chord step", |step| {
        step.evaluate(false);
        step.system.solve_own(&mut step.update).unwrap();
    }),
];

#[divan::bench(args = PARTS.map(|(name, _)| name))]
fn newton(bencher: Bencher, name: &str) {
    let (_, part) = PARTS.into_iter().find(|(part, _)| *part == name).unwrap();
    let mut step = step();
    bencher.bench_local(|| part(&mut step));
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
