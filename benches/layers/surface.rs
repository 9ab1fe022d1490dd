//! Divisions without axial symmetry.

use divan::black_box;
use furrow_cell::{Cell, Cue, Numerics};
use furrow_mechanics::division::DivisionInput;
use furrow_surface::division::{SurfaceDivision, divide};
use furrow_surface::space::Space;

use crate::clock;

/// One of each kind: its name, its radius, and whether it has the germline's cue.
const KINDS: [(&str, f64, bool); 3] =
    [("one-sided 2.0", 2.0, false), ("bent rest 1.4", 1.4, false), ("cued 5.4", 5.4, true)];

fn numerics() -> Numerics {
    Numerics { modes: 4, ..Numerics::default() }
}

#[divan::bench(args = KINDS.map(|(kind, ..)| kind), sample_count = 3, sample_size = 1)]
fn surface(kind: &str) -> SurfaceDivision {
    let (_, r0, cued) = KINDS.into_iter().find(|(name, ..)| *name == kind).unwrap();
    let cell = Cell::new(black_box(r0));
    let cell = if cued { cell.with_cue(Cue::published()) } else { cell };
    divide(&DivisionInput { numerics: numerics(), ..DivisionInput::new(cell) }, &mut |_, _| {}).unwrap()
}

/// The work of each.
pub fn print_work() {
    println!(
        "surface            outcome        chi modes unknowns steps rejected newton factorisations processor time"
    );
    for (kind, ..) in KINDS {
        let start = clock::now();
        let SurfaceDivision { division: d, modes, .. } = surface(kind);
        println!(
            "{kind:18} {:10} {:>7} {:5} {:8} {:5} {:8} {:6} {:14} {:12.2} s",
            format!("{:?}", d.outcome()),
            d.chi().map_or("-".to_owned(), |chi| format!("{chi:.4}")),
            modes,
            Space::new(numerics().elements, modes).unknowns(),
            d.work.steps,
            d.work.rejected,
            d.work.iterations,
            d.work.factorisations,
            clock::now() - start,
        );
    }
    println!();
}
