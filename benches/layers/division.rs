//! One division of each kind.

use divan::black_box;
use furrow_cell::{Cell, Law};
use furrow_mechanics::division::{Division, DivisionInput, divide};

/// The germline's cue, painted and carried.
const PAINTED: &str = "kappa:band,u0=0.465,omega=0.0577,amplitude=0.1";
const CARRIED: &str = "regulator:band,u0=0.465,omega=0.0577,amplitude=0.1,turnover=25,diffusion=1,kappa=1";

/// One of each kind: its name, its radius, and its cue.
const KINDS: [(&str, f64, &str); 7] = [
    ("symmetric 2.5", 2.5, "none"),
    ("asymmetric 2.0", 2.0, "none"),
    ("failed 1.6", 1.6, "none"),
    ("cued 5.4", 5.4, PAINTED),
    ("two furrows 5.4", 5.4, "none"),
    ("carried 5.4", 5.4, CARRIED),
    ("self-organised 2.5", 2.5, "regulator:none,turnover=10,diffusion=1,activity=0.3"),
];

#[divan::bench(args = KINDS.map(|(kind, ..)| kind))]
fn division(kind: &str) -> Division {
    let (_, r0, cue) = KINDS.into_iter().find(|(name, ..)| *name == kind).unwrap();
    divide(&DivisionInput::new(Cell::gao2026_thresholds(black_box(r0)).with_cue(cue.parse().unwrap()))).unwrap()
}

/// A division of R0 = 2.5 with a law of its own: the paper's as text, the same with rates of strain, and with a moment. The built-in law is
/// `symmetric 2.5` with other constants.
const LAWS: [(&str, &str); 4] =
    [("built-in", ""), ("text", ""), ("rates of strain", "0.5*(S_uu + S_phiphi)"), ("moment", "0.1*C^2")];

#[divan::bench(args = LAWS.map(|(name, _)| name))]
fn own_law(name: &str) -> Division {
    let (_, more) = LAWS.into_iter().find(|(other, _)| *other == name).unwrap();
    let cell = Cell::new(black_box(2.5));
    if name == "built-in" {
        return divide(&DivisionInput::new(cell)).unwrap();
    }
    let added = if more.is_empty() { String::new() } else { format!(" + {more}") };
    let moment = if name == "moment" { ", moment: \"0.2*C\"" } else { "" };
    let text = format!(
        "Law(name: \"x\", stress_uu: \"gain*(xi_b*C + xi_s*(c1 - c2)/2){added}\", stress_phiphi: \"gain*(xi_b*C - xi_s*(c1 - c2)/2){added}\"{moment})"
    );
    divide(&DivisionInput::new(cell.with_law(Law::parse(&text, "law").unwrap()))).unwrap()
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
