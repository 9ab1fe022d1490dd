//! Stationary shapes, their stability, and the boundaries of division.

use divan::{Bencher, black_box};
use furrow::cortex::{Cue, Numerics, Parameter, Physics};
use furrow::shapes::symmetric::{BranchOptions, first_pitchfork, follow};
use furrow::shapes::{curves, stationary};

/// ξ_s of three rows of the reference branch at R0 = 2.
const ACTIVITIES: [f64; 3] = [8.6322, 20.7468, 25.8689];

pub fn print_work() {
    println!("branch of R0     steps rejected newton factorisations remeshings");
    for r0 in [1.64, 2.0] {
        let branch = follow(&Physics::GAO2026, &Numerics::default(), r0, &BranchOptions::default(), |_| true).unwrap();
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
    let physics = Physics { xi_s, ..Physics::GAO2026 };
    black_box(stationary(&physics, &Numerics::default(), 2.0, &Cue::None).unwrap());
}

#[divan::bench]
fn stability(bencher: Bencher) {
    let physics = Physics { xi_s: ACTIVITIES[1], ..Physics::GAO2026 };
    let shape = stationary(&physics, &Numerics::default(), 2.0, &Cue::None).unwrap();
    bencher.bench_local(|| shape.spectrum().unwrap());
}

#[divan::bench(args = [1.64, 2.0])]
fn pitchfork(r0: f64) {
    black_box(first_pitchfork(&Physics::GAO2026, &Numerics::default(), r0, &BranchOptions::default()).unwrap());
}

/// The curve of pitchforks from R0 = 2 down to 1.64.
#[divan::bench(sample_count = 20)]
fn boundary() {
    let range = [2.0, 1.64];
    black_box(curves::pitchfork_curve(&Physics::GAO2026, &Numerics::default(), 2.0, Parameter::R0, range).unwrap());
}
