//! Benchmarks, one module per layer of the crate. `cargo bench --bench layers` runs all of them,
//! `cargo bench --bench layers -- division` one layer.
//!
//! The work of each (Newton iterations, factorisations) is printed first, since it does not depend on the machine and its load.

#[path = "../common/clock.rs"]
mod clock;
mod cortex;
mod division;
mod lineage;
mod numerics;
#[allow(dead_code)]
#[path = "../../tests/common/stand_in.rs"]
mod stand_in;
mod steady;
mod surface;

fn main() {
    let listing = std::env::args().any(|argument| argument == "--list" || argument == "--test");
    if !listing {
        division::print_work();
        steady::print_work();
        surface::print_work();
    }
    divan::main();
}
