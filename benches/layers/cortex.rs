//! Shapes without activity, and what is read off a shape.

use bvp::Gauss;
use divan::{Bencher, black_box};
use furrow::cortex::{Cortex, Cue, Domain, Numerics, Physics, shape};

#[divan::bench(args = [1.6, 2.5, 5.4])]
fn passive_shape(r0: f64) {
    black_box(shape::passive(&Physics::GAO2026, &Numerics::default(), black_box(r0)).unwrap());
}

#[divan::bench]
fn mesh_monitor(bencher: Bencher) {
    let (physics, numerics, r0) = (Physics::GAO2026, Numerics::default(), 2.5);
    let (half, _) = shape::passive(&physics, &numerics, r0).unwrap();
    let y = shape::unfold(&Gauss::new(numerics.stages), &half);
    let cortex = Cortex::new(&physics, r0, &Cue::None, Domain::Full, &[]);
    let mut weight = Vec::new();
    bencher.bench_local(|| shape::monitor(&cortex, black_box(&y), true, &mut weight));
}
