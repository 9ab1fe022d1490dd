//! One division of each kind.

use divan::black_box;
use furrow_cell::{Cell, Cue};
use furrow_mechanics::division::{Division, DivisionInput, divide};

/// One of each kind: its name, its radius, and whether it has the germline's cue.
const KINDS: [(&str, f64, bool); 5] = [
    ("symmetric 2.5", 2.5, false),
    ("asymmetric 2.0", 2.0, false),
    ("failed 1.6", 1.6, false),
    ("cued 5.4", 5.4, true),
    ("two furrows 5.4", 5.4, false),
];

#[divan::bench(args = KINDS.map(|(kind, ..)| kind))]
fn division(kind: &str) -> Division {
    let (_, r0, cued) = KINDS.into_iter().find(|(name, ..)| *name == kind).unwrap();
    let cue = if cued { Cue::published() } else { Cue::none() };
    divide(&DivisionInput::new(Cell::gao2026_thresholds(black_box(r0)).with_cue(cue))).unwrap()
}

/// The work of each.
pub fn print_work() {
    println!("division           outcome        chi steps rejected newton factorisations remeshings newton/step");
    for (kind, ..) in KINDS {
        let d = division(kind);
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
