//! One division of each kind.

use divan::black_box;
use furrow_cell::{Cell, Cue};
use furrow_mechanics::division::{Division, DivisionInput, divide};

fn division(r0: f64, cue: Cue) -> Division {
    divide(&DivisionInput::new(Cell::new(black_box(r0)).with_cue(cue))).unwrap()
}

/// The work of one division of each kind.
pub fn print_work() {
    println!("division           outcome        chi steps rejected newton factorisations remeshings newton/step");
    for (kind, r0, cue) in [
        ("symmetric 2.5", 2.5, Cue::none()),
        ("asymmetric 2.0", 2.0, Cue::none()),
        ("failed 1.6", 1.6, Cue::none()),
        ("cued 5.4", 5.4, Cue::published()),
        ("two furrows 5.4", 5.4, Cue::none()),
    ] {
        let d = division(r0, cue);
        println!(
            "{kind:18} {:10} {:>7} {:5} {:8} {:6} {:14} {:10} {:11.2}",
            format!("{:?}", d.outcome()),
            d.chi().map_or("-".to_owned(), |chi| format!("{chi:.4}")),
            d.work.steps,
            d.work.rejected,
            d.work.iterations,
            d.work.factorisations,
            d.work.remeshings,
            d.work.iterations as f64 / d.work.steps as f64,
        );
    }
    println!();
}

#[divan::bench]
fn symmetric() -> Division {
    division(2.5, Cue::none())
}

#[divan::bench]
fn asymmetric() -> Division {
    division(2.0, Cue::none())
}

#[divan::bench]
fn failed() -> Division {
    division(1.6, Cue::none())
}

#[divan::bench]
fn cued() -> Division {
    division(5.4, Cue::published())
}

#[divan::bench]
fn two_furrows() -> Division {
    division(5.4, Cue::none())
}
