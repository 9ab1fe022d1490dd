//! One division of each kind.

use divan::black_box;
use furrow::cortex::{Cue, Numerics, Physics};
use furrow::division::{Division, DivisionInput, divide};

const CUE: Cue = Cue::Kappa { u0: 0.465, omega: 0.0577, amplitude: 0.1 };

fn division(r0: f64, cue: Cue) -> Division {
    let (physics, numerics) = (Physics::GAO2026, Numerics::default());
    divide(&DivisionInput { physics, numerics, r0: black_box(r0), cue, seed: 0 }).unwrap()
}

pub fn print_work() {
    println!("division           outcome        chi steps rejected newton factorisations remeshings newton/step");
    for (kind, r0, cue) in [
        ("symmetric 2.5", 2.5, Cue::None),
        ("asymmetric 2.0", 2.0, Cue::None),
        ("failed 1.6", 1.6, Cue::None),
        ("cued 5.4", 5.4, CUE),
        ("two furrows 5.4", 5.4, Cue::None),
    ] {
        let d = division(r0, cue);
        println!(
            "{kind:18} {:10} {:>7} {:5} {:8} {:6} {:14} {:10} {:11.2}",
            format!("{:?}", d.outcome),
            d.chi.map_or("-".to_owned(), |chi| format!("{chi:.4}")),
            d.steps,
            d.rejected,
            d.newton_iterations,
            d.factorisations,
            d.remeshings,
            f64::from(d.newton_iterations) / f64::from(d.steps),
        );
    }
    println!();
}

#[divan::bench]
fn symmetric() -> Division {
    division(2.5, Cue::None)
}

#[divan::bench]
fn asymmetric() -> Division {
    division(2.0, Cue::None)
}

#[divan::bench]
fn failed() -> Division {
    division(1.6, Cue::None)
}

#[divan::bench]
fn cued() -> Division {
    division(5.4, CUE)
}

#[divan::bench]
fn two_furrows() -> Division {
    division(5.4, Cue::None)
}
