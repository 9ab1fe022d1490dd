//! Passive shapes and their observables.

use divan::{Bencher, black_box};
use furrow_cell::{Cell, Numerics};
use furrow_mechanics::cortex::symmetry::unfold;
use furrow_mechanics::cortex::{Cortex, Domain, resolution};
use furrow_mechanics::equilibria::passive;

#[divan::bench(args = [1.6, 2.5, 5.4])]
fn passive_shape(r0: f64) {
    black_box(passive(&Cell::gao2026_thresholds(black_box(r0)), &Numerics::default()).unwrap());
}

#[divan::bench]
fn mesh_monitor(bencher: Bencher) {
    let cell = Cell::gao2026_thresholds(2.5);
    let (half, _) = passive(&cell, &Numerics::default()).unwrap();
    let y = unfold(&half);
    let cortex = Cortex::new(&cell, Domain::Full, &[]);
    let mut weight = Vec::new();
    let mut places = resolution::Places::default();
    bencher.bench_local(|| resolution::monitor(&cortex, black_box(&y), true, &mut places, &mut weight));
}
