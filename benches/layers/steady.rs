//! Stationary shapes, their stability, and the boundaries of division.

use divan::{Bencher, black_box};
use furrow_cell::{Cell, Numerics, Parameter};
use furrow_mechanics::equilibria::{BranchOptions, curves, pitchfork, primary, stationary};

/// ξ_s of three rows of the reference branch at R0 = 2.
const ACTIVITIES: [f64; 3] = [8.6322, 20.7468, 25.8689];

pub fn print_work() {
    println!("branch of R0     steps rejected newton factorisations remeshings");
    for r0 in [1.64, 2.0] {
        let branch =
            primary::follow(&Cell::gao2026_thresholds(r0), &Numerics::default(), &BranchOptions::default(), |_| true)
                .unwrap();
        let w = branch.work;
        println!(
            "{r0:12} {:9} {:8} {:6} {:14} {:10}",
            w.steps, w.rejected, w.iterations, w.factorisations, w.remeshings
        );
    }
    println!();
}

#[divan::bench(args = ACTIVITIES)]
fn stationary_shape(xi_s: f64) {
    black_box(stationary(&Cell { xi_s, ..Cell::gao2026_thresholds(2.0) }, &Numerics::default()).unwrap());
}

#[divan::bench]
fn stability(bencher: Bencher) {
    let shape =
        stationary(&Cell { xi_s: ACTIVITIES[1], ..Cell::gao2026_thresholds(2.0) }, &Numerics::default()).unwrap();
    bencher.bench_local(|| shape.spectrum().unwrap());
}

#[divan::bench(args = [1.64, 2.0])]
fn pitchfork(r0: f64) {
    black_box(
        pitchfork::first(&Cell::gao2026_thresholds(r0), &Numerics::default(), &BranchOptions::default()).unwrap(),
    );
}

/// The curve of pitchforks from R0 = 2 down to 1.64.
#[divan::bench(sample_count = 20)]
fn boundary() {
    let range = [2.0, 1.64];
    black_box(
        curves::pitchfork_curve(&Cell::gao2026_thresholds(2.0), &Numerics::default(), Parameter::R0, range).unwrap(),
    );
}
