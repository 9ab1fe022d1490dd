//! Shells between plates, and cues at one side of the axis.

use std::f64::consts::PI;

use furrow_cell::{Cell, Cue, Numerics, RigidityGradient};
use furrow_mechanics::division::DivisionInput;
use furrow_surface::division::{divide, start};
use furrow_surface::plane::{Plates, turned};

use crate::states::within;

fn pressed(flattening: f64) -> Cell {
    let mut cell = Cell::new(2.0);
    cell.shell.flattening = flattening;
    cell
}

fn cue(text: &str) -> Cue {
    text.parse().unwrap()
}

/// Turned by a quarter, the mirror plane lies across the plates.
#[test]
fn a_passive_cell_between_plates_is_the_same_seen_from_both_mirror_planes() {
    let numerics = Numerics { modes: 4, elements: 32, ..Numerics::default() };
    let widths = |plates| {
        let (problem, state) = start(&pressed(0.8), plates, &numerics).unwrap();
        let (space, mut functions) = (&problem.space, Vec::new());
        space.functions(&state.surface, &space.station(0.5), &mut functions);
        let at = |phi: f64| space.shape(&functions, &space.meridian(phi))[0];
        ([at(0.0)[0], at(0.5 * PI)[1]], state.pressure)
    };
    let ([wide, thin], p) = widths(Plates::Beside);
    let ([thin_across, wide_across], p_across) = widths(Plates::Across);
    assert!(thin < 0.8 * wide, "{thin} {wide}");
    within("width", (wide / wide_across - 1.0).abs(), 2e-4);
    within("thickness", (thin / thin_across - 1.0).abs(), 2e-4);
    within("pressure", (p / p_across - 1.0).abs(), 2e-4);
}

#[test]
fn a_mirror_plane_holds_all_sides_or_the_cell_is_refused() {
    let term = |angles: &str| format!("activity:u0=0.4,omega=0.1,amplitude=0.1,at={angles}deg,spread=1");
    let place = |flattening: f64, angles: [&str; 2]| {
        let cell = pressed(flattening).with_cue(cue(&angles.map(term).join("+")));
        turned(&cell).map(|(cell, plates)| {
            let sides = cell.cue.terms().iter().filter_map(|term| term.side);
            (sides.map(|side| side.at.to_degrees().round()).collect::<Vec<_>>(), plates)
        })
    };
    assert_eq!(place(1.0, ["30", "210"]), Ok((vec![0.0, 180.0], Plates::Beside)));
    assert_eq!(place(0.8, ["90", "-90"]), Ok((vec![0.0, 180.0], Plates::Across)));
    assert_eq!(place(0.8, ["180", "0"]), Ok((vec![0.0, 180.0], Plates::Beside)));
    let refused = |flattening, angles| place(flattening, angles).unwrap_err().to_string();
    assert!(refused(1.0, ["30", "60"]).contains("no common plane"));
    assert!(refused(0.8, ["30", "210"]).contains("set at = 0deg"));
    let mut cell = pressed(1.0).with_cue(cue(&term("0")));
    cell.material.rigidity_gradient = RigidityGradient::Dropped;
    assert!(turned(&cell).unwrap_err().to_string().contains("rigidity_gradient = full"));
}

/// The equator of a cell at rest lies away from the more active side, as far for a cue at φ = 0 as for its mirror image.
#[test]
fn a_cue_at_one_side_moves_the_cell_to_the_other() {
    let numerics = Numerics { modes: 2, elements: 32, ..Numerics::default() };
    let lean = |at: &str| {
        // The first term fixes the mirror plane.
        let text = format!(
            "tension:u0=0.5,omega=0.1,amplitude=1e-9,at=0,spread=1+activity:u0=0.5,omega=0.1,amplitude=0.5,at={at},spread=1"
        );
        let cell = Cell { xi_s: 6.0, ..Cell::new(1.5) }.with_cue(cue(&text));
        let found = divide(&DivisionInput { numerics, ..DivisionInput::new(cell) }, &mut |_, _| ()).unwrap();
        let rest = found.rest.unwrap();
        let (space, mut functions) = (&rest.problem.space, Vec::new());
        let mut middle = |u: f64| {
            space.functions(&rest.state.surface, &space.station(u), &mut functions);
            let [right, left] = [0.0, PI].map(|phi| space.shape(&functions, &space.meridian(phi))[0][0]);
            0.5 * (right + left)
        };
        middle(0.5) - middle(0.25)
    };
    let (front, back) = (lean("0"), lean("180deg"));
    assert!(front < -5e-4, "{front}");
    within("lean", (front + back).abs(), 1e-7);
}
