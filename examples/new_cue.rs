//! A new cue: activity steps up towards one pole, with a width that is fixed in L_h, while friction falls along the axis.
//! Computes the division of a cell with it, the mirror image, and the critical radius.
//!
//! A cue is any sum of fields and profiles. CONTRIBUTING.md says how to add a field or a profile.
//!
//! `cargo run --release --example new_cue`

use furrow::{Cell, Cue, Numerics};
use furrow::{DivisionInput, divide};
use furrow_cell::cue::{Field, Profile, Term, Width};
use furrow_mechanics::critical::critical_radius;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let step = Profile::Step { u0: 0.4, omega: Width::Length(0.8) };
    let cue = Cue::new(vec![
        Term { field: Field::Activity, profile: step, amplitude: 0.1, side: None },
        Term { field: Field::Friction, profile: Profile::Gradient, amplitude: 0.5, side: None },
    ])?;
    println!("{cue}");
    for cue in [cue.clone(), cue.mirrored()] {
        let division = divide(&DivisionInput::new(Cell::new(3.5).with_cue(cue)))?;
        println!("{}: χ = {:?}, daughters {:?}", division.outcome(), division.chi_signed(), division.daughters());
    }
    let critical = critical_radius(&Cell::new(1.0).with_cue(cue), &Numerics::default())?;
    println!("cells with it do not divide below R0 = {:.4}", critical.r0);
    Ok(())
}
