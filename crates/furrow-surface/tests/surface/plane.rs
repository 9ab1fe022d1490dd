//! Shells between plates, and cues at one side of the axis.

use std::f64::consts::PI;

use furrow_cell::cue::Side;
use furrow_cell::{Cell, Cue, Numerics, RigidityGradient};
use furrow_mechanics::division::DivisionInput;
use furrow_surface::division::{divide, start};
use furrow_surface::law::{Vector, wall_force};
use furrow_surface::plane::{Plates, turned};
use furrow_surface::problem::Problem;
use furrow_surface::space::Space;

use crate::states::within;

fn pressed(flattening: f64) -> Cell {
    let mut cell = Cell::new(2.0);
    cell.shell.flattening = flattening;
    cell
}

fn cue(text: &str) -> Cue {
    text.parse().unwrap()
}

/// f_c = −∇(P0 exp((q − 1)/w²))·n with q = Σ x²/axis².
#[test]
fn the_force_of_a_flattened_shell_is_the_slope_of_its_wall() {
    let cell = pressed(0.8);
    let problem = Problem::new(&cell, Space::new(12, 2));
    let axes = problem.inverse_axes2();
    let [x, y, z] = axes.map(|inverse| inverse.recip().sqrt());
    within("volume", (x * y * z * cell.epsilon / cell.r0.powi(3) - 1.0).abs(), 1e-12);
    within("thickness", (y / x - 0.8f64.powf(1.5)).abs(), 1e-12);
    within("aspect", (z / x - cell.shell.aspect).abs(), 1e-12);
    let wall = |at: Vector<f64>| {
        let reach: f64 = at.iter().zip(axes).map(|(x, inverse)| x * x * inverse).sum();
        cell.shell.p0 * ((reach - 1.0) / (cell.shell.w * cell.shell.w)).exp()
    };
    let place = problem.place_at(0.5, 1.0);
    let (at, normal) = ([0.7 * x, 0.5 * y, 0.4 * z], [0.6, 0.64, 0.48]);
    let moved = |h: f64| wall([0, 1, 2].map(|k| at[k] + h * normal[k]));
    let slope = (moved(1e-5) - moved(-1e-5)) / 2e-5;
    within("force", (wall_force(&place, &normal, &at) / -slope - 1.0).abs(), 1e-7);
    let [[x, y, z], turned] = [Plates::Beside, Plates::Across].map(|plates| plates.factors(0.8));
    assert_eq!(turned, [y, x, z]);
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
fn the_share_of_a_side_is_1_at_its_middle_and_the_same_all_around_a_pole() {
    let side = Side { at: 0.5, spread: 0.8 };
    within("middle", (side.share(0.5, 0.5) - 1.0).abs(), 1e-15);
    within("slope", (side.share(0.5, 0.6) / (-0.01f64 / 0.64).exp() - 1.0).abs(), 3e-5);
    within("pole", (side.share(0.0, 0.5) - side.share(0.0, 3.0)).abs(), 1e-12);
    within("far", (side.share(0.5, 0.5 + PI) - (-4.0f64 / 0.64).exp()).abs(), 1e-12);
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
