//! A cue that nobody has tried: contractility steps up towards one pole while friction falls along the axis, with a width
//! that keeps its size in L_h while cells shrink. Its division, its mirror image's, and what bounds cells that carry it.
//!
//! A cue is data: any sum of fields and profiles. A field that is not there yet is one variant in `cell/cue/field.rs` and its
//! place in `Local::modulate` of `cortex/equations.rs`, both in `crates/mechanics/src`; a profile is one variant in
//! `cell/cue/profile.rs` with its formula. Text, files, keys, errors, meshes and derivatives take both from there.
//!
//! `cargo run --release --example new_cue`

use furrow::cell::cue::{Field, Profile, Term, Width};
use furrow::cell::{Cell, Cue, Numerics};
use furrow::division::{DivisionInput, divide};
use furrow::shapes::critical_radius;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let step = Profile::Step { u0: 0.4, omega: Width::Length(0.8) };
    let cue = Cue::new(vec![
        Term { field: Field::Activity, profile: step, amplitude: 0.1 },
        Term { field: Field::Friction, profile: Profile::Gradient, amplitude: 0.5 },
    ])?;
    println!("{cue}");
    for cue in [cue.clone(), cue.mirrored()] {
        let division = divide(&DivisionInput::new(Cell::new(3.5).with_cue(cue)))?;
        println!("{}: χ = {:?}, daughters {:?}", division.outcome, division.chi_signed, division.daughters);
    }
    let critical = critical_radius(&Cell::new(1.0).with_cue(cue), &Numerics::default())?;
    println!("cells with it do not divide below R0 = {:.4}", critical.r0);
    Ok(())
}
