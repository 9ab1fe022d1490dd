//! A surface that crosses itself is seen to.

use std::f64::consts::{PI, TAU};

use furrow_cell::{Cell, Numerics};
use furrow_surface::crossing::crossing;
use furrow_surface::embed::project;
use furrow_surface::problem::{Problem, State};
use furrow_surface::space::{Harmonic, Space};

use crate::states::{one_sided, steps, within};

/// A tube around a curve that bends back towards itself in the plane y = 0 until its ends are `apart`.
fn bent_tube(space: &Space, apart: f64) -> Vec<f64> {
    let count = space.harmonics.len();
    let mut surface = vec![0.0; space.coefficients()];
    let around = 24;
    for (place, harmonic) in space.harmonics.iter().enumerate() {
        let values: Vec<[f64; 2]> = space
            .stations
            .iter()
            .map(|station| {
                let mean = (0..around).map(|j| {
                    let phi = TAU * (j as f64 + 0.5) / f64::from(around);
                    let x = tube(station.u, phi, apart);
                    let factor = if let Harmonic::Along(m) = harmonic { if *m == 0 { 1.0 } else { 2.0 } } else { 1.0 };
                    factor
                        * match harmonic {
                            Harmonic::Across(k) => {
                                x[0] * (f64::from(*k) * phi).cos() + x[1] * (f64::from(*k) * phi).sin()
                            }
                            Harmonic::Along(m) => x[2] * (f64::from(*m) * phi).cos(),
                        }
                });
                [mean.sum::<f64>() / f64::from(around), 0.0]
            })
            .collect();
        for (spline, [value, _]) in project(space, place, &values).into_iter().enumerate() {
            surface[spline * count + place] = value;
        }
    }
    surface
}

/// Its radius is 0.3, its middle line an arc of radius 1 from one end to the other.
fn tube(u: f64, phi: f64, apart: f64) -> [f64; 3] {
    // The angle between the ends, so that they are `apart` at the nearest.
    let open = 2.0 * ((0.5 * apart) / 1.0).asin();
    let along = (TAU - open) * 0.5 * (PI * u).cos();
    let radius = 0.3 * (PI * u).sin();
    let out = radius * phi.cos();
    [(1.0 + out) * along.cos() - 1.0, radius * phi.sin(), (1.0 + out) * along.sin()]
}

#[test]
fn a_tube_bent_into_itself_crosses_itself() {
    let space = Space::new(40, 4);
    assert_eq!(crossing(&space, &bent_tube(&space, 0.2)), 0.0);
    let found = crossing(&space, &bent_tube(&space, -0.2));
    println!("deep by {found}");
    assert!(found > 0.05, "{found}");
}

/// Walls of a cell that divides from one side pass through each other without contact.
#[test]
fn walls_cross_without_contact_alone() {
    let depth = |(_, problem, state): &(f64, Problem, State)| crossing(&problem.space, &state.surface);
    let touching: Vec<f64> = one_sided().into_iter().map(depth).collect();
    let softness = 3.0 * one_sided()[0].1.contact_law()[0];
    println!("with contact {touching:?} of {softness} allowed");
    assert_eq!(touching[0], 0.0);
    within("walls in contact", touching.iter().copied().fold(0.0, f64::max), softness);
    let numerics = Numerics { modes: 3, elements: 32, contact: false, ..Numerics::default() };
    let passing: Vec<f64> = steps(Cell::new(2.0), numerics).iter().map(depth).collect();
    let deepest = passing.iter().copied().fold(0.0, f64::max);
    assert!(passing[0] == 0.0 && deepest > 3.0 * softness, "walls cross: {passing:?}");
}
